// A simplifier for glTF-Transform's `simplify()`, in the place of meshoptimizer's and with its calls.

import { init } from './engine.js';
import { invalidArgument } from './errors.js';
import { simplify } from './simplify.js';

/** Flags that mean something here, and those that ask for what is done anyway or has no counterpart. */
const FLAGS = ['LockBorder', 'Prune', 'ErrorAbsolute', 'Sparse'];
const IGNORED_FLAGS = ['Regularize', 'RegularizeLight', 'Permissive', 'PreserveFolds', 'ErrorClamped'];

/** As meshoptimizer names them. */
export type SimplifierFlag =
  | 'LockBorder'
  | 'Prune'
  | 'ErrorAbsolute'
  | 'Sparse'
  | 'Regularize'
  | 'RegularizeLight'
  | 'Permissive'
  | 'PreserveFolds'
  | 'ErrorClamped';

/** The part of meshoptimizer's simplifier that glTF-Transform calls. */
export interface Simplifier {
  /** Whether there is WebAssembly. */
  readonly supported: boolean;
  /** Settles when the engine is loaded; reading it begins that. */
  readonly ready: Promise<void>;
  /**
   * Fewer of the triangles, over the same vertices (`placement: 'subset'`): the indices that are left and the estimated
   * error. Vertices at the same place are the sides of a seam, which does not tear.
   *
   * @param indices three for each triangle
   * @param positions x, y, z and what else there is for each vertex, `stride` numbers apart, `stride` ≥ 3
   * @param targetIndexCount at most so many indices are left, if the error allows
   * @param targetError largest estimated deviation, ≥ 0: as a share of {@link getScale}, with `'ErrorAbsolute'` in model
   * units. The error that is returned has the same unit.
   *
   * Throws a `DecimeshError`: `invalid-argument`, `out-of-range`, `not-finite`, and `not-initialised` before
   * {@link ready}.
   */
  simplify(
    indices: Uint32Array,
    positions: Float32Array,
    stride: number,
    targetIndexCount: number,
    targetError: number,
    flags?: readonly SimplifierFlag[],
  ): [Uint32Array, number];
  /**
   * As {@link simplify}. The error is geometric: attributes and their weights are checked and do not count.
   *
   * @param vertexLock a number for each vertex; where it is odd, the vertex stays. meshoptimizer's 2 protects seams, which
   * never tear here.
   */
  simplifyWithAttributes(
    indices: Uint32Array,
    positions: Float32Array,
    stride: number,
    attributes: Float32Array,
    attributeStride: number,
    attributeWeights: readonly number[],
    vertexLock: Uint8Array | null,
    targetIndexCount: number,
    targetError: number,
    flags?: readonly SimplifierFlag[],
  ): [Uint32Array, number];
  /** The longest edge of the bounding box. */
  getScale(positions: Float32Array, stride: number): number;
  /**
   * Numbers for the vertices that `indices` use, in the order of their first use, and how many they are; others have
   * 0xffffffff. `indices` are changed to these numbers.
   */
  compactMesh(indices: Uint32Array): [Uint32Array, number];
  /** All points: there is no simplification of points here. */
  simplifyPoints(positions: Float32Array, stride: number, targetVertexCount: number): Uint32Array;
}

