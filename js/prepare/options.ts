// Checks what is asked of the preparation; it itself is loaded only when it is.

import { checkNames } from '../check.js';
import { invalidArgument } from '../errors.js';
import { shown } from '../options.js';
import type { PrepareOptions } from '../types.js';

/** `options` if they ask for something; throws `invalid-argument` naming the one that is wrong. */
export function checkPrepareOptions(options: PrepareOptions | undefined): PrepareOptions | undefined {
  if (options === undefined) return undefined;
  if (typeof options !== 'object' || options === null) throw invalidArgument('prepare', 'must be an object');
  checkNames(options, ['dedup', 'prune', 'resample', 'textures']);
  for (const name of ['dedup', 'prune', 'resample'] as const) {
    const value: unknown = options[name];
    if (value !== undefined && typeof value !== 'boolean') throw invalidArgument(`prepare.${name}`, 'must be true or false');
  }
  const { textures } = options;
  if (textures !== undefined) {
    if (typeof textures !== 'object' || textures === null) throw invalidArgument('prepare.textures', 'must be an object');
    checkNames(textures, ['maxSize', 'format', 'quality']);
    const { maxSize, format, quality } = textures;
    if (maxSize !== undefined && !(Number.isSafeInteger(maxSize) && maxSize >= 1)) {
      throw invalidArgument('prepare.textures.maxSize', `must be an integer of at least 1, not ${shown(maxSize)}`);
    }
    if (format !== undefined && !isImageFormat(format)) {
      throw invalidArgument('prepare.textures.format', `must be one of ${IMAGE_FORMATS.join(', ')}, not ${shown(format)}`);
    }
    if (quality !== undefined && !(typeof quality === 'number' && quality >= 0 && quality <= 1)) {
      throw invalidArgument('prepare.textures.quality', `must be a number from 0 to 1, not ${shown(quality)}`);
    }
  }
  const asked = options.dedup || options.prune || options.resample || textures !== undefined;
  return asked ? options : undefined;
}

/** What textures can be encoded as. */
export const IMAGE_FORMATS = ['webp', 'jpeg', 'png'] as const;

/** Whether `value` names one. */
export function isImageFormat(value: unknown): value is (typeof IMAGE_FORMATS)[number] {
  return (IMAGE_FORMATS as readonly unknown[]).includes(value);
}
