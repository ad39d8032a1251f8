// What the splits do not bring back: wedges that are the same as others, triangles without three vertices, wedges
// without a triangle, the sign of zeros, and, if it is wanted, the order of everything.

import { DecimeshError } from '../errors.js';
import type { Description } from './description.js';
import { FloatModel, IntegerModel } from './numbers.js';
import { newModels, type Coder } from './range_coder.js';
import { NONE, type SplitMesh } from './state.js';
import type { ValueCoder } from './value_coder.js';

/** What the writer knows of it. */
export interface RestPlan {
  readonly hasDuplicates: boolean;
  /** The name of the wedge that a corner of the mesh has in the original. */
  wedgeAt(corner: number): number;
  numberOf(name: number): number | undefined;
  named(name: number, wedge: number): void;
  readonly unused: ReadonlyArray<{ readonly name: number; readonly set: number; readonly position: Float32Array }>;
  readonly degenerate: ReadonlyArray<{ readonly group: number; readonly wedges: readonly number[]; made(triangle: number): void }>;
  /** The position of a wedge of the mesh with the signs of its own zeros. */
  positionOf(wedge: number): Float32Array;
  /** Place of a wedge of the mesh in its set of the original. */
  wedgePlace(wedge: number): number;
  /** Place of a triangle of the mesh in its group of the original, and there the place of its first corner. */
  trianglePlace(triangle: number): { readonly place: number; readonly turn: number };
}

/** What the reader needs to know of it. */
export interface Rest {
  /** `3 * wedge + k` where a zero has another sign than at the vertex. */
  readonly signs: readonly number[];
  /** Place of each wedge in its set of the original; undefined without the order. */
  readonly wedgePlaces: Uint32Array | undefined;
  /** Place of each triangle in its group of the original. */
  readonly trianglePlaces: Uint32Array | undefined;
  /** Place of each triangle's first corner. */
  readonly turns: Uint8Array | undefined;
}

/** Codes the rest, and makes the mesh whole. */
export function codeRest(coder: Coder, mesh: SplitMesh, description: Description, values: ValueCoder, plan?: RestPlan): Rest {
  const flags = newModels(8);
  const integers = new IntegerModel();
  codeDuplicates(coder, mesh, values, flags, integers, plan);
  codeUnused(coder, mesh, description, values, integers, plan);
  codeDegenerate(coder, mesh, description, integers, plan);
  checkCounts(mesh, description);
  const signs = codeSigns(coder, mesh, integers, plan);
  if (!description.keepsOrder) return { signs, wedgePlaces: undefined, trianglePlaces: undefined, turns: undefined };
  return { signs, ...codeOrder(coder, mesh, description, flags, integers, plan) };
}

function codeDuplicates(coder: Coder, mesh: SplitMesh, values: ValueCoder, flags: Uint16Array, integers: IntegerModel, plan: RestPlan | undefined): void {
  if (coder.bit(flags, 0, plan?.hasDuplicates === true ? 1 : 0) === 0) return;
  for (let corner = 0; corner < 3 * mesh.triangleCount; corner += 1) {
    const base = mesh.corners[corner] as number;
    const name = plan?.wedgeAt(corner);
    const known = name === undefined ? undefined : plan?.numberOf(name);
    if (coder.bit(flags, 1, name !== undefined && known !== base ? 1 : 0) === 0) continue;
    if (coder.bit(flags, 2, name !== undefined && known === undefined ? 1 : 0) === 0) {
      const back = integers.unsigned(coder, 0, mesh.wedgeCount - 1 - (known ?? 0));
      const wedge = mesh.wedgeCount - 1 - back;
      if (wedge < 0 || mesh.vertexOf[wedge] !== mesh.vertexOf[base] || mesh.setOf[wedge] !== mesh.setOf[base]) {
        throw new DecimeshError('syntax', 'a wedge is at another vertex', 'rest');
      }
      mesh.corners[corner] = wedge;
      continue;
    }
    const wedge = mesh.addWedge(mesh.setOf[base] as number, base, mesh.vertexOf[base] as number);
    if (name !== undefined) plan?.named(name, wedge);
    values.codeValues(coder, mesh, wedge);
    mesh.corners[corner] = wedge;
  }
}

function codeUnused(coder: Coder, mesh: SplitMesh, description: Description, values: ValueCoder, integers: IntegerModel, plan: RestPlan | undefined): void {
  const positions = new FloatModel(description.positionGrid, 3);
  const last = [0, 0, 0];
  const count = integers.unsigned(coder, 1, plan?.unused.length ?? 0);
  let before = NONE;
  for (let k = 0; k < count; k += 1) {
    const planned = plan?.unused[k];
    const set = integers.unsigned(coder, 2, planned?.set ?? 0);
    if (set >= mesh.sets.length) throw new DecimeshError('out-of-range', 'there is no such wedge set', 'rest');
    const vertex = mesh.addVertex(NONE);
    if (planned !== undefined) mesh.positions.set(planned.position, 3 * vertex);
    positions.code(coder, mesh.positions, 3 * vertex, last, description.diagonal);
    const wedge = mesh.addWedge(set, before !== NONE && mesh.setOf[before] === set ? before : NONE, vertex);
    if (planned !== undefined) plan?.named(planned.name, wedge);
    values.codeValues(coder, mesh, wedge);
    for (let i = 0; i < 3; i += 1) last[i] = mesh.positions[3 * vertex + i] as number;
    before = wedge;
  }
}

