// What else a download has done to it beside fewer triangles: the file tidied up, textures scaled and encoded.
import { holdsEncodings } from 'decimesh/worker';
import type { PrepareOptions, TextureOptions } from 'decimesh/worker';
import type { OutputFormat } from './formats.ts';

/** What textures can become. */
export const TEXTURE_FORMATS = ['webp', 'jpeg', 'png'] as const;
export type TextureFormat = (typeof TEXTURE_FORMATS)[number];

/** The choices of the longer side, pixels. */
export const TEXTURE_SIZES: readonly number[] = [4096, 2048, 1024, 512, 256];

/** Choices about the file beside its geometry; null leaves it as it is. */
export interface Preparation {
  /** Equal data once, unused data and needless keys of animations gone. */
  readonly tidy: boolean;
  /** The longer side of a texture at most, pixels. */
  readonly textureSize: number | null;
  readonly textureFormat: TextureFormat | null;
  /** Per cent, of WebP and JPEG; null is what the package finds good. */
  readonly textureQuality: number | null;
}

export const NO_PREPARATION: Preparation = { tidy: false, textureSize: null, textureFormat: null, textureQuality: null };

/** The quality of a texture when nobody chooses, per cent. */
export const USUAL_TEXTURE_QUALITY = 80;

/** The choices as the package takes them: nothing where the format cannot have it, or nothing is asked for. */
export function prepareOptions(format: OutputFormat, { tidy, textureSize, textureFormat, textureQuality }: Preparation): { prepare?: PrepareOptions } {
  if (!holdsEncodings(format)) return {};
  const textures: TextureOptions = {
    ...(textureSize === null ? {} : { maxSize: textureSize }),
    ...(textureFormat === null ? {} : { format: textureFormat }),
    ...(textureQuality === null ? {} : { quality: textureQuality / 100 }),
  };
  const prepare: PrepareOptions = {
    ...(tidy ? { dedup: true, prune: true, resample: true } : {}),
    ...(Object.keys(textures).length > 0 ? { textures } : {}),
  };
  return Object.keys(prepare).length > 0 ? { prepare } : {};
}

/** The same text for choices that make the same file. */
export const preparationKey = (format: OutputFormat, preparation: Preparation): string => JSON.stringify(prepareOptions(format, preparation));

/** Reads what {@link writePreparation} has written; what makes no sense is left alone. */
export function readPreparation(query: URLSearchParams): Preparation | null {
  const [tidy, size, format, quality] = NAMES.map((name) => query.get(name)) as [string | null, string | null, string | null, string | null];
  const textureSize = /^\d{1,5}$/.test(size ?? '') && Number(size) >= 1 ? Number(size) : null;
  const textureFormat = TEXTURE_FORMATS.find((known) => known === format) ?? null;
  const textureQuality = /^\d{1,3}$/.test(quality ?? '') && Number(quality) <= 100 ? Number(quality) : null;
  const found = { tidy: tidy !== null && tidy !== '0', textureSize, textureFormat, textureQuality };
  return JSON.stringify(found) === JSON.stringify(NO_PREPARATION) ? null : found;
}

const NAMES = ['prepare', 'texture-size', 'texture-format', 'texture-quality'] as const;

/** Writes into `query` what is asked for, and takes out what is not. */
export function writePreparation(query: URLSearchParams, { tidy, textureSize, textureFormat, textureQuality }: Preparation): void {
  const values = [tidy ? 1 : null, textureSize, textureFormat, textureQuality];
  // All of them anew, so that the same choices are the same text.
  for (const name of NAMES) query.delete(name);
  NAMES.forEach((name, index) => {
    const value = values[index] ?? null;
    if (value !== null) query.set(name, String(value));
  });
}

/** The options of the command line. */
export function prepareArguments(format: OutputFormat, preparation: Preparation): string[] {
  const { prepare } = prepareOptions(format, preparation);
  if (prepare === undefined) return [];
  const { maxSize, format: textureFormat, quality } = prepare.textures ?? {};
  return [
    ...(prepare.dedup === true ? ['--prepare', 'dedup,prune,resample'] : []),
    ...(maxSize === undefined ? [] : ['--texture-size', String(maxSize)]),
    ...(textureFormat === undefined ? [] : ['--texture-format', textureFormat]),
    ...(quality === undefined ? [] : ['--texture-quality', String(quality)]),
  ];
}
