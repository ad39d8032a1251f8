// An adaptive binary range coder (Martin 1979, with carry propagation and shift-by-five adaptation as in LZMA).
//
// Encoder and decoder have the same calls, each taking the value to be written and returning the value that stands there;
// the decoder does not look at what it is given. So everything that is coded is described once, for both directions.

import { DecimeshError } from '../errors.js';

/** Probabilities are twelve bits of a 0; they stay at least 31/4096 from either end, which bounds the bits in a byte. */
const PROBABILITY_BITS = 12;
const HALF = 1 << (PROBABILITY_BITS - 1);
const ADAPTATION = 5;
const RENORMALISE = 2 ** 24;

/** One direction of the coding. */
export interface Coder {
  /** Whether it reads. */
  readonly decodes: boolean;
  /** One bit whose probability is learnt in `models[index]`. */
  bit(models: Uint16Array, index: number, value: number): number;
  /** `count` bits, at most 12, that nothing is known about. */
  direct(count: number, value: number): number;
}

/** Models that know nothing yet. */
export function newModels(count: number): Uint16Array {
  return new Uint16Array(count).fill(HALF);
}

/** Writes. */
export class RangeEncoder implements Coder {
  readonly decodes = false;
  #low = 0;
  #range = 0xffffffff;
  #cache = 0;
  #pending = 1;
  #bytes = new Uint8Array(1024);
  #length = 0;

  bit(models: Uint16Array, index: number, value: number): number {
    const probability = models[index] as number;
    const bound = (this.#range >>> PROBABILITY_BITS) * probability;
    if (value === 0) {
      this.#range = bound;
      models[index] = probability + (((1 << PROBABILITY_BITS) - probability) >> ADAPTATION);
    } else {
      this.#low += bound;
      this.#range -= bound;
      models[index] = probability - (probability >> ADAPTATION);
    }
    while (this.#range < RENORMALISE) this.#shift();
    return value;
  }

  direct(count: number, value: number): number {
    this.#range = this.#range >>> count;
    this.#low += this.#range * value;
    while (this.#range < RENORMALISE) this.#shift();
    return value;
  }

  /** Ends and returns the bytes. */
  finish(): Uint8Array<ArrayBuffer> {
    for (let count = 0; count < 5; count += 1) this.#shift();
    // The first byte is the carry of nothing.
    return this.#bytes.slice(1, this.#length);
  }

  #shift(): void {
    if (this.#low < 0xff000000 || this.#low >= 2 ** 32) {
      const carry = this.#low >= 2 ** 32 ? 1 : 0;
      for (; this.#pending > 0; this.#pending -= 1) {
        this.#put((this.#cache + carry) & 0xff);
        this.#cache = 0xff;
      }
      this.#cache = Math.floor(this.#low / 2 ** 24) & 0xff;
    }
    this.#pending += 1;
    this.#low = (this.#low % 2 ** 24) * 256;
    this.#range = (this.#range * 256) % 2 ** 32;
  }

  #put(byte: number): void {
    if (this.#length === this.#bytes.length) {
      const grown = new Uint8Array(2 * this.#length);
      grown.set(this.#bytes);
      this.#bytes = grown;
    }
    this.#bytes[this.#length] = byte;
    this.#length += 1;
  }
}

/** Reads. Beyond the end it throws `truncated`. */
export class RangeDecoder implements Coder {
  readonly decodes = true;
  readonly #bytes: Uint8Array;
  #at = 0;
  #range = 0xffffffff;
  #code = 0;

  constructor(bytes: Uint8Array) {
    this.#bytes = bytes;
    for (let count = 0; count < 4; count += 1) this.#code = ((this.#code << 8) | this.#next()) >>> 0;
  }

  bit(models: Uint16Array, index: number, _value: number): number {
    const probability = models[index] as number;
    const bound = (this.#range >>> PROBABILITY_BITS) * probability;
    let value = 0;
    if (this.#code < bound) {
      this.#range = bound;
      models[index] = probability + (((1 << PROBABILITY_BITS) - probability) >> ADAPTATION);
    } else {
      value = 1;
      this.#code -= bound;
      this.#range -= bound;
      models[index] = probability - (probability >> ADAPTATION);
    }
    while (this.#range < RENORMALISE) this.#shift();
    return value;
  }

  direct(count: number, _value: number): number {
    this.#range = this.#range >>> count;
    // A damaged stream may have more than there can be.
    const value = Math.min(Math.floor(this.#code / this.#range), (1 << count) - 1);
    this.#code -= value * this.#range;
    while (this.#range < RENORMALISE) this.#shift();
    return value;
  }

  #shift(): void {
    this.#code = ((this.#code << 8) | this.#next()) >>> 0;
    this.#range = (this.#range << 8) >>> 0;
  }

  #next(): number {
    // What the encoder does not write at the end may be anything.
    if (this.#at >= this.#bytes.length + 4) throw new DecimeshError('truncated', 'a chunk ends before its content does');
    const byte = this.#bytes[this.#at] ?? 0;
    this.#at += 1;
    return byte;
  }
}
