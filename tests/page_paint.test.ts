// Protection by painting, as people do it: by pointer, by keyboard and by finger; what it does to the result, undone too.
import type { Page } from 'playwright-core';
import { beforeAll, describe, expect, it } from 'vitest';
import { openDocument } from 'decimesh';
import { violationsOf } from './support/axe.ts';
import { dropFiles } from './support/browser.mjs';
import { LONG, sample, usePages, type PageOptions } from './support/pages.ts';
import { pictureNow, stillPicture, untilStill } from './support/picture.ts';

const fan = sample('desk-fan.glb');
/** Of so few triangles that pictures and runs are quick. */
let nefertiti: { name: string; bytes: Uint8Array };

const pages = usePages({ viewport: { width: 1100, height: 760 }, serviceWorkers: 'block', plainGround: true });
const { status } = pages;
let page: Page;

beforeAll(async () => {
  using document = await openDocument(new Uint8Array(sample('nefertiti.glb').bytes));
  await document.simplify({ triangles: 14_000 });
  nefertiti = { name: 'nefertiti.glb', bytes: (await document.write({ format: 'glb' })).bytes };
});

async function openPage(model: { name: string; bytes: Uint8Array }, options: PageOptions = {}): Promise<void> {
  page = await pages.open(options);
  await dropFiles(page, [model]);
  // In any language: the levels are there.
  await page.locator('.lod-marks button').first().waitFor();
  if (options.locale === undefined) await status(/^Ready/);
}

const slider = () => page.getByRole('slider', { name: 'Triangles', exact: true });
const bar = () => page.getByRole('region', { name: 'Protect by painting' });
const tool = () => page.getByRole('button', { name: 'Protect by painting' });
const view = () => page.getByRole('application');
/** By the button; its code is fetched when it is asked for first, and until then a drag turns the model. */
async function takeBrush(): Promise<void> {
  await tool().click();
  await bar().waitFor();
}
const undo = () => page.getByRole('button', { name: 'Undo', exact: true });
const redo = () => page.getByRole('button', { name: 'Redo', exact: true });
const strength = (tenths: number) => bar().getByRole('slider', { name: 'Strength' }).fill(String(tenths));

/** Vertices that the page says are painted. */
async function painted(): Promise<number> {
  const text = await bar().locator('.paint-count').innerText();
  return Number(/^[\d,]+/.exec(text)?.[0].replaceAll(',', '') ?? 0);
}

async function drag(from: readonly [number, number], to: readonly [number, number], options: { button?: 'left' | 'right' } = {}): Promise<void> {
  await page.mouse.move(...from);
  await page.mouse.down(options);
  for (let step = 1; step <= 5; step += 1) await page.mouse.move(from[0] + ((to[0] - from[0]) * step) / 5, from[1] + ((to[1] - from[1]) * step) / 5);
  await page.mouse.up(options);
}

const AREA = { x: 440, y: 190, width: 220, height: 240 };
// Without the brush's ring.
const picture = async (): Promise<Buffer> => {
  await page.mouse.move(900, 220);
  return pictureNow(page, AREA);
};

async function stablePicture(): Promise<Buffer> {
  await page.mouse.move(900, 220);
  return stillPicture(page, AREA);
}

