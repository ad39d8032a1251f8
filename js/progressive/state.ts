// A mesh that grows by vertex splits: wedges with attributes at vertices, triangles of wedges, and each vertex's corners.
//
// Vertices, wedges and triangles are numbered in the order in which they come, so a split only appends, and changes
// the wedge at some corners. A corner is `3 * triangle + k`.

import type { Description } from './description.js';

/** Instead of a number. */
export const NONE = 0xffffffff;

type Growing = Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>;

/** `array` with room for `length` entries, filled with `value` beyond what was there. */
export function grown<Kind extends Growing>(array: Kind, length: number, value = 0): Kind {
  if (length <= array.length) return array;
  const larger = new (array.constructor as new (length: number) => Kind)(Math.max(length, 2 * array.length, 64));
  if (value !== 0) larger.fill(value, array.length);
  larger.set(array);
  return larger;
}

/** The wedges of one set. */
export class WedgeSetState {
  /** Numbers of each attribute, by the place of the wedge in the set. */
  readonly attributes: Float32Array<ArrayBuffer>[];
  readonly components: readonly number[];
  /** The wedges of the set, in their order. */
  wedges = new Uint32Array(0);
  count = 0;

  constructor(components: readonly number[]) {
    this.components = components;
    this.attributes = components.map(() => new Float32Array(0));
  }
}

/** The mesh after some splits. Arrays may have room behind what counts. */
export class SplitMesh {
  vertexCount = 0;
  /** x, y, z of each vertex. */
  positions = new Float32Array(0);
  /** The vertex that each was split from, or {@link NONE}. */
  parentVertices = new Uint32Array(0);
  wedgeCount = 0;
  /** Vertex of each wedge. */
  vertexOf = new Uint32Array(0);
  /** The wedge that each was like before its vertex was split off, or {@link NONE}. */
  parentWedges = new Uint32Array(0);
  setOf = new Uint32Array(0);
  /** Place of each wedge in its set. */
  placeOf = new Uint32Array(0);
  readonly sets: readonly WedgeSetState[];
  triangleCount = 0;
  /** Wedge at each corner. */
  corners = new Uint32Array(0);
  /** Group of each triangle. */
  groupOf = new Uint32Array(0);
  /** Wedges that went to another vertex since this was emptied: the wedge, the vertex before and after. */
  readonly rebound: number[] = [];
  #firstCorners = new Uint32Array(0);
  #nextCorners = new Uint32Array(0);

  constructor({ wedgeSets }: Description) {
    this.sets = wedgeSets.map(({ attributes }) => new WedgeSetState(attributes.map(({ components }) => components)));
  }

  /** One more vertex, without a position yet. */
  addVertex(parent: number): number {
    const vertex = this.vertexCount;
    this.vertexCount += 1;
    this.positions = grown(this.positions, 3 * this.vertexCount);
    this.parentVertices = grown(this.parentVertices, this.vertexCount);
    this.parentVertices[vertex] = parent;
    this.#firstCorners = grown(this.#firstCorners, this.vertexCount, NONE);
    return vertex;
  }

  /** One more wedge, without values yet. */
  addWedge(set: number, parent: number, vertex: number): number {
    const wedge = this.wedgeCount;
    this.wedgeCount += 1;
    this.vertexOf = grown(this.vertexOf, this.wedgeCount);
    this.parentWedges = grown(this.parentWedges, this.wedgeCount);
    this.setOf = grown(this.setOf, this.wedgeCount);
    this.placeOf = grown(this.placeOf, this.wedgeCount);
    const state = this.sets[set] as WedgeSetState;
    this.vertexOf[wedge] = vertex;
    this.parentWedges[wedge] = parent;
    this.setOf[wedge] = set;
    this.placeOf[wedge] = state.count;
    state.wedges = grown(state.wedges, state.count + 1);
    state.wedges[state.count] = wedge;
    state.count += 1;
    for (const [index, components] of state.components.entries()) {
      state.attributes[index] = grown(state.attributes[index] as Float32Array<ArrayBuffer>, components * state.count);
    }
    return wedge;
  }

  /** One more triangle, whose wedges are at these vertices from now on. */
  addTriangle(group: number, wedges: readonly number[], vertices: readonly number[]): number {
    const triangle = this.triangleCount;
    this.triangleCount += 1;
    this.corners = grown(this.corners, 3 * this.triangleCount);
    this.#nextCorners = grown(this.#nextCorners, 3 * this.triangleCount);
    this.groupOf = grown(this.groupOf, this.triangleCount);
    this.groupOf[triangle] = group;
    for (let k = 0; k < 3; k += 1) {
      const [wedge, vertex] = [wedges[k] as number, vertices[k] as number];
      this.corners[3 * triangle + k] = wedge;
      this.bind(wedge, vertex);
      this.link(3 * triangle + k, vertex);
    }
    return triangle;
  }

