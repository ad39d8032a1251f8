// The counts that a Draco stream states, read before its decoder allocates by them.
//
// Draco bitstream specification 2.2, sections 3 (header, metadata), 6 (connectivity); streams before 2.2 have 32-bit
// numbers where later ones have numbers of variable length.

import { DecimeshError } from '../errors.js';
import { syntaxError } from './tree.js';

/** What a stream says it holds. */
export interface DracoCounts {
  readonly faces: number;
  /** For a stream by edgebreaker, before vertices are split by their attributes. */
  readonly points: number;
}

const METADATA_FLAG = 0x8000;
const DEEPEST_METADATA = 32;

class Cursor {
  readonly #bytes: Uint8Array;
  readonly #where: string;
  #at = 0;

  constructor(bytes: Uint8Array, where: string) {
    [this.#bytes, this.#where] = [bytes, where];
  }

  byte(): number {
    const value = this.#bytes[this.#at];
    if (value === undefined) throw new DecimeshError('truncated', 'the Draco data ends inside its header', this.#where);
    this.#at += 1;
    return value;
  }

  skip(count: number): void {
    this.#at += count;
    if (this.#at > this.#bytes.length) throw new DecimeshError('truncated', 'the Draco data ends inside its header', this.#where);
  }

  u16(): number {
    return this.byte() + 0x100 * this.byte();
  }

  u32(): number {
    return this.u16() + 0x1_0000 * this.u16();
  }

  /** Seven bits a byte, the lowest first. */
  varint(): number {
    let value = 0;
    for (let shift = 1; shift <= 2 ** 28; shift *= 2 ** 7) {
      const byte = this.byte();
      value += (byte & 0x7f) * shift;
      if (byte < 0x80) return value;
    }
    throw syntaxError(this.#where, 'the Draco data has a number of more than 32 bits');
  }
}

/** The counts in a stream's header; throws a typed error at `where` for what is no Draco mesh. */
export function readDracoCounts(bytes: Uint8Array, where: string): DracoCounts {
  const cursor = new Cursor(bytes, where);
  for (const letter of 'DRACO') {
    if (cursor.byte() !== letter.charCodeAt(0)) throw syntaxError(where, 'the data does not begin as Draco data do');
  }
  const version = 10 * cursor.byte() + cursor.byte();
  if (version < 20 || version > 22) {
    throw new DecimeshError('unsupported', `Draco bitstream ${(version / 10).toFixed(1)}; only 2.0 to 2.2 are meshes here`, where);
  }
  if (cursor.byte() !== 1) throw syntaxError(where, 'the Draco data are no triangle mesh');
  const method = cursor.byte();
  if ((cursor.u16() & METADATA_FLAG) !== 0) skipAllMetadata(cursor, where);
  const number = version < 22 ? () => cursor.u32() : () => cursor.varint();
  if (method === 0) {
    const faces = number();
    return { faces, points: number() };
  }
  if (method !== 1) throw syntaxError(where, `Draco encoding method ${method} is not known`);
  cursor.byte();
  const points = number();
  return { faces: number(), points };
}

function skipAllMetadata(cursor: Cursor, where: string): void {
  const count = cursor.varint();
  for (let i = 0; i < count; i += 1) {
    cursor.varint();
    skipMetadata(cursor, where, 0);
  }
  skipMetadata(cursor, where, 0);
}

// Every turn of a loop reads a byte at least, so that counts without end meet the end of the data.
function skipMetadata(cursor: Cursor, where: string, depth: number): void {
  if (depth > DEEPEST_METADATA) throw syntaxError(where, 'the metadata of the Draco data are nested too deeply');
  const entries = cursor.varint();
  for (let i = 0; i < entries; i += 1) {
    cursor.skip(cursor.byte());
    cursor.skip(cursor.varint());
  }
  const children = cursor.varint();
  for (let i = 0; i < children; i += 1) {
    cursor.skip(cursor.byte());
    skipMetadata(cursor, where, depth + 1);
  }
}
