// One level of detail among many: which is asked for, and what it is.

/**
 * Why there are not fewer triangles: the count was reached, the next step would exceed the error, nothing more can be
 * removed without damage, or the time budget was spent.
 */
export type StopReason = 'target' | 'error' | 'constraints' | 'time';

/**
 * How many of the edges that are left when a run ends are blocked by what. Each edge counts once, for the first reason
 * in the order of the sweep: what its ends lie on, the error, the topology, the flip test.
 */
export interface Blockers {
  /** Between vertices on seams of texture coordinates, colours, skins or materials, but not along one seam. */
  readonly seam: number;
  /** At a vertex where seams meet, end or reach a border. */
  readonly corner: number;
  /** Between vertices on open borders, but not along the border. */
  readonly border: number;
  /** Where more than two faces meet in an edge, or several sheets in a point. */
  readonly nonManifold: number;
  /** At a vertex that may not move. */
  readonly locked: number;
  /** The surface would hang together in another way, or a part of it would vanish. */
  readonly topology: number;
  /** A triangle would turn over or become degenerate. */
  readonly flip: number;
  /** The estimated error would exceed the limit. */
  readonly error: number;
  /** Nothing stands against the edge by itself. */
  readonly other: number;
}

/** A selected level of detail. */
export interface LevelSummary {
  readonly triangles: number;
  readonly vertices: number;
  /** Estimated deviation from the original in model units; 0 at full detail. Not measured. */
  readonly estimatedError: number;
  readonly stopReason: StopReason;
  /** What blocks the edges that are left, at the last level of a run that ended for `'error'` or `'constraints'`. */
  readonly blockers: Blockers | null;
}

/** Where to stop; of several targets, the first that is reached. */
export interface Targets {
  /** Keep this share of the triangles, 0 to 1. 1 keeps all, 0 goes as far as the shape allows. */
  readonly ratio?: number | undefined;
  /** Keep at most this many triangles, an integer ≥ 0. */
  readonly triangles?: number | undefined;
  /**
   * Largest estimated deviation: a number ≥ 0 in model units, or `'0.1%'` of the bounding box's diagonal. 0 removes
   * only what changes nothing.
   */
  readonly error?: number | `${number}%` | undefined;
}

/** From where a model is looked at, to turn an error into pixels. */
export interface ScreenView {
  /** From the eye to the model's centre, model units, > 0. Default: where the model's bounding sphere just fits. */
  readonly distance?: number | undefined;
  /** Vertical angle of view in degrees, above 0 and below 180. Default 45. */
  readonly fieldOfView?: number | undefined;
  /** Height of the picture in pixels, > 0. Default 1080. */
  readonly viewportHeight?: number | undefined;
}

/** Which of the recorded levels; of several targets, the first that is reached. */
export interface LevelTargets extends Targets {
  /**
   * Largest estimated deviation as it appears on the screen, in pixels ≥ 0, when the model is looked at as `view` says:
   * an error of e model units takes e · viewportHeight / (2 · distance · tan(fieldOfView / 2)) pixels.
   */
  readonly pixels?: number | undefined;
  /** What `pixels` refers to; without them it has no effect. */
  readonly view?: ScreenView | undefined;
}
