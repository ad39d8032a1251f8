// Levels of a progressive mesh as arrays for a renderer.

import type { LevelGeometry } from '../types.js';
import type { Description } from './description.js';
import type { Rest } from './rest_coder.js';
import { NONE, type SplitMesh, type WedgeSetState } from './state.js';

/** Which triangles there are, with which wedges, at which vertices. */
export interface View {
  readonly corners: Uint32Array;
  readonly vertexOf: Uint32Array;
  /** Triangles that count; and of these only those that `has` does not leave out. */
  readonly triangleCount: number;
  readonly has?: Uint8Array;
}

/** The wedges of each set that a view uses, in their order, and the place of each wedge among those. */
export interface Used {
  readonly wedges: readonly Uint32Array[];
  readonly places: Uint32Array;
}

/** Finds the wedges in use. */
export function wedgesInUse(mesh: SplitMesh, { corners, triangleCount, has }: View): Used {
  const places = new Uint32Array(mesh.wedgeCount).fill(NONE);
  for (let corner = 0; corner < 3 * triangleCount; corner += 1) {
    if (has !== undefined && has[Math.floor(corner / 3)] === 0) continue;
    places[corners[corner] as number] = 0;
  }
  const counts = mesh.sets.map(() => 0);
  for (let wedge = 0; wedge < mesh.wedgeCount; wedge += 1) {
    if (places[wedge] === NONE) continue;
    const set = mesh.setOf[wedge] as number;
    places[wedge] = counts[set] as number;
    counts[set] = (counts[set] as number) + 1;
  }
  const wedges = counts.map((count) => new Uint32Array(count));
  for (let wedge = 0; wedge < mesh.wedgeCount; wedge += 1) {
    if (places[wedge] !== NONE) (wedges[mesh.setOf[wedge] as number] as Uint32Array)[places[wedge] as number] = wedge;
  }
  return { wedges, places };
}

/** The arrays of a view. */
export function geometryOf(mesh: SplitMesh, description: Description, view: View, used = wedgesInUse(mesh, view)): LevelGeometry {
  const { corners, triangleCount, has } = view;
  const counts = description.groups.map(() => 0);
  const alive = (triangle: number): boolean => has === undefined || has[triangle] !== 0;
  for (let triangle = 0; triangle < triangleCount; triangle += 1) {
    if (alive(triangle)) counts[mesh.groupOf[triangle] as number] = (counts[mesh.groupOf[triangle] as number] as number) + 1;
  }
  const indices = counts.map((count) => new Uint32Array(3 * count));
  const ends = counts.map(() => 0);
  for (let triangle = 0; triangle < triangleCount; triangle += 1) {
    if (!alive(triangle)) continue;
    const group = mesh.groupOf[triangle] as number;
    const at = ends[group] as number;
    for (let k = 0; k < 3; k += 1) (indices[group] as Uint32Array)[at + k] = used.places[corners[3 * triangle + k] as number] as number;
    ends[group] = at + 3;
  }
  return {
    groups: description.groups.map(({ mesh: owner, primitive, wedgeSet }, group) => ({ mesh: owner, primitive, wedgeSet, indices: indices[group] as Uint32Array })),
    wedgeSets: used.wedges.map((wedges, set) => ({
      positions: positionsOf(mesh, wedges, view.vertexOf),
      attributes: Object.fromEntries(
        (description.wedgeSets[set] as Description['wedgeSets'][number]).attributes.map(({ name, components }, index) => [
          name,
          { components, values: valuesOf(mesh, mesh.sets[set] as WedgeSetState, index, wedges) },
        ]),
      ),
    })),
  };
}

/** The positions of wedges at these vertices. */
export function positionsOf(mesh: SplitMesh, wedges: Uint32Array, vertexOf: Uint32Array): Float32Array {
  const positions = new Float32Array(3 * wedges.length);
  for (let i = 0; i < wedges.length; i += 1) {
    const at = 3 * (vertexOf[wedges[i] as number] as number);
    for (let k = 0; k < 3; k += 1) positions[3 * i + k] = mesh.positions[at + k] as number;
  }
  return positions;
}

/** The values of attribute `index` of wedges of one set. */
export function valuesOf(mesh: SplitMesh, state: WedgeSetState, index: number, wedges: Uint32Array): Float32Array {
  const components = state.components[index] as number;
  const from = state.attributes[index] as Float32Array;
  const values = new Float32Array(components * wedges.length);
  for (let i = 0; i < wedges.length; i += 1) {
    const at = components * (mesh.placeOf[wedges[i] as number] as number);
    for (let k = 0; k < components; k += 1) values[components * i + k] = from[at + k] as number;
  }
  return values;
}

/** The whole mesh, with everything that the splits do not bring back, in the input's order if that is known. */
export function wholeGeometry(mesh: SplitMesh, description: Description, { signs, wedgePlaces, trianglePlaces, turns }: Rest): LevelGeometry {
  const order = mesh.sets.map(({ wedges, count }) => {
    if (wedgePlaces === undefined) return wedges.slice(0, count);
    const ordered = new Uint32Array(count);
    for (let i = 0; i < count; i += 1) ordered[wedgePlaces[wedges[i] as number] as number] = wedges[i] as number;
    return ordered;
  });
  const places = wedgePlaces ?? mesh.placeOf;
  const corners = mesh.corners;
  const indices = description.groups.map(({ triangles }) => new Uint32Array(3 * triangles));
  const ends = description.groups.map(() => 0);
  for (let triangle = 0; triangle < mesh.triangleCount; triangle += 1) {
    const group = mesh.groupOf[triangle] as number;
    const at = 3 * (trianglePlaces?.[triangle] ?? (ends[group] as number));
    const turn = turns?.[triangle] ?? 0;
    for (let k = 0; k < 3; k += 1) {
      (indices[group] as Uint32Array)[at + ((k + turn) % 3)] = places[corners[3 * triangle + k] as number] as number;
    }
    ends[group] = (ends[group] as number) + 1;
  }
  const geometry = geometryOf(mesh, description, { corners, vertexOf: mesh.vertexOf, triangleCount: 0 }, { wedges: order, places });
  for (const sign of signs) {
    const wedge = Math.floor(sign / 3);
    const { positions } = geometry.wedgeSets[mesh.setOf[wedge] as number] as { positions: Float32Array };
    const at = 3 * (places[wedge] as number) + (sign % 3);
    positions[at] = -(positions[at] as number);
  }
  return { ...geometry, groups: geometry.groups.map((group, index) => ({ ...group, indices: indices[index] as Uint32Array })) };
}
