// Seeing, as people do it: comparing, surfaces, lines, light, morph targets; and what happens to the canvas meanwhile.
import { readFileSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { readFirstPrimitive, subdivide, writeGlb } from '../benches/support/subdivide.mjs';
import { at } from '../scripts/project.mjs';
import { violationsOf } from './support/axe.ts';
import { dropFiles } from './support/browser.mjs';
import { LONG, sample, usePages, type PageOptions } from './support/pages.ts';
import { pictureNow, stillPicture } from './support/picture.ts';
import { openViewWorker, viewWorkerOf } from './support/view_worker.mjs';

const fan = sample('desk-fan.glb');
const nefertiti = sample('nefertiti.glb');
const morphing = { name: 'cube.glb', bytes: readFileSync(at('tests', 'fixtures', 'gltf', 'AnimatedMorphCube.glb')) };

const pages = usePages({ viewport: { width: 1100, height: 760 }, serviceWorkers: 'block', plainGround: true });
const { glimpse, status } = pages;
let page: Page;

async function openPage(options: PageOptions = {}): Promise<void> {
  page = await pages.open(options);
}

const slider = () => page.getByRole('slider', { name: 'Triangles', exact: true });
const ready = () => status(/^Ready/);
const handle = () => page.getByRole('separator', { name: 'Handle between original and result' });
const options = () => page.getByRole('button', { name: 'View options', exact: true });
const choice = (name: string) => page.getByRole('radio', { name, exact: true });
const share = async (): Promise<number> => Number(await handle().getAttribute('aria-valuenow'));

const AREA = { x: 200, y: 100, width: 560, height: 300 };
const picture = (clip = AREA): Promise<Buffer> => stillPicture(page, clip);
const moment = (clip = AREA): Promise<Buffer> => pictureNow(page, clip);
const pictureBecomes = (test: (now: Buffer) => boolean, clip = AREA) => expect.poll(async () => test(await moment(clip)), LONG).toBe(true);

async function openAt(model: { name: string; bytes: Uint8Array }, triangles?: string): Promise<void> {
  await dropFiles(page, [model]);
  await ready();
  if (triangles === undefined) return;
  await slider().fill(triangles);
  await status(/^Ready\. Showing/);
}

describe('comparing', () => {
  it('puts a handle between original and result, for keyboard and pointer', async () => {
    await openPage();
    await openAt(nefertiti);
    const original = await picture();
    await slider().fill('600');
    await status(/^Ready\. Showing/);
    await pictureBecomes((now) => !now.equals(original));
    const result = await picture();

    await page.keyboard.press('s');
    await handle().waitFor();
    expect(await handle().getAttribute('aria-orientation')).toBe('vertical');
    expect(await share()).toBe(50);
    await handle().focus();
    await page.keyboard.press('ArrowRight');
    expect(await share()).toBe(52);
    await page.keyboard.press('PageDown');
    expect(await share()).toBe(42);
    expect(await handle().getAttribute('aria-valuetext')).toBe('Original on 42 % of the width');
    await page.keyboard.press('End');
    expect(await share()).toBe(100);
    await pictureBecomes((now) => now.equals(original));
    await page.keyboard.press('Home');
    expect(await share()).toBe(0);
    await pictureBecomes((now) => now.equals(result));

    // Half of each, on one camera.
    await page.mouse.move(1, 300);
    await page.mouse.down();
    await page.mouse.move(300, 300);
    await page.mouse.move(550, 300);
    await page.mouse.up();
    expect(await share()).toBe(50);
    const left = { x: 330, y: 100, width: 190, height: 300 };
    const right = { x: 580, y: 100, width: 190, height: 300 };
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('ArrowRight');
    const halves = { left: await picture(left), right: await picture(right) };
    await page.keyboard.press('End');
    await pictureBecomes((now) => now.equals(halves.left), left);
    await pictureBecomes((now) => !now.equals(halves.right), right);
    await page.keyboard.press('Home');
    await pictureBecomes((now) => now.equals(halves.right), right);

    await page.keyboard.press('s');
    expect(await handle().count()).toBe(0);
  });

  it('follows a finger', async () => {
    await openPage({ viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true });
    await openAt(nefertiti, '600');
    await page.getByRole('button', { name: 'Handle between original and result' }).tap();
    const box = await handle().boundingBox();
    if (box === null) throw new Error('the handle is not visible');
    expect(box.width).toBeGreaterThanOrEqual(44);
    const session = await page.context().newCDPSession(page);
    const touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', x?: number) =>
      session.send('Input.dispatchTouchEvent', { type, touchPoints: x === undefined ? [] : [{ x, y: 200 }] });
    await touch('touchStart', box.x + 22);
    for (const x of [150, 120, 90]) await touch('touchMove', x);
    await touch('touchEnd');
    await expect.poll(share).toBe(25);
  });

  it('shows both side by side, with one camera', async () => {
    await openPage();
    await openAt(nefertiti, '600');
    await options().click();
    await choice('Side by side').check();
    await page.keyboard.press('Escape');
    expect(await page.getByRole('group', { name: 'View options' }).count()).toBe(0);
    expect(await options().evaluate((button) => button === document.activeElement)).toBe(true);
    const left = { x: 150, y: 100, width: 250, height: 300 };
    const right = { x: 700, y: 100, width: 250, height: 300 };
    const coarse = await picture(right);
    expect((await picture(left)).equals(coarse)).toBe(false);
    await page.keyboard.down('c');
    await pictureBecomes((now) => !now.equals(coarse), right);
    await page.keyboard.up('c');
    await pictureBecomes((now) => now.equals(coarse), right);
    const before = { left: await picture(left), right: await picture(right) };
    await page.getByRole('application').focus();
    await page.keyboard.press('ArrowLeft');
    await pictureBecomes((now) => !now.equals(before.left), left);
    await pictureBecomes((now) => !now.equals(before.right), right);
  });
});

describe('surfaces and lines', () => {
  it('draws clay, a checker and normals, each another picture, and the file’s own again', async () => {
    await openPage();
    await openAt(fan, '4000');
    const seen = [await picture()];
    await options().click();
    for (const name of ['Clay', 'Checker on texture coordinates', 'Normals as colours']) {
      await choice(name).check();
      await pictureBecomes((now) => seen.every((earlier) => !now.equals(earlier)));
      seen.push(await picture());
    }
    await page.getByRole('region', { name: 'Legend' }).getByText('Faces up').waitFor();
    await choice('As in the file').check();
    await pictureBecomes((now) => now.equals(seen[0] ?? now));
    expect(await page.getByRole('region', { name: 'Legend' }).count()).toBe(0);
  });

  it('offers no checker where there are no texture coordinates, and says why', async () => {
    await openPage();
    await openAt(fan);
    await options().click();
    await choice('Checker on texture coordinates').check();
    await openAt(morphing);
    expect(await choice('As in the file').isChecked()).toBe(true);
    const checker = page.getByRole('radio', { name: /^Checker/ });
    expect(await checker.isDisabled()).toBe(true);
    await page.getByText('This model has no texture coordinates.').waitFor();
  });

  it('measures the level for the heat map, draws it with its legend, and anew for another level', async () => {
    await openPage();
    await openAt(nefertiti, '600');
    const plain = await picture();
    await options().click();
    const heat = choice('Distance from the original');
    await heat.check();
    const legend = page.getByRole('region', { name: 'Legend' });
    const limit = async (): Promise<number> => Number(/([\d.]+) %$/.exec(await legend.innerText())?.[1]);
    await status(/^Measured/);
    const coarse = await limit();
    expect(coarse).toBeGreaterThan(0.01);
    await pictureBecomes((now) => !now.equals(plain));
    // Blue and red are on screen; clay has neither.
    const colours = async (): Promise<{ blue: number; red: number }> => {
      const base64 = (await picture()).toString('base64');
      return page.evaluate(async (source) => {
        const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${source}`)).blob());
        const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
        context?.drawImage(image, 0, 0);
        const { data } = context?.getImageData(0, 0, image.width, image.height) ?? { data: new Uint8ClampedArray() };
        const counts = { blue: 0, red: 0 };
        for (let pixel = 0; pixel < data.length; pixel += 4) {
          const difference = (data[pixel] ?? 0) - (data[pixel + 2] ?? 0);
          if (difference > 60) counts.red += 1;
          if (difference < -40) counts.blue += 1;
        }
        return counts;
      }, base64);
    };
    await expect.poll(async () => Math.min(...Object.values(await colours())), LONG).toBeGreaterThan(50);
    await slider().fill('6000');
    await legend.getByText('The distance is measured first.').waitFor();
    await status(/^Measured/);
    expect(await limit()).toBeLessThan(coarse);
    await choice('As in the file').check();
    await slider().fill('600');
    await pictureBecomes((now) => now.equals(plain));
  });

  it('leaves the heat map when its measuring is cancelled', async () => {
    await openPage();
    await openAt({ name: 'large.glb', bytes: writeGlb(subdivide(readFirstPrimitive(nefertiti.bytes), 1)) }, '60000');
    await options().click();
    await choice('Distance from the original').check();
    await glimpse('[role=progressbar][aria-label="Measuring"]');
    await page.getByRole('button', { name: 'Cancel measuring' }).click();
    await status(/^Cancelled measuring/);
    expect(await choice('As in the file').isChecked()).toBe(true);
  });

  it('counts and draws borders and seams of what is on screen', async () => {
    await openPage();
    await openAt(fan, '4000');
    const plain = await picture();
    await page.keyboard.press('e');
    const legend = page.getByRole('region', { name: 'Legend' });
    const seams = async (): Promise<number> => Number((await legend.getByText(/seam edge/).innerText()).replace(/\D/g, ''));
    await expect.poll(seams, LONG).toBeGreaterThan(100);
    await pictureBecomes((now) => !now.equals(plain));
    const atLevel = await seams();
    // The original has more of them.
    await page.keyboard.down('c');
    await expect.poll(seams, LONG).toBeGreaterThan(atLevel);
    await page.keyboard.up('c');
    await expect.poll(seams, LONG).toBe(atLevel);
    await page.keyboard.press('e');
    await pictureBecomes((now) => now.equals(plain));
    expect(await legend.count()).toBe(0);
  });
});

describe('light and motion', () => {
  it('lets the light stay where the model is', async () => {
    await openPage();
    await openAt(nefertiti);
    const before = await picture();
    await options().click();
    await choice('Stays beside the model').check();
    await pictureBecomes((now) => !now.equals(before));
    expect(await page.getByRole('radio', { name: /^Goes around/ }).isDisabled()).toBe(true);
    expect(await page.getByRole('checkbox', { name: /^Turntable/ }).isDisabled()).toBe(true);
    await choice('Follows the view').check();
    await pictureBecomes((now) => now.equals(before));
  });

  it('turns the model or the light while that is wanted, and then rests', async () => {
    await openPage({ reducedMotion: 'no-preference' });
    await openAt(morphing);
    await page.getByRole('button', { name: 'Pause animation' }).click();
    await options().click();
    for (const control of [page.getByRole('checkbox', { name: 'Turntable' }), choice('Goes around the model')]) {
      await control.check();
      const first = await moment();
      await pictureBecomes((now) => !now.equals(first));
      const second = await moment();
      await pictureBecomes((now) => !now.equals(second));
      if ((await control.getAttribute('type')) === 'checkbox') await control.uncheck();
      else await choice('Follows the view').check();
      const last = await picture();
      expect((await picture()).equals(last)).toBe(true);
    }
  });

  it('moves morph targets, by keyboard too, and gives them back to the file', async () => {
    await openPage();
    await openAt(morphing);
    const rest = await picture();
    await options().click();
    const targets = page.getByRole('group', { name: 'Morph targets' }).getByRole('slider');
    expect(await targets.count()).toBe(2);
    await targets.first().fill('1');
    await pictureBecomes((now) => !now.equals(rest));
    await targets.last().focus();
    await page.keyboard.press('End');
    expect(await targets.last().inputValue()).toBe('1');
    const moved = await picture();
    await page.getByRole('group', { name: 'Morph targets' }).getByRole('button', { name: 'As in the file' }).click();
    await pictureBecomes((now) => now.equals(rest) && !now.equals(moved));
    expect(await targets.first().inputValue()).toBe('0');
  });
});

describe('for everyone', () => {
  it.each(['light', 'dark'] as const)('has nothing that axe-core objects to while comparing, with every option open, in the %s', async (colorScheme) => {
    await openPage({ colorScheme });
    await openAt(morphing);
    await page.keyboard.press('s');
    await page.keyboard.press('e');
    await options().click();
    await page.getByRole('region', { name: 'Legend' }).waitFor();
    expect(await violationsOf(page)).toEqual([]);
    await choice('Normals as colours').check();
    await choice('Side by side').check();
    expect(await violationsOf(page)).toEqual([]);
  });

  it.each([360, 768, 1440])('covers nothing and scrolls nowhere sideways at %i pixels', async (width) => {
    await openPage({ viewport: { width, height: width === 360 ? 740 : 900 } });
    await openAt(fan);
    await page.keyboard.press('s');
    await page.keyboard.press('e');
    await page.getByRole('region', { name: 'Legend' }).waitFor();
    await options().click();
    expect(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)).toBe(false);
    // What can be pressed is not below something else.
    const hidden = await page.evaluate(() =>
      [...document.querySelectorAll<HTMLElement>('.toolbar button, .view-options input:enabled, .handle')]
        .filter((element) => element.checkVisibility())
        .filter((element) => {
          element.scrollIntoView({ block: 'nearest' });
          const { left, top, width: across, height } = (element.querySelector('.grip') ?? element).getBoundingClientRect();
          const there = document.elementFromPoint(left + across / 2, top + height / 2);
          const label = element.closest('label');
          return there === null || !(element.contains(there) || label?.contains(there) === true || element.matches('.handle') && there.closest('.view-options') !== null);
        })
        .map((element) => element.getAttribute('aria-label') ?? element.outerHTML.slice(0, 80)));
    expect(hidden).toEqual([]);
  });
});

describe('the canvas', () => {
  const pixels = () => page.locator('#view').evaluate((canvas: HTMLCanvasElement) => canvas.width);

  it('follows the window and the pixels of its screen', async () => {
    await openPage();
    await openAt(fan);
    expect(await pixels()).toBe(1100);
    await page.setViewportSize({ width: 800, height: 700 });
    await expect.poll(pixels, LONG).toBe(800);
    // Headless Chromium tells of another scale only together with another size.
    const session = await page.context().newCDPSession(page);
    const screen = (width: number, deviceScaleFactor: number) =>
      session.send('Emulation.setDeviceMetricsOverride', { width, height: 700, deviceScaleFactor, mobile: false });
    await screen(801, 2);
    await expect.poll(pixels, LONG).toBe(1602);
    // More than two pixels to one are not drawn.
    await screen(700, 3);
    await expect.poll(pixels, LONG).toBe(1400);
  });

  it('survives the loss of its graphics context in its worker, with what was being looked at', async () => {
    await openPage({ before: openViewWorker });
    await openAt(fan, '4000');
    await options().click();
    await choice('Checker on texture coordinates').check();
    await page.keyboard.press('Escape');
    await page.keyboard.press('s');
    await page.keyboard.press('e');
    await page.getByRole('region', { name: 'Legend' }).waitFor();
    const before = await picture();
    const worker = await viewWorkerOf(page);
    await worker.evaluate(() => {
      const scope = globalThis as unknown as { viewContext: WebGL2RenderingContext; restore(): void };
      const loser = scope.viewContext.getExtension('WEBGL_lose_context');
      scope.restore = () => loser?.restoreContext();
      loser?.loseContext();
    });
    await status(/graphics card/);
    await slider().fill('2000');
    await slider().fill('4000');
    await worker.evaluate(() => (globalThis as unknown as { restore(): void }).restore());
    await ready();
    await pictureBecomes((now) => now.equals(before));
  });
});
