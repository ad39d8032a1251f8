// Attributes in fewer bytes, by KHR_mesh_quantization: positions on a grid of 16 bits, undone by the nodes' placement.

import type { GltfData, Layout, Triangles } from './gltf_data.js';
import { placeMeshes, placeableMeshes } from './quantize_nodes.js';
import { requireExtension, type Tree } from './tree.js';

/**
 * Bits of a grid. Positions: a step of 1/16383 of the mesh's extent; directions: 0.1 degrees; texture coordinates: a
 * quarter of a texel of 4096. Fewer bits than there is room for make what is compressed afterwards smaller.
 */
const BITS = { position: 14, direction: 10, texture: 14 } as const;

/** Where a mesh's grid lies: original = `offset` + `scale` × stored. */
export interface Grid {
  readonly offset: readonly [number, number, number];
  readonly scale: number;
}

/** New values of an accessor. */
interface Replacement {
  readonly values: Int16Array | Uint16Array;
  readonly componentType: number;
  readonly bounds: boolean;
}

/** Quantises what can be without a visible change; the rest stays as it is. */
export function quantize(data: GltfData): void {
  const triangles = data.triangles();
  const elsewhere = data.usedElsewhere(triangles);
  for (const accessor of ambiguous(triangles)) elsewhere.add(accessor);
  const replacements = new Map<number, Replacement>();
  const [grids, positions] = quantizePositions(data, triangles, elsewhere);
  for (const [accessor, replacement] of positions) replacements.set(accessor, replacement);
  for (const [semantic, accessor, isTarget] of triangles.flatMap(namedAccessors)) {
    const layout = data.layout(accessor);
    if (layout?.componentType !== 5126 || elsewhere.has(accessor) || replacements.has(accessor)) continue;
    const replacement = isTarget ? quantizeDelta(semantic, data, layout) : quantizeAttribute(semantic, data, layout);
    if (replacement !== undefined) replacements.set(accessor, replacement);
  }
  if (replacements.size === 0) return;
  store(data, replacements);
  placeMeshes(data, grids);
  requireExtension(data.tree, 'KHR_mesh_quantization');
}

/** Accessors that are several things at once, of which each would be rounded in its own way. */
function ambiguous(triangles: readonly Triangles[]): Set<number> {
  const uses = new Map<number, string>();
  const found = new Set<number>();
  for (const [semantic, accessor, isTarget] of triangles.flatMap(namedAccessors)) {
    const use = `${semantic.replace(/_\d+$/, '')}/${isTarget}`;
    if ((uses.get(accessor) ?? use) !== use) found.add(accessor);
    uses.set(accessor, use);
  }
  return found;
}

function namedAccessors({ attributes, targets }: Triangles): Array<[semantic: string, accessor: number, isTarget: boolean]> {
  return [
    ...attributes.map(([semantic, accessor]): [string, number, boolean] => [semantic, accessor, false]),
    ...targets.flat().map(([semantic, accessor]): [string, number, boolean] => [semantic, accessor, true]),
  ];
}

/** One grid for all meshes that share an accessor; none for a mesh that cannot be placed anew. */
function quantizePositions(
  data: GltfData,
  triangles: readonly Triangles[],
  elsewhere: ReadonlySet<number>,
): [Map<number, Grid>, Map<number, Replacement>] {
  const placeable = placeableMeshes(data);
  const grids = new Map<number, Grid>();
  const replacements = new Map<number, Replacement>();
  const meshesOf = new Map<number, Set<number>>();
  for (const { mesh, attributes, targets } of triangles) {
    for (const [, accessor] of [attributes, ...targets].flat().filter(([semantic]) => semantic === 'POSITION')) {
      meshesOf.set(accessor, (meshesOf.get(accessor) ?? new Set()).add(mesh));
    }
  }
  for (const mesh of new Set(triangles.map((primitive) => primitive.mesh))) {
    const own = triangles.filter((primitive) => primitive.mesh === mesh);
    const bases = new Set(own.flatMap(({ attributes }) => accessorsOf(attributes)));
    const deltas = new Set(own.flatMap(({ targets }) => targets.flatMap(accessorsOf)));
    const all = [...bases, ...deltas];
    const layouts = new Map(all.map((accessor) => [accessor, data.layout(accessor)]));
    const primitives = data.tree['meshes'] as Array<{ primitives: unknown[] }>;
    const whole = primitives[mesh]?.primitives.length === own.length;
    const free = all.every(
      (accessor) =>
        layouts.get(accessor)?.componentType === 5126 && !elsewhere.has(accessor) && meshesOf.get(accessor)?.size === 1,
    );
    // Points or lines of the same mesh would be moved with it.
    if (!placeable.has(mesh) || !whole || !free || bases.size === 0 || [...bases].some((accessor) => deltas.has(accessor))) continue;
    const grid = gridOf(data, [...bases].map((accessor) => layouts.get(accessor) as Layout), [...deltas].map((accessor) => layouts.get(accessor) as Layout));
    if (grid === undefined) continue;
    grids.set(mesh, grid);
    for (const accessor of all) {
      const origin = bases.has(accessor) ? grid.offset : [0, 0, 0];
      const values = data.values(layouts.get(accessor) as Layout).map((value, at) => (value - (origin[at % 3] as number)) / grid.scale);
      replacements.set(accessor, { values: onGrid(values as Float32Array, BITS.position), componentType: 5122, bounds: true });
    }
  }
  return [grids, replacements];
}

const accessorsOf = (list: ReadonlyArray<readonly [string, number]>): number[] =>
  list.filter(([semantic]) => semantic === 'POSITION').map(([, accessor]) => accessor);

