// A page for tests of what is beside the view: found by role and name, and where wished without a picture, which takes
// a processor most of its time.
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';

/** A page with what it complained about. */
export interface PanelPage {
  readonly page: Page;
  /** Errors of the console and of scripts. */
  readonly problems: string[];
  /** Waits until the live region says what matches. */
  status(text: RegExp): Promise<void>;
}

export const LONG = { timeout: 50_000 };

/** Opens `address`; `picture: false` takes WebGL away, and puts the notice about that away. */
export async function openPanelPage(
  browser: Browser,
  address: string,
  { picture = false, ...options }: BrowserContextOptions & { picture?: boolean } = {},
): Promise<PanelPage> {
  const context = await browser.newContext({
    viewport: { width: 1280, height: 900 }, reducedMotion: 'reduce', permissions: ['clipboard-read', 'clipboard-write'], ...options,
  });
  const page = await context.newPage();
  const problems: string[] = [];
  page.setDefaultTimeout(LONG.timeout);
  page.on('console', (message) => {
    // three says itself that there is no WebGL.
    if (message.type() === 'error' && !(!picture && message.text().includes('WebGL'))) problems.push(message.text());
  });
  page.on('pageerror', (error) => problems.push(String(error)));
  if (!picture) {
    await page.addInitScript(() => {
      Reflect.deleteProperty(HTMLCanvasElement.prototype, 'transferControlToOffscreen');
      HTMLCanvasElement.prototype.getContext = () => null;
      new MutationObserver(() => {
        const notice = [...document.querySelectorAll('.notice')].find(({ textContent }) => textContent?.includes('no-webgl'));
        notice?.querySelector('button')?.click();
      }).observe(document, { childList: true, subtree: true });
    });
  }
  await page.goto(address);
  return { page, problems, status: (text) => page.locator('p[role=status]').filter({ hasText: text }).waitFor({ ...LONG, state: 'attached' }) };
}