describe('the brush', () => {
  it('paints by dragging, erases, and each stroke is one step of undo', async () => {
    await openPage(nefertiti);
    await page.keyboard.press('b');
    await bar().waitFor();
    expect(await tool().getAttribute('aria-pressed')).toBe('true');
    expect(await view().getAttribute('aria-label')).toMatch(/Space paints/);
    const plain = await stablePicture();
    await drag([520, 260], [580, 280]);
    await expect.poll(painted, LONG).toBeGreaterThan(200);
    const first = await painted();
    const withPaint = await stablePicture();
    expect(withPaint.equals(plain)).toBe(false);
    await drag([520, 340], [580, 350]);
    await expect.poll(painted, LONG).toBeGreaterThan(first);
    const second = await painted();

    await bar().getByRole('radio', { name: 'Erase' }).check();
    await strength(10);
    await drag([500, 260], [600, 290]);
    await expect.poll(painted, LONG).toBeLessThan(second);

    for (const count of [second, first, 0]) {
      await undo().click();
      await expect.poll(painted, LONG).toBe(count);
    }
    expect(await undo().isDisabled()).toBe(true);
    expect((await stablePicture()).equals(plain)).toBe(true);
    await redo().click();
    await expect.poll(painted, LONG).toBe(first);
    expect((await stablePicture()).equals(withPaint)).toBe(true);
  });

  it('is put down with its paint, which is cleared as a step of its own', async () => {
    await openPage(nefertiti);
    await takeBrush();
    await drag([520, 260], [580, 280]);
    await expect.poll(painted, LONG).toBeGreaterThan(200);
    const first = await painted();
    const withPaint = await stablePicture();
    await bar().getByRole('button', { name: 'Clear' }).click();
    await expect.poll(painted, LONG).toBe(0);
    expect(await bar().getByRole('button', { name: 'Clear' }).isDisabled()).toBe(true);
    await undo().click();
    await expect.poll(painted, LONG).toBe(first);
    await page.keyboard.press('Escape');
    await bar().waitFor({ state: 'detached' });
    // Taken up again, the paint is there.
    await takeBrush();
    await expect.poll(painted, LONG).toBe(first);
    expect((await stablePicture()).equals(withPaint)).toBe(true);
  });

  it('keeps what is painted with full strength', async () => {
    await openPage(nefertiti);
    const fewest = async (): Promise<number> => {
      await slider().focus();
      await page.keyboard.press('Home');
      await status(/^Ready\. Showing/);
      return Number((await page.getByRole('textbox', { name: 'Exact triangle count' }).inputValue()).replace(/\D/g, ''));
    };
    const before = await fewest();
    await takeBrush();
    await strength(10);
    await drag([520, 260], [580, 280]);
    await expect.poll(painted, LONG).toBeGreaterThan(200);
    const locked = await painted();
    await status(/^Ready/);
    await bar().getByRole('button', { name: 'Done' }).click();
    // Of every triangle with three locked corners nothing goes: about two for a vertex, but those at the rim.
    await expect.poll(fewest, LONG).toBeGreaterThan(before + 0.5 * locked);
  });

  it('spends more triangles where it has painted with less than full strength', async () => {
    await openPage(nefertiti);
    await slider().fill('2000');
    await status(/^Ready\. Showing/);
    await page.keyboard.press('w');
    const even = await stablePicture();
    await takeBrush();
    await strength(6);
    await drag([520, 260], [580, 280]);
    await expect.poll(painted, LONG).toBeGreaterThan(200);
    await page.keyboard.press('Escape');
    await status(/^Ready\. Showing/);
    const uneven = await stablePicture();
    expect(uneven.equals(even)).toBe(false);
    expect(await page.getByRole('textbox', { name: 'Exact triangle count' }).inputValue()).toBe('2,000');
    await undo().click();
    await expect.poll(async () => (await picture()).equals(even), LONG).toBe(true);
  });

  it('goes by keyboard alone', async () => {
    await openPage(nefertiti);
    await page.keyboard.press('b');
    await bar().waitFor();
    // The bar moves what is seen, and the brush with it.
    await untilStill(page);
    expect(await view().evaluate((element) => element === document.activeElement)).toBe(true);
    const size = bar().getByRole('slider', { name: 'Size' });
    const before = Number(await size.inputValue());
    await page.keyboard.press('.');
    expect(Number(await size.inputValue())).toBeGreaterThan(before);
    await page.keyboard.press(',');
    await page.keyboard.press('7');
    expect(await bar().getByRole('slider', { name: 'Strength' }).inputValue()).toBe('7');
    await page.keyboard.down(' ');
    await page.keyboard.press('ArrowUp');
    await page.keyboard.press('ArrowUp');
    await page.keyboard.up(' ');
    await expect.poll(painted, LONG).toBeGreaterThan(100);
    const first = await painted();
    await page.keyboard.press('x');
    expect(await bar().getByRole('radio', { name: 'Erase' }).isChecked()).toBe(true);
    await page.keyboard.press('0');
    await page.keyboard.press(' ');
    await expect.poll(painted, LONG).toBeLessThan(first);
    // It turns, too.
    const still = await stablePicture();
    await page.keyboard.press('Shift+ArrowLeft');
    await expect.poll(async () => (await picture()).equals(still), LONG).toBe(false);
    await page.keyboard.press('Control+z');
    await expect.poll(painted, LONG).toBe(first);
    // From the view Tab comes to the brush's controls.
    await page.keyboard.press('Tab');
    expect(await bar().evaluate((element) => element.contains(document.activeElement))).toBe(true);
    await page.keyboard.press('Escape');
    await bar().waitFor({ state: 'detached' });
    expect(await view().getAttribute('aria-label')).toMatch(/^Model\./);
  });

  it('turns the model with the other button or Shift, and paints nothing on the background', async () => {
    await openPage(nefertiti);
    await takeBrush();
    const before = await stablePicture();
    await drag([520, 260], [600, 260], { button: 'right' });
    await expect.poll(async () => (await picture()).equals(before), LONG).toBe(false);
    const turned = await stablePicture();
    await page.keyboard.down('Shift');
    await drag([600, 260], [520, 260]);
    await page.keyboard.up('Shift');
    await expect.poll(async () => (await picture()).equals(turned), LONG).toBe(false);
    await drag([40, 300], [90, 320]);
    await drag([520, 260], [580, 280]);
    await expect.poll(painted, LONG).toBeGreaterThan(100);
    // One step, not two.
    await undo().click();
    expect(await undo().isDisabled()).toBe(true);
  });

  it('paints with one finger and turns with two, without a trace of the first', async () => {
    await openPage(nefertiti, { viewport: { width: 390, height: 800 }, hasTouch: true, isMobile: true });
    await tool().tap();
    await bar().waitFor();
    const session = await page.context().newCDPSession(page);
    const touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', ...points: Array<readonly [number, number]>) =>
      session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    await touch('touchStart', [195, 270]);
    await touch('touchMove', [200, 275]);
    await touch('touchStart', [200, 275], [230, 300]);
    await touch('touchMove', [220, 275], [250, 300]);
    await touch('touchEnd');
    expect(await undo().isDisabled()).toBe(true);
    await touch('touchStart', [195, 270]);
    await touch('touchMove', [200, 280]);
    await touch('touchEnd');
    await expect.poll(painted, LONG).toBeGreaterThan(50);
    expect(await undo().isDisabled()).toBe(false);
  });

  it('paints on skins where they are seen, with what is kept in the tree; another model has none of it', async () => {
    await openPage(fan);
    await page.keyboard.press('o');
    await page.locator('summary', { hasText: 'Parts of the model' }).click();
    await page.locator('.scene-tree input').first().uncheck();
    await page.keyboard.press('o');
    await status(/^Ready/);
    await takeBrush();
    await bar().getByRole('slider', { name: 'Size' }).fill('120');
    await drag([540, 300], [560, 310]);
    await expect.poll(painted, LONG).toBeGreaterThan(500);
    await status(/^Ready/);
    await dropFiles(page, [nefertiti]);
    await status(/nefertiti|^Ready/);
    await bar().waitFor({ state: 'detached' });
    await status(/^Ready/);
    await takeBrush();
    expect(await painted()).toBe(0);
    await drag([520, 260], [580, 280]);
    await expect.poll(painted, LONG).toBeGreaterThan(100);
  });
});

