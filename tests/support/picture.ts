// Pictures of the view that can be compared byte for byte: the software renderer draws the same one every time.
import type { Page } from 'playwright-core';

/** What of the page is in a picture, in CSS pixels. */
export interface Clip {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/**
 * Gives the page, before it is opened, a ground of one colour: browsers dither a gradient, and what they paint anew may
 * differ from what was there before by 1 of 255.
 */
export const makeGroundPlain = (page: Page): Promise<unknown> =>
  page.addInitScript(() => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync('body { background: var(--paper) !important }');
    document.adoptedStyleSheets.push(sheet);
  });

/** What is on screen this moment; the view may be on its way to something else. */
export const pictureNow = (page: Page, clip: Clip): Promise<Buffer> => page.screenshot({ clip });

/** Waits until the view shows what the page was told last, and rests; for ever where something goes on moving. */
export async function untilStill(page: Page): Promise<void> {
  // What the page has been told last is laid out and passed on to the view.
  await page.evaluate(() => new Promise<void>((done) => {
    requestAnimationFrame(() => requestAnimationFrame(() => done()));
  }));
  await page.locator('#view[data-still]').waitFor({ state: 'attached' });
}

/** What the view comes to rest at. */
export async function stillPicture(page: Page, clip: Clip): Promise<Buffer> {
  await untilStill(page);
  return pictureNow(page, clip);
}
