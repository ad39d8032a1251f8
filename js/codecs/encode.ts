// A GLB of the engine in the encoding that was asked for.

import { DecimeshError } from '../errors.js';
import type { Compression, PrepareOptions, Warning } from '../types.js';
import { encodeDraco } from './draco_encode.js';
import { GltfData } from './gltf_data.js';
import { encodeMeshopt } from './meshopt_encode.js';
import { quantize } from './quantize.js';
import { separate, takeImages, type SideFile } from './separate.js';

/** How to store the geometry. */
export interface Encoding {
  readonly compress: Compression;
  readonly quantize: boolean;
  /** Undefined: nothing but the geometry. */
  readonly prepare: PrepareOptions | undefined;
}

/** An encoded file, and what could not be encoded as asked for. */
export interface Encoded {
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly warnings: readonly Warning[];
  /** Triangles without an area, which Draco leaves out. */
  readonly dropped: number;
}

/** As {@link Encoded}, with what the file refers to. */
export interface EncodedFiles extends Encoded {
  /** Empty for a GLB. */
  readonly files: readonly SideFile[];
}

/**
 * `glb`, as the engine wrote it, encoded anew; itself when there is nothing to do. With `name`, as a .gltf and files
 * whose names begin so.
 */
export async function encodeGlb(glb: Uint8Array<ArrayBuffer>, encoding: Encoding, name?: string): Promise<EncodedFiles> {
  const { prepare } = encoding;
  if (encoding.compress === 'none' && !encoding.quantize && name === undefined && prepare === undefined) {
    return { bytes: glb, files: [], warnings: [], dropped: 0 };
  }
  const data = new GltfData(glb);
  const preparation = prepare && (await import('../prepare/prepare.js'));
  const warnings = preparation === undefined ? [] : await preparation.prepareContent(data, prepare as PrepareOptions);
  const changesVertices = encoding.compress === 'meshopt' || (encoding.quantize && encoding.compress !== 'draco');
  // Zeros cost next to nothing where they are packed.
  if (changesVertices) data.makeTargetsDense(data.triangles(), encoding.compress === 'meshopt');
  // Draco quantises by itself, and finer steps than its own would only cost.
  if (encoding.quantize && encoding.compress !== 'draco') quantize(data);
  if (preparation !== undefined) warnings.push(...preparation.prepareStructure(data, prepare as PrepareOptions));
  const images = name === undefined ? [] : takeImages(data, name);
  const encoded = await compress(data, encoding.compress).catch((error: unknown) => {
    if (error instanceof DecimeshError) throw error;
    // The encoders' own memory is at its end.
    throw new DecimeshError('too-large', `the geometry is too large for ${encoding.compress}`, 'compress', { cause: error });
  });
  warnings.push(...encoded.warnings);
  if (name === undefined) return { ...encoded, warnings, files: [] };
  const { bytes, files } = separate(encoded.bytes, name);
  return { ...encoded, warnings, bytes, files: [...files, ...images] };
}

async function compress(data: GltfData, compression: Compression): Promise<Encoded> {
  switch (compression) {
    case 'none':
      return { bytes: data.build(), warnings: [], dropped: 0 };
    case 'meshopt':
      return { bytes: await encodeMeshopt(data), warnings: [], dropped: 0 };
    case 'draco':
      return encodeDraco(data);
  }
}
