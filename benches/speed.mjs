// Speed: the whole call and the engine alone, in turn with meshoptimizer's `simplify` in one process.
import * as glue from '../dist/wasm/decimesh.js';
import { peerSimplify, simplifyOurs } from './support/engines.mjs';
import { benchModel } from './support/models.mjs';
import { atMost, printGoals, printTable, shown } from './support/report.mjs';
import { geometricMean, median, timeTogether } from './support/statistics.mjs';

/** Models by name; `*4` is subdivided once with noise, `*16` twice. 69 thousand to 1.1 million triangles. */
const MODELS = ['stanford-bunny', 'nefertiti', 'igea', 'stanford-bunny*4', 'stanford-bunny*16'];
const RATIOS = [0.5, 0.1, 0.01];

/** The first job of the project: a scan to so many triangles with the default preset. */
const FIRST_JOB = { model: 'stanford-bunny', triangles: 1000, preset: 'balanced', limit: 1.5 };

/** Time as a share of the peer's, by preset. */
const TIME_LIMIT = { fast: 0.6, balanced: 1, best: 2.5 };

/** Time per triangle of 4.4 million triangles against that of 400 thousand. */
const SCALING = { small: 'nefertiti*4', large: 'stanford-bunny*64', ratio: 0.1, limit: 1.5 };

/** Runs the bench, prints its tables and returns everything for `--json`. */
export function speed({ presets, quick }) {
  const engineAlone = canTimeEngine(presets);
  if (!engineAlone) console.log('speed: the glue has no calls to time the engine alone by');
  const cases = [];
  for (const name of quick ? MODELS.slice(0, 1) : MODELS) {
    const mesh = benchModel(name);
    for (const share of RATIOS) cases.push(timeCase(name, mesh, share, presets, engineAlone));
    console.error(`speed: ${name} done`);
  }
  const means = presets.map(({ name }) => ({
    preset: name,
    whole: geometricMean(cases.map(({ ours }) => ours[name].share)),
    engine: geometricMean(cases.map(({ ours }) => ours[name].engineShare)),
  }));
  const bunny = benchModel(FIRST_JOB.model);
  const firstJob = timeCase(FIRST_JOB.model, bunny, FIRST_JOB.triangles / (bunny.indices.length / 3), presets, engineAlone);
  const first = presets.find(({ preset }) => preset === FIRST_JOB.preset);
  const scaling = quick ? [] : scalingOf(presets);
  const firstGoal = atMost(`${FIRST_JOB.model} to ${FIRST_JOB.triangles}, ${FIRST_JOB.preset}: time / simplify`,
    first && firstJob.ours[first.name].share, FIRST_JOB.limit);
  const goals = [firstGoal, ...presets.flatMap(({ name, preset }, at) => [
    atMost(`${name}: time / simplify`, means[at].whole, TIME_LIMIT[preset]),
    atMost(`${name}: time per triangle, 4.4M / 400k`, scaling.find((row) => row.name === name)?.growth, SCALING.limit),
  ])];
  print(presets, cases, means, scaling);
  printGoals('speed: what must hold', goals);
  return { cases, firstJob, means, scaling, goals };
}

function timeCase(model, mesh, share, presets, engineAlone) {
  const triangles = mesh.indices.length / 3;
  const target = Math.floor(triangles * share);
  const jobs = [
    () => peerSimplify(mesh, target).indices,
    ...presets.flatMap(({ options }) => [
      () => simplifyOurs(mesh, target, options).indices,
      ...(engineAlone ? [() => timeEngine(mesh, target, options)] : []),
    ]),
  ];
  const times = timeTogether(jobs, { seconds: 8 });
  const each = engineAlone ? 2 : 1;
  const ours = Object.fromEntries(presets.map(({ name }, at) => {
    const [whole, engine] = [times[1 + at * each], engineAlone ? times[2 + at * each] : undefined];
    // The ratio of each round and not of the medians: both of a round saw the same machine.
    const shares = (list) => list && median(list.map((time, round) => time / times[0][round]));
    return [name, { whole: median(whole), engine: engine && median(engine), share: shares(whole), engineShare: shares(engine),
      spread: Math.max(...whole) / Math.min(...whole) }];
  }));
  return { model, triangles, share, target, peer: median(times[0]), rounds: times[0].length, ours };
}

/** Whether the glue, which is no public surface, still has the calls and options that {@link timeEngine} makes. */
function canTimeEngine(presets) {
  const mesh = { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), indices: Uint32Array.of(0, 1, 2) };
  try {
    for (const { options } of presets) timeEngine(mesh, 1, options);
    return true;
  } catch {
    return false;
  }
}

/** Milliseconds of a run without copying the arrays in and the level out, so that the boundary's share is seen. */
function timeEngine({ positions, indices }, target, options) {
  const model = glue.Model.fromArrays(positions, indices, '[]', []);
  try {
    const start = performance.now();
    model.beginSimplify(JSON.stringify({ triangles: target, ...options }));
    while (model.step(1e9) < 1);
    return performance.now() - start;
  } finally {
    model.free();
  }
}

function scalingOf(presets) {
  const contestants = [
    { name: 'simplify', run: (mesh, target) => peerSimplify(mesh, target) },
    ...presets.map(({ name, options }) => ({ name, run: (mesh, target) => simplifyOurs(mesh, target, options) })),
  ];
  // Both sizes in every round: minutes apart, the machine's other work would count as growth.
  const meshes = [SCALING.small, SCALING.large].map((name) => benchModel(name));
  const jobs = contestants.flatMap(({ run }) =>
    meshes.map((mesh) => () => run(mesh, Math.floor((mesh.indices.length / 3) * SCALING.ratio)).indices));
  const times = timeTogether(jobs, { least: 3, most: 3 });
  console.error('speed: scaling done');
  return contestants.map(({ name }, at) => {
    const [small, large] = meshes.map((mesh, size) =>
      times[2 * at + size].map((time) => (time / (mesh.indices.length / 3)) * 1e6));
    const growth = median(large.map((time, round) => time / small[round]));
    return { name, small: median(small), large: median(large), growth };
  });
}

function print(presets, cases, means, scaling) {
  printTable('speed: milliseconds, medians, and as a share of simplify in the same round',
    ['case', 'triangles', 'rounds', 'simplify', 'M/s', ...presets.flatMap(({ name }) => [name, 'share', 'engine', 'share', 'max/min'])],
    cases.map(({ model, triangles, share, rounds, peer, ours }) => [
      `${model} ${share * 100} %`, String(triangles), String(rounds), shown(peer, 1), shown(triangles / peer / 1000, 2),
      ...presets.flatMap(({ name }) => {
        const mine = ours[name];
        return [shown(mine.whole, 1), shown(mine.share, 2), shown(mine.engine, 1), shown(mine.engineShare, 2), shown(mine.spread, 2)];
      }),
    ]));
  printTable('speed: geometric means of the shares', ['preset', 'whole call', 'engine alone'],
    means.map(({ preset, whole, engine }) => [preset, shown(whole), shown(engine)]));
  if (scaling.length > 0) {
    printTable(`speed: nanoseconds a triangle, to ${SCALING.ratio * 100} %`, ['engine', SCALING.small, SCALING.large, 'growth'],
      scaling.map(({ name, small, large, growth }) => [name, shown(small, 0), shown(large, 0), shown(growth, 2)]));
  }
}
