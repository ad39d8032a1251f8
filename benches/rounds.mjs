// Whether the page gives back what it took: open, simplify, look, export, and open again, many times over.
//
//     node benches/rounds.mjs [MODEL.glb] [--rounds N] [--interpreted] [--site DIRECTORY]
//
// Without a model the bundled desk fan, with its textures, skins and animations; opening it closes the one before. After
// the first five rounds and every fifth the memory of the page and all of its workers is asked for (JavaScript and
// WebAssembly, after a garbage collection), and what is alive on the graphics card is counted where they are made; in
// round 5 and at the end all that is alive on the JavaScript heaps but compiled code, of which the engine makes more the
// longer something runs: how much more is told. With --interpreted it compiles nothing, and what grows then is the
// page's. The page is driven by a few lines of its own: a test tool's script would run in it and be counted, too.
// The exit code is 1 when any of them is more than a tenth above that of round 5 at the end.

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
const interpreted = options.includes('--interpreted');
if (interpreted) options.splice(options.indexOf('--interpreted'), 1);
const site = resolve(option('--site', at('site')));
const path = options[0] ?? at('www', 'samples', 'desk-fan.glb');
const bytes = readFileSync(path);

/** Bytes by the browser's own account, of the page with its workers. */
async function memoryOf(run) {
  const { bytes: total, breakdown } = await run('performance.measureUserAgentSpecificMemory()');
  return { total, parts: breakdown.filter((part) => part.bytes > 0).map((part) => [part.bytes, part.types.join(' '), part.attribution.map(({ scope, url: address }) => `${scope} ${address.split('/').pop()}`).join(' ')]) };
}

/** The user's part of a round, for the page: `globalThis.user`, whose functions resolve when the page has followed. */
function addUser() {
  const until = async (look) => {
    const end = performance.now() + 120_000;
    for (; !look(); await new Promise((done) => setTimeout(done, 20))) if (performance.now() > end) throw new Error(`waited in vain: ${look}`);
  };
  const text = (place) => document.querySelector(place)?.textContent ?? '';
  const press = (key) => document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
  globalThis.user = {
    async drop(name) {
      // Fetched: what is handed over by the debugging protocol stays in the browser's memory.
      const transfer = new DataTransfer();
      transfer.items.add(new File([await (await fetch('dropped.glb')).blob()], `${name}.glb`));
      document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
      // The status may still be the last round's: the name tells them apart.
      await until(() => text('.model-name') === name && text('[role=status]').startsWith('Ready'));
    },
    async slide(share) {
      const slider = document.querySelector('input[type=range]');
      const before = text('[role=status]');
      slider.value = Math.round(slider.max * share);
      slider.dispatchEvent(new Event('input', { bubbles: true }));
      slider.dispatchEvent(new Event('change', { bubbles: true }));
      await until(() => text('[role=status]').startsWith('Ready. Showing') && text('[role=status]') !== before);
    },
    /** Everything that makes lines, and both sides. */
    async look() {
      for (const key of ['s', 'w', 'e']) press(key);
      await until(() => /\d/.test(text('.legend')));
      for (const key of ['e', 'w', 's']) press(key);
    },
    save() {
      document.querySelector('input[type=radio][value=fast]').click();
      [...document.querySelectorAll('button')].find((button) => button.textContent === 'Download').click();
    },
  };
}

async function round(page, run, number) {
  await run(`user.drop('round-${number}')`);
  for (const share of [0.5, 0.1]) await run(`user.slide(${share})`);
  await run('user.look()');
  const [saved] = await Promise.all([page.waitForEvent('download', WAIT), run('user.save()')]);
  await saved.delete();
}

const { url, browser, close } = await startPage(site, ['--enable-blink-features=ForceEagerMeasureMemory', ...(interpreted ? ['--js-flags=--no-sparkplug --no-maglev --no-turbofan'] : [])]);
const problems = [];
try {
  const page = await (await browser.newContext({ viewport: { width: 1100, height: 760 }, reducedMotion: 'reduce', serviceWorkers: 'block' })).newPage();
  page.setDefaultTimeout(WAIT.timeout);
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.addInitScript(openViewWorker);
  await page.addInitScript(addUser);
  await page.route('**/dropped.glb', (route) => route.fulfill({ body: bytes }));
  await page.goto(url);
  const worker = await viewWorkerOf(page);
  const session = await page.context().newCDPSession(page);
  const run = async (expression) => {
    const { result, exceptionDetails } = await session.send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails !== undefined) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  const heap = await heapMeter(page);
  console.log(`${basename(path)}, ${bytes.length} bytes, ${rounds} rounds`);
  let base;
  let last;
  for (let number = 1; number <= rounds; number += 1) {
    await round(page, run, number);
    // Asking is work, too.
    if (number > BASE && number % 5 !== 0 && number !== rounds) continue;
    const { total, parts } = await memoryOf(run);
    const card = await worker.evaluate(() => globalThis.liveObjects());
    last = { memory: total, ...card };
    // A snapshot takes memory itself: after the rest.
    const alive = number === BASE || number === rounds ? await heap() : null;
    if (alive !== null) last.heap = alive.rest;
    if (number === BASE) base = last;
    console.log(`round ${String(number).padStart(2)}: ${(total / 1e6).toFixed(2).padStart(6)} MB memory   ${String(card.buffers).padStart(4)} buffers   ${(card.bufferBytes / 1e6).toFixed(2).padStart(6)} MB in them   ${String(card.textures).padStart(3)} textures   ${card.programs} programs   ${card.vertexArrays} vertex arrays`);
    if (alive !== null) console.log(`          ${(alive.rest / 1e6).toFixed(2)} MB alive on the JavaScript heaps without compiled code, and ${(alive.code / 1e6).toFixed(2)} MB of that`);
    if (process.env.PARTS !== undefined) for (const part of parts) console.log('   ', ...part);
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
