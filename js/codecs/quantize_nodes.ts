// The placement of quantised meshes: each node that shows one undoes the grid, and nothing else in the scene moves.

import type { GltfData, Layout } from './gltf_data.js';
import type { Grid } from './quantize.js';
import { arrayAt, objectOr, objects, uint, type Tree } from './tree.js';

/** Extensions of nodes that do not depend on where the node's own mesh is. */
const HARMLESS = new Set(['KHR_lights_punctual', 'KHR_node_visibility', 'MSFT_lod']);

/** The meshes whose every node can be placed anew. */
export function placeableMeshes(data: GltfData): Set<number> {
  const { tree } = data;
  const meshes = new Set(objects(tree, 'meshes').keys());
  // An animation of anything by its address may be of what is changed here.
  if (JSON.stringify(tree['animations'] ?? []).includes('KHR_animation_pointer')) return new Set();
  const skinsAreClear = objects(tree, 'skins').every((skin) => {
    const accessor = uint(skin['inverseBindMatrices']);
    return accessor === undefined || matrices(data, accessor) !== undefined;
  });
  for (const node of objects(tree, 'nodes')) {
    const mesh = uint(node['mesh']);
    if (mesh === undefined) continue;
    const extensions = Object.keys(objectOr(node['extensions']));
    if (!extensions.every((name) => HARMLESS.has(name))) meshes.delete(mesh);
    if (node['skin'] !== undefined && !skinsAreClear) meshes.delete(mesh);
  }
  // Instances are placed between the node and its mesh, and shapes of physics may be meshes that no node shows.
  const used = JSON.stringify(tree['extensionsUsed'] ?? []);
  if (/EXT_mesh_gpu_instancing|physics/i.test(used)) return new Set();
  return meshes;
}

/** Places every node that shows a mesh with a grid. */
export function placeMeshes(data: GltfData, grids: ReadonlyMap<number, Grid>): void {
  if (objects(data.tree, 'nodes').length === 0) return;
  const nodes = arrayAt(data.tree, 'nodes');
  const skins = new Map<string, number>();
  const animated = new Map<number, Set<string>>();
  for (const animation of objects(data.tree, 'animations')) {
    for (const channel of objects(animation, 'channels')) {
      const { node, path } = objectOr(channel['target']);
      const index = uint(node);
      if (index !== undefined) animated.set(index, (animated.get(index) ?? new Set()).add(String(path)));
    }
  }
  const joints = new Set(objects(data.tree, 'skins').flatMap((skin) => (Array.isArray(skin['joints']) ? skin['joints'] : [])));
  for (const [index, value] of [...nodes.entries()]) {
    const node = objectOr(value);
    const mesh = uint(node['mesh']);
    const grid = mesh === undefined ? undefined : grids.get(mesh);
    if (grid === undefined) continue;
    const skin = uint(node['skin']);
    const moves = [...(animated.get(index) ?? [])].some((path) => path !== 'weights');
    const lit = Object.hasOwn(objectOr(node['extensions']), 'KHR_lights_punctual');
    const others = node['children'] !== undefined || node['camera'] !== undefined || lit;
    if (skin !== undefined) node['skin'] = skinFor(data, skin, mesh as number, grid, skins);
    else if (moves || others || joints.has(index)) moveToChild(data, index, node, grid);
    else placeNode(node, grid);
  }
}

/** node = node × translate(offset) × scale. */
function placeNode(node: Tree, { offset, scale }: Grid): void {
  const matrix = numbers(node['matrix'], 16);
  if (matrix !== undefined) {
    for (let row = 0; row < 4; row += 1) {
      let moved = matrix[12 + row] as number;
      for (let column = 0; column < 3; column += 1) {
        moved += (matrix[4 * column + row] as number) * (offset[column] as number);
        matrix[4 * column + row] = (matrix[4 * column + row] as number) * scale;
      }
      matrix[12 + row] = moved;
    }
    node['matrix'] = matrix;
    return;
  }
  const translation = numbers(node['translation'], 3) ?? [0, 0, 0];
  const rotation = numbers(node['rotation'], 4) ?? [0, 0, 0, 1];
  const size = numbers(node['scale'], 3) ?? [1, 1, 1];
  const moved = rotate(rotation, offset.map((value, axis) => value * (size[axis] as number)));
  node['translation'] = translation.map((value, axis) => value + (moved[axis] as number));
  node['scale'] = size.map((value) => value * scale);
}

