// A glTF's JSON as it was read: looked at with care, because a file may hold anything, and edited in place.

import { DecimeshError } from '../errors.js';

/** A JSON object. */
export type Tree = { [key: string]: unknown };

export const MESHOPT_EXTENSIONS = ['EXT_meshopt_compression', 'KHR_meshopt_compression'] as const;
export const DRACO_EXTENSION = 'KHR_draco_mesh_compression';

/** `value` if it is an object, and else an empty one that is no part of anything. */
export function objectOr(value: unknown): Tree {
  return typeof value === 'object' && value !== null && !Array.isArray(value) ? (value as Tree) : {};
}

/** The objects under `key`, by their number in the array; what is no object is an empty one. */
export function objects(tree: Tree, key: string): Tree[] {
  const value = tree[key];
  return Array.isArray(value) ? value.map(objectOr) : [];
}

/** `value` if it is an integer that can count or index. */
export function uint(value: unknown): number | undefined {
  return typeof value === 'number' && Number.isSafeInteger(value) && value >= 0 ? value : undefined;
}

/** The extension `name` of a JSON object, if it has that. */
export function extensionOf(tree: Tree, name: string): Tree | undefined {
  const extensions = objectOr(tree['extensions']);
  return Object.hasOwn(extensions, name) ? objectOr(extensions[name]) : undefined;
}

/** Takes the extension `name` out of a JSON object. */
export function removeExtension(tree: Tree, name: string): void {
  const extensions = objectOr(tree['extensions']);
  delete extensions[name];
  if (Object.keys(extensions).length === 0) delete tree['extensions'];
}

/** Puts the extension `name` into a JSON object, beside those it has. */
export function setExtension(tree: Tree, name: string, value: Tree): void {
  tree['extensions'] = { ...objectOr(tree['extensions']), [name]: value };
}

/** The array under `key`, made if need be. */
export function arrayAt(tree: Tree, key: string): unknown[] {
  const value = tree[key];
  if (Array.isArray(value)) return value as unknown[];
  const made: unknown[] = [];
  tree[key] = made;
  return made;
}

/** Takes `name` off the lists of used and required extensions; an empty list goes too. */
export function forgetExtension(tree: Tree, name: string): void {
  for (const key of ['extensionsUsed', 'extensionsRequired']) {
    const names = tree[key];
    if (!Array.isArray(names)) continue;
    const kept = names.filter((listed) => listed !== name);
    if (kept.length === 0) delete tree[key];
    else tree[key] = kept;
  }
}

/** Puts `name` on the list of used extensions, and of required ones. */
export function requireExtension(tree: Tree, name: string): void {
  for (const key of ['extensionsUsed', 'extensionsRequired']) {
    const names = arrayAt(tree, key);
    if (!names.includes(name)) names.push(name);
  }
}

/** Components of an accessor's `type`; undefined for an unknown one. */
export function componentsOf(accessor: Tree): number | undefined {
  const counts: Readonly<Record<string, number>> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT2: 4, MAT3: 9, MAT4: 16 };
  const { type } = accessor;
  return typeof type === 'string' && Object.hasOwn(counts, type) ? counts[type] : undefined;
}

/** Arrays of an accessor's `componentType`. */
export const COMPONENT_ARRAYS = {
  5120: Int8Array,
  5121: Uint8Array,
  5122: Int16Array,
  5123: Uint16Array,
  5125: Uint32Array,
  5126: Float32Array,
} as const;

/** An accessor's component type. */
export type ComponentType = keyof typeof COMPONENT_ARRAYS;

/** `value` if it is the number of a component type. */
export function componentTypeOf(value: unknown): ComponentType | undefined {
  return typeof value === 'number' && Object.hasOwn(COMPONENT_ARRAYS, value) ? (value as ComponentType) : undefined;
}

/** The numbers of the `count` elements that a sparse accessor has, from byte `start` on, each `size` bytes wide. */
export function sparseRows(bytes: Uint8Array, start: number, count: number, size: number): Uint32Array {
  const view = new DataView(bytes.buffer, bytes.byteOffset + start, count * size);
  const at = (row: number): number =>
    size === 1 ? view.getUint8(row) : size === 2 ? view.getUint16(2 * row, true) : view.getUint32(4 * row, true);
  return Uint32Array.from({ length: count }, (_, row) => at(row));
}

/** The error for a value in a file that breaks the format's rules. */
export function syntaxError(where: string, message: string): DecimeshError {
  return new DecimeshError('syntax', message, where);
}

/** The error for a place that is not there. */
export function rangeError(where: string, message: string): DecimeshError {
  return new DecimeshError('out-of-range', message, where);
}

/** The error for more than can be handled, or more than the bytes can hold. */
export function tooLarge(where: string, message: string): DecimeshError {
  return new DecimeshError('too-large', message, where);
}
