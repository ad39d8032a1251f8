// Progressive meshes (Hoppe 1996): a coarse mesh and vertex splits in a file that refines while it arrives.
//
// Reading needs no WebAssembly, and nothing else of the package.

import { DecimeshError, invalidArgument } from './errors.js';
import { yieldToEvents } from './platform.js';
import { ProgressiveDecoder, type ProgressiveMesh, type ProgressiveReadOptions } from './progressive/decode.js';

export { DecimeshError } from './errors.js';
export { PROGRESSIVE_EXTENSION, PROGRESSIVE_MIME_TYPE, isProgressive } from './progressive/container.js';
export type { ProgressiveLevel, ProgressiveMesh, ProgressiveReadOptions } from './progressive/decode.js';
export type { AttributeDescription, Description, GroupDescription, WedgeSetDescription } from './progressive/description.js';
export type { ProgressiveOptions } from './progressive/encode.js';
export type { Geomorph } from './progressive/geomorph.js';
export { boxRegion, frustumRegion } from './progressive/regions.js';
export type { Region } from './progressive/selective.js';
export type { LevelGeometry } from './types.js';

/** Where a progressive mesh comes from: a stream, a response of `fetch`, chunks of bytes, a file, or all bytes. */
export type ProgressiveInput =
  | ReadableStream<Uint8Array>
  | Response
  | AsyncIterable<Uint8Array>
  | Blob
  | Uint8Array
  | ArrayBuffer;

/** How to read while it arrives. */
export interface ProgressiveStreamOptions extends ProgressiveReadOptions {
  /** Aborting rejects with the signal's reason. */
  readonly signal?: AbortSignal | undefined;
}

/**
 * Reads while the bytes arrive: gives the mesh with the base, and again each time that a chunk has made it finer, at last
 * complete. It is the same object each time. Long chunks leave events their turn.
 *
 * Rejects with `truncated`, `syntax`, `out-of-range`, `not-finite`, `too-large`, `unsupported` or `unknown-format` for what
 * is no whole progressive mesh, with `cannot-read` for a response that failed, and with the signal's reason.
 */
export async function* readProgressive(
  input: ProgressiveInput,
  { signal, ...options }: ProgressiveStreamOptions = {},
): AsyncGenerator<ProgressiveMesh, void> {
  signal?.throwIfAborted();
  const decoder = new ProgressiveDecoder(options);
  for await (const bytes of chunksOf(input)) {
    signal?.throwIfAborted();
    decoder.push(bytes);
    for (const { mesh, levelEnds } of decoder.decode()) {
      if (levelEnds) yield mesh;
      else await yieldToEvents();
      signal?.throwIfAborted();
    }
  }
  signal?.throwIfAborted();
  decoder.finish();
}

/** Reads a whole file at once. Throws what {@link readProgressive} rejects with. */
export function decodeProgressive(bytes: Uint8Array, options: ProgressiveReadOptions = {}): ProgressiveMesh {
  if (!(bytes instanceof Uint8Array)) throw invalidArgument('bytes', 'must be a Uint8Array');
  const decoder = new ProgressiveDecoder(options);
  decoder.push(bytes);
  for (const _ of decoder.decode());
  return decoder.finish();
}

async function* chunksOf(input: ProgressiveInput): AsyncGenerator<Uint8Array, void> {
  if (input instanceof Uint8Array) return yield input;
  if (input instanceof ArrayBuffer) return yield new Uint8Array(input);
  if (typeof Response === 'function' && input instanceof Response) {
    if (!input.ok) throw new DecimeshError('cannot-read', `HTTP status ${input.status}`, input.url);
    if (input.body !== null) yield* streamed(input.body);
    return;
  }
  if (typeof Blob === 'function' && input instanceof Blob) return yield* streamed(input.stream());
  if (typeof ReadableStream === 'function' && input instanceof ReadableStream) return yield* streamed(input);
  if (typeof input === 'object' && input !== null && Symbol.asyncIterator in input) return yield* input;
  throw invalidArgument('input', 'must be a stream, a response, a file or bytes');
}

// Safari's streams are not iterable.
async function* streamed(stream: ReadableStream<Uint8Array>): AsyncGenerator<Uint8Array, void> {
  const reader = stream.getReader();
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      yield value;
    }
  } finally {
    // Also when nobody wants the rest.
    await reader.cancel().catch(() => {});
  }
}
