// The base mesh as bits: corner by corner, each a wedge that was there or a new one.
//
// Its normals come after it. They have no digits in common with what is around them and would take half of the bytes before
// the first picture, which can do with those of the surface.

import { DecimeshError } from '../errors.js';
import { isDirection, type Description } from './description.js';
import { FloatModel, IntegerModel } from './numbers.js';
import { newModels, type Coder } from './range_coder.js';
import { NONE, type SplitMesh } from './state.js';
import type { ValueCoder } from './value_coder.js';

/** A corner of the base mesh, as the writer knows it; three in a row are a triangle. */
export interface BaseCorner {
  readonly name: number;
  readonly group: number;
  readonly vertex: number;
  readonly wedge: number;
}

/** What the writer knows of the base mesh. */
export interface BasePlan {
  readonly corners: readonly BaseCorner[];
  /** Vertices without a triangle that others will be split from. */
  readonly alone: readonly number[];
  vertexOf(name: number): number | undefined;
  wedgeOf(name: number): number | undefined;
  vertexMade(name: number, vertex: number): void;
  wedgeMade(name: number, wedge: number): void;
  cornerMade(name: number, corner: number): void;
}

/** Codes the base mesh into an empty mesh. */
export function codeBase(coder: Coder, mesh: SplitMesh, description: Description, values: ValueCoder, plan?: BasePlan): void {
  const integers = new IntegerModel();
  const positions = new FloatModel(description.positionGrid, 3);
  const flags = newModels(4);
  let last = [0, 0, 0];
  const addVertex = (name: number | undefined): number => {
    const vertex = mesh.addVertex(NONE);
    if (plan !== undefined && name !== undefined) plan.vertexMade(name, vertex);
    positions.code(coder, mesh.positions, 3 * vertex, last, description.diagonal);
    last = [...mesh.positions.subarray(3 * vertex, 3 * vertex + 3)];
    return vertex;
  };
  const index = (context: number, count: number, value: number): number => {
    const read = integers.unsigned(coder, context, value);
    if (read >= count) throw new DecimeshError('out-of-range', 'an index points outside of the base mesh', 'base');
    return read;
  };
  const aloneCount = integers.unsigned(coder, 0, plan?.alone.length ?? 0);
  for (let k = 0; k < aloneCount; k += 1) addVertex(plan?.alone[k]);
  let group = 0;
  for (let triangle = 0; triangle < description.baseTriangles; triangle += 1) {
    const planned = plan?.corners.slice(3 * triangle, 3 * triangle + 3);
    if (coder.bit(flags, 0, planned !== undefined && planned[0]?.group !== group ? 1 : 0) === 1) {
      group = index(1, description.groups.length, planned?.[0]?.group ?? 0);
    }
    const set = description.groups[group]?.wedgeSet ?? 0;
    const wedges: number[] = [];
    const vertices: number[] = [];
    for (let k = 0; k < 3; k += 1) {
      const corner = planned?.[k];
      const known = corner && plan?.wedgeOf(corner.wedge);
      if (coder.bit(flags, 1, corner !== undefined && known === undefined ? 1 : 0) === 0) {
        const wedge = mesh.wedgeCount - 1 - index(2, mesh.wedgeCount, mesh.wedgeCount - 1 - (known ?? 0));
        if (mesh.setOf[wedge] !== set) throw new DecimeshError('syntax', 'a triangle has wedges of several sets', 'base');
        wedges.push(wedge);
        vertices.push(mesh.vertexOf[wedge] as number);
        continue;
      }
      const knownVertex = corner && plan?.vertexOf(corner.vertex);
      const isNew = coder.bit(flags, 2, corner !== undefined && knownVertex === undefined ? 1 : 0) === 1;
      const vertex = isNew ? addVertex(corner?.vertex) : mesh.vertexCount - 1 - index(3, mesh.vertexCount, mesh.vertexCount - 1 - (knownVertex ?? 0));
      // The wedge before is a parent for the prediction alone: there is no coarser level.
      const before = wedges.at(-1) ?? mesh.wedgeCount - 1;
      const wedge = mesh.addWedge(set, before >= 0 && mesh.setOf[before] === set ? before : NONE, vertex);
      if (corner !== undefined) plan?.wedgeMade(corner.wedge, wedge);
      values.codeValues(coder, mesh, wedge, 'others');
      wedges.push(wedge);
      vertices.push(vertex);
    }
    if (new Set(vertices).size < 3) throw new DecimeshError('syntax', 'a triangle has a vertex twice', 'base');
    const made = mesh.addTriangle(group, wedges, vertices);
    for (const [k, corner] of (planned ?? []).entries()) plan?.cornerMade(corner.name, 3 * made + k);
  }
}

/** Codes the normals of the base mesh, once that is there. */
export function codeDirections(coder: Coder, mesh: SplitMesh, values: ValueCoder): void {
  for (let wedge = 0; wedge < mesh.wedgeCount; wedge += 1) values.codeValues(coder, mesh, wedge, 'directions');
}

/** Gives the wedges of the base mesh the normals of its surface, until their own are there: by area, of unit length. */
export function guessDirections(mesh: SplitMesh, { wedgeSets }: Description): void {
  const sums = new Float64Array(3 * mesh.wedgeCount);
  for (let triangle = 0; triangle < mesh.triangleCount; triangle += 1) {
    const wedges = [0, 1, 2].map((k) => mesh.corners[3 * triangle + k] as number);
    const [a, b, c] = wedges.map((wedge) => 3 * (mesh.vertexOf[wedge] as number)) as [number, number, number];
    const side = (to: number, k: number): number => (mesh.positions[to + k] as number) - (mesh.positions[a + k] as number);
    for (let k = 0; k < 3; k += 1) {
      const [p, q] = [(k + 1) % 3, (k + 2) % 3];
      const normal = side(b, p) * side(c, q) - side(b, q) * side(c, p);
      for (const wedge of wedges) sums[3 * wedge + k] = (sums[3 * wedge + k] as number) + normal;
    }
  }
  for (let wedge = 0; wedge < mesh.wedgeCount; wedge += 1) {
    const set = mesh.setOf[wedge] as number;
    const normal = sums.subarray(3 * wedge, 3 * wedge + 3);
    const length = Math.hypot(...normal);
    for (const [index, attribute] of (wedgeSets[set]?.attributes ?? []).entries()) {
      if (!isDirection(attribute)) continue;
      const unit = length > 0 && Number.isFinite(length) ? normal.map((value) => value / length) : [0, 0, 1];
      mesh.sets[set]?.attributes[index]?.set(unit, 3 * (mesh.placeOf[wedge] as number));
    }
  }
}
