// What the tests of the page share: the page served and a browser for each file, a page for each test that must not complain.
import { readFileSync } from 'node:fs';
import type { BrowserContextOptions, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect } from 'vitest';
import { at } from '../../scripts/project.mjs';
import { startPage } from './browser.mjs';
import { makeGroundPlain } from './picture.ts';

/** For what takes long on two busy cores; less than a test may take, so that it is told what was waited for. */
export const LONG = { timeout: 50_000 };

const OFTEN = { ...LONG, polling: 10 };

/** How to open a page; what a browser's context takes goes there. */
export interface PageOptions extends BrowserContextOptions {
  /** What follows the address. Default: nothing. */
  readonly path?: string;
  /** Runs in the page before its own scripts. */
  readonly before?: () => void;
  /** `false` takes WebGL away, which takes a processor most of its time, and puts the notice about that away. Default: true. */
  readonly picture?: boolean;
  /** For pictures that are compared byte for byte. Default: false. */
  readonly plainGround?: boolean;
}

/** The pages of one file of tests. */
export interface Pages {
  /** Where the page is served. */
  readonly url: string;
  /** Opens a page in a context of its own; it is closed after the test. One for each test. */
  open(options?: PageOptions): Promise<Page>;
  /** Waits until the live region says what matches; also while a sheet hides it. */
  status(text: RegExp): Promise<void>;
  /**
   * Waits until an element that `selector` matches has text that matches. Looks every few milliseconds: what is there only
   * while work lasts may come and go between two looks of a locator, which are up to half a second apart.
   */
  glimpse(selector: string, text?: RegExp): Promise<void>;
  /** Complaints so far that contain `text` were to be expected. */
  forgive(text: string): void;
}

/**
 * Serves `directory` (default: site/) for the tests of the file that calls this, and closes everything after them. A test
 * in which the page wrote an error to the console, or threw one, fails. `defaults` are for every page.
 */
export function usePages({ directory, ...defaults }: PageOptions & { readonly directory?: string } = {}): Pages {
  let served: Awaited<ReturnType<typeof startPage>>;
  let page: Page | undefined;
  let problems: string[] = [];

  beforeAll(async () => {
    served = await startPage(directory);
  });
  afterAll(() => served?.close());
  afterEach(async () => {
    await page?.context().close();
    page = undefined;
    const found = problems;
    problems = [];
    expect(found).toEqual([]);
  });

  async function glimpse(selector: string, { source, flags } = /(?:)/): Promise<void> {
    const opened = page as Page;
    await opened.waitForFunction(isThere, [selector, source, flags] as const, OFTEN).catch(async (cause: unknown) => {
      const texts = await opened.locator(selector).allTextContents();
      throw new Error(`no ${selector} with /${source}/ came; at last there were ${JSON.stringify(texts)}`, { cause });
    });
  }

  return {
    get url() {
      return served.url;
    },
    async open(options = {}) {
      const { path = '', before, picture = true, plainGround = false, ...context } = { ...defaults, ...options };
      page = await (await served.browser.newContext({ reducedMotion: 'reduce', ...context })).newPage();
      page.setDefaultTimeout(LONG.timeout);
      page.on('console', (message) => {
        // three says itself that there is no WebGL.
        if (message.type() === 'error' && !(!picture && message.text().includes('WebGL'))) problems.push(message.text());
      });
      page.on('pageerror', (error) => problems.push(String(error)));
      if (plainGround) await makeGroundPlain(page);
      if (!picture) await page.addInitScript(takeWebGLAway);
      if (before !== undefined) await page.addInitScript(before);
      await page.goto(served.url + path);
      return page;
    },
    status: (text) => glimpse('p[role=status]', text),
    glimpse,
    forgive(text) {
      problems = problems.filter((problem) => !problem.includes(text));
    },
  };
}

/** In the page. */
function isThere([selector, source, flags]: readonly [string, string, string]): boolean {
  const wanted = new RegExp(source, flags);
  return [...document.querySelectorAll(selector)].some(({ textContent }) => wanted.test((textContent ?? '').replace(/\s+/g, ' ').trim()));
}

function takeWebGLAway(): void {
  Reflect.deleteProperty(HTMLCanvasElement.prototype, 'transferControlToOffscreen');
  HTMLCanvasElement.prototype.getContext = () => null;
  new MutationObserver(() => {
    const notice = [...document.querySelectorAll('.notice')].find(({ textContent }) => textContent?.includes('no-webgl'));
    notice?.querySelector('button')?.click();
  }).observe(document, { childList: true, subtree: true });
}

/** A file to be dropped: the sample of this name that the page offers. */
export const sample = (name: string): { readonly name: string; readonly bytes: Buffer } =>
  ({ name, bytes: readFileSync(at('www', 'samples', name)) });
