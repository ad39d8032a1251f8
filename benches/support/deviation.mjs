// Measured deviation and validity of a result, by an independent meter on files.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { cached, digest } from './cache.mjs';
import { toObj } from './models.mjs';

const meter = process.env.MESHDIST ?? fileURLToPath(new URL('../../../shared/tools/meshdist', import.meta.url));

/** Whether there is a meter: MESHDIST names one, or it stands in ../shared/tools. */
export const available = existsSync(meter);

/** Says which meter measured, by its sources' contents. */
const meterVersion = (() => {
  if (!available) return '';
  const sources = path.join(path.dirname(meter), 'src');
  const files = existsSync(sources) ? readdirSync(sources).toSorted().map((name) => path.join(sources, name)) : [];
  return digest(...[meter, ...files].map((file) => readFileSync(file, 'latin1')));
})();

const work = mkdtempSync(path.join(tmpdir(), 'decimesh-bench-'));
process.on('exit', () => rmSync(work, { recursive: true, force: true }));
const written = new Set();

/** Digest of a mesh's arrays. */
const meshDigest = ({ positions, indices }) => digest(positions, indices);

/**
 * The key of a result that is made from `original` by what `parts` names: hash of the model, the meter, the parts.
 * With it {@link cached} can skip both the making and the measuring.
 */
export const resultKey = (original, ...parts) => digest(originalDigest(original), meterVersion, ...parts);

const digests = new WeakMap();
function originalDigest(mesh) {
  if (!digests.has(mesh)) digests.set(mesh, meshDigest(mesh));
  return digests.get(mesh);
}

/**
 * The meter's figures for `result` against `original`: `mean`, `rms` and `haus` (maximum), symmetric, in % of the
 * original's diagonal; counts of faults; and `borderLength` in units of the model. `undefined` without a meter.
 */
export function measure(original, result) {
  if (!available) return undefined;
  return cached(resultKey(original, 'measure', result.positions, result.indices), () => {
    const files = [original, result].map((mesh, at) => {
      const file = path.join(work, at === 0 ? `${originalDigest(original)}.obj` : 'result.obj');
      if (at === 1 || !written.has(file)) writeFileSync(file, toObj(mesh));
      written.add(file);
      return file;
    });
    const figures = JSON.parse(execFileSync(meter, files, { encoding: 'utf8' }));
    return { ...figures, triangles: result.indices.length / 3, borderLength: borderLength(result) };
  });
}

/** Length of all edges that one triangle uses; vertices at the same position are one. */
function borderLength({ positions, indices }) {
  const vertexAt = new Map();
  const vertex = Uint32Array.from({ length: positions.length / 3 }, (_, at) => {
    const key = `${positions[3 * at]} ${positions[3 * at + 1]} ${positions[3 * at + 2]}`;
    if (!vertexAt.has(key)) vertexAt.set(key, at);
    return vertexAt.get(key);
  });
  const uses = new Map();
  for (let corner = 0; corner < indices.length; corner += 1) {
    const [a, b] = [vertex[indices[corner]], vertex[indices[corner % 3 === 2 ? corner - 2 : corner + 1]]];
    const key = Math.min(a, b) * 2 ** 26 + Math.max(a, b);
    uses.set(key, (uses.get(key) ?? 0) + 1);
  }
  let length = 0;
  for (const [key, count] of uses) {
    if (count !== 1) continue;
    const [a, b] = [Math.floor(key / 2 ** 26), key % 2 ** 26];
    length += Math.hypot(...[0, 1, 2].map((axis) => positions[3 * a + axis] - positions[3 * b + axis]));
  }
  return length;
}
