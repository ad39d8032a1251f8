// Where a file's bytes are: geometry, textures, animation, and the rest.

import { splitContainer, textOf } from './codecs/container.js';
import { findFile } from './codecs/resources.js';
import { onlyMembers } from './codecs/skim.js';
import { DRACO_EXTENSION, MESHOPT_EXTENSIONS, extensionOf, objectOr, objects, uint, type Tree } from './codecs/tree.js';
import type { LoadedFile } from './files.js';
import type { Format } from './types.js';

/** Bytes as they are stored, compressed or not; together all that was given or written (of a .zip, what is in it). */
export interface Parts {
  /** Vertices, triangles, morph targets, instances. */
  readonly geometry: number;
  readonly textures: number;
  /** Keys of animations, matrices of skins. */
  readonly animation: number;
  /** Names, materials, the structure of the file; in formats of text, what is no geometry is here too. */
  readonly other: number;
}

const INSTANCING = 'EXT_mesh_gpu_instancing';

/** The members of a glTF that say what its bytes are for; with {@link INSTANCING} the nodes do too. */
const MEMBERS: ReadonlySet<string> = new Set(['accessors', 'animations', 'buffers', 'bufferViews', 'images', 'meshes', 'skins']);

type Part = Exclude<keyof Parts, 'other'>;

/** What is kept of the input until somebody asks: sizes, and the text of a glTF. */
export interface PartsSource {
  readonly format: Format;
  readonly files: ReadonlyArray<{ readonly name: string; readonly size: number }>;
  /** Index of the glTF among the files, and its JSON. */
  readonly main: number;
  readonly json: Uint8Array | undefined;
}

/** What to keep of `files`, a model in `format`. */
export function partsSource(files: readonly LoadedFile[], format: Format): PartsSource {
  const sizes = files.map(({ name, bytes }) => ({ name, size: bytes.byteLength }));
  if (format === 'glb' || format === 'gltf') {
    for (const [main, { bytes }] of files.entries()) {
      const container = splitContainer(bytes);
      if (container === undefined || container.isBinary !== (format === 'glb')) continue;
      // A copy: the chunk alone would keep the whole file in memory.
      return { format, files: sizes, main, json: container.isBinary ? container.json.slice() : container.json };
    }
  }
  return { format, files: sizes, main: 0, json: undefined };
}

/** The bytes of each part. Never fails: what is not understood counts as `other`. */
export function partsOf({ format, files, main, json }: PartsSource): Parts {
  const total = files.reduce((sum, { size }) => sum + size, 0);
  const tree = json === undefined ? undefined : parse(json);
  const sums: Record<Part, number> = { geometry: 0, textures: 0, animation: 0 };
  if (tree !== undefined) addGltf(tree, files, main, sums);
  else if (format !== 'glb' && format !== 'gltf') {
    for (const { name, size } of files) {
      if (/\.(png|jpe?g|webp|gif|bmp|tga|tiff?|dds|ktx2?|avif)$/i.test(name)) sums.textures += size;
      else if (!/\.(mtl|txt|md)$/i.test(name)) sums.geometry += size;
    }
  }
  const geometry = Math.min(Math.round(sums.geometry), total);
  const textures = Math.min(Math.round(sums.textures), total - geometry);
  const animation = Math.min(Math.round(sums.animation), total - geometry - textures);
  return { geometry, textures, animation, other: total - geometry - textures - animation };
}

function parse(json: Uint8Array): Tree | undefined {
  try {
    const text = textOf({ isBinary: false, json, binary: undefined }) ?? '';
    return objectOr(JSON.parse(onlyMembers(text, text.includes(INSTANCING) ? new Set([...MEMBERS, 'nodes']) : MEMBERS)));
  } catch {
    return undefined;
  }
}

function addGltf(tree: Tree, files: PartsSource['files'], main: number, sums: Record<Part, number>): void {
  const loaded = files.map(({ name }): LoadedFile => ({ name, bytes: new Uint8Array() }));
  for (const { uri } of objects(tree, 'images')) {
    if (typeof uri !== 'string') continue;
    const file = /^data:/i.test(uri) ? undefined : findFile(uri, loaded, loaded[main] as LoadedFile);
    sums.textures += /^data:/i.test(uri) ? uri.length : (files[loaded.indexOf(file as LoadedFile)]?.size ?? 0);
  }
  // What base64 adds belongs to what it holds.
  const weights = objects(tree, 'buffers').map(({ uri, byteLength }) =>
    typeof uri === 'string' && /^data:/i.test(uri) ? uri.length / Math.max(1, uint(byteLength) ?? 1) : 1,
  );
  const parts = partsOfViews(tree);
  const ranges = objects(tree, 'bufferViews').flatMap((view, index) => {
    const part = parts.get(index);
    const packed = MESHOPT_EXTENSIONS.map((name) => extensionOf(view, name)).find((found) => found !== undefined);
    const { buffer, byteOffset, byteLength } = packed ?? view;
    const start = uint(byteOffset) ?? 0;
    return part === undefined ? [] : [{ part, buffer: uint(buffer) ?? 0, start, end: start + (uint(byteLength) ?? 0) }];
  });
  // Views may overlap; a byte counts once.
  ranges.sort((a, b) => a.buffer - b.buffer || a.start - b.start);
  let [buffer, counted] = [-1, 0];
  for (const range of ranges) {
    if (range.buffer !== buffer) [buffer, counted] = [range.buffer, 0];
    sums[range.part] += Math.max(0, range.end - Math.max(range.start, counted)) * (weights[buffer] ?? 1);
    counted = Math.max(counted, range.end);
  }
}

/** What each view is for; the first use counts. */
function partsOfViews(tree: Tree): Map<number, Part> {
  const parts = new Map<number, Part>();
  const accessors = objects(tree, 'accessors');
  const view = (index: unknown, part: Part): void => {
    const number = uint(index);
    if (number !== undefined && !parts.has(number)) parts.set(number, part);
  };
  const accessor = (index: unknown, part: Part): void => {
    const json = accessors[uint(index) ?? -1] ?? {};
    const sparse = objectOr(json['sparse']);
    for (const holder of [json, objectOr(sparse['indices']), objectOr(sparse['values'])]) view(holder['bufferView'], part);
  };
  for (const image of objects(tree, 'images')) view(image['bufferView'], 'textures');
  for (const mesh of objects(tree, 'meshes')) {
    for (const primitive of objects(mesh, 'primitives')) {
      accessor(primitive['indices'], 'geometry');
      for (const list of [objectOr(primitive['attributes']), ...objects(primitive, 'targets')]) {
        for (const index of Object.values(list)) accessor(index, 'geometry');
      }
      view(extensionOf(primitive, DRACO_EXTENSION)?.['bufferView'], 'geometry');
    }
  }
  for (const node of objects(tree, 'nodes')) {
    const instances = objectOr(extensionOf(node, INSTANCING)?.['attributes']);
    for (const index of Object.values(instances)) accessor(index, 'geometry');
  }
  for (const animation of objects(tree, 'animations')) {
    for (const { input, output } of objects(animation, 'samplers')) for (const index of [input, output]) accessor(index, 'animation');
  }
  for (const skin of objects(tree, 'skins')) accessor(skin['inverseBindMatrices'], 'animation');
  return parts;
}
