// Side by side with meshoptimizer: time and deviation on the same mesh and target, in one process.
//
//   npm run bench                    the bunny at 1,000 triangles, and six models at 10, 2 and 0.5 %
//   npm run bench -- --quick         the bunny alone
//
// Times are medians of 7 after one warm-up, each engine in turn, of the whole call: arrays in,
// arrays out. Deviations come from an independent meter if there is one (MESHDIST names it, or it
// stands in ../shared/tools): symmetric, in % of the bounding box's diagonal.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { MeshoptSimplifier } from 'meshoptimizer';
import { init, simplify } from '../dist/index.js';
import { available, loadModel, toObj } from './support/models.mjs';

const RUNS = 7;

const meter = process.env.MESHDIST ?? fileURLToPath(new URL('../../shared/tools/meshdist', import.meta.url));
const work = mkdtempSync(path.join(tmpdir(), 'decimesh-bench-'));
process.on('exit', () => rmSync(work, { recursive: true, force: true }));

function median(values) {
  return values.toSorted((a, b) => a - b)[values.length >> 1];
}

/** Runs both in turn, so that a change of the machine's speed hits both. */
function timeTogether(first, second) {
  const times = [[], []];
  for (let run = -1; run < RUNS; run++) {
    [first, second].forEach((job, k) => {
      const start = performance.now();
      job();
      if (run >= 0) times[k].push(performance.now() - start);
    });
  }
  return times.map(median);
}

function deviation(original, mesh) {
  if (!existsSync(meter)) return undefined;
  const files = [original, mesh].map((m, k) => {
    const file = path.join(work, `${k}.obj`);
    writeFileSync(file, toObj(m));
    return file;
  });
  return JSON.parse(execFileSync(meter, files, { encoding: 'utf8' }));
}

function compare(name, mesh, target) {
  const ours = () => simplify(mesh, { triangles: target });
  const theirs = () => MeshoptSimplifier.simplify(mesh.indices, mesh.positions, 3, target * 3, 1e9);
  const [ourTime, theirTime] = timeTogether(ours, theirs);
  const ourDeviation = deviation(mesh, ours());
  const theirDeviation = deviation(mesh, { positions: mesh.positions, indices: theirs()[0] });
  return { name, target, ourTime, theirTime, ourDeviation, theirDeviation };
}

const columns = [16, 9, 9, 9, 7, 9, 9, 7, 7];
const print = (cells) => console.log(cells.map((cell, k) => String(cell).padStart(columns[k])).join(' '));
const number = (value, digits = 4) => (value === undefined ? '–' : value.toFixed(digits));

if (!available) {
  console.log('SKIPPED: the bench models are not in ../shared/assets/bench');
  process.exit(0);
}
await Promise.all([init(), MeshoptSimplifier.ready]);
console.log(`${cpus()[0]?.model ?? 'unknown processor'}, Node ${process.version}, against meshoptimizer simplify`);
print(['model', 'target', 'ms', 'peer ms', 'ratio', 'mean %', 'rms %', 'rms/p', 'max/p']);

const quick = process.argv.includes('--quick');
const cases = [['stanford-bunny', 1000]];
if (!quick) {
  for (const name of ['stanford-bunny', 'igea', 'nefertiti', 'fandisk', 'rocker-arm', 'beast']) {
    for (const ratio of [0.1, 0.02, 0.005]) cases.push([name, ratio]);
  }
}
const models = new Map();
const sums = { time: [], rms: [], max: [] };
for (const [name, size] of cases) {
  if (!models.has(name)) models.set(name, loadModel(name));
  const mesh = models.get(name);
  const target = size <= 1 ? Math.floor((mesh.indices.length / 3) * size) : size;
  const row = compare(name, mesh, target);
  const ratio = (key) =>
    row.ourDeviation === undefined ? undefined : row.ourDeviation[key] / row.theirDeviation[key];
  print([
    name,
    target,
    number(row.ourTime, 1),
    number(row.theirTime, 1),
    number(row.ourTime / row.theirTime, 2),
    number(row.ourDeviation?.mean),
    number(row.ourDeviation?.rms),
    number(ratio('rms'), 3),
    number(ratio('haus'), 3),
  ]);
  if (size <= 1) {
    sums.time.push(row.ourTime / row.theirTime);
    if (row.ourDeviation !== undefined) {
      sums.rms.push(ratio('rms'));
      sums.max.push(ratio('haus'));
    }
  }
}
const geometricMean = (values) =>
  values.length === 0 ? undefined : Math.exp(values.reduce((sum, v) => sum + Math.log(v), 0) / values.length);
if (!quick) {
  const means = [sums.time, sums.rms, sums.max].map((values) => number(geometricMean(values), 3));
  console.log(`geometric means of ${sums.time.length} cases: time ${means[0]}, rms ${means[1]}, max ${means[2]} of the peer's`);
}