  /** Puts a wedge at a vertex. */
  bind(wedge: number, vertex: number): void {
    const before = this.vertexOf[wedge] as number;
    if (before === vertex) return;
    this.vertexOf[wedge] = vertex;
    this.rebound.push(wedge, before, vertex);
  }

  /** Forgets which corners are at `vertex`; they are to be linked again. */
  unlink(vertex: number): void {
    this.#firstCorners[vertex] = NONE;
  }

  /** Puts a corner first among those at `vertex`. */
  link(corner: number, vertex: number): void {
    this.#nextCorners[corner] = this.#firstCorners[vertex] as number;
    this.#firstCorners[vertex] = corner;
  }

  /** Puts the corners at `vertex` into `list` and returns how many there are. */
  cornersAt(vertex: number, list: number[]): number {
    let count = 0;
    for (let corner = this.#firstCorners[vertex] as number; corner !== NONE; corner = this.#nextCorners[corner] as number) {
      list[count] = corner;
      count += 1;
    }
    return count;
  }

  /** The wedge at the next corner of the same triangle. */
  nextWedge(corner: number): number {
    return this.corners[corner % 3 === 2 ? corner - 2 : corner + 1] as number;
  }

  /** The wedge at the corner before. */
  previousWedge(corner: number): number {
    return this.corners[corner % 3 === 0 ? corner + 2 : corner - 1] as number;
  }
}

/** The triangles around a vertex in their order: fans in which each shares an edge with the next. */
export class Ring {
  /** The vertex's corner of each triangle, and the vertices at its next and its previous corner. */
  readonly corners: number[] = [];
  readonly next: number[] = [];
  readonly previous: number[] = [];
  count = 0;
  /** Where each fan begins. */
  readonly fanStarts: number[] = [];
  /** Whether the last triangle of each fan shares an edge with its first. */
  readonly fanCloses: boolean[] = [];
  readonly #found: number[] = [];
  readonly #after: number[] = [];
  readonly #before: number[] = [];

  /** Reads the ring of `vertex`. Where several triangles could follow, it is the first that was linked last. */
  read(mesh: SplitMesh, vertex: number): void {
    const count = mesh.cornersAt(vertex, this.#found);
    const { vertexOf } = mesh;
    this.count = 0;
    this.fanStarts.length = 0;
    this.fanCloses.length = 0;
    const [after, before, found] = [this.#after, this.#before, this.#found];
    const nexts: number[] = [];
    for (let i = 0; i < count; i += 1) {
      nexts[i] = vertexOf[mesh.nextWedge(found[i] as number)] as number;
      after[i] = -1;
      before[i] = -1;
    }
    const byNext = count > 24 ? firstPlaces(nexts) : undefined;
    for (let i = 0; i < count; i += 1) {
      const shared = vertexOf[mesh.previousWedge(found[i] as number)] as number;
      const follower = byNext === undefined ? nexts.indexOf(shared) : (byNext.get(shared) ?? -1);
      if (follower >= 0 && before[follower] === -1 && follower !== i) {
        after[i] = follower;
        before[follower] = i;
      }
    }
    const follow = (start: number, closes: boolean): void => {
      this.fanStarts.push(this.count);
      this.fanCloses.push(closes);
      for (let i = start; i >= 0; ) {
        const corner = found[i] as number;
        this.corners[this.count] = corner;
        this.next[this.count] = nexts[i] as number;
        this.previous[this.count] = vertexOf[mesh.previousWedge(corner)] as number;
        this.count += 1;
        const follower = after[i] as number;
        // Done, and the end of a closed fan.
        after[i] = -2;
        i = follower >= 0 && after[follower] !== -2 ? follower : -1;
      }
    };
    for (let i = 0; i < count; i += 1) if (before[i] === -1) follow(i, false);
    for (let i = 0; i < count; i += 1) if (after[i] !== -2) follow(i, true);
  }
}

function firstPlaces(values: readonly number[]): Map<number, number> {
  const places = new Map<number, number>();
  for (const [place, value] of values.entries()) if (!places.has(value)) places.set(value, place);
  return places;
}
