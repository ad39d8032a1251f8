// The recorded history as a progressive mesh needs it: for each collapse what it changed, so that it can be undone.

import type { ProgressiveSource } from './source.js';
import { NONE } from './state.js';

/** The mesh with names for everything, and the collapses; by name: wedges of all sets one after the other. */
export interface History {
  readonly source: ProgressiveSource;
  /** First wedge of each set, and the end. */
  readonly setStarts: readonly number[];
  /** First triangle of each group, and the end. */
  readonly groupStarts: readonly number[];
  /** Wedges at the corners of the original. */
  readonly corners: Uint32Array;
  readonly vertexOf: Uint32Array;
  /** The wedge that each is the same as, or {@link NONE}. */
  readonly duplicateOf: Uint32Array;
  /** The wedge that each merges into, or {@link NONE}. */
  readonly mergesInto: Uint32Array;
  /** Whether the triangle has three vertices. */
  readonly isLive: Uint8Array;
  readonly collapses: Collapses;
  /** Wedges at the corners after all collapses, of triangles that are left then. */
  readonly lastCorners: Uint32Array;
  /** The vertex at each corner then. */
  readonly lastVertices: Uint32Array;
}

/** What each collapse does, in parts of long lists. */
export interface Collapses {
  readonly count: number;
  readonly from: Uint32Array;
  readonly into: Uint32Array;
  readonly errors: Float32Array;
  /** Triangles that are left after so many. */
  readonly trianglesAfter: Uint32Array;
  /** Corners that go over and the wedges that they had: ends of each collapse's part in the list, two entries a corner. */
  readonly movedEnds: Uint32Array;
  readonly moved: Uint32Array;
  /** Triangles that vanish with their wedges and their third corner's vertex: five entries a triangle. */
  readonly deadEnds: Uint32Array;
  readonly dead: Uint32Array;
  /** Vertices around both ends. */
  readonly ringEnds: Uint32Array;
  readonly rings: Uint32Array;
}

class List {
  values = new Uint32Array(1024);
  length = 0;
  push(value: number): void {
    if (this.length === this.values.length) {
      const larger = new Uint32Array(2 * this.length);
      larger.set(this.values);
      this.values = larger;
    }
    this.values[this.length] = value;
    this.length += 1;
  }
}

