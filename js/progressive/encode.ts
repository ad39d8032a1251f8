// A progressive mesh written from a recorded history: the coarsest level, then the collapses undone in chunks.
//
// Undoing may be done in another order than the reverse one, as long as what touches the same vertices keeps its order.
// In a chunk the splits are sorted into generations that do not touch each other, and in those by their vertex, so that
// a vertex takes the bits of a small gap and not those of a number.

import { codeBase, codeDirections, type BaseCorner } from './base_coder.js';
import { packChunks, VERSION, type ChunkType } from './container.js';
import { hasDirections, packDescription, type Description } from './description.js';
import { readHistory, type Collapses, type History } from './history.js';
import { gridOf, IntegerModel } from './numbers.js';
import { RangeEncoder } from './range_coder.js';
import { codeRest, type RestPlan } from './rest_coder.js';
import type { ProgressiveSource } from './source.js';
import { SplitCoder } from './split_coder.js';
import type { PlannedTriangle, SplitPlan } from './split_plan.js';
import { NONE, SplitMesh, type WedgeSetState } from './state.js';
import type { ValueCoder } from './value_coder.js';

/** How to write. */
export interface ProgressiveOptions {
  /**
   * Whether triangles and vertices come back in the order of the input, down to the corner that each begins with. It takes
   * two to five bytes a vertex more. Without it the order is that of the splits. Default true.
   */
  readonly keepOrder?: boolean | undefined;
}

/** A chunk has this many times the triangles of the mesh before it, and at most so many splits. */
const GROWTH = 1.3;
const MOST_SPLITS = 65536;

/** Of the triangles, in the base mesh; and at least so many. */
const BASE_SHARE = 0.01;
const FEWEST_BASE = 4;

/** The bytes of a progressive mesh. */
export function encodeProgressive(source: ProgressiveSource, { keepOrder = true }: ProgressiveOptions = {}): Uint8Array<ArrayBuffer> {
  return new ProgressiveEncoder(readHistory(source), keepOrder).encode();
}

class ProgressiveEncoder {
  readonly #history: History;
  readonly #description: Description;
  readonly #mesh: SplitMesh;
  readonly #baseCollapses: number;
  /** Vertices of the triangles that have three. */
  readonly #inUse = new Set<number>();
  /** Numbers in the mesh by name. */
  readonly #vertexNumbers: Uint32Array;
  readonly #wedgeNumbers: Uint32Array;
  readonly #cornerNumbers: Uint32Array;
  /** Names by number. */
  readonly #wedgeNames: number[] = [];
  readonly #cornerNames: number[] = [];
  /** The name of the wedge that a corner of the mesh is about to have, plus 1. */
  readonly #about: Uint32Array;

