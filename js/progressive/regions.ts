// Regions to refine in: a box, and what a camera sees.

import { invalidArgument } from '../errors.js';
import type { Region } from './selective.js';

/** The box between two corners, model units. What has an error of at most `error` is not refined. */
export function boxRegion(min: readonly [number, number, number], max: readonly [number, number, number], error = 0): Region {
  return {
    error,
    touches: (x, y, z, radius) => {
      const outside = [x, y, z].map((c, k) => Math.max((min[k] as number) - c, c - (max[k] as number), 0));
      return Math.hypot(...outside) <= radius;
    },
  };
}

/**
 * What is in a view frustum: `matrix` is projection × view × model, 16 numbers by columns, as three.js has them. What has
 * an error of at most `error`, model units, is not refined.
 */
export function frustumRegion(matrix: ArrayLike<number>, error = 0): Region {
  if (matrix.length !== 16) throw invalidArgument('matrix', 'must have 16 numbers');
  const row = (k: number): number[] => [0, 1, 2, 3].map((column) => matrix[4 * column + k] as number);
  const [x, y, z, w] = [row(0), row(1), row(2), row(3)] as [number[], number[], number[], number[]];
  // Six planes, pointing inwards (Gribb & Hartmann 2001).
  const planes = [x, y, z].flatMap((axis) => [1, -1].map((sign) => w.map((value, k) => value + sign * (axis[k] as number))));
  const lengths = planes.map(([a = 0, b = 0, c = 0]) => Math.hypot(a, b, c));
  return {
    error,
    touches: (px, py, pz, radius) =>
      planes.every(([a = 0, b = 0, c = 0, d = 0], k) => a * px + b * py + c * pz + d >= -radius * (lengths[k] as number)),
  };
}