/** Goes through the collapses once. */
export function readHistory(source: ProgressiveSource): History {
  const { wedgeSets, groups, words } = source;
  const setStarts = starts(wedgeSets.map(({ positions }) => positions.length / 3));
  const groupStarts = starts(groups.map(({ indices }) => indices.length / 3));
  const triangleCount = groupStarts.at(-1) as number;
  const corners = new Uint32Array(3 * triangleCount);
  for (const [index, { indices, wedgeSet }] of groups.entries()) {
    const [at, first] = [3 * (groupStarts[index] as number), setStarts[wedgeSet] as number];
    for (let k = 0; k < indices.length; k += 1) corners[at + k] = (indices[k] as number) + first;
  }
  const [wedgeCount = 0, duplicateCount = 0, collapseCount = 0] = words;
  const vertexOf = words.slice(3, 3 + wedgeCount);
  let at = 3 + wedgeCount;
  const duplicateOf = new Uint32Array(wedgeCount).fill(NONE);
  for (let k = 0; k < duplicateCount; k += 1, at += 2) duplicateOf[words[at] as number] = words[at + 1] as number;

  const current = corners.map((wedge) => (duplicateOf[wedge] === NONE ? wedge : (duplicateOf[wedge] as number)));
  const vertexAt = corners.map((wedge) => vertexOf[wedge] as number);
  const isLive = new Uint8Array(triangleCount);
  const lists: Array<number[] | undefined> = [];
  let left = 0;
  for (let triangle = 0; triangle < triangleCount; triangle += 1) {
    const [a, b, c] = vertexAt.subarray(3 * triangle, 3 * triangle + 3) as unknown as [number, number, number];
    if (a === b || b === c || c === a) continue;
    isLive[triangle] = 1;
    left += 1;
    for (let k = 0; k < 3; k += 1) (lists[vertexAt[3 * triangle + k] as number] ??= []).push(3 * triangle + k);
  }

  const alive = isLive.slice();
  const mergesInto = new Uint32Array(wedgeCount).fill(NONE);
  const mergesAt = new Uint32Array(wedgeCount).fill(NONE);
  const collapses = {
    count: collapseCount,
    from: new Uint32Array(collapseCount),
    into: new Uint32Array(collapseCount),
    errors: new Float32Array(collapseCount),
    trianglesAfter: new Uint32Array(collapseCount + 1),
    movedEnds: new Uint32Array(collapseCount),
    deadEnds: new Uint32Array(collapseCount),
    ringEnds: new Uint32Array(collapseCount),
  };
  const errorWords = new Uint32Array(collapses.errors.buffer);
  collapses.trianglesAfter[0] = left;
  const [moved, dead, rings] = [new List(), new List(), new List()];
  const inRing = new Uint32Array(wedgeCount);
  const others = (corner: number): [number, number] => (corner % 3 === 0 ? [corner + 1, corner + 2] : corner % 3 === 1 ? [corner + 1, corner - 1] : [corner - 2, corner - 1]);
  for (let i = 0; i < collapseCount; i += 1) {
    const [from, into, merges] = [words[at] as number, words[at + 1] as number, words[at + 3] as number];
    errorWords[i] = words[at + 2] as number;
    collapses.from[i] = from;
    collapses.into[i] = into;
    at += 4;
    for (let k = 0; k < merges; k += 1, at += 2) {
      mergesInto[words[at] as number] = words[at + 1] as number;
      mergesAt[words[at] as number] = i;
    }
    const kept: number[] = [];
    const around = (corner: number): void => {
      for (const other of others(corner)) {
        const vertex = vertexAt[other] as number;
        if (vertex === from || vertex === into || inRing[vertex] === i + 1) continue;
        inRing[vertex] = i + 1;
        rings.push(vertex);
      }
    };
    const goes: number[] = [];
    for (const corner of lists[from] ?? []) {
      const triangle = Math.floor(corner / 3);
      if (alive[triangle] === 0) continue;
      around(corner);
      const [next, previous] = others(corner);
      if (vertexAt[next] !== into && vertexAt[previous] !== into) {
        goes.push(corner);
        continue;
      }
      alive[triangle] = 0;
      left -= 1;
      for (const value of [triangle, current[3 * triangle], current[3 * triangle + 1], current[3 * triangle + 2]]) dead.push(value as number);
      dead.push(vertexAt[vertexAt[next] === into ? previous : next] as number);
    }
    for (const corner of lists[into] ?? []) {
      if (alive[Math.floor(corner / 3)] === 0) continue;
      around(corner);
      kept.push(corner);
    }
    for (const corner of goes) {
      let wedge = current[corner] as number;
      moved.push(corner);
      moved.push(wedge);
      while (mergesAt[wedge] === i) wedge = mergesInto[wedge] as number;
      current[corner] = wedge;
      vertexAt[corner] = into;
      kept.push(corner);
    }
    lists[from] = undefined;
    lists[into] = kept;
    collapses.trianglesAfter[i + 1] = left;
    collapses.movedEnds[i] = moved.length;
    collapses.deadEnds[i] = dead.length;
    collapses.ringEnds[i] = rings.length;
  }
  return {
    source, setStarts, groupStarts, corners, vertexOf, duplicateOf, mergesInto, isLive,
    collapses: { ...collapses, moved: moved.values, dead: dead.values, rings: rings.values },
    lastCorners: current,
    lastVertices: vertexAt,
  };
}

function starts(counts: readonly number[]): number[] {
  const result = [0];
  for (const count of counts) result.push((result.at(-1) as number) + count);
  return result;
}