  constructor(history: History, keepsOrder: boolean) {
    this.#history = history;
    const { source, collapses, setStarts, groupStarts, vertexOf, isLive, corners } = history;
    const triangles = groupStarts.at(-1) as number;
    const wanted = Math.max(Math.ceil(BASE_SHARE * triangles), FEWEST_BASE);
    let base = 0;
    while (base < collapses.count && (collapses.trianglesAfter[base] as number) > wanted) base += 1;
    this.#baseCollapses = base;
    const inUse = this.#inUse;
    for (let corner = 0; corner < corners.length; corner += 1) {
      if (isLive[Math.floor(corner / 3)] === 1) inUse.add(vertexOf[corners[corner] as number] as number);
    }
    const allPositions = joined(source.wedgeSets.map(({ positions }) => positions));
    this.#description = {
      vertices: inUse.size,
      triangles,
      baseTriangles: collapses.trianglesAfter[base] as number,
      splits: base,
      diagonal: source.diagonal,
      positionGrid: gridOf(allPositions),
      keepsOrder,
      wedgeSets: source.wedgeSets.map(({ attributes }, set) => ({
        wedges: (setStarts[set + 1] as number) - (setStarts[set] as number),
        attributes: attributes.map(({ name, components, values }) => ({ name, components, grid: gridOf(values) })),
      })),
      groups: source.groups.map(({ indices, ...rest }) => ({ triangles: indices.length / 3, ...rest })),
    };
    this.#mesh = new SplitMesh(this.#description);
    const wedges = setStarts.at(-1) as number;
    this.#vertexNumbers = new Uint32Array(wedges).fill(NONE);
    this.#wedgeNumbers = new Uint32Array(wedges).fill(NONE);
    this.#cornerNumbers = new Uint32Array(3 * triangles).fill(NONE);
    this.#about = new Uint32Array(3 * triangles);
  }

  encode(): Uint8Array<ArrayBuffer> {
    const chunks: Array<{ type: ChunkType; payload: Uint8Array }> = [];
    chunks.push({ type: 'HEAD', payload: new TextEncoder().encode(JSON.stringify({ version: VERSION, ...packDescription(this.#description) })) });
    const coder = new SplitCoder(this.#description);
    chunks.push({ type: 'BASE', payload: this.#base(coder.values) });
    if (hasDirections(this.#description)) {
      const directions = new RangeEncoder();
      codeDirections(directions, this.#mesh, coder.values);
      chunks.push({ type: 'NORM', payload: directions.finish() });
    }
    const integers = new IntegerModel();
    const { trianglesAfter } = this.#history.collapses;
    for (let end = this.#baseCollapses; end > 0; ) {
      const most = GROWTH * Math.max(trianglesAfter[end] as number, 16);
      let start = end - 1;
      while (start > 0 && end - start < MOST_SPLITS && (trianglesAfter[start - 1] as number) <= most) start -= 1;
      chunks.push({ type: 'SPLT', payload: this.#chunk(coder, integers, start, end) });
      end = start;
    }
    const rest = new RangeEncoder();
    codeRest(rest, this.#mesh, this.#description, coder.values, this.#restPlan());
    chunks.push({ type: 'REST', payload: rest.finish() }, { type: 'DONE', payload: new Uint8Array(0) });
    return packChunks(chunks);
  }

  #base(values: ValueCoder): Uint8Array {
    const { isLive, lastCorners, lastVertices, collapses, groupStarts } = this.#history;
    const base = this.#baseCollapses;
    // The corners at the base level: those at the end, with what later collapses changed put back.
    const [corners, vertices, alive] = [lastCorners.slice(), lastVertices.slice(), isLive.slice()];
    for (let i = 0; i < collapses.deadEnds.length; i += 1) {
      for (let at = i === 0 ? 0 : (collapses.deadEnds[i - 1] as number); at < (collapses.deadEnds[i] as number); at += 5) {
        const triangle = collapses.dead[at] as number;
        if (i < base) alive[triangle] = 0;
      }
    }
    for (let i = collapses.count - 1; i >= base; i -= 1) {
      for (let at = i === 0 ? 0 : (collapses.movedEnds[i - 1] as number); at < (collapses.movedEnds[i] as number); at += 2) {
        corners[collapses.moved[at] as number] = collapses.moved[at + 1] as number;
        vertices[collapses.moved[at] as number] = collapses.from[i] as number;
      }
    }
    const list: BaseCorner[] = [];
    let group = 0;
    for (let triangle = 0; triangle < alive.length; triangle += 1) {
      while (triangle >= (groupStarts[group + 1] as number)) group += 1;
      if (alive[triangle] === 0) continue;
      for (let k = 0; k < 3; k += 1) {
        const corner = 3 * triangle + k;
        list.push({ name: corner, group, vertex: vertices[corner] as number, wedge: corners[corner] as number });
      }
    }
    const withTriangles = new Set(list.map(({ vertex }) => vertex));
    // Others may be split from them, or have triangles with them again.
    const alone = new Set(this.#inUse);
    for (let i = 0; i < base; i += 1) alone.add(collapses.into[i] as number);
    for (let i = 0; i < base; i += 1) alone.delete(collapses.from[i] as number);
    for (const vertex of withTriangles) alone.delete(vertex);
    const coder = new RangeEncoder();
    codeBase(coder, this.#mesh, this.#description, values, {
      corners: list,
      alone: [...alone],
      vertexOf: (name) => numberIn(this.#vertexNumbers, name),
      wedgeOf: (name) => numberIn(this.#wedgeNumbers, name),
      vertexMade: (name, vertex) => this.#placeVertex(name, vertex),
      wedgeMade: (name, wedge) => this.#nameWedge(name, wedge),
      cornerMade: (name, corner) => this.#nameCorner(name, corner),
    });
    return withError(base === 0 ? 0 : (collapses.errors[base - 1] as number), coder.finish());
  }

  /** Undoes the collapses from `end` down to `start`. */
  #chunk(coder: SplitCoder, integers: IntegerModel, start: number, end: number): Uint8Array {
    const { collapses } = this.#history;
    const encoder = new RangeEncoder();
    const generations = generationsOf(collapses, start, end, this.#vertexNumbers.length);
    integers.unsigned(encoder, 0, generations.length);
    for (const generation of generations) {
      integers.unsigned(encoder, 1, generation.length);
      const numbers = this.#vertexNumbers;
      generation.sort((a, b) => (numbers[collapses.into[a] as number] as number) - (numbers[collapses.into[b] as number] as number));
      let last = -1;
      for (const i of generation) {
        const s = numbers[collapses.into[i] as number] as number;
        integers.unsigned(encoder, 2, s - last - 1);
        last = s;
        this.#split(encoder, coder, i, s);
      }
    }
    return withError(start === 0 ? 0 : (collapses.errors[start - 1] as number), encoder.finish());
  }

  #split(encoder: RangeEncoder, coder: SplitCoder, i: number, s: number): void {
    const { collapses, groupStarts } = this.#history;
    const { moved, movedEnds, dead, deadEnds } = collapses;
    const from = collapses.from[i] as number;
    const firstMoved = i === 0 ? 0 : (movedEnds[i - 1] as number);
    for (let at = firstMoved; at < (movedEnds[i] as number); at += 2) {
      this.#about[this.#cornerNumbers[moved[at] as number] as number] = (moved[at + 1] as number) + 1;
    }
    const triangles: PlannedTriangle[] = [];
    for (let at = i === 0 ? 0 : (deadEnds[i - 1] as number); at < (deadEnds[i] as number); at += 5) {
      const triangle = dead[at] as number;
      const wedges = [dead[at + 1] as number, dead[at + 2] as number, dead[at + 3] as number] as const;
      const third = dead[at + 4] as number;
      const { lastVertices } = this.#history;
      const placeOf = (vertex: number): number => [0, 1, 2].find((k) => lastVertices[3 * triangle + k] === vertex) as number;
      const [atS, atT, atThird] = [placeOf(collapses.into[i] as number), placeOf(from), placeOf(third)];
      triangles.push({
        third: this.#vertexNumbers[third] as number,
        forward: (atS + 1) % 3 === atT,
        group: groupAt(groupStarts, triangle),
        wedges: [wedges[atS] as number, wedges[atT] as number, wedges[atThird] as number],
        made: (number, places) => {
          for (const [k, place] of [atS, atT, atThird].entries()) this.#nameCorner(3 * triangle + place, 3 * number + (places[k] as number));
        },
      });
    }
    const plan: SplitPlan = {
      moved: (corner) => {
        const name = this.#about[corner] as number;
        return name === 0 ? undefined : name - 1;
      },
      triangles,
      numberOf: (name) => numberIn(this.#wedgeNumbers, name),
      parentOf: (name) => this.#parentOf(name),
      setOf: (name) => this.#setOf(name),
      named: (name, wedge) => this.#nameWedge(name, wedge),
      place: (vertex) => this.#placeVertex(from, vertex),
    };
    coder.code(encoder, this.#mesh, s, plan);
    for (let at = firstMoved; at < (movedEnds[i] as number); at += 2) {
      this.#about[this.#cornerNumbers[moved[at] as number] as number] = 0;
    }
  }

  #parentOf(name: number): number {
    let parent = this.#history.mergesInto[name] as number;
    while (parent !== NONE && this.#wedgeNumbers[parent] === NONE) parent = this.#history.mergesInto[parent] as number;
    return parent === NONE ? NONE : (this.#wedgeNumbers[parent] as number);
  }

  #setOf(name: number): number {
    return groupAt(this.#history.setStarts, name);
  }

  #placeVertex(name: number, vertex: number): void {
    this.#vertexNumbers[name] = vertex;
    const set = this.#setOf(name);
    const { positions } = this.#history.source.wedgeSets[set] as { positions: Float32Array };
    const at = 3 * (name - (this.#history.setStarts[set] as number));
    this.#mesh.positions.set(positions.subarray(at, at + 3), 3 * vertex);
  }

  #nameWedge(name: number, wedge: number): void {
    this.#wedgeNumbers[name] = wedge;
    this.#wedgeNames[wedge] = name;
    const set = this.#setOf(name);
    const local = name - (this.#history.setStarts[set] as number);
    const state = this.#mesh.sets[set] as WedgeSetState;
    const place = this.#mesh.placeOf[wedge] as number;
    for (const [index, { components, values }] of (this.#history.source.wedgeSets[set] as ProgressiveSource['wedgeSets'][number]).attributes.entries()) {
      const to = state.attributes[index] as Float32Array;
      for (let k = 0; k < components; k += 1) to[place * components + k] = values[local * components + k] as number;
    }
  }

  #nameCorner(name: number, corner: number): void {
    this.#cornerNumbers[name] = corner;
    this.#cornerNames[corner] = name;
  }

  #restPlan(): RestPlan {
    const { corners, duplicateOf, isLive, groupStarts, setStarts, source } = this.#history;
    const unused: number[] = [];
    const degenerate: Array<{ group: number; corner: number }> = [];
    const named = new Uint8Array(setStarts.at(-1) as number);
    for (let corner = 0; corner < corners.length; corner += 1) {
      const triangle = Math.floor(corner / 3);
      if (isLive[triangle] === 1) named[corners[corner] as number] = 1;
      else if (corner % 3 === 0) degenerate.push({ group: groupAt(groupStarts, triangle), corner });
    }
    for (let name = 0; name < named.length; name += 1) if (named[name] === 0 && this.#wedgeNumbers[name] === NONE) unused.push(name);
    const positionOf = (name: number): Float32Array => {
      const set = this.#setOf(name);
      const at = 3 * (name - (setStarts[set] as number));
      return (source.wedgeSets[set] as { positions: Float32Array }).positions.subarray(at, at + 3);
    };
    return {
      hasDuplicates: duplicateOf.some((of) => of !== NONE),
      wedgeAt: (corner) => corners[this.#cornerNames[corner] as number] as number,
      numberOf: (name) => numberIn(this.#wedgeNumbers, name),
      named: (name, wedge) => this.#nameWedge(name, wedge),
      unused: unused.map((name) => ({ name, set: this.#setOf(name), position: positionOf(name) })),
      degenerate: degenerate.map(({ group, corner }) => ({
        group,
        wedges: [corners[corner] as number, corners[corner + 1] as number, corners[corner + 2] as number],
        made: (triangle) => {
          for (let k = 0; k < 3; k += 1) this.#nameCorner(corner + k, 3 * triangle + k);
        },
      })),
      positionOf: (wedge) => positionOf(this.#wedgeNames[wedge] as number),
      wedgePlace: (wedge) => {
        const name = this.#wedgeNames[wedge] as number;
        return name - (setStarts[this.#setOf(name)] as number);
      },
      trianglePlace: (triangle) => {
        const name = this.#cornerNames[3 * triangle] as number;
        const real = Math.floor(name / 3);
        return { place: real - (groupStarts[groupAt(groupStarts, real)] as number), turn: name % 3 };
      },
    };
  }
}

/** The collapses from `end` down to `start` in generations: each touches nothing that another of the same touches. */
function generationsOf({ from, into, rings, ringEnds }: Collapses, start: number, end: number, names: number): number[][] {
  const written = new Uint16Array(names);
  const read = new Uint16Array(names);
  const generations: number[][] = [];
  for (let i = end - 1; i >= start; i -= 1) {
    const [s, t] = [into[i] as number, from[i] as number];
    let generation = Math.max(written[s] as number, read[s] as number, written[t] as number, read[t] as number);
    const first = i === 0 ? 0 : (ringEnds[i - 1] as number);
    for (let at = first; at < (ringEnds[i] as number); at += 1) generation = Math.max(generation, written[rings[at] as number] as number);
    generation += 1;
    written[s] = written[t] = generation;
    for (let at = first; at < (ringEnds[i] as number); at += 1) {
      const vertex = rings[at] as number;
      read[vertex] = Math.max(read[vertex] as number, generation);
    }
    (generations[generation - 1] ??= []).push(i);
  }
  return generations;
}

function withError(error: number, coded: Uint8Array): Uint8Array {
  const payload = new Uint8Array(4 + coded.length);
  new DataView(payload.buffer).setFloat32(0, error, true);
  payload.set(coded, 4);
  return payload;
}

function numberIn(numbers: Uint32Array, name: number): number | undefined {
  const number = numbers[name] as number;
  return number === NONE ? undefined : number;
}

/** Which of the parts that begin at `starts` has number `value`. */
function groupAt(starts: readonly number[], value: number): number {
  let [low, high] = [0, starts.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((starts[middle] as number) <= value) low = middle;
    else high = middle;
  }
  return low;
}

function joined(arrays: readonly Float32Array[]): Float32Array {
  const all = new Float32Array(arrays.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const array of arrays) {
    all.set(array, at);
    at += array.length;
  }
  return all;
}
