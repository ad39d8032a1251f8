// Textures in a browser, where the canvas encodes them: in the page itself and in the package's worker.
import { readFileSync } from 'node:fs';
import { afterAll, beforeAll, expect, it } from 'vitest';
import type * as Package from 'decimesh';
import type * as WorkerPackage from 'decimesh/worker';
import { at } from '../scripts/project.mjs';
import { startPage } from './support/browser.mjs';
import { gltfErrors } from './support/validate.ts';

const PAGE = `<!doctype html><script type="module">
  import * as page from '/index.js';
  import * as worker from '/worker/client.js';
  globalThis.packages = { page, worker };
</script>`;

declare const packages: { page: typeof Package; worker: typeof WorkerPackage };

let served: Awaited<ReturnType<typeof startPage>>;

beforeAll(async () => {
  served = await startPage(at('dist'));
});

afterAll(() => served.close());

it.each(['page', 'worker'])('become WebP of the size asked for, in the %s', async (place) => {
  const page = await served.browser.newPage();
  const problems: string[] = [];
  page.on('console', (message) => {
    if (message.type() === 'error') problems.push(message.text());
  });
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.route('**/blank.html', (route) => route.fulfill({ contentType: 'text/html', body: PAGE }));
  await page.goto(`${served.url}blank.html`);
  const model = readFileSync(at('www', 'samples', 'flight-helmet.glb')).toString('base64');
  const { base64, before, after } = await page.evaluate(
    async ([content, kind]) => {
      const bytes = Uint8Array.from(atob(content as string), (character) => character.charCodeAt(0));
      const prepare = { textures: { maxSize: 64, format: 'webp', quality: 0.7 }, dedup: true, prune: true } as const;
      const document = kind === 'page' ? await packages.page.openDocument(bytes) : await packages.worker.createWorkerClient().openDocument(bytes);
      const written = await document.write({ prepare });
      return {
        base64: btoa(Array.from(written.bytes, (byte) => String.fromCharCode(byte)).join('')),
        before: written.report.input.parts.textures,
        after: written.report.output.parts.textures,
      };
    },
    [model, place],
  );
  expect(after).toBeLessThan(0.5 * before);
  const bytes = new Uint8Array(Buffer.from(base64, 'base64'));
  expect(await gltfErrors(bytes)).toEqual([]);
  expect(Buffer.from(bytes).includes('"image/webp"')).toBe(true);
  await page.close();
  expect(problems).toEqual([]);
});
