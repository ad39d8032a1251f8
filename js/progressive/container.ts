// The container of a progressive mesh: a signature, then chunks with a type, a length and a checksum.

import { crc32 } from '../checksum.js';
import { DecimeshError } from '../errors.js';

/** The usual extension of the files, with its dot. */
export const PROGRESSIVE_EXTENSION = '.pmesh';

/** The MIME type, in the vendor tree and not registered. */
export const PROGRESSIVE_MIME_TYPE = 'model/vnd.decimesh.progressive';

/** Of the format. Readers refuse any other: files of version 1 were never released. */
export const VERSION = 2;

/** Not text, as nobody's transfer may change the ends of lines in it, which the last bytes would show. */
const SIGNATURE = [0x89, 0x50, 0x4d, 0x53, 0x48, 0x0d, 0x0a, 0x1a];

/** The kinds of chunks, in the order in which they come. */
export type ChunkType = 'HEAD' | 'BASE' | 'NORM' | 'SPLT' | 'REST' | 'DONE';

const TYPES: readonly string[] = ['HEAD', 'BASE', 'NORM', 'SPLT', 'REST', 'DONE'];

/** A chunk that was read. */
export interface Chunk {
  readonly type: ChunkType;
  readonly payload: Uint8Array;
  /** Where the file stands after it. */
  readonly end: number;
}

/** Whether these are the first bytes of a progressive mesh. */
export function isProgressive(bytes: Uint8Array): boolean {
  return bytes.length >= SIGNATURE.length && SIGNATURE.every((byte, at) => bytes[at] === byte);
}

/** The file of these chunks. */
export function packChunks(chunks: ReadonlyArray<{ readonly type: ChunkType; readonly payload: Uint8Array }>): Uint8Array<ArrayBuffer> {
  const size = chunks.reduce((sum, { payload }) => sum + 12 + payload.length, SIGNATURE.length);
  const bytes = new Uint8Array(size);
  const view = new DataView(bytes.buffer);
  bytes.set(SIGNATURE);
  let at = SIGNATURE.length;
  for (const { type, payload } of chunks) {
    for (let k = 0; k < 4; k += 1) bytes[at + k] = type.charCodeAt(k);
    view.setUint32(at + 4, payload.length, true);
    bytes.set(payload, at + 8);
    view.setUint32(at + 8 + payload.length, crc32(bytes.subarray(at, at + 8 + payload.length)), true);
    at += 12 + payload.length;
  }
  return bytes;
}

/** Takes bytes as they arrive, and gives chunks as they are complete. */
export class ChunkReader {
  #bytes = new Uint8Array(0);
  #length = 0;
  /** Bytes of the file before what is held. */
  #before = 0;
  #signed = false;

  /** All bytes that were given. */
  get received(): number {
    return this.#before + this.#length;
  }

  /** More bytes; they are copied. */
  push(bytes: Uint8Array): void {
    const length = this.#length + bytes.length;
    if (length > this.#bytes.length) {
      const larger = new Uint8Array(Math.max(length, 2 * this.#bytes.length));
      larger.set(this.#bytes.subarray(0, this.#length));
      this.#bytes = larger;
    }
    this.#bytes.set(bytes, this.#length);
    this.#length = length;
  }

  /**
   * The next chunk, undefined until it is there. Throws `unknown-format` for another signature, `syntax` for an unknown
   * chunk or a wrong checksum.
   */
  next(): Chunk | undefined {
    if (!this.#signed) {
      if (this.#length < SIGNATURE.length) return undefined;
      if (!isProgressive(this.#bytes)) throw new DecimeshError('unknown-format', 'it does not begin as a progressive mesh does');
      this.#drop(SIGNATURE.length);
      this.#signed = true;
    }
    if (this.#length < 8) return undefined;
    const type = String.fromCharCode(...this.#bytes.subarray(0, 4));
    const where = `chunk at byte ${this.#before}`;
    if (!TYPES.includes(type)) throw new DecimeshError('syntax', 'is of no known type', where);
    const view = new DataView(this.#bytes.buffer);
    const length = view.getUint32(4, true);
    if (length > 2 ** 30) throw new DecimeshError('too-large', 'is larger than a gibibyte', where);
    if (this.#length < 12 + length) return undefined;
    if (view.getUint32(8 + length, true) !== crc32(this.#bytes.subarray(0, 8 + length))) {
      throw new DecimeshError('syntax', 'is damaged: the checksum is wrong', where);
    }
    const payload = this.#bytes.slice(8, 8 + length);
    this.#drop(12 + length);
    return { type: type as ChunkType, payload, end: this.#before };
  }

  /** Whether there is something behind the chunks that were given. */
  get hasMore(): boolean {
    return this.#length > 0;
  }

  #drop(count: number): void {
    this.#bytes.copyWithin(0, count, this.#length);
    this.#length -= count;
    this.#before += count;
  }
}
