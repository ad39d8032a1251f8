// A GLB of the engine in the encoding that was asked for.

import type { Compression, Warning } from '../types.js';
import { encodeDraco } from './draco_encode.js';
import { GltfData } from './gltf_data.js';
import { encodeMeshopt } from './meshopt_encode.js';
import { quantize } from './quantize.js';

/** How to store the geometry. */
export interface Encoding {
  readonly compress: Compression;
  readonly quantize: boolean;
}

/** An encoded file, and what could not be encoded as asked for. */
export interface Encoded {
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly warnings: readonly Warning[];
  /** Triangles without an area, which Draco leaves out. */
  readonly dropped: number;
}

/** `glb`, as the engine wrote it, encoded anew; itself when there is nothing to do. */
export async function encodeGlb(glb: Uint8Array<ArrayBuffer>, encoding: Encoding): Promise<Encoded> {
  if (encoding.compress === 'none' && !encoding.quantize) return { bytes: glb, warnings: [], dropped: 0 };
  const data = new GltfData(glb);
  // Draco quantises by itself, and finer steps than its own would only cost.
  if (encoding.quantize && encoding.compress !== 'draco') quantize(data);
  switch (encoding.compress) {
    case 'none':
      return { bytes: data.build(), warnings: [], dropped: 0 };
    case 'meshopt':
      return { bytes: await encodeMeshopt(data), warnings: [], dropped: 0 };
    case 'draco':
      return encodeDraco(data);
  }
}
