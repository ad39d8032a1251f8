// Triangles in the order of the vertex cache and vertices in the order of their first use: nothing else changes.

import type { GltfData, Layout, Triangles } from './gltf_data.js';
import { meshoptEncoder } from './modules.js';
import { objectOr } from './tree.js';

/** Extensions of primitives that do not refer to a vertex by its number. */
const HARMLESS = new Set(['KHR_materials_variants', 'EXT_mesh_features', 'EXT_structural_metadata']);

/** Orders every list of triangles, and the vertices where nothing else refers to them. */
export async function reorder(data: GltfData): Promise<void> {
  const encoder = await meshoptEncoder();
  const triangles = data.triangles();
  const elsewhere = data.usedElsewhere(triangles);
  const indexUses = new Map<number, number>();
  for (const { indices } of triangles) indexUses.set(indices, (indexUses.get(indices) ?? 0) + 1);
  const ordered = new Map<number, Uint32Array>();
  for (const { indices } of triangles) {
    if (ordered.has(indices) || elsewhere.has(indices)) continue;
    const values = Uint32Array.from(data.values(data.layout(indices) as Layout));
    const cached = values.slice();
    const [remap] = encoder.reorderMesh(cached, true, true);
    // It numbers the vertices anew at once; several primitives may share them, so that is taken back here.
    const original = new Uint32Array(remap.length);
    for (const [from, to] of remap.entries()) if (to !== 0xffff_ffff) original[to] = from;
    ordered.set(indices, cached.map((vertex) => original[vertex] as number));
  }
  for (const group of vertexGroups(triangles)) renumber(data, group, elsewhere, indexUses, ordered);
  for (const [accessor, values] of ordered) overwrite(data, accessor, values);
}

/** Primitives by the vertices they share. */
function vertexGroups(triangles: readonly Triangles[]): Triangles[][] {
  const groupOf = new Map<number, Set<Triangles>>();
  for (const primitive of triangles) {
    const members = new Set([primitive]);
    for (const accessor of accessorsOf(primitive)) for (const member of groupOf.get(accessor) ?? []) members.add(member);
    for (const member of members) for (const accessor of accessorsOf(member)) groupOf.set(accessor, members);
  }
  return [...new Set(groupOf.values())].map((members) => [...members]);
}

const accessorsOf = ({ attributes, targets }: Triangles): number[] => [attributes, ...targets].flat().map(([, accessor]) => accessor);

function renumber(
  data: GltfData,
  group: readonly Triangles[],
  elsewhere: ReadonlySet<number>,
  indexUses: ReadonlyMap<number, number>,
  ordered: Map<number, Uint32Array>,
): void {
  const accessors = [...new Set(group.flatMap(accessorsOf))];
  const layouts = accessors.map((accessor) => data.layout(accessor));
  const count = layouts[0]?.count ?? 0;
  const fits = layouts.every((layout, index) => layout?.count === count && !elsewhere.has(accessors[index] as number));
  const harmless = group.every(({ json }) => Object.keys(objectOr(json['extensions'])).every((name) => HARMLESS.has(name)));
  const lists = [...new Set(group.map(({ indices }) => indices))];
  // Indices that another group uses too would have to be right for both.
  const own = lists.every((indices) => indexUses.get(indices) === group.filter((primitive) => primitive.indices === indices).length);
  if (!fits || !harmless || !own || !lists.every((indices) => ordered.has(indices))) return;
  const remap = new Uint32Array(count).fill(0xffff_ffff);
  let next = 0;
  for (const indices of lists) {
    for (const vertex of ordered.get(indices) as Uint32Array) {
      if (vertex >= count) return;
      if (remap[vertex] === 0xffff_ffff) remap[vertex] = next++;
    }
  }
  // What no triangle uses goes to the end: it may be there for a reason.
  for (let vertex = 0; vertex < count; vertex += 1) if (remap[vertex] === 0xffff_ffff) remap[vertex] = next++;
  for (const indices of lists) ordered.set(indices, (ordered.get(indices) as Uint32Array).map((vertex) => remap[vertex] as number));
  for (const layout of layouts as Layout[]) permute(data, layout, remap);
}

function permute(data: GltfData, { view, offset, stride, size, count }: Layout, remap: Uint32Array): void {
  const source = data.views[view] as Uint8Array;
  const target = source.slice();
  for (let row = 0; row < count; row += 1) {
    const from = offset + row * stride;
    target.set(source.subarray(from, from + size), offset + (remap[row] as number) * stride);
  }
  data.views[view] = target;
}

function overwrite(data: GltfData, accessor: number, values: Uint32Array): void {
  const { view, offset, componentType } = data.layout(accessor) as Layout;
  const json = data.accessor(accessor);
  if (json['min'] !== undefined) json['min'] = [values.reduce((least, value) => Math.min(least, value), Infinity)];
  if (json['max'] !== undefined) json['max'] = [values.reduce((most, value) => Math.max(most, value), 0)];
  const target = (data.views[view] as Uint8Array).slice();
  const narrow = componentType === 5121 ? Uint8Array.from(values) : componentType === 5123 ? Uint16Array.from(values) : values;
  target.set(new Uint8Array(narrow.buffer, narrow.byteOffset, narrow.byteLength), offset);
  data.views[view] = target;
}
