// How fast the deviation is measured, and whether an independent meter says the same.
//
//   node benches/deviation.mjs             six models at 10 and 1 %, and the bunny at 1,000 triangles
//   node benches/deviation.mjs --quick     the bunny at 1,000 and igea at 10 %
//   node benches/deviation.mjs --scans     all scans at 10 and 1 %, each measured once
//   … --meter=8000000                      samples a side that the meter takes. Default: 400,000
//
// Samples per second are all places measured at (faces, edges, vertices, both sides) over the time of the whole
// measurement, building the trees included: the median of 3 after one warm-up. The meter is the one that MESHDIST
// names, or ../shared/tools/meshdist; its figures are in % of the bounding box's diagonal, and so are ours here.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { init, openDocument } from '../dist/index.js';
import { allModels, available, loadModel, toObj } from './support/models.mjs';

const ofScans = process.argv.includes('--scans');
const RUNS = ofScans ? 1 : 3;
const METER_SAMPLES = Number(process.argv.find((argument) => argument.startsWith('--meter='))?.slice(8) ?? 400_000);

if (!available) {
  console.log('SKIPPED: the bench models are not in ../shared/assets/bench');
  process.exit(0);
}
const meter = process.env.MESHDIST ?? fileURLToPath(new URL('../../shared/tools/meshdist', import.meta.url));
const work = mkdtempSync(path.join(tmpdir(), 'decimesh-bench-'));
process.on('exit', () => rmSync(work, { recursive: true, force: true }));

async function measured(document) {
  const times = [];
  let deviation;
  for (let run = ofScans ? 0 : -1; run < RUNS; run += 1) {
    const start = performance.now();
    deviation = await document.measure();
    if (run >= 0) times.push(performance.now() - start);
  }
  return { deviation, milliseconds: times.toSorted((a, b) => a - b)[RUNS >> 1] };
}

function byMeter(original, level) {
  if (!existsSync(meter)) return undefined;
  const files = [original, level].map((bytes, k) => {
    const file = path.join(work, `${k}.obj`);
    writeFileSync(file, bytes);
    return file;
  });
  return JSON.parse(execFileSync(meter, [...files, String(METER_SAMPLES)], { encoding: 'utf8' }));
}

const columns = [20, 9, 8, 8, 8, 9, 9, 9, 9, 9, 9];
const print = (cells) => console.log(cells.map((cell, k) => String(cell).padStart(columns[k])).join(' '));

await init();
console.log(`${cpus()[0]?.model ?? 'unknown processor'}, Node ${process.version}; / is ours over the meter's`);
print(['model', 'triangles', 'samples', 'ms', 'M / s', 'mean %', 'rms %', 'max %', 'mean /', 'rms /', 'max /']);

const cases = ofScans ? [] : [['stanford-bunny', 1000], ['igea', 0.1]];
const scans = new Map(allModels().map(({ name, read }) => [name, read]));
if (ofScans) {
  for (const name of scans.keys()) cases.push([name, 0.1], [name, 0.01]);
} else if (!process.argv.includes('--quick')) {
  cases.push(['igea', 0.01]);
  for (const name of ['stanford-bunny', 'nefertiti', 'fandisk', 'rocker-arm', 'beast']) cases.push([name, 0.1], [name, 0.01]);
}
const farthest = { mean: 0, rms: 0, haus: 0 };
let [slowest, name, document, original] = [Infinity];
for (const [wanted, size] of cases) {
  if (wanted !== name) {
    document?.dispose();
    name = wanted;
    const read = ofScans ? scans.get(name) : undefined;
    document = await openDocument([read ? { name, bytes: read() } : { name: `${name}.obj`, bytes: Buffer.from(toObj(loadModel(name))) }]);
    // The meter reads one format, and what the document holds.
    original = (await document.write({ format: 'obj' })).bytes;
  }
  const { triangles } = await document.simplify(size <= 1 ? { ratio: size } : { triangles: size });
  const { deviation, milliseconds } = await measured(document);
  const theirs = byMeter(original, (await document.write({ format: 'obj' })).bytes);
  const samples = deviation.originalToSimplified.samples + deviation.simplifiedToOriginal.samples;
  const rate = samples / milliseconds / 1000;
  slowest = Math.min(slowest, rate);
  const percent = (value) => (100 * value) / deviation.relativeTo;
  const ratios = [['mean', deviation.mean], ['rms', deviation.rms], ['haus', deviation.max]].map(([key, ours]) => {
    if (theirs === undefined) return '–';
    const ratio = percent(ours) / theirs[key];
    farthest[key] = Math.max(farthest[key], Math.abs(ratio - 1));
    return ratio.toFixed(4);
  });
  const figures = [deviation.mean, deviation.rms, deviation.max].map((value) => percent(value).toPrecision(4));
  print([name, triangles, samples, milliseconds.toFixed(0), rate.toFixed(2), ...figures, ...ratios]);
}
document?.dispose();
const worst = (key) => `${(100 * farthest[key]).toFixed(2)} %`;
console.log(`slowest: ${slowest.toFixed(2)} M samples/s`);
if (existsSync(meter)) console.log(`farthest from the meter: mean ${worst('mean')}, rms ${worst('rms')}, max ${worst('haus')}`);