function codeDegenerate(coder: Coder, mesh: SplitMesh, { groups }: Description, integers: IntegerModel, plan: RestPlan | undefined): void {
  const count = integers.unsigned(coder, 3, plan?.degenerate.length ?? 0);
  for (let k = 0; k < count; k += 1) {
    const planned = plan?.degenerate[k];
    const group = integers.unsigned(coder, 4, planned?.group ?? 0);
    if (group >= groups.length) throw new DecimeshError('out-of-range', 'there is no such group', 'rest');
    const wedges: number[] = [];
    for (let corner = 0; corner < 3; corner += 1) {
      const name = planned?.wedges[corner];
      const wedge = integers.unsigned(coder, 5, name === undefined ? 0 : (plan?.numberOf(name) ?? 0));
      if (wedge >= mesh.wedgeCount) throw new DecimeshError('out-of-range', `there is no wedge ${wedge}`, 'rest');
      wedges.push(wedge);
    }
    const triangle = mesh.addTriangle(group, wedges, wedges.map((wedge) => mesh.vertexOf[wedge] as number));
    planned?.made(triangle);
  }
}

function checkCounts(mesh: SplitMesh, { triangles, wedgeSets, groups }: Description): void {
  const counts = groups.map(() => 0);
  for (let triangle = 0; triangle < mesh.triangleCount; triangle += 1) {
    const group = mesh.groupOf[triangle] as number;
    counts[group] = (counts[group] as number) + 1;
  }
  const asSaid =
    mesh.triangleCount === triangles &&
    mesh.sets.every(({ count }, set) => count === wedgeSets[set]?.wedges) &&
    counts.every((count, group) => count === groups[group]?.triangles);
  if (!asSaid) throw new DecimeshError('syntax', 'the counts are not those of the header', 'rest');
}

function codeSigns(coder: Coder, mesh: SplitMesh, integers: IntegerModel, plan: RestPlan | undefined): number[] {
  const signs: number[] = [];
  if (plan !== undefined) {
    for (let wedge = 0; wedge < mesh.wedgeCount; wedge += 1) {
      const own = plan.positionOf(wedge);
      const at = 3 * (mesh.vertexOf[wedge] as number);
      for (let k = 0; k < 3; k += 1) if (!Object.is(own[k], mesh.positions[at + k])) signs.push(3 * wedge + k);
    }
  }
  const count = integers.unsigned(coder, 6, signs.length);
  let last = -1;
  for (let k = 0; k < count; k += 1) {
    last += 1 + integers.unsigned(coder, 7, (signs[k] ?? 0) - last - 1);
    if (last >= 3 * mesh.wedgeCount) throw new DecimeshError('out-of-range', 'there is no such wedge', 'rest');
    signs[k] = last;
  }
  return signs;
}

function codeOrder(coder: Coder, mesh: SplitMesh, description: Description, flags: Uint16Array, integers: IntegerModel, plan: RestPlan | undefined): Omit<Rest, 'signs'> {
  const wedgePlaces = new Uint32Array(mesh.wedgeCount);
  const places = (count: number): Uint8Array => new Uint8Array(count);
  const taken = mesh.sets.map(({ count }) => places(count));
  const put = (seen: Uint8Array | undefined, place: number): number => {
    if (seen === undefined || place < 0 || place >= seen.length || seen[place] === 1) throw new DecimeshError('syntax', 'the order has a place twice', 'rest');
    seen[place] = 1;
    return place;
  };
  for (let wedge = 0; wedge < mesh.wedgeCount; wedge += 1) {
    const parent = mesh.parentWedges[wedge] as number;
    const guess = parent === NONE ? 0 : (wedgePlaces[parent] as number);
    const place = guess + integers.signed(coder, 8, plan === undefined ? 0 : plan.wedgePlace(wedge) - guess);
    wedgePlaces[wedge] = put(taken[mesh.setOf[wedge] as number], place);
  }
  const trianglePlaces = new Uint32Array(mesh.triangleCount);
  const turns = new Uint8Array(mesh.triangleCount);
  const groupsTaken = description.groups.map(({ triangles }) => places(triangles));
  // The triangle of the same wedge that was met last is not far.
  const lastAt = new Uint32Array(mesh.wedgeCount);
  for (let triangle = 0; triangle < mesh.triangleCount; triangle += 1) {
    const planned = plan?.trianglePlace(triangle);
    let guess = 0;
    for (let k = 0; k < 3; k += 1) guess = Math.max(guess, lastAt[mesh.corners[3 * triangle + k] as number] as number);
    const place = guess + integers.signed(coder, 9, planned === undefined ? 0 : planned.place - guess);
    trianglePlaces[triangle] = put(groupsTaken[mesh.groupOf[triangle] as number], place);
    for (let k = 0; k < 3; k += 1) lastAt[mesh.corners[3 * triangle + k] as number] = place;
    const turn = planned?.turn ?? 0;
    turns[triangle] = coder.bit(flags, 3, turn > 0 ? 1 : 0) === 0 ? 0 : 1 + coder.bit(flags, 4, turn > 1 ? 1 : 0);
  }
  return { wedgePlaces, trianglePlaces, turns };
}

