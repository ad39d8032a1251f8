// Starts Chromium on a served page, for the page tests and the page benchmark.
import { chromium } from 'playwright-core';
import { serve } from '../../scripts/serve.mjs';
import { at } from '../../scripts/project.mjs';

/** WebGL in software, so that it is there without a graphics card; and nothing that phones home. */
const BROWSER_ARGUMENTS = [
  '--no-sandbox',
  '--headless=new',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--no-first-run',
];

/** Chromium from the environment variable CHROMIUM, or where Debian puts it; `more` are further arguments for it. */
export const launchBrowser = (more = []) =>
  chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: [...BROWSER_ARGUMENTS, ...more] });

/**
 * Serves the built page and starts a browser; resolves to `{ url, browser, close }`.
 *
 * `directory` (default: site/) is the built page, `more` are arguments for the browser.
 */
export async function startPage(directory = at('site'), more = []) {
  const server = await serve(directory, 0);
  const browser = await launchBrowser(more).catch(async (error) => {
    await server.close();
    throw error;
  });
  return {
    url: server.url,
    browser,
    close: async () => {
      await browser.close();
      await server.close();
    },
  };
}

/**
 * Lets the user of `page` drop files on the window, as the browser does it: real File objects in a DataTransfer.
 *
 * `files` is a list of `{ name, bytes }`; they are held over the window for `hover` milliseconds.
 */
export async function dropFiles(page, files, hover = 0) {
  const transfer = await page.evaluateHandle((list) => {
    const data = new DataTransfer();
    for (const { name, base64 } of list) {
      const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
      data.items.add(new File([bytes], name));
    }
    return data;
  }, files.map(({ name, bytes }) => ({ name, base64: Buffer.from(bytes).toString('base64') })));
  await page.dispatchEvent('body', 'dragenter', { dataTransfer: transfer });
  await page.dispatchEvent('body', 'dragover', { dataTransfer: transfer });
  if (hover > 0) await page.waitForTimeout(hover);
  await page.dispatchEvent('body', 'drop', { dataTransfer: transfer });
  await transfer.dispose();
}
