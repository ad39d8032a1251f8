// The formats that can be written, and which one to write when nobody named one.

import type { Compression, Format, OutputFormat } from './types.js';

// A record and not a list, so that the compiler notices a format that is missing here.
const OUTPUTS: Readonly<Record<OutputFormat, true>> = { glb: true, gltf: true, obj: true, ply: true, stl: true, off: true, smf: true };

/** Every format that can be written, by its usual extension. */
export const OUTPUT_FORMATS: readonly OutputFormat[] = Object.keys(OUTPUTS) as OutputFormat[];

/** Whether `value` names a format that can be written. */
export function isOutputFormat(value: unknown): value is OutputFormat {
  return typeof value === 'string' && Object.hasOwn(OUTPUTS, value);
}

/** The format to write for a document read from `format`: the same, but one file for a glTF. */
export function usualFormat(format: Format): OutputFormat {
  return format === 'gltf' ? 'glb' : format;
}

/** Whether a format can be compressed and quantised. */
export function holdsEncodings(format: OutputFormat): boolean {
  return format === 'glb' || format === 'gltf';
}

// As above.
const COMPRESSION: Readonly<Record<Compression, true>> = { none: true, meshopt: true, draco: true };

/** Every way to store the geometry of a glTF. */
export const COMPRESSIONS: readonly Compression[] = Object.keys(COMPRESSION) as Compression[];

/** Whether `value` names a way to store geometry. */
export function isCompression(value: unknown): value is Compression {
  return typeof value === 'string' && Object.hasOwn(COMPRESSION, value);
}
