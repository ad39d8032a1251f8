// A glTF as a .gltf and the files it refers to, in place of one GLB.

import { encodeTree, splitContainer, textOf } from './container.js';
import type { GltfData } from './gltf_data.js';
import { arrayAt, objectOr, objects, uint, type Tree } from './tree.js';

/** A file that a .gltf refers to, under the name by which it does. */
export interface SideFile {
  readonly name: string;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

const EXTENSIONS: Readonly<Record<string, string>> = {
  'image/png': 'png',
  'image/jpeg': 'jpg',
  'image/webp': 'webp',
  'image/ktx2': 'ktx2',
  'image/avif': 'avif',
  'image/vnd-ms.dds': 'dds',
};

/**
 * Takes the images out of the buffer views, as files whose names begin with `name`: beside the output there may be the
 * originals.
 */
export function takeImages(data: GltfData, name: string): SideFile[] {
  const files: SideFile[] = [];
  const taken = new Set<string>();
  const freed = new Set<number>();
  for (const [index, value] of arrayAtIfThere(data.tree, 'images').entries()) {
    const image = objectOr(value);
    const view = uint(image['bufferView']);
    const bytes = view === undefined ? undefined : data.views[view];
    if (view === undefined || bytes === undefined || bytes.length === 0) continue;
    const own = typeof image['name'] === 'string' ? image['name'].replace(/\.(png|jpe?g|webp|ktx2|avif|dds)$/i, '') : '';
    const extension = EXTENSIONS[String(image['mimeType'])] ?? 'bin';
    // Letters that every file system and URI knows; images that end up with the same name are numbered.
    const stem = `${name}_${own.replace(/[^\w-]+/g, '_').slice(0, 60) || `image${index}`}`;
    let unique = `${stem}.${extension}`;
    for (let number = 1; taken.has(unique.toLowerCase()); number += 1) unique = `${stem}_${number}.${extension}`;
    taken.add(unique.toLowerCase());
    files.push({ name: unique, bytes: bytes.slice() });
    delete image['bufferView'];
    image['uri'] = encodeURIComponent(unique);
    freed.add(view);
  }
  data.freeViews(freed);
  return files;
}

function arrayAtIfThere(tree: Tree, key: string): unknown[] {
  return objects(tree, key).length === 0 ? [] : arrayAt(tree, key);
}

/** A GLB as the text of a .gltf and its binary chunk, a file called `name`.bin; none if there is no chunk. */
export function separate(glb: Uint8Array, name: string): { bytes: Uint8Array<ArrayBuffer>; files: SideFile[] } {
  const container = splitContainer(glb);
  const tree = objectOr(JSON.parse((container && textOf(container)) ?? '{}'));
  const buffer = objects(tree, 'buffers')[0];
  const length = uint(buffer?.['byteLength']) ?? 0;
  const binary = container?.binary?.slice(0, length) as Uint8Array<ArrayBuffer> | undefined;
  if (buffer === undefined || binary === undefined) return { bytes: encodeTree(tree), files: [] };
  const file = `${name}.bin`;
  // First, where a reader expects it.
  arrayAt(tree, 'buffers')[0] = { uri: encodeURIComponent(file), ...buffer };
  return { bytes: encodeTree(tree), files: [{ name: file, bytes: binary }] };
}
