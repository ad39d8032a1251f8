// Whether the page gives back what it took: open, simplify, look, export, and open again, many times over.
//
//     node benches/rounds.mjs [MODEL.glb] [--rounds N] [--site DIRECTORY]
//
// Without a model the bundled desk fan, with its textures, skins and animations; opening it closes the one before. After
// each round the memory of the page and all of its workers is asked for (JavaScript and WebAssembly, after a garbage
// collection), and what is alive on the graphics card is counted where they are made; in round 5 and at the end all that
// is alive on the JavaScript heaps but compiled code, of which the engine makes more the longer something runs. The exit
// code is 1 when any of them is more than a tenth above that of round 5 at the end.

import { readFileSync } from 'node:fs';
import { basename, resolve } from 'node:path';
import { at } from '../scripts/project.mjs';
import { startPage } from '../tests/support/browser.mjs';
import { heapMeter } from './support/heap.mjs';
import { openViewWorker, viewWorkerOf } from '../tests/support/view_worker.mjs';

const BASE = 5;
const TOLERANCE = 1.1;
const WAIT = { timeout: 120_000 };

const options = process.argv.slice(2);
const option = (name, otherwise) => (options.includes(name) ? options.splice(options.indexOf(name), 2)[1] : otherwise);
const rounds = Number(option('--rounds', '50'));
const site = resolve(option('--site', at('site')));
const path = options[0] ?? at('www', 'samples', 'desk-fan.glb');
const bytes = readFileSync(path);

/** Bytes by the browser's own account, of the page with its workers. */
const memoryOf = (page) =>
  page.evaluate(async () => {
    const { bytes: total, breakdown } = await performance.measureUserAgentSpecificMemory();
    return { total, parts: breakdown.filter((part) => part.bytes > 0).map((part) => [part.bytes, part.types.join(' '), part.attribution.map(({ scope, url }) => `${scope} ${url.split('/').pop()}`).join(' ')]) };
  });

async function round(page, number) {
  const status = (text) => page.getByRole('status').filter({ hasText: text }).waitFor(WAIT);
  // The status may still be the last round's: the name tells them apart.
  // Fetched: what is handed over by the debugging protocol stays in the browser's memory.
  await page.evaluate(async (name) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([await (await fetch('dropped.glb')).blob()], name));
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
  }, `round-${number}.glb`);
  await page.locator('.model-name').filter({ hasText: `round-${number}` }).waitFor(WAIT);
  await status(/^Ready/);
  const slider = page.getByRole('slider', { name: 'Triangles', exact: true });
  const all = Number(await slider.getAttribute('max'));
  for (const share of [0.5, 0.1]) {
    await slider.fill(String(Math.round(all * share)));
    await status(/^Ready\. Showing/);
  }
  // Everything that makes lines, and both sides.
  for (const key of ['s', 'w', 'e']) await page.keyboard.press(key);
  await page.locator('.legend').waitFor(WAIT);
  for (const key of ['e', 'w', 's']) await page.keyboard.press(key);
  await page.getByRole('radio', { name: 'Fast' }).check();
  const [saved] = await Promise.all([page.waitForEvent('download', WAIT), page.getByRole('button', { name: 'Download', exact: true }).click()]);
  await saved.delete();
}

const { url, browser, close } = await startPage(site, ['--enable-blink-features=ForceEagerMeasureMemory']);
const problems = [];
try {
  const page = await (await browser.newContext({ viewport: { width: 1100, height: 760 }, reducedMotion: 'reduce', serviceWorkers: 'block' })).newPage();
  page.setDefaultTimeout(WAIT.timeout);
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.addInitScript(openViewWorker);
  await page.route('**/dropped.glb', (route) => route.fulfill({ body: bytes }));
  await page.goto(url);
  const worker = await viewWorkerOf(page);
  const heap = await heapMeter(page);
  console.log(`${basename(path)}, ${bytes.length} bytes, ${rounds} rounds`);
  let base;
  let last;
  for (let number = 1; number <= rounds; number += 1) {
    await round(page, number);
    const { total, parts } = await memoryOf(page);
    const card = await worker.evaluate(() => globalThis.liveObjects());
    last = { memory: total, ...card };
    // A snapshot takes memory itself: after the rest.
    if (number === BASE || number === rounds) last.heap = await heap();
    if (number === BASE) base = last;
    if (number <= BASE || number % 5 === 0) {
      console.log(`round ${String(number).padStart(2)}: ${(total / 1e6).toFixed(1).padStart(6)} MB memory   ${String(card.buffers).padStart(4)} buffers   ${(card.bufferBytes / 1e6).toFixed(2).padStart(6)} MB in them   ${String(card.textures).padStart(3)} textures   ${card.programs} programs   ${card.vertexArrays} vertex arrays`);
    }
    if (last.heap !== undefined) console.log(`          ${(last.heap / 1e6).toFixed(2)} MB alive on the JavaScript heaps without compiled code`);
    if (process.env.PARTS !== undefined && number % 5 === 0) for (const part of parts) console.log('   ', ...part);
  }
  for (const [name, value] of Object.entries(last)) {
    if (base !== undefined && value > base[name] * TOLERANCE) problems.push(`${name} went from ${base[name]} in round ${BASE} to ${value} in round ${rounds}`);
  }
} finally {
  await close();
}
for (const problem of problems) console.log(problem);
if (problems.length > 0) process.exitCode = 1;
else console.log(`Within ${Math.round(100 * (TOLERANCE - 1))} % of round ${BASE}.`);
