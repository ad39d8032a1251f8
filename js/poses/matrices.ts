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

/** As {@link eigen}, the first `count` of them, by iteration of a subspace: for large matrices a small share of the time. */
export function largestEigen(symmetric: Float64Array, size: number, count: number): { values: number[]; vectors: Float64Array[] } {
  if (size <= 2 * count) return eigen(symmetric, size);
  // A few more than wanted, which makes the wanted ones settle sooner; those of the largest diagonal to begin with.
  const m = Math.min(size, count + 4);
  const order = Array.from({ length: size }, (_, k) => k).sort((p, q) => (symmetric[q * size + q] as number) - (symmetric[p * size + p] as number));
  let basis: Float64Array[] = order.slice(0, m).map((k) => Float64Array.from({ length: size }, (_, at) => (at === k ? 1 : 0)));
  const times = (vector: Float64Array): Float64Array => {
    const out = new Float64Array(size);
    for (let row = 0; row < size; row += 1) {
      let sum = 0;
      for (let k = 0; k < size; k += 1) sum += (symmetric[row * size + k] as number) * (vector[k] as number);
      out[row] = sum;
    }
    return out;
  };
  const dot = (a: Float64Array, b: Float64Array): number => a.reduce((sum, value, at) => sum + value * (b[at] as number), 0);
  for (let round = 0; round < 20; round += 1) {
    const next: Float64Array[] = [];
    for (const vector of basis.map(times)) {
      for (const other of next) {
        const along = dot(vector, other);
        for (let at = 0; at < size; at += 1) vector[at] = (vector[at] as number) - along * (other[at] as number);
      }
      const length = Math.sqrt(dot(vector, vector));
      if (length > 0) next.push(vector.map((value) => value / length));
    }
    if (next.length === 0) break;
    basis = next;
  }
  const images = basis.map(times);
  const projected = Float64Array.from({ length: basis.length ** 2 }, (_, at) =>
    dot(basis[Math.floor(at / basis.length)] as Float64Array, images[at % basis.length] as Float64Array));
  const { values, vectors } = eigen(projected, basis.length);
  const combined = vectors.map((share) => Float64Array.from({ length: size }, (_, at) => basis.reduce((sum, vector, k) => sum + (share[k] as number) * (vector[at] as number), 0)));
  return { values, vectors: combined };
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
