// Images that were encoded before: while a slider moves, the same textures are asked for with every level.

import type { EncodedImage, ImageCodec, ImageRequest } from './images.js';

/** Bytes of encoded images that are kept at most. */
const MOST_BYTES = 64 << 20;

/** By what was encoded and how, the one used last at the end. */
const kept = new Map<string, EncodedImage>();
let keptBytes = 0;

/** `codec`, which does nothing twice as long as there is room. Where digests cannot be had, `codec` itself. */
export function remembering(codec: ImageCodec): ImageCodec {
  // Browsers have them on secure pages only.
  const { subtle } = globalThis.crypto ?? {};
  if (subtle === undefined) return codec;
  return async (bytes, request) => {
    const key = await keyOf(subtle, bytes, request);
    const known = kept.get(key);
    if (known !== undefined) {
      kept.delete(key);
      kept.set(key, known);
      return copyOf(known);
    }
    const encoded = await codec(bytes, request);
    keep(key, copyOf(encoded));
    return encoded;
  };
}

/** Whoever has an image may hand its bytes to another thread. */
const copyOf = ({ bytes, format }: EncodedImage): EncodedImage => ({ bytes: new Uint8Array(bytes), format });

/** Two images of the same SHA-256 are the same image. */
async function keyOf(subtle: SubtleCrypto, bytes: Uint8Array, { type, maxSize, format, quality }: ImageRequest): Promise<string> {
  const digest = new Uint8Array(await subtle.digest('SHA-256', bytes as Uint8Array<ArrayBuffer>));
  return [...digest, type, maxSize, format, quality].join(' ');
}

function keep(key: string, encoded: EncodedImage): void {
  if (encoded.bytes.length > MOST_BYTES || kept.has(key)) return;
  kept.set(key, encoded);
  keptBytes += encoded.bytes.length;
  for (const [oldest, { bytes }] of kept) {
    if (keptBytes <= MOST_BYTES) return;
    kept.delete(oldest);
    keptBytes -= bytes.length;
  }
}
