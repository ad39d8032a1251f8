// The contestants: this package by preset, and meshoptimizer's simplifiers, each a function from mesh and target to mesh.
import { readFileSync } from 'node:fs';
import { MeshoptSimplifier } from 'meshoptimizer';
import { init, simplify } from '../../dist/index.js';

/** No deviation reaches this, as a multiple of the model's extent: only the count stops a run. */
const NO_ERROR_LIMIT = 1e9;

/** Version of the installed meshoptimizer, part of the key under which its results are kept. */
export const peerVersion = JSON.parse(
  readFileSync(new URL('../../node_modules/meshoptimizer/package.json', import.meta.url), 'utf8'),
).version;

/** Gets all engines ready. */
export const ready = () => Promise.all([init(), MeshoptSimplifier.ready]);

/**
 * The presets that the built package knows, as `{ name, preset, options }`: `preset` is what its goals are listed
 * under, `options` what is passed. A package without presets has one, `default`, judged as `balanced`.
 */
export function presets() {
  const probe = { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), indices: Uint32Array.of(0, 1, 2) };
  try {
    simplify(probe, { ratio: 1, preset: 'balanced' });
  } catch (error) {
    if (error.code !== 'invalid-argument') throw error;
    console.log('the built package knows no option `preset`: measured as `default`, judged as `balanced`');
    return [{ name: 'default', preset: 'balanced', options: {} }];
  }
  return ['fast', 'balanced', 'best'].map((name) => ({ name, preset: name, options: { preset: name } }));
}

/** The package's call at `target` triangles. */
export const simplifyOurs = (mesh, target, options) => simplify(mesh, { triangles: target, ...options });

/** meshoptimizer `simplify`: vertices stay where they were. `flags` as its API names them. */
export function peerSimplify({ positions, indices }, target, flags = []) {
  return { positions, indices: MeshoptSimplifier.simplify(indices, positions, 3, target * 3, NO_ERROR_LIMIT, flags)[0] };
}

/** meshoptimizer `simplifyWithAttributes`, with `numbers` of five a vertex: vertices stay where they were. */
export function peerWithAttributes({ positions, indices }, numbers, target) {
  const weights = [0.5, 0.5, 0.5, 1, 1];
  const [kept] = MeshoptSimplifier.simplifyWithAttributes(
    indices, positions, 3, numbers, weights.length, weights, null, target * 3, NO_ERROR_LIMIT);
  return { positions, indices: kept };
}

/** meshoptimizer `simplifyWithUpdate`: vertices move; positions only, so no attributes. */
export function peerUpdate({ positions, indices }, target) {
  const moved = positions.slice();
  const kept = indices.slice();
  const none = new Float32Array(0);
  const [count] = MeshoptSimplifier.simplifyWithUpdate(kept, moved, 3, none, 0, [], null, target * 3, NO_ERROR_LIMIT);
  return compact({ positions: moved, indices: kept.subarray(0, count) });
}

/** `simplifyWithUpdate` to half the triangles again and again, so that quadrics are taken from the current surface. */
export function peerHalving(mesh, target) {
  let current = mesh;
  for (;;) {
    const triangles = current.indices.length / 3;
    const next = peerUpdate(current, Math.max(target, triangles >> 1));
    if (next.indices.length / 3 <= target || next.indices.length === current.indices.length) return next;
    current = next;
  }
}

/** The same mesh with only the vertices it uses. */
function compact({ positions, indices }) {
  const [remap, count] = MeshoptSimplifier.compactMesh(indices);
  const packed = new Float32Array(count * 3);
  remap.forEach((to, from) => {
    if (to < count) packed.set(positions.subarray(3 * from, 3 * from + 3), 3 * to);
  });
  return { positions: packed, indices };
}
