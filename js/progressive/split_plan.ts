// What the writer of a split knows of it, and what a split changed.

/** A triangle that a split makes, as the writer knows it; wedges by the names that {@link SplitPlan} has for them. */
export interface PlannedTriangle {
  /** Vertex of the mesh beside s and t. */
  readonly third: number;
  /** Whether s, t, third is its direction, and not t, s, third. */
  readonly forward: boolean;
  readonly group: number;
  /** Names of the wedges at s, t and third. */
  readonly wedges: readonly [number, number, number];
  /** Called with the triangle's number once it has one, and the places of s, t and third in it. */
  made(triangle: number, places: readonly [number, number, number]): void;
}

/** What the writer knows of a split. */
export interface SplitPlan {
  /** The name of the wedge that a corner at s has afterwards, at t; undefined for a corner that stays. */
  moved(corner: number): number | undefined;
  readonly triangles: readonly PlannedTriangle[];
  /** The number of a wedge with this name; undefined before it has one. */
  numberOf(name: number): number | undefined;
  /** The wedge that a new one came from, {@link NONE} if nothing of its set is there yet. */
  parentOf(name: number): number;
  setOf(name: number): number;
  /** A wedge has got its number: its name, and its values are put into the mesh. */
  named(name: number, wedge: number): void;
  /** Puts the position of the new vertex into the mesh. */
  place(vertex: number): void;
}

/** What a split changed. */
export interface SplitEffect {
  readonly from: number;
  readonly vertex: number;
  /** Corners that went over, and their wedges afterwards. */
  readonly moved: readonly number[];
  readonly movedTo: readonly number[];
  /** The wedges that they had. */
  readonly formerly: readonly number[];
  readonly firstTriangle: number;
}
