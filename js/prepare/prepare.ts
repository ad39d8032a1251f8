// Preparation beside simplification: textures, animations, what is there twice, what nobody needs. On the tree that was
// read, so that extensions that are not known survive.

import type { GltfData } from '../codecs/gltf_data.js';
import type { PrepareOptions, Warning } from '../types.js';
import { dedup } from './dedup.js';
import { prune } from './prune.js';
import { resample } from './resample.js';
import { shrinkTextures } from './textures.js';

/** What changes content: before the geometry is quantised. Rejects with `unsupported` where images cannot be encoded. */
export async function prepareContent(data: GltfData, options: PrepareOptions): Promise<Warning[]> {
  if (options.resample) resample(data);
  return options.textures === undefined ? [] : shrinkTextures(data, options.textures);
}

/** What changes references: after the geometry is quantised, which meshes that share it could not be. */
export function prepareStructure(data: GltfData, options: PrepareOptions): Warning[] {
  if (options.dedup) dedup(data);
  return options.prune ? prune(data) : [];
}
