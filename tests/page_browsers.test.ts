// The main journey in browsers that are no Chromium: open a sample, ask for fewer triangles, save.
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { at } from '../scripts/project.mjs';
import { serve } from '../scripts/serve.mjs';
import { MISSING, startFirefox, startWebKit, type OtherBrowser } from './support/other_browsers.ts';

let server: Awaited<ReturnType<typeof serve>>;
beforeAll(async () => {
  server = await serve(at('site'), 0);
});
afterAll(() => server?.close());

/** Waits in the page until the live region says what matches. */
const STATUS = `
  const status = async (text) => {
    for (let tries = 0; tries < 900; tries += 1) {
      const now = document.querySelector('[role=status]')?.textContent ?? '';
      if (text.test(now)) return now;
      await new Promise((resolve) => setTimeout(resolve, 100));
    }
    throw new Error('the status is: ' + document.querySelector('[role=status]')?.textContent + ' ' + document.querySelector('[role=alert]')?.textContent);
  };`;

const STARTS = { Firefox: startFirefox, WebKitGTK: startWebKit } as const;

describe.each(['Firefox', 'WebKitGTK'] as const)('%s', (name) => {
  const missing = MISSING[name];
  if (missing !== undefined) console.warn(`SKIPPED: ${name} is not tested: ${missing}`);

  it.skipIf(missing !== undefined)('opens a sample, goes to a tenth, and saves it', async () => {
    const browser: OtherBrowser = await STARTS[name]();
    try {
      await browser.navigate(server.url);
      const opened = await browser.run(`${STATUS}
        globalThis.faults = [];
        addEventListener('error', ({ message }) => faults.push(message));
        while (document.querySelectorAll('.samples button').length < 2) await new Promise((resolve) => setTimeout(resolve, 50));
        document.querySelectorAll('.samples button')[1].click();
        return status(/^Ready/);`);
      expect(opened).toBe('Ready. 21,080 triangles.');
      const shown = await browser.run(`${STATUS}
        document.querySelector('button[aria-label="Keep 10 %"]').click();
        return status(/^Ready\\. Showing/);`);
      expect(shown).toMatch(/^Ready\. Showing (2,1\d\d|2,0\d\d) of 21,080 triangles\.$/);
      const saved = await browser.run(`${STATUS}
        const blobs = [];
        const make = URL.createObjectURL;
        URL.createObjectURL = (blob) => (blobs.push(blob), make.call(URL, blob));
        HTMLAnchorElement.prototype.click = function () { blobs.push(this.download); };
        [...document.querySelectorAll('button')].find(({ textContent }) => textContent === 'Download').click();
        await status(/^Saved/);
        const head = new Uint8Array(await blobs[0].slice(0, 4).arrayBuffer());
        return [blobs[1], String.fromCharCode(...head), blobs[0].size < 1500000, faults.join()].join(' ');`);
      expect(saved).toBe('desk-fan.glb glTF true ');
    } finally {
      await browser.close();
    }
  }, 300_000);
});
