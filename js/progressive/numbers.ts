// How numbers are coded: integers by their length in bits, floats as integers beside a prediction, without loss.

import { DecimeshError } from '../errors.js';
import { newModels, type Coder } from './range_coder.js';

/** Lengths go from 0 to 32. */
const LENGTHS = 64;

/** Contexts that a length may be coded in. */
const CONTEXTS = 18;

/** Bits after the leading one that are worth learning. */
const LEARNT = 3;

/** Integers from 0 to 2³² − 1 whose lengths are learnt in contexts. */
export class IntegerModel {
  readonly #lengths = newModels(CONTEXTS * LENGTHS);
  readonly #mantissas = newModels(33 << LEARNT);
  readonly #signs = newModels(2);

  /** Codes `value`; `context` is 0 to 17. */
  unsigned(coder: Coder, context: number, value: number): number {
    const length = coder.decodes ? 0 : 32 - Math.clz32(value);
    let node = 1;
    for (let bit = 5; bit >= 0; bit -= 1) {
      node = 2 * node + coder.bit(this.#lengths, context * LENGTHS + node, (length >> bit) & 1);
    }
    let left = Math.min(node - 64, 32);
    if (left < 2) return left;
    const mantissas = left << LEARNT;
    left -= 1;
    let result = 1;
    for (let prefix = 1; left > 0 && prefix < 1 << LEARNT; ) {
      left -= 1;
      const bit = coder.bit(this.#mantissas, mantissas + prefix, (value >>> left) & 1);
      prefix = 2 * prefix + bit;
      result = 2 * result + bit;
    }
    while (left > 0) {
      const count = Math.min(left, 12);
      left -= count;
      result = result * 2 ** count + coder.direct(count, (value >>> left) & ((1 << count) - 1));
    }
    return result;
  }

  /** As {@link unsigned}, for any 32-bit integer. */
  signed(coder: Coder, context: number, value: number): number {
    const magnitude = this.unsigned(coder, context, Math.abs(value) >>> 0);
    if (magnitude === 0) return 0;
    return coder.bit(this.#signs, 0, value < 0 ? 1 : 0) === 1 ? -magnitude | 0 : magnitude | 0;
  }
}

const bits = new Int32Array(1);
const float = new Float32Array(bits.buffer);

/** The bits of a float as an integer that rises with it. */
function orderedBits(value: number): number {
  float[0] = value;
  const raw = bits[0] as number;
  return raw < 0 ? raw ^ 0x7fffffff : raw;
}

function fromOrderedBits(ordered: number): number {
  bits[0] = ordered < 0 ? ordered ^ 0x7fffffff : ordered;
  return float[0] as number;
}

/** 0 for floats as they are; else every value is an integer divided by this and rounded. */
export type Grid = number;

// Decimals of text, fractions of two, and normalised integers.
const GRIDS = [1, 10, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 2 ** 10, 2 ** 12, 2 ** 14, 2 ** 16, 2 ** 18, 2 ** 20, 2 ** 24, 127, 255, 32767, 65535];

/** The coarsest grid that all values are on to the bit, 0 if there is none or it would not be worth it. */
export function gridOf(values: Float32Array): Grid {
  let best = 0;
  let cost = roughCost(values, 0);
  for (const grid of GRIDS) {
    if (!isOn(grid, values)) continue;
    const found = roughCost(values, grid);
    if (found < cost) [best, cost] = [grid, found];
  }
  return best;
}

function isOn(grid: Grid, values: Float32Array): boolean {
  for (let at = 0; at < values.length; at += 1) {
    const value = values[at] as number;
    // Of a negative zero the sum is a positive one, which it is not to be taken for.
    const whole = Math.round(value * grid) + 0;
    if (Math.abs(whole) > 2 ** 30 || !Object.is(Math.fround(whole / grid), value)) return false;
  }
  return true;
}

// What stands three places before is in the same direction, and near if anything is.
function roughCost(values: Float32Array, grid: Grid): number {
  let cost = 0;
  for (let at = 3; at < values.length; at += 1) {
    const difference = (integerOf(values[at] as number, grid) - integerOf(values[at - 3] as number, grid)) | 0;
    cost += 32 - Math.clz32(Math.abs(difference));
  }
  return cost;
}

function integerOf(value: number, grid: Grid): number {
  if (grid === 0) return orderedBits(value);
  return Math.max(-(2 ** 30), Math.min(2 ** 30, Math.round(value * grid)));
}

/** The numbers of one attribute, or of the positions. */
export class FloatModel {
  readonly #grid: Grid;
  readonly #components: readonly IntegerModel[];

  constructor(grid: Grid, components: number) {
    this.#grid = grid;
    this.#components = Array.from({ length: components }, () => new IntegerModel());
  }

  /**
   * Codes the numbers of `values` from `at` on, given a prediction; `scale` is how far, roughly, they may be from it, in
   * the same units, and tells only how many bits to expect.
   */
  code(coder: Coder, values: Float32Array, at: number, predicted: ArrayLike<number>, scale: number): void {
    const grid = this.#grid;
    const middle = predicted[0] as number;
    let length = 32 - Math.clz32(Math.abs(integerOf(middle + scale, grid) - integerOf(middle, grid)));
    for (let k = 0; k < this.#components.length; k += 1) {
      const guess = integerOf(predicted[k] as number, grid);
      const value = coder.decodes ? 0 : integerOf(values[at + k] as number, grid);
      const model = this.#components[k] as IntegerModel;
      const residual = model.signed(coder, (length + 1) >> 1, (value - guess) | 0);
      length = 32 - Math.clz32(Math.abs(residual));
      if (!coder.decodes) continue;
      const whole = (guess + residual) | 0;
      const read = grid === 0 ? fromOrderedBits(whole) : whole / grid;
      if (!Number.isFinite(read)) throw new DecimeshError('not-finite', 'a number is infinite or none');
      values[at + k] = read;
    }
  }
}