function gridOf(data: GltfData, bases: readonly Layout[], deltas: readonly Layout[]): Grid | undefined {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const layout of bases) {
    for (const [at, value] of data.values(layout).entries()) {
      low[at % 3] = Math.min(low[at % 3] as number, value);
      high[at % 3] = Math.max(high[at % 3] as number, value);
    }
  }
  let scale = Math.max(...high.map((value, axis) => (value - (low[axis] as number)) / 2));
  for (const layout of deltas) for (const value of data.values(layout)) scale = Math.max(scale, Math.abs(value));
  const offset = low.map((value, axis) => (value + (high[axis] as number)) / 2);
  if (!(scale > 0) || !Number.isFinite(scale) || !offset.every(Number.isFinite)) return undefined;
  return { offset: offset as [number, number, number], scale };
}

/** Values from -1 to 1 as normalised 16-bit integers, on a grid of fewer bits. */
function onGrid(values: Float32Array, bits: number): Int16Array {
  const steps = 2 ** (bits - 1) - 1;
  return Int16Array.from(values, (value) => Math.round((Math.round(Math.max(-1, Math.min(1, value)) * steps) / steps) * 32767));
}

function quantizeAttribute(semantic: string, data: GltfData, layout: Layout): Replacement | undefined {
  const values = data.values(layout) as Float32Array;
  const within = (low: number): boolean => values.every((value) => value >= low && value <= 1);
  if (semantic === 'NORMAL' || semantic === 'TANGENT') {
    return values.every((value) => Math.abs(value) <= 1.001)
      ? { values: onGrid(values, BITS.direction), componentType: 5122, bounds: false }
      : undefined;
  }
  if (semantic.startsWith('TEXCOORD_')) {
    // Beyond 0 to 1 textures repeat, and a transform of the texture would be needed.
    if (!within(0)) return undefined;
    const steps = 2 ** BITS.texture - 1;
    const quantized = Uint16Array.from(values, (value) => Math.round((Math.round(value * steps) / steps) * 65535));
    return { values: quantized, componentType: 5123, bounds: false };
  }
  if (semantic.startsWith('COLOR_') && within(0)) {
    return { values: Uint16Array.from(values, (value) => Math.round(value * 65535)), componentType: 5123, bounds: false };
  }
  if (semantic === 'WEIGHTS_0' && layout.components === 4 && within(0)) {
    return { values: quantizeWeights(values), componentType: 5123, bounds: false };
  }
  return undefined;
}

// Of morph targets only the directions: positions have the grid of their mesh.
function quantizeDelta(semantic: string, data: GltfData, layout: Layout): Replacement | undefined {
  if (semantic !== 'NORMAL' && semantic !== 'TANGENT') return undefined;
  const values = data.values(layout) as Float32Array;
  if (!values.every((value) => Math.abs(value) <= 1)) return undefined;
  return { values: onGrid(values, BITS.direction), componentType: 5122, bounds: false };
}

/** Four weights as 16 bits each that add up to 1 if the weights do. With 8 bits what is far from its joint would shake. */
function quantizeWeights(values: Float32Array): Uint16Array {
  const quantized = Uint16Array.from(values, (value) => Math.round(value * 65535));
  for (let row = 0; row < values.length; row += 4) {
    const weights = values.subarray(row, row + 4);
    const sum = weights.reduce((total, value) => total + value, 0);
    if (Math.abs(sum - 1) > 1e-3) continue;
    const rest = 65535 - quantized.subarray(row, row + 4).reduce((total, value) => total + value, 0);
    // The largest can take what rounding left, which is at most two steps.
    const largest = row + weights.indexOf(Math.max(...weights));
    quantized[largest] = (quantized[largest] as number) + rest;
  }
  return quantized;
}

/** Puts the new values into views by their stride, as many in one as there are of it. */
function store(data: GltfData, replacements: ReadonlyMap<number, Replacement>): void {
  const pools = new Map<number, Array<{ accessor: number; rows: Uint8Array }>>();
  const left = new Set<number>();
  for (const [accessor, { values, componentType, bounds }] of replacements) {
    const { components, count, view } = data.layout(accessor) as Layout;
    const json = data.accessor(accessor);
    left.add(view);
    const size = components * values.BYTES_PER_ELEMENT;
    const stride = Math.ceil(size / 4) * 4;
    const rows = new Uint8Array(count * stride);
    const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    for (let row = 0; row < count; row += 1) rows.set(bytes.subarray(row * size, (row + 1) * size), row * stride);
    for (const key of ['byteOffset', 'bufferView', 'min', 'max']) delete json[key];
    Object.assign(json, { componentType, normalized: true }, bounds ? boundsOf(values, components) : {});
    pools.set(stride, [...(pools.get(stride) ?? []), { accessor, rows }]);
  }
  data.freeViews(left);
  for (const [byteStride, members] of pools) {
    const bytes = new Uint8Array(members.reduce((sum, { rows }) => sum + rows.length, 0));
    const view = data.addView(bytes, { byteStride, target: 34962 });
    let offset = 0;
    for (const { accessor, rows } of members) {
      bytes.set(rows, offset);
      Object.assign(data.accessor(accessor), { bufferView: view }, offset > 0 ? { byteOffset: offset } : {});
      offset += rows.length;
    }
  }
}

function boundsOf(values: ArrayLike<number>, components: number): Tree {
  const min = Array.from({ length: components }, () => Infinity);
  const max = Array.from({ length: components }, () => -Infinity);
  for (let at = 0; at < values.length; at += 1) {
    min[at % components] = Math.min(min[at % components] as number, values[at] as number);
    max[at % components] = Math.max(max[at % components] as number, values[at] as number);
  }
  return { min, max };
}
