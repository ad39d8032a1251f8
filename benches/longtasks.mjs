// Whether the page stays responsive with a large model: long tasks while it loads, simplifies and follows the slider.
//
//     node benches/longtasks.mjs [MODEL.glb|MODEL.obj] [--site DIRECTORY] [--limit MILLISECONDS]
//
// Without a model one of 1,120,000 triangles is made of the bundled scan, subdivided twice with seeded noise. The
// exit code is 1 when a task was longer than the limit (default 50 ms) or cancelling took longer than 100 ms.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join, resolve } from 'node:path';
import { startPage } from '../tests/support/browser.mjs';
import { at } from '../scripts/project.mjs';
import { readFirstPrimitive, subdivide, writeGlb } from './support/subdivide.mjs';

const CANCEL_LIMIT = 100;
const SLIDER_MOVES = 30;
const WAIT = { timeout: 300_000 };

const options = process.argv.slice(2);
const option = (name, otherwise) => (options.includes(name) ? options.splice(options.indexOf(name), 2)[1] : otherwise);
const limit = Number(option('--limit', '50'));
const site = resolve(option('--site', at('site')));
const directory = mkdtempSync(join(tmpdir(), 'decimesh-'));

function makeModel() {
  const path = join(directory, 'large.glb');
  const small = readFirstPrimitive(readFileSync(at('www', 'samples', 'nefertiti.glb')));
  writeFileSync(path, writeGlb(subdivide(small, 2)));
  return path;
}

/** Gathers tasks of more than 50 ms from the page's first moment on, each with the time it started. */
const observe = (page) =>
  page.addInitScript(() => {
    globalThis.longTasks = [];
    new PerformanceObserver((list) => {
      for (const { startTime, duration } of list.getEntries()) globalThis.longTasks.push({ startTime, duration });
    }).observe({ type: 'longtask', buffered: true });
  });

/** Runs `act` and tells how long it took and which long tasks fell into it. */
async function phase(page, title, act) {
  // A page that is still to be loaded starts at 0.
  const from = page.url() === 'about:blank' ? 0 : await page.evaluate(() => performance.now());
  await act();
  // Entries are delivered after their task: two frames later they are there.
  const [to, tasks] = await page.evaluate(async (start) => {
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50))));
    return [performance.now(), globalThis.longTasks.filter((task) => task.startTime >= start)];
  }, from);
  const longest = Math.max(0, ...tasks.map((task) => task.duration));
  console.log(`${title.padEnd(34)} ${((to - from) / 1000).toFixed(2).padStart(7)} s   long tasks ${String(tasks.length).padStart(2)}   longest ${longest.toFixed(0).padStart(4)} ms`);
  return longest;
}

const { url, browser, close } = await startPage(site);
let longest = 0;
let cancelTime = 0;
try {
  const model = options[0] ?? makeModel();
  console.log(`${basename(model)}, ${readFileSync(model).length} bytes`);
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page.on('pageerror', (error) => console.error(error));
  await observe(page);
  const status = page.getByRole('status');
  const slider = page.getByRole('slider', { name: 'Triangles', exact: true });
  const measure = async (title, act) => { longest = Math.max(longest, await phase(page, title, act)); };

  // Not held to the limit: the browser's own first layout is in it.
  await phase(page, 'loading the page', () => page.goto(url, { waitUntil: 'networkidle' }));
  await measure('opening, simplifying, cancelled', async () => {
    // From the key to the word on the page, by the page's own clock: asking from here could come too late.
    const cancelling = page.evaluate(async () => {
      const seen = (test) => new Promise((done) => {
        const observer = new MutationObserver(() => {
          if (!test()) return;
          observer.disconnect();
          done();
        });
        observer.observe(document.body, { childList: true, characterData: true, subtree: true, attributes: true });
      });
      const saying = (pattern) => pattern.test(document.querySelector('[role=status]').textContent);
      await seen(() => saying(/^Simplifying/) && Number(document.querySelector('[role=progressbar]')?.getAttribute('aria-valuenow')) >= 10);
      const start = performance.now();
      dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape', bubbles: true }));
      await seen(() => saying(/^Cancelled/));
      return performance.now() - start;
    });
    await page.setInputFiles('input[type=file]', model);
    cancelTime = await cancelling;
  });
  console.log(`cancelled after ${cancelTime.toFixed(0)} ms`);
  await measure('simplifying again, to the end', async () => {
    await slider.focus();
    await page.keyboard.press('PageDown');
    await status.filter({ hasText: /^Ready\. Showing/ }).waitFor(WAIT);
  });
  await measure(`${SLIDER_MOVES} slider moves and the file`, async () => {
    for (let move = 0; move < SLIDER_MOVES; move += 1) await page.keyboard.press(move % 2 ? 'ArrowLeft' : 'ArrowRight');
    await page.keyboard.press('PageDown');
    await page.locator('.mesh-stats .pending').first().waitFor({ ...WAIT, state: 'detached' });
  });
  await measure('full detail again', async () => {
    await page.keyboard.press('End');
    await status.filter({ hasText: /^Ready\. [\d,]+ triangles/ }).waitFor(WAIT);
  });
} finally {
  await close();
  rmSync(directory, { recursive: true, force: true });
}
if (longest > limit || cancelTime > CANCEL_LIMIT) {
  console.log(`Too slow: the longest task took ${longest.toFixed(0)} ms (limit ${limit}), cancelling ${cancelTime.toFixed(0)} ms (limit ${CANCEL_LIMIT}).`);
  process.exitCode = 1;
}
