// Textures of fewer pixels and bytes.

import type { GltfData } from '../codecs/gltf_data.js';
import { extensionOf, objectOr, objects, requireExtension, setExtension, uint, type Tree } from '../codecs/tree.js';
import { DecimeshError } from '../errors.js';
import { yieldToEvents } from '../platform.js';
import type { TextureOptions, Warning } from '../types.js';
import { remembering } from './encoded.js';
import { imageCodec, type ImageCodec } from './images.js';
import { referencesOf } from './references.js';

const WEBP_EXTENSION = 'EXT_texture_webp';
const DECODABLE = new Set(['image/png', 'image/jpeg', 'image/webp']);

/** What is no colour, normals above all, shows the traces of a codec sooner. */
const LEAST_QUALITY_OF_NORMALS = 0.95;

const DEFAULT_QUALITY = 0.8;

/** Scales and encodes every image that becomes smaller by it. What cannot be decoded stays, with a warning. */
export async function shrinkTextures(data: GltfData, options: TextureOptions): Promise<Warning[]> {
  const warnings: Warning[] = [];
  const images = objects(data.tree, 'images');
  if (images.length === 0) return warnings;
  let codec: ImageCodec | undefined;
  const normals = imagesOfNormals(data.tree);
  for (const [index, image] of images.entries()) {
    const view = uint(image['bufferView']);
    const bytes = view === undefined ? undefined : data.views[view];
    const type = String(image['mimeType']);
    const where = `images[${index}]`;
    if (bytes === undefined || !DECODABLE.has(type)) {
      warnings.push({ code: 'texture-kept', message: `${image['mimeType'] === undefined ? 'an image that is not there' : type} is left as it is`, where });
      continue;
    }
    const use = useOf(data.tree, index);
    if (use === 'none') continue;
    const { format, maxSize, quality = DEFAULT_QUALITY } = options;
    // JPEG has no alpha, which whoever asks for it everywhere did not mean to lose.
    const opaque = format === 'jpeg' && type !== 'image/jpeg' && hasAlpha(bytes, type) ? 'png' : format;
    const wanted = use === 'one of two' ? undefined : opaque;
    codec ??= remembering(await imageCodec());
    await yieldToEvents();
    try {
      const own = normals.has(index) ? Math.max(quality, LEAST_QUALITY_OF_NORMALS) : quality;
      const encoded = await codec(bytes, { type, maxSize, format: wanted, quality: own });
      if (encoded.bytes.length >= bytes.length) continue;
      replace(data, index, image, encoded.bytes, `image/${encoded.format}`);
    } catch (error) {
      if (error instanceof DecimeshError) throw error;
      const message = `cannot be decoded and is left as it is: ${error instanceof Error ? error.message : String(error)}`;
      warnings.push({ code: 'texture-kept', message, where });
    }
  }
  return warnings;
}

/** How textures use an image: beside another one its format has to stay. */
function useOf(tree: Tree, index: number): 'none' | 'alone' | 'one of two' {
  const uses = objects(tree, 'textures').flatMap((texture) => {
    const sources = [texture['source'], ...Object.values(objectOr(texture['extensions'])).map((extension) => objectOr(extension)['source'])];
    const isPlain = texture['source'] === index || extensionOf(texture, WEBP_EXTENSION)?.['source'] === index;
    return isPlain ? [sources.filter((source) => source !== undefined).length] : [];
  });
  if (uses.length === 0) return 'none';
  return uses.some((sources) => sources > 1) ? 'one of two' : 'alone';
}

function replace(data: GltfData, index: number, image: Tree, bytes: Uint8Array, type: string): void {
  const old = image['bufferView'] as number;
  delete image['bufferView'];
  data.freeViews(new Set([old]));
  image['bufferView'] = data.addView(bytes, {});
  const isWebp = type === 'image/webp';
  image['mimeType'] = type;
  let named = false;
  for (const texture of objects(data.tree, 'textures')) {
    const webp = extensionOf(texture, WEBP_EXTENSION);
    if (isWebp && texture['source'] === index && webp === undefined) {
      delete texture['source'];
      setExtension(texture, WEBP_EXTENSION, { source: index });
      named = true;
    } else if (!isWebp && webp?.['source'] === index && texture['source'] === undefined) {
      texture['source'] = index;
      delete objectOr(texture['extensions'])[WEBP_EXTENSION];
      if (Object.keys(objectOr(texture['extensions'])).length === 0) delete texture['extensions'];
    }
  }
  // Without a source beside it a reader has to know the extension.
  if (named) requireExtension(data.tree, WEBP_EXTENSION);
}

/** The images of normal textures. */
function imagesOfNormals(tree: Tree): Set<number> {
  const textures = new Set<number>();
  const visit = (value: unknown, key: string): void => {
    if (typeof value !== 'object' || value === null) return;
    if (/normalTexture$/i.test(key)) textures.add(uint((value as Tree)['index']) ?? -1);
    for (const [name, item] of Object.entries(value)) visit(item, name);
  };
  for (const material of objects(tree, 'materials')) visit(material, '');
  const normals = objects(tree, 'textures').filter((_, index) => textures.has(index));
  return new Set(normals.flatMap((texture) => referencesOf('textures', texture)).flatMap(({ list, index }) => (list === 'images' ? [index] : [])));
}

/** Whether an image may have alpha: by the colour type of a PNG, always for WebP. */
function hasAlpha(bytes: Uint8Array, type: string): boolean {
  if (type === 'image/webp') return true;
  const colorType = bytes[25] ?? 6;
  // Palettes and the others may have a transparent colour in a chunk of its own.
  return colorType === 4 || colorType === 6 || new TextDecoder('latin1').decode(bytes.subarray(0, 4096)).includes('tRNS');
}