/** q v q⁻¹ for a unit quaternion x, y, z, w. */
function rotate([x = 0, y = 0, z = 0, w = 1]: readonly number[], [a = 0, b = 0, c = 0]: readonly number[]): number[] {
  const [tx, ty, tz] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * tx + (y * tz - z * ty), b + w * ty + (z * tx - x * tz), c + w * tz + (x * ty - y * tx)];
}

// The node itself moves, or others hang on it: the mesh goes into a node of its own below.
function moveToChild(data: GltfData, index: number, node: Tree, { offset, scale }: Grid): void {
  const child: Tree = { mesh: node['mesh'], translation: [...offset], scale: [scale, scale, scale] };
  if (node['weights'] !== undefined) child['weights'] = node['weights'];
  delete node['mesh'];
  delete node['weights'];
  const number = arrayAt(data.tree, 'nodes').push(child) - 1;
  arrayAt(node, 'children').push(number);
  for (const animation of objects(data.tree, 'animations')) {
    for (const channel of objects(animation, 'channels')) {
      const target = objectOr(channel['target']);
      if (target['node'] === index && target['path'] === 'weights') target['node'] = number;
    }
  }
}

/** A skin like the old one for a mesh on a grid: a placed vertex is what a joint sees first. */
function skinFor(data: GltfData, skin: number, mesh: number, { offset, scale }: Grid, made: Map<string, number>): number {
  const key = `${skin}/${mesh}`;
  const known = made.get(key);
  if (known !== undefined) return known;
  const skins = arrayAt(data.tree, 'skins');
  const copy = structuredClone(objectOr(skins[skin]));
  const accessor = uint(copy['inverseBindMatrices']);
  const count = Array.isArray(copy['joints']) ? copy['joints'].length : 0;
  const values = (accessor === undefined ? undefined : matrices(data, accessor)) ?? identities(count);
  for (let start = 0; start < values.length; start += 16) {
    const matrix = { matrix: [...values.subarray(start, start + 16)] };
    placeNode(matrix, { offset, scale });
    values.set(matrix.matrix, start);
  }
  const view = data.addView(new Uint8Array(values.buffer), {});
  const json = { bufferView: view, componentType: 5126, count: values.length / 16, type: 'MAT4' };
  copy['inverseBindMatrices'] = arrayAt(data.tree, 'accessors').push(json) - 1;
  const number = skins.push(copy) - 1;
  made.set(key, number);
  return number;
}

function identities(count: number): Float32Array<ArrayBuffer> {
  return Float32Array.from({ length: 16 * count }, (_, at) => (at % 16 % 5 === 0 ? 1 : 0));
}

/** The 4 × 4 matrices of an accessor; undefined if they are stored in any but the usual way. */
function matrices(data: GltfData, index: number): Float32Array<ArrayBuffer> | undefined {
  const json = data.accessor(index);
  const [view, count] = [uint(json['bufferView']), uint(json['count'])];
  if (json['type'] !== 'MAT4' || json['componentType'] !== 5126 || view === undefined || count === undefined) return undefined;
  if (json['sparse'] !== undefined || data.view(view)['byteStride'] !== undefined) return undefined;
  const layout: Layout = { view, offset: uint(json['byteOffset']) ?? 0, stride: 64, size: 64, count, components: 16, componentType: 5126, normalized: false };
  if (layout.offset + 64 * count > (data.views[view]?.length ?? 0)) return undefined;
  return Float32Array.from(data.values(layout));
}

function numbers(value: unknown, count: number): number[] | undefined {
  return Array.isArray(value) && value.length === count && value.every((item) => typeof item === 'number') ? [...(value as number[])] : undefined;
}
