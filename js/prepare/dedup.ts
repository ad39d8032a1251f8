// What is there twice is referred to once. Nothing is numbered anew: a reference that is not known stays right.

import type { GltfData } from '../codecs/gltf_data.js';
import { objectOr, objects, type Tree } from '../codecs/tree.js';
import { allReferences, type List, type Reference } from './references.js';
import { releaseAccessors } from './release.js';

/**
 * Lets references to equal accessors, buffer views, images, samplers, textures and materials all name the first of
 * them. Names do not make a difference but for materials, which applications look up by name.
 */
export function dedup(data: GltfData): void {
  const { tree } = data;
  const contents = new Contents();
  const released = redirect(tree, 'accessors', (json, index) => accessorKey(data, contents, json, index));
  releaseAccessors(data, released);
  const views = redirect(tree, 'bufferViews', (json, index) => viewKey(data, contents, json, index));
  data.freeViews(views);
  for (const list of ['images', 'samplers', 'textures', 'materials'] as const) {
    redirect(tree, list, (json) => JSON.stringify(list === 'materials' ? json : { ...json, name: undefined }));
  }
}

const ARRAY_BUFFER = 34962;

/** Redirects references to elements with the key of an earlier one; returns those that lost their use so. */
function redirect(tree: Tree, list: List, keyOf: (json: Tree, index: number) => string | undefined): Set<number> {
  const references = new Map<number, Reference[]>();
  for (const reference of allReferences(tree)) {
    if (reference.list !== list) continue;
    const known = references.get(reference.index);
    if (known === undefined) references.set(reference.index, [reference]);
    else known.push(reference);
  }
  const firsts = new Map<string, number>();
  const left = new Set<number>();
  for (const [index, json] of objects(tree, list).entries()) {
    // What nobody is known to use may be meant for somebody unknown.
    if (!references.has(index)) continue;
    const key = keyOf(json, index);
    if (key === undefined) continue;
    const first = firsts.get(key);
    if (first === undefined) {
      firsts.set(key, index);
      continue;
    }
    for (const { holder, key: place } of references.get(index) ?? []) (holder as Tree)[place] = first;
    left.add(index);
  }
  return left;
}

function accessorKey(data: GltfData, contents: Contents, json: Tree, index: number): string | undefined {
  const layout = data.layout(index);
  if (layout === undefined) return undefined;
  const { target } = data.view(layout.view);
  const { buffer, byteOffset, byteLength } = data.values(layout);
  const content = contents.number(new Uint8Array(buffer, byteOffset, byteLength));
  const { bufferView: _view, byteOffset: _offset, name: _name, ...rest } = json;
  // Members in one order: what was added to some comes last there.
  return JSON.stringify([Object.entries(rest).sort(([a], [b]) => (a < b ? -1 : 1)), target, content]);
}

function viewKey(data: GltfData, contents: Contents, json: Tree, index: number): string | undefined {
  const bytes = data.views[index];
  if (bytes === undefined || bytes.length === 0) return undefined;
  const { byteStride, target } = json;
  // Attributes that share a view need a stride, and one that is not shared may have none.
  if (target === ARRAY_BUFFER && byteStride === undefined) return undefined;
  return JSON.stringify([byteStride, target, objectOr(json['extensions']), json['extras'], contents.number(bytes)]);
}

/** Numbers for contents: the same for equal ones. */
class Contents {
  readonly #byHash = new Map<number, Array<{ readonly bytes: Uint8Array; readonly number: number }>>();
  #next = 0;

  number(bytes: Uint8Array): number {
    const hash = hashOf(bytes);
    const alike = this.#byHash.get(hash) ?? [];
    const known = alike.find((other) => equal(other.bytes, bytes));
    if (known !== undefined) return known.number;
    this.#byHash.set(hash, [...alike, { bytes, number: this.#next }]);
    return this.#next++;
  }
}

/** FNV-1a (Fowler, Noll, Vo), mixed with the length. */
function hashOf(bytes: Uint8Array): number {
  let hash = 0x811c_9dc5 ^ bytes.length;
  for (const byte of bytes) hash = Math.imul(hash ^ byte, 0x0100_0193);
  return hash >>> 0;
}

function equal(a: Uint8Array, b: Uint8Array): boolean {
  return a.length === b.length && a.every((byte, at) => byte === b[at]);
}