describe('the code of the brush', () => {
  /** Keeps what the page asks for under such addresses until the answer is called. */
  async function hold(addresses: string): Promise<() => void> {
    let release = (): void => {};
    const held = new Promise<void>((resolve) => (release = resolve));
    await page.context().route(addresses, async (route) => {
      await held;
      await route.continue();
    });
    return release;
  }

  it('is waited for with a sign, and forgotten when another model comes', async () => {
    await openPage(nefertiti);
    const release = await hold('**/painting-*.js');
    await tool().click();
    await expect.poll(() => tool().getAttribute('aria-busy'), LONG).toBe('true');
    await dropFiles(page, [fan]);
    await expect.poll(() => page.title(), LONG).toMatch(/^desk-fan/);
    await status(/^Ready/);
    release();
    await expect.poll(() => tool().getAttribute('aria-busy'), LONG).toBe('false');
    expect(await bar().count()).toBe(0);
    await takeBrush();
  });

  it('paints on the model on screen, however late it comes', async () => {
    await openPage(nefertiti);
    const release = await hold('**/painter-*.js');
    await takeBrush();
    await dropFiles(page, [fan]);
    await bar().waitFor({ state: 'detached' });
    await status(/^Ready/);
    release();
    await takeBrush();
    await bar().getByRole('slider', { name: 'Size' }).fill('120');
    await drag([540, 300], [560, 310]);
    await expect.poll(painted, LONG).toBeGreaterThan(500);
  });

  it('is told of when it does not come', async () => {
    await openPage(nefertiti);
    await page.context().route('**/painter-*.js', (route) => route.abort());
    await tool().click();
    await page.locator('.notice').filter({ hasText: 'internal' }).waitFor(LONG);
    await bar().waitFor({ state: 'detached' });
    pages.forgive('ERR_FAILED');
  });
});

describe('for everyone', () => {
  it.each([['light', 1280], ['dark', 360]] as const)('has nothing that axe-core objects to while painting, %s at %i pixels', async (colorScheme, width) => {
    await openPage(nefertiti, { colorScheme, viewport: { width, height: 800 } });
    await takeBrush();
    await drag([width * 0.48, 300], [width * 0.52, 310]);
    await expect.poll(painted, LONG).toBeGreaterThan(50);
    expect(await violationsOf(page)).toEqual([]);
    expect(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)).toBe(false);
    await page.keyboard.press('o');
    await page.locator('summary', { hasText: 'File and textures' }).click();
    expect(await violationsOf(page)).toEqual([]);
    await page.keyboard.press('o');
    await page.getByRole('button', { name: 'View options', exact: true }).click();
    expect(await violationsOf(page)).toEqual([]);
    // The popover first, then the brush.
    await page.getByRole('radio', { name: 'As in the file' }).focus();
    await page.keyboard.press('Escape');
    await bar().waitFor();
    await page.keyboard.press('Escape');
    await bar().waitFor({ state: 'detached' });
    await page.keyboard.press('s');
    expect(await violationsOf(page)).toEqual([]);
  });

  it.each(['de', 'es', 'it', 'ja', 'zh'])('fits the brush’s controls on a phone in %s', async (locale) => {
    await openPage(fan, { locale, viewport: { width: 360, height: 740 } });
    await page.keyboard.press('b');
    const controls = page.locator('.paint-bar');
    await controls.waitFor();
    const tooWide = await controls.evaluate((element) =>
      [element, ...element.querySelectorAll('button, label, fieldset')]
        .filter((box) => box.scrollWidth > box.clientWidth + 1 || box.getBoundingClientRect().right > innerWidth)
        .map(({ outerHTML }) => outerHTML.slice(0, 100)));
    expect(tooWide).toEqual([]);
  });
});
