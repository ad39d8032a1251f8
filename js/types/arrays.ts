// Triangle meshes as arrays: what is given, and what comes back.
import type { Blockers, StopReason } from './levels.js';

/** Arrays of numbers that attributes may come in. */
export type AttributeArray =
  | Float32Array
  | Float64Array
  | Int8Array
  | Uint8Array
  | Uint8ClampedArray
  | Int16Array
  | Uint16Array
  | Int32Array
  | Uint32Array;

/**
 * Vertex attributes by name, each an array of the same number of values for every vertex.
 *
 * Known names: `normal` (3, unit length), `uv` (2), `color` (3 or 4), `tangent` (4, the last ±1), `joints` (4) with
 * `weights` (4). `uv1`, `color2`… are further sets of the same kind. Other names may have 1 to 16 components; where
 * vertices merge, theirs are interpolated in float arrays and taken from the nearer vertex in integer arrays.
 */
export interface MeshAttributes {
  readonly normal?: AttributeArray;
  readonly uv?: AttributeArray;
  readonly color?: AttributeArray;
  readonly tangent?: AttributeArray;
  readonly joints?: AttributeArray;
  readonly weights?: AttributeArray;
  readonly [name: string]: AttributeArray | undefined;
}

/** A triangle mesh as arrays. */
export interface MeshInput {
  /** x, y, z for each vertex; finite. */
  readonly positions: Float32Array;
  /** Three for each triangle; absent: every three vertices are a triangle. */
  readonly indices?: Uint32Array | Uint16Array | undefined;
  readonly attributes?: MeshAttributes | undefined;
}

/** A simplified mesh. The arrays are the caller's own. */
export interface SimplifiedMesh {
  readonly positions: Float32Array;
  readonly indices: Uint32Array;
  /** The attributes that were given, in arrays of the type they came in. */
  readonly attributes: Readonly<Record<string, AttributeArray>>;
  /** Estimated deviation from the original in the units of the positions. Not measured. */
  readonly estimatedError: number;
  readonly stopReason: StopReason;
  /** As in `LevelSummary`. */
  readonly blockers: Blockers | null;
  /** For each vertex, the vertex of the input that it came from. */
  readonly vertexMap: Uint32Array;
}

/** The vertices of a level that some groups share. */
export interface WedgeSetGeometry {
  /** x, y, z for each vertex, in the mesh's local space. */
  readonly positions: Float32Array;
  /** By name; `components` numbers for each vertex. */
  readonly attributes: Readonly<Record<string, { readonly components: number; readonly values: Float32Array }>>;
}

/** The triangles of a level in one group. */
export interface GroupGeometry {
  readonly mesh: number;
  readonly primitive: number;
  /** Three for each triangle, into the wedge set's vertices. */
  readonly indices: Uint32Array;
  readonly wedgeSet: number;
}

/** A level as arrays, ready for a renderer. The arrays are the caller's own. */
export interface LevelGeometry {
  readonly groups: readonly GroupGeometry[];
  readonly wedgeSets: readonly WedgeSetGeometry[];
}
