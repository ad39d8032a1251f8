// How to simplify, how to measure, and what may accompany both.
import type { Targets } from './levels.js';

/**
 * Time against quality. `'fast'` collapses edges and no more, and merges vertices where they are as long as there are far more
 * than wanted; `'balanced'` fits the remaining vertices to the original surface, one round where it pays; `'best'` takes finer
 * sweeps and three rounds of fitting.
 */
export type Preset = 'fast' | 'balanced' | 'best';

/**
 * What attributes weigh in the cost of a collapse beside positions, each as a multiple (a number ≥ 0) of a weight that
 * is found for the model. 0: nothing is done to keep it; its values follow the vertices all the same. Default 1 for each.
 */
export interface AttributeWeights {
  /** Normals, and with them the shading. */
  readonly normal?: number | undefined;
  /** Texture coordinates, by the length on the surface that a texture would be displaced. */
  readonly uv?: number | undefined;
  /** Vertex colours. */
  readonly color?: number | undefined;
  /** Displacements of the first eight morph targets, and of skins over the animations of a file. */
  readonly morph?: number | undefined;
}

/** How to simplify. */
export interface SimplifyOptions extends Targets {
  /** Open borders do not move. Default false. */
  readonly lockBorder?: boolean | undefined;
  /** Parts that are down to one triangle or tetrahedron may vanish, cheapest first; one always stays. Default false. */
  readonly prune?: boolean | undefined;
  /** What attributes weigh; by default what looks best. */
  readonly attributeWeights?: AttributeWeights | undefined;
  /** `'optimal'` (default) puts vertices where the error is least; `'subset'` uses only original positions. */
  readonly placement?: 'optimal' | 'subset' | undefined;
  /** Default `'balanced'`. It matters for a run to one level; one whose every level is wanted is the same with each. */
  readonly preset?: Preset | undefined;
  /**
   * Milliseconds that the simplification may take, a number ≥ 0; no target, but a limit on the way to one. When they
   * are spent, what was done so far is the result and its stop reason is `'time'`. Looked at about every 10 ms, and not
   * while a large mesh is made ready; the same budget gives another result on another machine. Default: no limit.
   */
  readonly timeBudget?: number | undefined;
  /**
   * Vertices of separate parts of a mesh that are nearer than this may merge although no edge joins them: a number ≥ 0
   * in model units, or `'0.1%'` of the bounding box's diagonal. 0 (default) keeps separate what is. Where parts have
   * merged, more than two faces may meet in an edge.
   */
  readonly mergeDistance?: number | `${number}%` | undefined;
  /**
   * Most bytes the engine may take for the run beside the mesh, a number ≥ 0. What the run will take is estimated before
   * it starts, from above; more is the error `too-large`, which names both figures. Default: what WebAssembly can have.
   */
  readonly memoryLimit?: number | undefined;
}

/** How to simplify bare arrays. */
export interface MeshSimplifyOptions extends SimplifyOptions {
  /**
   * How dear collapses are at each vertex: a finite number ≥ 0 multiplies their cost by 1 + weight, so that they come
   * later. 0 is neutral, 10 protects, 1e6 is the most there is and gives way only when nothing else is left. Positions
   * and the estimated error are not weighted. What changes nothing, as in a flat place, goes all the same.
   */
  readonly weights?: Float32Array | undefined;
  /** For each vertex whether it stays: where it is not 0 the vertex neither moves nor vanishes. */
  readonly locked?: Uint8Array | undefined;
}

/** How to simplify a document, whose levels can be asked for afterwards. */
export interface DocumentSimplifyOptions extends SimplifyOptions {
  /**
   * The largest distance of either surface from the other that may be measured: a number > 0 in model units, or `'0.1%'` of
   * the bounding box's diagonal. Records every level, and selects the coarsest level found whose maximum, measured both ways
   * as {@link Document.measure} does, is below it by 1 %, for what another look may find.
   * Collapses that would lead beyond it are refused, and others go on, unless there is a `timeBudget` or a `weightAttribute`:
   * then the level is one of the record. Takes up to twenty runs and measurements. Beside other targets, the first that is
   * reached counts. Default: nothing is measured.
   */
  readonly maximumDeviation?: number | `${number}%` | undefined;
  /**
   * Levels beside the target are wanted too. Each is then as good as a sweep to that level alone, but the final fit of
   * the presets, which improves the target's level only, is left out. Default: true when no target is given.
   */
  readonly everyLevel?: boolean | undefined;
  /**
   * The levels recorded by an earlier run stay at hand for `level()`; this run gives the selected level alone. Without
   * an earlier run it has no effect. Default false.
   */
  readonly keepLevels?: boolean | undefined;
  /**
   * The vertex attribute that has the weights of {@link MeshSimplifyOptions}, by the file's name for it, with a component
   * or else the first: `'_WEIGHT'`, `'COLOR_0.g'`. Vertices without it weigh 0. Default: nothing is weighted.
   */
  readonly weightAttribute?: string | undefined;
  /**
   * As {@link MeshSimplifyOptions}' `weights`, one number for each of the document's vertices: those of its wedge sets
   * in order. Instead of `weightAttribute`.
   */
  readonly weights?: Float32Array | undefined;
  /** For each of the document's vertices, in the same order, whether it stays: where it is not 0 it neither moves nor vanishes. */
  readonly locked?: Uint8Array | undefined;
  /** Multiplies the weights of `weightAttribute`, a number ≥ 0: colours go from 0 to 1. Default 1. */
  readonly weightScale?: number | undefined;
}

/** What may accompany a run that takes time. */
export interface RunOptions {
  /** Called at most about 20 times a second with the share of the work that is done; last, and only once, with 1. */
  readonly onProgress?: ((fraction: number) => void) | undefined;
  /** Aborting rejects with the signal's reason and leaves everything as it was before the call. */
  readonly signal?: AbortSignal | undefined;
}

/** How to measure. */
export interface MeasureOptions {
  /**
   * Samples on the faces of either side, an integer from 1 to 1e9; vertices and edges come on top. Default 400,000,
   * with which mean and rms are exact to a small part of a per cent. The maximum is climbed to from the farthest samples; very
   * few may miss the spot.
   */
  readonly samples?: number | undefined;
}
