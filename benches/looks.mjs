// Looks: how alike original and result are when drawn, against gltfpack and glTF-Transform's simplify, twelve models.
import { readFileSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { basename, join } from 'node:path';
import { cachedAsync, digest } from './support/cache.mjs';
import * as look from './support/look.mjs';
import { PEERS, decoded, simplifyOurs } from './support/gltf-engines.mjs';
import { atMost, none, printGoals, printTable, shown } from './support/report.mjs';
import { geometricMean, ratio } from './support/statistics.mjs';
import { withTemporaryFolder } from './support/temporary.mjs';

/** The share of the triangles that every engine is asked for. */
const SHARE = 0.25;

/** Where a peer's result must land to count, as shares of the original's triangles. */
const COMPARABLE = [0.2, 0.3];

/** Limits on (1 - SSIM), as a share of the better peer's: over all models, and on any one. */
const MEAN_LIMIT = 0.8;
const WORST_LIMIT = 1.05;
/** Our own triangles, as a share of the original's. */
const COUNT_LIMIT = 0.26;
/** Least SSIM where no peer lands near the target. */
const LEAST_SSIM = 0.9;

const folder = new URL('../../shared/assets/gltf/', import.meta.url);

/** By name: the file, and whether no peer is to be compared with because all of them fail on it. */
const MODELS = {
  CesiumMan: { file: 'CesiumMan.glb' },
  runeSword: { file: 'runeSword.glb', alone: true },
  torus: { file: 'torus.gltf' },
  'oculus-touch-right': { file: 'oculus-touch-right.glb' },
  BrainStem: { file: 'BrainStem.glb' },
  garage: { file: 'garage/garage.gltf', alone: true },
  PalmTree: { file: 'PalmTree/PalmTree.gltf', alone: true },
  ghost_v2: { file: 'ghost_v2.glb' },
  vintageFan_animated: { file: 'vintageFan_animated/vintageFan_animated.gltf' },
  FlightHelmet: { file: 'FlightHelmet/FlightHelmet.gltf' },
  headphones: { file: 'headphones.gltf' },
  Duck: { file: 'Duck/Duck.gltf' },
};

const QUICK = ['CesiumMan', 'torus', 'Duck'];

/** Runs the bench, prints its table and returns everything for `--json`. */
export async function looks({ quick }) {
  if (!look.available) {
    console.log('looks: SKIPPED: ../shared has no tools/lookdist.mjs and assets/gltf');
    return { skipped: 'no meter or no models' };
  }
  const cases = [];
  for (const name of quick ? QUICK : Object.keys(MODELS)) {
    cases.push(await withTemporaryFolder((work) => runCase(name, MODELS[name], work)));
    console.error(`looks: ${name} done`);
  }
  const goals = goalsOf(cases);
  print(cases);
  printGoals('looks: what must hold', goals);
  return { share: SHARE, peers: PEERS.map(({ name, version }) => ({ name, version })), cases, goals };
}

async function runCase(name, { file, alone = false }, work) {
  const original = new URL(file, folder).pathname;
  const input = await decoded(original, join(work, 'decoded.glb'));
  const figures = {};
  const content = readFileSync(original);
  for (const { name: peer, version, run } of PEERS) {
    const key = digest('looks', look.version, content, basename(original), peer, version, String(SHARE));
    figures[peer] = await cachedAsync(key, async () => {
      const result = join(work, `${peer}.glb`);
      await run(input, result, SHARE);
      return look.compare(input, result);
    });
  }
  const ours = join(work, 'ours.glb');
  await simplifyOurs(input, ours, SHARE);
  figures.decimesh = look.compare(input, ours);
  const better = alone ? undefined : betterOf(figures);
  return { model: name, bytes: (await readFile(ours)).length, figures, better, ratio: ratio(1 - figures.decimesh.ssim, better && 1 - better) };
}

/** The highest SSIM of the peers that did what they were asked. */
function betterOf(figures) {
  const values = PEERS.map(({ name }) => figures[name])
    .filter((figure) => kept(figure) >= COMPARABLE[0] && kept(figure) <= COMPARABLE[1])
    .map(({ ssim }) => ssim);
  return values.length > 0 ? Math.max(...values) : undefined;
}

const kept = ({ triangles, triangles_in: before }) => triangles / before;

function goalsOf(cases) {
  const compared = cases.filter((row) => row.better !== undefined);
  const alone = cases.filter((row) => row.better === undefined);
  const listed = (rows, value) => rows.map((row) => `${row.model} ${shown(value(row))}`);
  const worse = compared.filter((row) => row.ratio > WORST_LIMIT);
  const many = cases.filter(({ figures }) => kept(figures.decimesh) > COUNT_LIMIT);
  const unlike = alone.filter(({ figures }) => figures.decimesh.ssim < LEAST_SSIM);
  return [
    atMost('(1 - SSIM) / the better peer', geometricMean(compared.map((row) => row.ratio)), MEAN_LIMIT),
    none(`worse than the better peer by over ${Math.round(100 * (WORST_LIMIT - 1))} %`, listed(worse, (row) => row.ratio), compared.length),
    none(`more than ${100 * COUNT_LIMIT} % of the triangles`, listed(many, ({ figures }) => kept(figures.decimesh)), cases.length),
    none(`SSIM below ${LEAST_SSIM} where no peer is compared`, listed(unlike, ({ figures }) => figures.decimesh.ssim), alone.length),
  ];
}

function print(cases) {
  const who = ['decimesh', ...PEERS.map(({ name }) => name)];
  const rows = cases.map(({ model, figures, better, ratio: share }) => [
    model,
    String(figures.decimesh.triangles_in),
    ...who.flatMap((name) => [shown(figures[name].ssim, 4), shown(figures[name].worst, 3), shown(100 * kept(figures[name]), 1)]),
    shown(better, 4),
    shown(share),
  ]);
  printTable(
    `looks: SSIM (mean, worst view) and triangles kept in % when asked for ${100 * SHARE} %`,
    ['model', 'triangles', ...who.flatMap((name) => [name, 'worst', '%']), 'better', '1-SSIM/better'],
    rows,
  );
}
