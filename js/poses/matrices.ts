// Matrices of four by four as arrays in columns, as glTF has them, and placements that make them.

/** Sixteen numbers, column after column. */
export type Matrix = Float64Array;

/** A node's place: translation, rotation as a quaternion, scale. */
export interface Placement {
  translation: ArrayLike<number>;
  rotation: ArrayLike<number>;
  scale: ArrayLike<number>;
}

/** `a` after `b`. */
export function multiply(a: ArrayLike<number>, b: ArrayLike<number>): Matrix {
  const out = new Float64Array(16);
  for (let at = 0; at < 16; at += 1) {
    const [row, column] = [at % 4, at - (at % 4)];
    let sum = 0;
    for (let k = 0; k < 4; k += 1) sum += (a[4 * k + row] as number) * (b[column + k] as number);
    out[at] = sum;
  }
  return out;
}

/** Translation · rotation · scale. */
export function compose({ translation, rotation, scale }: Placement): Matrix {
  const [x = 0, y = 0, z = 0, w = 1] = Array.from(rotation);
  const length = x * x + y * y + z * z + w * w;
  const s = length > 0 ? 2 / length : 0;
  const axes = [
    1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y),
    s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x),
    s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y),
  ];
  const out = new Float64Array(16);
  for (let column = 0; column < 3; column += 1) {
    for (let row = 0; row < 3; row += 1) out[4 * column + row] = (axes[3 * column + row] as number) * (scale[column] ?? 1);
    out[12 + column] = translation[column] ?? 0;
  }
  out[15] = 1;
  return out;
}

/** The length of the longest axis. */
export function longestAxis(matrix: ArrayLike<number>): number {
  return Math.max(...[0, 4, 8].map((at) => Math.hypot(matrix[at] as number, matrix[at + 1] as number, matrix[at + 2] as number)));
}

/**
 * The eigenvalues of a symmetric matrix of `size` rows, falling, with their eigenvectors as rows, by Jacobi's rotations.
 */
export function eigen(symmetric: Float64Array, size: number): { values: number[]; vectors: Float64Array[] } {
  const a = symmetric.slice();
  const v = new Float64Array(size * size);
  for (let k = 0; k < size; k += 1) v[k * size + k] = 1;
  const at = (matrix: Float64Array, row: number, column: number): number => matrix[row * size + column] as number;
  for (let sweep = 0; sweep < 30; sweep += 1) {
    let off = 0;
    let all = 0;
    for (let p = 0; p < size; p += 1) for (let q = 0; q < size; q += 1) {
      all += at(a, p, q) ** 2;
      if (p !== q) off += at(a, p, q) ** 2;
    }
    if (off <= 1e-18 * all) break;
    for (let p = 0; p < size; p += 1) for (let q = p + 1; q < size; q += 1) {
      const apq = at(a, p, q);
      if (apq === 0) continue;
      const theta = (at(a, q, q) - at(a, p, p)) / (2 * apq);
      const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.hypot(theta, 1));
      const c = 1 / Math.hypot(t, 1);
      const s = t * c;
      for (let k = 0; k < size; k += 1) {
        const [akp, akq] = [at(a, k, p), at(a, k, q)];
        a[k * size + p] = c * akp - s * akq;
        a[k * size + q] = s * akp + c * akq;
      }
      for (let k = 0; k < size; k += 1) {
        const [apk, aqk] = [at(a, p, k), at(a, q, k)];
        a[p * size + k] = c * apk - s * aqk;
        a[q * size + k] = s * apk + c * aqk;
        const [vpk, vqk] = [at(v, p, k), at(v, q, k)];
        v[p * size + k] = c * vpk - s * vqk;
        v[q * size + k] = s * vpk + c * vqk;
      }
    }
  }
  const order = Array.from({ length: size }, (_, k) => k).sort((p, q) => at(a, q, q) - at(a, p, p));
  return { values: order.map((k) => at(a, k, k)), vectors: order.map((k) => v.slice(k * size, (k + 1) * size)) };
}

/** Solves `matrix` · x = b for a symmetric positive matrix of `size` rows and several b, in place, by Cholesky's factors. */
export function solve(matrix: Float64Array, size: number, columns: readonly Float64Array[]): void {
  const at = (row: number, column: number): number => matrix[row * size + column] as number;
  for (let i = 0; i < size; i += 1) {
    for (let j = 0; j <= i; j += 1) {
      let sum = at(i, j);
      for (let k = 0; k < j; k += 1) sum -= at(i, k) * at(j, k);
      matrix[i * size + j] = i === j ? Math.sqrt(Math.max(sum, Number.MIN_VALUE)) : sum / at(j, j);
    }
  }
  for (const b of columns) {
    for (let i = 0; i < size; i += 1) {
      for (let k = 0; k < i; k += 1) b[i] = (b[i] as number) - at(i, k) * (b[k] as number);
      b[i] = (b[i] as number) / at(i, i);
    }
    for (let i = size - 1; i >= 0; i -= 1) {
      for (let k = i + 1; k < size; k += 1) b[i] = (b[i] as number) - at(k, i) * (b[k] as number);
      b[i] = (b[i] as number) / at(i, i);
    }
  }
}
