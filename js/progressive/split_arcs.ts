// The two arcs of triangles around a vertex that is split, and the gaps between them where new triangles stand.

import { DecimeshError } from '../errors.js';
import type { IntegerModel } from './numbers.js';
import { newModels, type Coder } from './range_coder.js';
import type { PlannedTriangle, SplitPlan } from './split_plan.js';
import type { Ring } from './state.js';

/** The place of a new triangle: where arcs meet, the end of a fan, or beside nothing. */
export interface Gap {
  readonly third: number;
  readonly forward: boolean;
  /** The triangle of t's arc and that of s's beside it, as places in the ring; −1 if there is none. */
  readonly atT: number;
  readonly atS: number;
  /** The new triangle, as the writer knows it. */
  readonly planned: PlannedTriangle | undefined;
}

/** Models of arcs and gaps. */
export class ArcCoder {
  readonly #moved = newModels(13 * 13 * 3 * 2);
  readonly #gaps = newModels(8);
  readonly #direction = newModels(1);
  readonly #integers: IntegerModel;

  /** `integers` are the numbers in splits about which nothing is known. */
  constructor(integers: IntegerModel) {
    this.#integers = integers;
  }

  /** Which of the triangles around s go to t. */
  codeArcs(coder: Coder, ring: Ring, plan: SplitPlan | undefined): boolean[] {
    const moves: boolean[] = [];
    const size = Math.min(ring.count, 12);
    let [turns, last] = [0, 0];
    for (let i = 0; i < ring.count; i += 1) {
      const context = ((size * 13 + Math.min(i, 12)) * 3 + turns) * 2 + last;
      const wanted = plan?.moved(ring.corners[i] as number) === undefined ? 0 : 1;
      const moved = coder.bit(this.#moved, context, wanted);
      if (i > 0 && moved !== last && turns < 2) turns += 1;
      last = moved;
      moves.push(moved === 1);
    }
    return moves;
  }

  /** Where the new triangles are, first those beside the arcs. */
  codeGaps(coder: Coder, ring: Ring, moves: readonly boolean[], s: number, t: number, plan?: SplitPlan): Gap[] {
    const left = plan === undefined ? [] : [...plan.triangles];
    const take = (third: number, forward: boolean): PlannedTriangle | undefined => {
      const at = left.findIndex((triangle) => triangle.third === third && triangle.forward === forward);
      return at < 0 ? undefined : left.splice(at, 1)[0];
    };
    const made: Gap[] = [];
    const offer = (context: number, third: number, forward: boolean, atT: number, atS: number): void => {
      if (third === s) return;
      const planned = take(third, forward);
      if (coder.bit(this.#gaps, context, planned === undefined ? 0 : 1) === 1) made.push({ third, forward, atT, atS, planned });
    };
    for (const [fan, start] of ring.fanStarts.entries()) {
      const end = ring.fanStarts[fan + 1] ?? ring.count;
      const closes = ring.fanCloses[fan] as boolean;
      if (!closes) {
        const moved = moves[start] as boolean;
        offer(moved ? 2 : 3, ring.next[start] as number, !moved, moved ? start : -1, moved ? -1 : start);
      }
      for (let i = start; i < end; i += 1) {
        const follower = i + 1 < end ? i + 1 : start;
        if (i + 1 === end && !closes) break;
        const moved = moves[i] as boolean;
        if (moved === moves[follower]) continue;
        offer(closes ? 0 : 1, ring.previous[i] as number, moved, moved ? i : follower, moved ? follower : i);
      }
      if (!closes) {
        const moved = moves[end - 1] as boolean;
        offer(moved ? 4 : 5, ring.previous[end - 1] as number, moved, moved ? end - 1 : -1, moved ? -1 : end - 1);
      }
    }
    // What is beside nothing.
    while (coder.bit(this.#gaps, 6, left.length === 0 ? 0 : 1) === 1) {
      const planned = left.shift();
      const third = codeIndex(coder, this.#integers, t, planned?.third ?? 0, 'triangle');
      if (third === s) throw new DecimeshError('syntax', 'a triangle has a corner twice', `splits[${t}]`);
      const forward = coder.bit(this.#direction, 0, planned?.forward === true ? 1 : 0) === 1;
      made.push({ third, forward, atT: -1, atS: -1, planned });
      if (made.length > 1e6) throw new DecimeshError('too-large', 'a split makes more than a million triangles', `splits[${t}]`);
    }
    return made;
  }
}

/** A number below `count`, about which nothing is known. */
export function codeIndex(coder: Coder, integers: IntegerModel, count: number, value: number, what: string): number {
  const index = integers.unsigned(coder, 0, value);
  if (index >= count) throw new DecimeshError('out-of-range', `there is no ${what} ${index}`, 'splits');
  return index;
}
