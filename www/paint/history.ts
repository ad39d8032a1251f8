// Every state of what is painted on a model, as numbered steps from one to the next: undo walks them in either direction.
import type { PaintChange } from './protocol.ts';

/** The number of the state in which nothing is painted. */
export const UNPAINTED = 0;

interface Stroke {
  /** The state it was made in. */
  readonly from: number;
  readonly change: PaintChange;
  /** How many strokes lead to it. */
  readonly depth: number;
}

/** What is painted on one model, in any of the states that it has been in. */
export class PaintHistory {
  private readonly strokes = new Map<number, Stroke>();
  private state = UNPAINTED;
  private last = UNPAINTED;
  private readonly painted: Uint8Array<ArrayBuffer>;

  constructor(vertices: number) {
    this.painted = new Uint8Array(vertices);
  }

  /** Adds a stroke made in state `from`; returns the number of the state after it. */
  add(from: number, change: PaintChange): number {
    this.last += 1;
    this.strokes.set(this.last, { from, change, depth: this.depth(from) + 1 });
    return this.last;
  }

  /** Each vertex's paint in `state`; none in one that is not known. The array is the history's own and changes with the next call. */
  at(wanted: number): Uint8Array<ArrayBuffer> {
    const state = this.strokes.has(wanted) ? wanted : UNPAINTED;
    const forwards: number[] = [];
    let target = state;
    // Up to where both come from, and down again.
    while (this.state !== target) {
      if (this.depth(target) >= this.depth(this.state)) {
        forwards.push(target);
        target = this.strokes.get(target)?.from ?? UNPAINTED;
      } else {
        this.apply(this.state);
        this.state = this.strokes.get(this.state)?.from ?? UNPAINTED;
      }
    }
    for (const number of forwards.reverse()) this.apply(number);
    this.state = state;
    return this.painted;
  }

  /** Forgets strokes that lead to none of `states`: those that were undone and have another in their place. */
  keep(states: Iterable<number>): void {
    const kept = new Set<number>();
    for (const end of [this.state, ...states]) {
      for (let state = end; state !== UNPAINTED && !kept.has(state); state = this.strokes.get(state)?.from ?? UNPAINTED) kept.add(state);
    }
    for (const state of this.strokes.keys()) if (!kept.has(state)) this.strokes.delete(state);
  }

  /** How many strokes are kept. */
  get size(): number {
    return this.strokes.size;
  }

  private depth(state: number): number {
    return this.strokes.get(state)?.depth ?? 0;
  }

  private apply(state: number): void {
    const change = this.strokes.get(state)?.change;
    if (change === undefined) return;
    const { painted } = this;
    const { indices, values } = change;
    if (indices === null) for (let vertex = 0; vertex < painted.length; vertex += 1) painted[vertex] = (painted[vertex] ?? 0) ^ (values[vertex] ?? 0);
    else indices.forEach((vertex, at) => (painted[vertex] = (painted[vertex] ?? 0) ^ (values[at] ?? 0)));
  }
}

/** What leads from `before` to `after`, in the smaller form; null when they are the same. */
export function changeBetween(before: Uint8Array, after: Uint8Array): PaintChange | null {
  let count = 0;
  for (let vertex = 0; vertex < before.length; vertex += 1) if (before[vertex] !== after[vertex]) count += 1;
  if (count === 0) return null;
  // An index takes four bytes.
  if (5 * count >= before.length) return { indices: null, values: Uint8Array.from(before, (value, vertex) => value ^ (after[vertex] ?? 0)) };
  const indices = new Uint32Array(count);
  const values = new Uint8Array(count);
  for (let vertex = 0, at = 0; vertex < before.length; vertex += 1) {
    if (before[vertex] === after[vertex]) continue;
    indices[at] = vertex;
    values[at] = (before[vertex] ?? 0) ^ (after[vertex] ?? 0);
    at += 1;
  }
  return { indices, values };
}
