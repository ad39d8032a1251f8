// Refinement of a part of the mesh: splits with what they depend on, done in their order (Hoppe 1997; Xia & Varshney 1996).
//
// A split reads the triangles around its vertex and writes that vertex and the new one. It depends on the splits before it
// that wrote what it reads, and on those that read what it writes. Splits that do not depend on each other may change
// places; so any set that has, with a split, all that it depends on, is a level of the same collapses in another order:
// a mesh without cracks.

import type { ProgressiveLevel } from './decode.js';
import type { View } from './levels.js';
import type { Ring, SplitMesh } from './state.js';
import { grown, NONE } from './state.js';
import type { SplitEffect } from './split_plan.js';
import type { SplitLog } from './split_log.js';

/** Where to refine. */
export interface Region {
  /**
   * Whether a sphere is in the region, at least in part: centre and radius in model units. It holds everything that comes
   * out of a vertex.
   */
  touches(x: number, y: number, z: number, radius: number): boolean;
  /** What has an error of at most this, model units, is not refined further. Default 0. */
  readonly error?: number | undefined;
}

/** What each split depends on. */
export class Dependencies {
  /** Ends of each split's part of the list. */
  #ends = new Uint32Array(0);
  #list = new Uint32Array(0);
  #length = 0;
  /** By vertex: the split that wrote it last, plus 1, and those that have read it since, as lists. */
  #writers: Uint32Array<ArrayBuffer>;
  #readers: Uint32Array<ArrayBuffer>;
  #readerOf = new Uint32Array(0);
  #nextReader = new Uint32Array(0);
  #readerCount = 0;

  constructor(vertices: number) {
    this.#writers = new Uint32Array(vertices);
    this.#readers = new Uint32Array(vertices).fill(NONE);
  }

  /** Adds split number `k`, with the ring that its vertex had. */
  push(ring: Ring, { from, vertex, firstTriangle }: SplitEffect, mesh: SplitMesh, k: number): void {
    this.#writers = grown(this.#writers, mesh.vertexCount);
    this.#readers = grown(this.#readers, mesh.vertexCount, NONE);
    const around = new Set<number>();
    for (let i = 0; i < ring.count; i += 1) around.add(ring.next[i] as number).add(ring.previous[i] as number);
    for (let corner = 3 * firstTriangle; corner < 3 * mesh.triangleCount; corner += 1) around.add(mesh.vertexOf[mesh.corners[corner] as number] as number);
    around.delete(from);
    around.delete(vertex);
    const needs = new Set<number>();
    needs.add((this.#writers[from] as number) - 1);
    for (let at = this.#readers[from] as number; at !== NONE; at = this.#nextReader[at] as number) needs.add(this.#readerOf[at] as number);
    for (const other of around) needs.add((this.#writers[other] as number) - 1);
    needs.delete(-1);
    this.#list = grown(this.#list, this.#length + needs.size);
    for (const need of needs) this.#list[this.#length++] = need;
    this.#ends = grown(this.#ends, k + 1);
    this.#ends[k] = this.#length;
    for (const written of [from, vertex]) {
      this.#writers[written] = k + 1;
      this.#readers[written] = NONE;
    }
    this.#readerOf = grown(this.#readerOf, this.#readerCount + around.size);
    this.#nextReader = grown(this.#nextReader, this.#readerCount + around.size);
    for (const other of around) {
      this.#readerOf[this.#readerCount] = k;
      this.#nextReader[this.#readerCount] = this.#readers[other] as number;
      this.#readers[other] = this.#readerCount;
      this.#readerCount += 1;
    }
  }

  /** The mesh that is fine in the region. */
  refine({ touches, error: tolerance = 0 }: Region, mesh: SplitMesh, log: SplitLog, levels: readonly ProgressiveLevel[]): View {
    const wanted = new Uint8Array(log.count);
    // From the last to the first, the sphere of a vertex grows by all that comes out of it later.
    const radii = new Float64Array(mesh.vertexCount);
    let level = levels.length - 1;
    for (let k = log.count - 1; k >= 0; k -= 1) {
      while (level > 0 && (levels[level - 1] as ProgressiveLevel).splits > k) level -= 1;
      const [s, t] = [log.from[k] as number, log.baseVertices + k];
      const [x, y, z] = mesh.positions.subarray(3 * s, 3 * s + 3) as unknown as [number, number, number];
      const [u, v, w] = mesh.positions.subarray(3 * t, 3 * t + 3) as unknown as [number, number, number];
      radii[s] = Math.max(radii[s] as number, Math.hypot(u - x, v - y, w - z) + (radii[t] as number));
      // The mesh before the chunk has the error of the chunk before.
      const before = (levels[Math.max(level - 1, 0)] as ProgressiveLevel).error;
      if (wanted[k] === 0 && before > tolerance && touches(x, y, z, radii[s] as number)) wanted[k] = 1;
      if (wanted[k] === 0) continue;
      for (let at = k === 0 ? 0 : (this.#ends[k - 1] as number); at < (this.#ends[k] as number); at += 1) wanted[this.#list[at] as number] = 1;
    }
    return replay(wanted, log);
  }
}

function replay(wanted: Uint8Array, log: SplitLog): View {
  const triangleCount = log.trianglesAfter(log.count);
  const corners = log.born.slice(0, 3 * triangleCount);
  const vertexOf = log.vertexOf.slice(0, log.wedgesAfter(log.count));
  const has = new Uint8Array(triangleCount).fill(1, 0, log.baseTriangles);
  for (let k = 0; k < log.count; k += 1) {
    if (wanted[k] === 0) continue;
    has.fill(1, log.trianglesAfter(k), log.trianglesAfter(k + 1));
    for (let at = log.movedBefore(k); at < (log.movedEnds[k] as number); at += 3) {
      corners[log.moved[at] as number] = log.moved[at + 2] as number;
    }
    for (let at = log.reboundBefore(k); at < (log.reboundEnds[k] as number); at += 3) {
      vertexOf[log.rebound[at] as number] = log.rebound[at + 2] as number;
    }
  }
  return { corners, vertexOf, triangleCount, has };
}
