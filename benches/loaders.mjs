// Loaders: reading OBJ in Chromium, this package against three.js's OBJLoader, from the same bytes to arrays.
import { readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';
import { serve } from '../scripts/serve.mjs';
import { at } from '../scripts/project.mjs';
import { launchBrowser } from '../tests/support/browser.mjs';
import { folder } from './support/models.mjs';
import { none, printGoals, printTable, shown } from './support/report.mjs';

const MODELS = ['stanford-bunny', 'igea', 'nefertiti'];
const QUICK = ['stanford-bunny'];
const RUNS = 5;

/** How many times as fast as the peer, at least. */
const LEAST = 2;

const PAGE = `<!doctype html>
<script type="importmap">{ "imports": { "three": "/node_modules/three/build/three.module.js" } }</script>
<script type="module">
  import { init, openDocument } from '/dist/index.js';
  import { OBJLoader } from '/node_modules/three/examples/jsm/loaders/OBJLoader.js';
  await init();
  globalThis.loaders = {
    decimesh: async (bytes) => {
      const document = await openDocument(bytes);
      const { triangles } = document.summary;
      document.dispose();
      return triangles;
    },
    three: async (bytes) => {
      let corners = 0;
      new OBJLoader().parse(new TextDecoder().decode(bytes)).traverse((object) => {
        if (object.isMesh) corners += object.geometry.getAttribute('position').count;
      });
      return corners / 3;
    },
  };
</script>`;

/** Runs the bench, prints its table and returns everything for `--json`. */
export async function loaders({ quick }) {
  const server = await serve(at('.'), 0);
  const browser = await launchBrowser();
  const cases = [];
  try {
    const page = await browser.newPage();
    await page.route('**/loaders.html', (route) => route.fulfill({ contentType: 'text/html', body: PAGE }));
    await page.goto(`${server.url}loaders.html`);
    await page.waitForFunction(() => globalThis.loaders !== undefined);
    for (const model of quick ? QUICK : MODELS) {
      const bytes = gunzipSync(readFileSync(new URL(`${model}.obj.gz`, folder)));
      const result = await page.evaluate(measure, { base64: bytes.toString('base64'), runs: RUNS });
      cases.push({ model, megabytes: bytes.length / 1e6, ...result });
      console.error(`loaders: ${model} done`);
    }
  } finally {
    await browser.close();
    await server.close();
  }
  const rows = cases.map(({ model, megabytes, triangles, decimesh, three }) => [
    model, shown(megabytes, 1), String(triangles), shown(decimesh, 0), shown(three, 0), shown(three / decimesh, 2), shown(megabytes / (decimesh / 1000), 0),
  ]);
  printTable('loaders: OBJ in Chromium, shortest of the runs, ms', ['model', 'MB', 'triangles', 'decimesh', 'three.js', 'times as fast', 'MB/s'], rows);
  const slow = cases.filter(({ decimesh, three }) => three / decimesh < LEAST);
  const goals = [none(`less than ${LEAST} times as fast as OBJLoader`, slow.map(({ model, decimesh, three }) => `${model} ${shown(three / decimesh, 2)}`), cases.length)];
  printGoals('loaders: what must hold', goals);
  return { cases, goals };
}

/** In the page: the shortest time of each loader, in turn, and that both find the same. */
async function measure({ base64, runs }) {
  const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
  const best = {};
  const found = {};
  for (let run = 0; run < runs; run += 1) {
    for (const [name, load] of Object.entries(globalThis.loaders)) {
      const start = performance.now();
      found[name] = await load(bytes);
      best[name] = Math.min(best[name] ?? Infinity, performance.now() - start);
    }
  }
  if (found.decimesh !== found.three) throw new Error(`${found.decimesh} and ${found.three} triangles`);
  return { ...best, triangles: found.decimesh };
}
