// What a move of the slider costs with a large model, part by part, in Chromium: the level, its arrays, their upload.
//
//     node benches/slider.mjs [MODEL.glb]
//
// Without a model one of 1,120,000 triangles is made of the bundled scan, as for longtasks.mjs. 200 seeded positions,
// evenly spread over all triangle counts. Drawing is left out: without a graphics card it would measure the processor.

import { readFileSync } from 'node:fs';
import { at } from '../scripts/project.mjs';
import { startPage } from '../tests/support/browser.mjs';
import { median } from './support/statistics.mjs';
import { readFirstPrimitive, seededRandom, subdivide, writeGlb } from './support/subdivide.mjs';

const MOVES = 200;
const FRAME = 20;

const makeModel = () => writeGlb(subdivide(readFirstPrimitive(readFileSync(at('www', 'samples', 'nefertiti.glb'))), 2));

const [path] = process.argv.slice(2);
const model = path === undefined ? makeModel() : readFileSync(path);
const random = seededRandom(7);
const positions = Array.from({ length: MOVES }, () => random());
const { url, browser, close } = await startPage(at('dist'));
try {
  const page = await browser.newPage();
  page.on('pageerror', (error) => console.error(error));
  await page.route('**/bench.html', (route) => route.fulfill({ contentType: 'text/html', body: '<!doctype html><canvas></canvas>' }));
  await page.route('**/model.glb', (route) => route.fulfill({ body: Buffer.from(model) }));
  await page.goto(new URL('bench.html', url).href);
  const { triangles, ready, moves } = await page.evaluate(async (shares) => {
    const { createWorkerClient } = await import(new URL('worker/client.js', location.href).href);
    const document = await createWorkerClient().openDocument(await (await fetch('model.glb')).arrayBuffer());
    const began = performance.now();
    await document.simplify();
    const ready = performance.now() - began;
    const gl = globalThis.document.querySelector('canvas').getContext('webgl2');
    const moves = [];
    for (const share of shares) {
      const start = performance.now();
      await document.level({ triangles: Math.round(share * document.summary.triangles) });
      const selected = performance.now();
      const { groups, wedgeSets } = await document.geometry();
      const copied = performance.now();
      const buffers = [];
      const upload = (target, array) => {
        const buffer = gl.createBuffer();
        gl.bindBuffer(target, buffer);
        gl.bufferData(target, array, gl.STATIC_DRAW);
        buffers.push(buffer);
      };
      for (const { indices } of groups) upload(gl.ELEMENT_ARRAY_BUFFER, indices);
      for (const { positions, attributes } of wedgeSets) {
        upload(gl.ARRAY_BUFFER, positions);
        for (const { values } of Object.values(attributes)) upload(gl.ARRAY_BUFFER, values);
      }
      gl.finish();
      const uploaded = performance.now();
      for (const buffer of buffers) gl.deleteBuffer(buffer);
      moves.push({ level: selected - start, arrays: copied - selected, upload: uploaded - copied, whole: uploaded - start });
    }
    return { triangles: document.summary.triangles, ready, moves };
  }, positions);
  console.log(`${triangles} triangles, recorded and indexed in ${(ready / 1000).toFixed(1)} s; ${MOVES} moves, milliseconds`);
  for (const part of ['level', 'arrays', 'upload', 'whole']) {
    const times = moves.map((move) => move[part]).sort((a, b) => a - b);
    const late = times[Math.floor(0.95 * times.length)];
    console.log(`${part.padEnd(8)} median ${median(times).toFixed(1).padStart(6)}   95 % ${late.toFixed(1).padStart(6)}   longest ${times.at(-1).toFixed(1).padStart(6)}`);
  }
  const whole = median(moves.map((move) => move.whole));
  console.log(`median of the whole ${whole <= FRAME ? 'met' : 'missed'}: ${whole.toFixed(1)} ms, at most ${FRAME}`);
} finally {
  await close();
}
