// Poses: how far a quarter of the triangles is from the original when skins move and morph targets act, against at rest.
import { readFileSync, readdirSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { init, openDocument } from '../dist/index.js';
import { available as meterAvailable, measure } from './support/deviation.mjs';
import { atFrames, atTargets, loadScene, rest, worldMesh } from './support/poses.mjs';
import { none, printGoals, printTable, shown } from './support/report.mjs';

const SHARE = 0.25;
const FRAMES = 16;

/** The largest deviation of any pose, as a multiple of that at rest. */
const LIMIT = 1.5;

const folder = fileURLToPath(new URL('../../shared/assets/gltf/', import.meta.url));

/** The animated skins and the morph targets of the assets. */
const MODELS = [
  'CesiumMan.glb',
  'BrainStem.glb',
  'Fox.glb',
  'RiggedFigure.glb',
  'ghost_v2.glb',
  'vintageFan_animated/vintageFan_animated.gltf',
  'MorphStressTest.gltf',
];

const QUICK = ['CesiumMan.glb', 'RiggedFigure.glb', 'MorphStressTest.gltf'];

/** Runs the bench, prints its table and returns everything for `--json`. */
export async function poses({ quick }) {
  if (!meterAvailable) {
    console.log('poses: SKIPPED: no meter; MESHDIST names one, or it stands in ../shared/tools');
    return { skipped: 'no meter' };
  }
  await init();
  const cases = [];
  for (const name of quick ? QUICK : MODELS) {
    cases.push(await runCase(name));
    console.error(`poses: ${name} done`);
  }
  const rows = cases.map(({ model, triangles, atRest, worst, where, worstRms, moments }) => [
    model, String(triangles), String(moments), shown(atRest, 4), shown(worst, 4), shown(worst / atRest, 2), shown(worstRms, 2), where,
  ]);
  const header = ['model', 'triangles', 'poses', 'max at rest', 'worst max', 'ratio', 'ratio of rms', 'where'];
  printTable(`poses: deviation at ${100 * SHARE} % of the triangles, in % of the diagonal at rest`, header, rows);
  const failed = cases.filter(({ worst, atRest }) => worst > LIMIT * atRest);
  const goals = [none(`worse than ${LIMIT} times at rest`, failed.map(({ model, worst, atRest }) => `${model} ${shown(worst / atRest, 2)}`), cases.length)];
  printGoals('poses: what must hold', goals);
  return { share: SHARE, frames: FRAMES, cases, goals };
}

async function runCase(model) {
  const path = join(folder, model);
  const files = readdirSync(dirname(path)).filter((name) => name !== basename(path) && model.includes('/'));
  const named = [basename(path), ...files].map((name) => ({ name, bytes: new Uint8Array(readFileSync(join(dirname(path), name))) }));
  const document = await openDocument(model.includes('/') ? named : named.slice(0, 1));
  const before = await loadScene((await document.write({ compress: 'none' })).bytes);
  const { triangles } = await document.simplify({ ratio: SHARE });
  const after = await loadScene((await document.write({ compress: 'none' })).bytes);
  document.dispose();
  for (const scene of [before, after]) rest(scene);
  const original = worldMesh(before);
  const unit = diagonal(original);
  const atRest = inUnits(original, worldMesh(after), unit);
  // One scene after the other: each has its own mixer.
  const moments = [];
  const collect = (scene, side) => {
    let next = 0;
    return (label) => {
      moments[next] = { ...moments[next], label, [side]: worldMesh(scene) };
      next += 1;
    };
  };
  for (const [scene, side] of [[before, 'original'], [after, 'result']]) {
    const look = collect(scene, side);
    if (scene.animations.length > 0 && hasSkin(scene)) await atFrames(scene, FRAMES, look);
    rest(scene);
    await atTargets(scene, look);
  }
  const measured = moments.map(({ label, original: posed, result }) => ({ label, ...inUnits(posed, result, unit) }));
  const worst = measured.reduce((most, one) => (one.max > most.max ? one : most));
  return {
    model,
    triangles,
    moments: measured.length,
    atRest: atRest.max,
    worst: worst.max,
    worstRms: Math.max(...measured.map(({ rms }) => rms)) / atRest.rms,
    where: worst.label,
    measured,
  };
}

function hasSkin({ scene }) {
  let found = false;
  scene.traverse((object) => (found ||= object.isSkinnedMesh === true));
  return found;
}

/** Deviations in % of `unit`: the meter gives them in % of the diagonal of the pose. */
function inUnits(original, result, unit) {
  const { haus, rms } = measure(original, result);
  const scale = diagonal(original) / unit;
  return { max: haus * scale, rms: rms * scale };
}

function diagonal({ positions, indices }) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const index of indices) {
    for (let axis = 0; axis < 3; axis += 1) {
      low[axis] = Math.min(low[axis], positions[3 * index + axis]);
      high[axis] = Math.max(high[axis], positions[3 * index + axis]);
    }
  }
  return Math.hypot(...high.map((value, axis) => value - low[axis]));
}
