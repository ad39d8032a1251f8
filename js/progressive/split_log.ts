// What each split changed, kept so that any level can be had again, and parts of the mesh at different ones.

import type { SplitEffect } from './split_plan.js';
import { grown, type SplitMesh } from './state.js';

/** The splits that were done, in their order; of split k the new vertex is `baseVertices + k`. */
export class SplitLog {
  count = 0;
  /** Of the base mesh. */
  readonly baseVertices: number;
  readonly baseTriangles: number;
  readonly baseWedges: number;
  /** The vertex that was split. */
  from = new Uint32Array(0);
  /** Triangles and wedges that there are after each split. */
  triangleEnds = new Uint32Array(0);
  wedgeEnds = new Uint32Array(0);
  /** Ends of each split's part of `moved`, which has three entries for each corner: it, its former wedge, its new one. */
  movedEnds = new Uint32Array(0);
  moved = new Uint32Array(0);
  /** Wedges at the corners of each triangle when it came. */
  born = new Uint32Array(0);
  /** Ends of each split's part of `rebound`, which has three entries for each wedge: it, its former vertex, its new one. */
  reboundEnds = new Uint32Array(0);
  rebound = new Uint32Array(0);
  /** The vertex of each wedge when it came, before it was rebound. */
  vertexOf: Uint32Array<ArrayBuffer>;

  /** After the base mesh. */
  constructor(mesh: SplitMesh) {
    this.baseVertices = mesh.vertexCount;
    this.baseTriangles = mesh.triangleCount;
    this.baseWedges = mesh.wedgeCount;
    this.born = mesh.corners.slice(0, 3 * mesh.triangleCount);
    this.vertexOf = mesh.vertexOf.slice(0, mesh.wedgeCount);
  }

  /** Adds a split that the mesh has just had. */
  push(mesh: SplitMesh, { from, vertex, moved, movedTo, formerly, firstTriangle }: SplitEffect): void {
    const k = this.count;
    const wedges = this.wedgesAfter(k);
    this.count += 1;
    this.from = grown(this.from, this.count);
    this.triangleEnds = grown(this.triangleEnds, this.count);
    this.wedgeEnds = grown(this.wedgeEnds, this.count);
    this.movedEnds = grown(this.movedEnds, this.count);
    this.from[k] = from;
    this.triangleEnds[k] = mesh.triangleCount;
    this.wedgeEnds[k] = mesh.wedgeCount;
    let at = k === 0 ? 0 : (this.movedEnds[k - 1] as number);
    this.moved = grown(this.moved, at + 3 * moved.length);
    for (let i = 0; i < moved.length; i += 1, at += 3) {
      this.moved[at] = moved[i] as number;
      this.moved[at + 1] = formerly[i] as number;
      this.moved[at + 2] = movedTo[i] as number;
    }
    this.movedEnds[k] = at;
    this.vertexOf = grown(this.vertexOf, mesh.wedgeCount);
    for (let wedge = wedges; wedge < mesh.wedgeCount; wedge += 1) this.vertexOf[wedge] = vertex;
    const end = this.reboundBefore(k) + mesh.rebound.length;
    this.rebound = grown(this.rebound, end);
    this.rebound.set(mesh.rebound, end - mesh.rebound.length);
    this.reboundEnds = grown(this.reboundEnds, this.count);
    this.reboundEnds[k] = end;
    this.born = grown(this.born, 3 * mesh.triangleCount);
    this.born.set(mesh.corners.subarray(3 * firstTriangle, 3 * mesh.triangleCount), 3 * firstTriangle);
  }

  trianglesAfter(splits: number): number {
    return splits === 0 ? this.baseTriangles : (this.triangleEnds[splits - 1] as number);
  }

  wedgesAfter(splits: number): number {
    return splits === 0 ? this.baseWedges : (this.wedgeEnds[splits - 1] as number);
  }

  reboundBefore(split: number): number {
    return split === 0 ? 0 : (this.reboundEnds[split - 1] as number);
  }

  movedBefore(split: number): number {
    return split === 0 ? 0 : (this.movedEnds[split - 1] as number);
  }
}

/** Corners and wedges at one level, taken to another by the splits between them. */
export class Cursor {
  readonly #log: SplitLog;
  splits = 0;
  corners: Uint32Array<ArrayBuffer>;
  vertexOf: Uint32Array<ArrayBuffer>;

  /** At the base mesh. */
  constructor(log: SplitLog) {
    this.#log = log;
    this.corners = log.born.slice(0, 3 * log.baseTriangles);
    this.vertexOf = log.vertexOf.slice(0, log.baseWedges);
  }

  /** Goes to the level after so many splits, in time that rises with their number between. */
  goTo(splits: number): void {
    const log = this.#log;
    this.corners = grown(this.corners, 3 * log.trianglesAfter(splits));
    this.vertexOf = grown(this.vertexOf, log.wedgesAfter(splits));
    for (; this.splits < splits; this.splits += 1) this.#split(this.splits);
    for (; this.splits > splits; this.splits -= 1) this.#collapse(this.splits - 1);
  }

  #split(k: number): void {
    const log = this.#log;
    for (let at = log.movedBefore(k); at < (log.movedEnds[k] as number); at += 3) {
      this.corners[log.moved[at] as number] = log.moved[at + 2] as number;
    }
    for (let wedge = log.wedgesAfter(k); wedge < log.wedgesAfter(k + 1); wedge += 1) this.vertexOf[wedge] = log.vertexOf[wedge] as number;
    for (let at = log.reboundBefore(k); at < (log.reboundEnds[k] as number); at += 3) {
      this.vertexOf[log.rebound[at] as number] = log.rebound[at + 2] as number;
    }
    const [first, end] = [3 * log.trianglesAfter(k), 3 * log.trianglesAfter(k + 1)];
    for (let corner = first; corner < end; corner += 1) this.corners[corner] = log.born[corner] as number;
  }

  #collapse(k: number): void {
    const log = this.#log;
    for (let at = log.movedBefore(k); at < (log.movedEnds[k] as number); at += 3) {
      this.corners[log.moved[at] as number] = log.moved[at + 1] as number;
    }
    for (let at = (log.reboundEnds[k] as number) - 3; at >= log.reboundBefore(k); at -= 3) {
      this.vertexOf[log.rebound[at] as number] = log.rebound[at + 1] as number;
    }
  }
}
