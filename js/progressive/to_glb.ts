// A progressive mesh at full detail as a GLB, for everything that reads documents.

import { buildGlb, encodeTree } from '../codecs/container.js';
import type { Tree } from '../codecs/tree.js';
import type { LevelGeometry } from '../types.js';
import type { Description } from './description.js';

const FLOAT = 5126;
const UNSIGNED_SHORT = 5123;
const UNSIGNED_INT = 5125;
const TYPES: Readonly<Record<number, string>> = { 1: 'SCALAR', 2: 'VEC2', 3: 'VEC3', 4: 'VEC4' };

/** What arrays without a file call their attributes, as glTF does. */
const NAMES: Readonly<Record<string, string>> = { normal: 'NORMAL', tangent: 'TANGENT', uv: 'TEXCOORD', color: 'COLOR', joints: 'JOINTS', weights: 'WEIGHTS' };

/** The file; positions and attributes are the same to the bit, joints are whole numbers. */
export function progressiveToGlb({ groups, wedgeSets }: Description, geometry: LevelGeometry): Uint8Array<ArrayBuffer> {
  const parts: Uint8Array[] = [];
  const accessors: Tree[] = [];
  const bufferViews: Tree[] = [];
  let size = 0;
  const add = (array: Float32Array | Uint16Array | Uint32Array, components: number, componentType: number, more: Tree = {}): number => {
    bufferViews.push({ buffer: 0, byteOffset: size, byteLength: array.byteLength });
    accessors.push({ bufferView: bufferViews.length - 1, componentType, count: array.length / components, type: TYPES[components] ?? 'SCALAR', ...more });
    parts.push(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    size += array.byteLength;
    const odd = size % 4;
    if (odd > 0) parts.push(new Uint8Array(4 - odd));
    size += odd > 0 ? 4 - odd : 0;
    return accessors.length - 1;
  };
  const sets = geometry.wedgeSets.map(({ positions, attributes: values }, set) => {
    const attributes: Record<string, number> = {};
    const targets: Array<Record<string, number>> = [];
    if (positions.length === 0) return { attributes, targets };
    attributes['POSITION'] = add(positions, 3, FLOAT, extent(positions));
    for (const { name } of wedgeSets[set]?.attributes ?? []) {
      const { components, values: numbers } = values[name] ?? { components: 0, values: new Float32Array() };
      if (TYPES[components] === undefined) continue;
      const target = /^TARGET_(\d{1,3})\/(\w+)$/.exec(name);
      const isJoints = /^joints(_?\d+)?$/i.test(name);
      const accessor = add(isJoints ? Uint16Array.from(numbers) : numbers, components, isJoints ? UNSIGNED_SHORT : FLOAT, target?.[2] === 'POSITION' ? extent(numbers) : {});
      if (target === null) attributes[semanticOf(name)] = accessor;
      else (targets[Number(target[1])] ??= {})[target[2] as string] = accessor;
    }
    return { attributes, targets: targets.filter((target) => target !== undefined) };
  });
  const materials = [...new Set(groups.flatMap(({ material }) => (material === null ? [] : [material])))];
  const meshes: Array<{ name?: string; primitives: Tree[] }> = [];
  const owners: number[] = [];
  for (const [index, { mesh, object, material, wedgeSet }] of groups.entries()) {
    const indices = geometry.groups[index]?.indices ?? new Uint32Array();
    if (indices.length === 0) continue;
    if (!owners.includes(mesh)) {
      owners.push(mesh);
      meshes.push({ ...(object === null ? {} : { name: object }), primitives: [] });
    }
    const { attributes, targets } = sets[wedgeSet] as (typeof sets)[number];
    meshes[owners.indexOf(mesh)]?.primitives.push({
      attributes,
      indices: add(indices, 1, UNSIGNED_INT),
      ...(targets.length === 0 ? {} : { targets }),
      ...(material === null ? {} : { material: materials.indexOf(material) }),
    });
  }
  return buildGlb(
    encodeTree({
      asset: { version: '2.0', generator: 'decimesh' },
      scene: 0,
      scenes: [{ nodes: meshes.map((_, node) => node) }],
      nodes: meshes.map((_, mesh) => ({ mesh })),
      meshes,
      ...(materials.length === 0 ? {} : { materials: materials.map((name) => ({ name })) }),
      accessors,
      bufferViews,
      buffers: [{ byteLength: size }],
    }),
    parts,
  );
}

function semanticOf(name: string): string {
  const [, kind = '', number = ''] = /^([a-z]+)(\d*)$/.exec(name) ?? [];
  const known = NAMES[kind];
  if (known !== undefined) return known === 'NORMAL' || known === 'TANGENT' ? known : `${known}_${number === '' ? 0 : number}`;
  return /^(_|NORMAL$|TANGENT$|(TEXCOORD|COLOR|JOINTS|WEIGHTS)_\d)/.test(name) ? name : `_${name.toUpperCase()}`;
}

function extent(positions: Float32Array): Tree {
  const [min, max] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let at = 0; at < positions.length; at += 1) {
    min[at % 3] = Math.min(min[at % 3] as number, positions[at] as number);
    max[at % 3] = Math.max(max[at % 3] as number, positions[at] as number);
  }
  return { min, max };
}
