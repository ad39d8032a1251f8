// Every triangle of every level with the errors between which it is there: the multiresolution of Jade (Ciampalini,
// Cignoni, Montani & Scopigno 1997).

import { readHistory } from './history.js';
import { NONE } from './state.js';
import type { ProgressiveSource } from './source.js';

/** The triangles of all levels, about three times those of the original. */
export interface TriangleLifetimes {
  /** Vertices of the input, three for each triangle. */
  readonly indices: Uint32Array;
  /** The error from which on each is there, model units; 0 for those of the original. */
  readonly births: Float32Array;
  /** The error from which on it is there no more; infinite for those of the coarsest level. */
  readonly deaths: Float32Array;
}

/** From the record of a run that keeps vertices. Triangles that live from an error to the same one are left out. */
export function lifetimesOf(source: ProgressiveSource): TriangleLifetimes {
  const { corners: original, duplicateOf, isLive, collapses, lastCorners } = readHistory(source);
  const corners = original.map((wedge) => (duplicateOf[wedge] === NONE ? wedge : (duplicateOf[wedge] as number)));
  const { errors, moved, movedEnds, dead, deadEnds } = collapses;
  const since = new Float32Array(isLive.length);
  const indices: number[] = [];
  const births: number[] = [];
  const deaths: number[] = [];
  const end = (triangle: number, error: number): void => {
    if (error > (since[triangle] as number)) {
      indices.push(corners[3 * triangle] as number, corners[3 * triangle + 1] as number, corners[3 * triangle + 2] as number);
      births.push(since[triangle] as number);
      deaths.push(error);
    }
    since[triangle] = error;
  };
  // What a corner becomes is what it was before its next change: known going backwards.
  const after = new Uint32Array(moved.length / 2);
  const next = lastCorners.slice();
  for (let at = (movedEnds.at(-1) ?? 0) - 2; at >= 0; at -= 2) {
    const corner = moved[at] as number;
    after[at / 2] = next[corner] as number;
    next[corner] = moved[at + 1] as number;
  }
  const alive = isLive.slice();
  for (let i = 0; i < collapses.count; i += 1) {
    const error = errors[i] as number;
    for (let at = i === 0 ? 0 : (deadEnds[i - 1] as number); at < (deadEnds[i] as number); at += 5) {
      end(dead[at] as number, error);
      alive[dead[at] as number] = 0;
    }
    for (let at = i === 0 ? 0 : (movedEnds[i - 1] as number); at < (movedEnds[i] as number); at += 2) {
      const corner = moved[at] as number;
      end(Math.floor(corner / 3), error);
      corners[corner] = after[at / 2] as number;
    }
  }
  for (let triangle = 0; triangle < alive.length; triangle += 1) if (alive[triangle] === 1) end(triangle, Infinity);
  return { indices: Uint32Array.from(indices), births: Float32Array.from(births), deaths: Float32Array.from(deaths) };
}
