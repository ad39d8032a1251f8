// What a progressive mesh is written from: the original's arrays and the engine's record of one run.

import type { GroupSummary } from '../types.js';

/** One wedge set of the original. */
export interface SourceWedgeSet {
  readonly positions: Float32Array;
  readonly attributes: ReadonlyArray<{ readonly name: string; readonly components: number; readonly values: Float32Array }>;
}

/** One group of the original. */
export interface SourceGroup extends GroupSummary {
  /** In its wedge set. */
  readonly indices: Uint32Array;
}

/** Everything. */
export interface ProgressiveSource {
  readonly wedgeSets: readonly SourceWedgeSet[];
  readonly groups: readonly SourceGroup[];
  /** Of the bounding box, model units. */
  readonly diagonal: number;
  /** The engine's `history()`. */
  readonly words: Uint32Array;
}
