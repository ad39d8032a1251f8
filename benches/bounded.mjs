// How few triangles a limit for the measured deviation takes, against the preset `best` at the same maximum.
//
//     npm run bench -- bounded                  all scans and bench models at 0.1 and 0.5 % of the diagonal
//     npm run bench -- bounded --quick          three of them
//
// The maximum is measured once more, with 400,000 samples a side. `best` is run to 1.25 times fewer triangles: where its
// maximum is larger than ours, it needs more than that for the same. The independent meter is the one
// that MESHDIST names, or ../shared/tools/meshdist.
import { execFileSync } from 'node:child_process';
import { existsSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { openDocument } from '../dist/index.js';
import { allModels } from './support/models.mjs';
import { atMost, none, printGoals, shown } from './support/report.mjs';
import { withTemporaryFolder } from './support/temporary.mjs';

const LIMITS = [0.1, 0.5];
const QUICK = ['rocker-arm', 'fandisk', 'brain'];
const FEWER = 1.25;

const meter = process.env.MESHDIST ?? fileURLToPath(new URL('../../shared/tools/meshdist', import.meta.url));

function byMeter(directory, original, level) {
  if (!existsSync(meter)) return undefined;
  const files = [original, level].map((bytes, index) => {
    const file = `${directory}/${index}.obj`;
    writeFileSync(file, bytes);
    return file;
  });
  return JSON.parse(execFileSync(meter, files, { encoding: 'utf8' })).haus;
}

/** The bench, for `run.mjs`; `names` takes others than all models. */
export function bounded({ quick = false, names } = {}) {
  const only = names ?? (quick ? QUICK : undefined);
  const chosen = allModels().filter(({ name }) => only === undefined || only.includes(name.replace(/\..*/, '')));
  return withTemporaryFolder((directory) => measureAll(directory, chosen));
}

async function measureAll(directory, chosen) {
  console.log('\nbounded: maxima in % of the diagonal, ours and by the independent meter; best at 1.25 times fewer triangles');
  const widths = [24, 6, 9, 9, 8, 8, 8, 9, 9];
  const print = (cells) => console.log(cells.map((cell, at) => (at === 0 ? String(cell).padEnd(widths[at]) : String(cell).padStart(widths[at]))).join(' '));
  print(['model', 'limit', 'triangles', 'of', 'max', 'meter', 's', 'best at', 'has max']);
  const cases = [];
  for (const { name, read } of chosen) {
    const document = await openDocument([{ name, bytes: read() }]);
    const original = (await document.write({ format: 'obj' })).bytes;
    for (const limit of LIMITS) {
      const found = await measureOne(document, limit, (level) => byMeter(directory, original, level));
      cases.push({ name, limit, ...found });
      print([name, limit, found.triangles, found.of, shown(found.max, 4), shown(found.meter, 4), shown(found.seconds, 1), found.fewer, shown(found.best, 4)]);
    }
    document.dispose();
  }
  const goals = [
    atMost('measured maximum / limit', Math.max(...cases.map(({ max, meter: other = 0, limit }) => Math.max(max, other) / limit)), 1),
    none('best needs 1.25 times fewer', cases.filter(({ max, best }) => best <= max).map(({ name, limit }) => `${name} at ${limit} %`), cases.length),
  ];
  printGoals('bounded: what must hold', goals);
  return { cases, goals };
}

async function measureOne(document, limit, measuredBy) {
  const start = performance.now();
  const { triangles } = await document.simplify({ maximumDeviation: `${limit}%` });
  const seconds = (performance.now() - start) / 1000;
  const percent = ({ max, relativeTo }) => (100 * max) / relativeTo;
  const max = percent(await document.measure());
  const other = measuredBy((await document.write({ format: 'obj' })).bytes);
  const fewer = Math.floor(triangles / FEWER);
  await document.simplify({ triangles: fewer, preset: 'best', keepLevels: true });
  return { triangles, of: document.summary.triangles, max, meter: other, seconds, fewer, best: percent(await document.measure()) };
}