/** `simplify({ simplifier: DecimeshSimplifier, ratio, error })`. */
export const DecimeshSimplifier: Simplifier = {
  get supported() {
    return typeof WebAssembly === 'object';
  },

  get ready() {
    return init();
  },

  simplify(indices, positions, stride, targetIndexCount, targetError, flags = []) {
    return subset(indices, positions, stride, null, targetIndexCount, targetError, flags);
  },

  simplifyWithAttributes(indices, positions, stride, attributes, attributeStride, weights, vertexLock, targetIndexCount, targetError, flags = []) {
    if (!(attributes instanceof Float32Array) || !(attributeStride >= weights.length)) {
      throw invalidArgument('attributes', 'must have a stride of at least one number for each weight');
    }
    if ((vertexLock ?? null) !== null && !(vertexLock instanceof Uint8Array && vertexLock.length === Math.floor(positions.length / stride))) {
      throw invalidArgument('vertexLock', 'must be a Uint8Array of one number for each vertex, or null');
    }
    return subset(indices, positions, stride, vertexLock ?? null, targetIndexCount, targetError, flags);
  },

  getScale(positions, stride) {
    return extent(packedPositions(positions, stride), 3, undefined);
  },

  compactMesh(indices) {
    const count = indices.reduce((most, index) => Math.max(most, index + 1), 0);
    const remap = new Uint32Array(count).fill(0xffffffff);
    let unique = 0;
    for (const [at, index] of indices.entries()) {
      if (remap[index] === 0xffffffff) remap[index] = unique++;
      indices[at] = remap[index] as number;
    }
    return [remap, unique];
  },

  simplifyPoints(positions, stride) {
    return Uint32Array.from({ length: Math.floor(positions.length / stride) }, (_, index) => index);
  },
};

/** Fewer of the triangles over the same vertices, of which those stay whose lock is odd. */
function subset(
  indices: Uint32Array,
  positions: Float32Array,
  stride: number,
  vertexLock: Uint8Array | null,
  targetIndexCount: number,
  targetError: number,
  flags: readonly SimplifierFlag[],
): [Uint32Array, number] {
  for (const flag of flags) {
    if (![...FLAGS, ...IGNORED_FLAGS].includes(flag)) throw invalidArgument('flags', `'${String(flag)}' is unknown`);
  }
  if (!(indices instanceof Uint32Array)) throw invalidArgument('indices', 'must be a Uint32Array');
  if (!(targetIndexCount >= 0)) throw invalidArgument('targetIndexCount', 'must be a number of at least 0');
  if (!(targetError >= 0)) throw invalidArgument('targetError', 'must be a number of at least 0');
  const packed = packedPositions(positions, stride);
  const scale = flags.includes('ErrorAbsolute') ? 1 : extent(packed, 3, flags.includes('Sparse') ? indices : undefined);
  // Vertices at one place differ in attributes that are not known here: a number of its own says so for each.
  const vertex = Uint32Array.from({ length: packed.length / 3 }, (_, index) => index % EXACT);
  const error = targetError * scale;
  const result = simplify(
    { positions: packed, indices, attributes: { vertex } },
    {
      triangles: Math.floor(Math.min(targetIndexCount, indices.length) / 3),
      ...(Number.isFinite(error) ? { error } : {}),
      placement: 'subset',
      lockBorder: flags.includes('LockBorder'),
      prune: flags.includes('Prune'),
      ...(vertexLock === null ? {} : { locked: vertexLock.map((lock) => lock & 1) }),
    },
  );
  const left = result.indices.map((index) => result.vertexMap[index] as number);
  return [left, scale > 0 ? result.estimatedError / scale : 0];
}

/** Whole numbers below this are told apart in single precision. */
const EXACT = 2 ** 24;

function packedPositions(positions: Float32Array, stride: number): Float32Array {
  if (!(positions instanceof Float32Array)) throw invalidArgument('positions', 'must be a Float32Array');
  if (!Number.isInteger(stride) || stride < 3) throw invalidArgument('stride', 'must be an integer of at least 3');
  if (stride === 3) return positions;
  const count = Math.floor(positions.length / stride);
  const packed = new Float32Array(3 * count);
  for (let vertex = 0; vertex < count; vertex += 1) {
    packed.set(positions.subarray(vertex * stride, vertex * stride + 3), 3 * vertex);
  }
  return packed;
}

function extent(positions: Float32Array, stride: number, indices: Uint32Array | undefined): number {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  const count = indices?.length ?? positions.length / stride;
  for (let at = 0; at < count; at += 1) {
    const start = stride * (indices?.[at] ?? at);
    for (let axis = 0; axis < 3; axis += 1) {
      const value = positions[start + axis] as number;
      low[axis] = Math.min(low[axis] as number, value);
      high[axis] = Math.max(high[axis] as number, value);
    }
  }
  return Math.max(0, ...high.map((value, axis) => value - (low[axis] as number)));
}
