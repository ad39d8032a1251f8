// For everyone: no violation that axe-core knows, every control by keyboard, pictures of every size and theme to look at.
import { mkdirSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { at } from '../scripts/project.mjs';
import { violationsOf } from './support/axe.ts';
import { dropFiles } from './support/browser.mjs';
import { hills, plyOf } from './support/meshes.ts';
import { sample, usePages } from './support/pages.ts';

const helmet = sample('flight-helmet.glb');
const plates = [20, 24].map((size) => ({ name: `plate-${size}.ply`, bytes: plyOf(hills(size)) }));

const pages = usePages({ picture: false });
const { status } = pages;
let page: Page;

/** Controls that Tab does not come to; of a group of radio buttons one is enough. */
async function unreachable(): Promise<string[]> {
  await page.evaluate(() => {
    const shown = (element: Element): boolean =>
      element.checkVisibility({ visibilityProperty: true }) && element.closest('[inert]') === null;
    const scope: ParentNode = document.querySelector('dialog[open]') ?? document;
    const controls = [...scope.querySelectorAll('a[href], button:enabled, input:enabled, select:enabled, summary, [tabindex="0"]')].filter(shown);
    const names = new Set<string>();
    for (const control of controls) {
      if (control instanceof HTMLInputElement && control.type === 'radio') {
        if (names.has(control.name)) continue;
        names.add(control.name);
      }
      control.setAttribute('data-control', control instanceof HTMLInputElement && control.type === 'radio' ? `radio ${control.name}` : '');
    }
    Object.assign(globalThis, { seen: new Set<Element | string>() });
    document.addEventListener('focusin', ({ target }) => {
      const { seen } = globalThis as unknown as { seen: Set<unknown> };
      if (target instanceof HTMLInputElement && target.type === 'radio') seen.add(`radio ${target.name}`);
      else seen.add(target);
    });
    if (scope === document) (document.activeElement as HTMLElement | null)?.blur();
  });
  const count = await page.locator('[data-control]').count();
  for (let press = 0; press < count + 20; press += 1) await page.keyboard.press('Tab');
  return page.evaluate(() => {
    const { seen } = globalThis as unknown as { seen: Set<unknown> };
    const missed = [...document.querySelectorAll('[data-control]')].filter(
      (control) => !seen.has(control) && !seen.has(control.getAttribute('data-control') || '-') && control !== document.activeElement,
    );
    for (const control of document.querySelectorAll('[data-control]')) control.removeAttribute('data-control');
    return missed.map(({ outerHTML }) => outerHTML.slice(0, 120));
  });
}

/** Each leaves the page in a state worth looking at. */
const STATES: ReadonlyArray<readonly [name: string, reach: () => Promise<void>]> = [
  ['the start page', async () => {}],
  ['the start page with a file over it', async () => {
    await dragOver();
  }],
  ['an error', async () => {
    await dropFiles(page, [{ name: 'bad.glb', bytes: Buffer.from('no model') }]);
    await page.getByRole('alert').waitFor();
  }],
  ['the keys', async () => {
    await page.keyboard.press('?');
    await page.getByRole('dialog').waitFor();
  }],
  ['several files', async () => {
    await dropFiles(page, [...plates, { name: 'bad.glb', bytes: Buffer.from('no model') }]);
    await page.getByRole('button', { name: 'Simplify all' }).waitFor();
  }],
  ['several files, simplified', async () => {
    await dropFiles(page, [...plates, { name: 'bad.glb', bytes: Buffer.from('no model') }]);
    await page.getByRole('button', { name: 'Simplify all' }).click();
    await status(/^Done/);
  }],
  ['a model', async () => openModel()],
  ['a model measured', async () => {
    await openModel();
    await page.getByRole('button', { name: 'Keep 10 %' }).click();
    await status(/^(Ready|Drawing)/);
    await page.getByRole('button', { name: 'Measure', exact: true }).click();
    await status(/^Measured/);
  }],
  ['a model with its options', async () => {
    await openModel();
    await page.keyboard.press('o');
    await page.getByRole('dialog').waitFor();
    await page.locator('details.sheet-fold').evaluateAll((folds) => folds.forEach((fold) => fold.setAttribute('open', '')));
    await page.getByRole('checkbox', { name: /^Save a chain/ }).check();
    await page.locator('.figures').waitFor();
  }],
  ['a model and its original with a handle between', async () => {
    await openModel();
    await page.keyboard.press('s');
    await page.getByRole('separator').waitFor();
    await page.keyboard.press('e');
    await page.getByRole('button', { name: 'View options', exact: true }).click();
    await page.getByRole('group', { name: 'View options' }).waitFor();
  }],
  ['a model and its original side by side', async () => {
    await openModel();
    await page.getByRole('button', { name: 'View options', exact: true }).click();
    await page.getByRole('radio', { name: 'Side by side' }).check();
    await page.getByRole('radio', { name: 'Distance from the original' }).check();
    await page.getByRole('region', { name: 'Legend' }).waitFor();
  }],
  ['a model while another is dragged over it', async () => {
    await openModel();
    await dragOver();
  }],
  ['a model with an error', async () => {
    await openModel();
    await dropFiles(page, [{ name: 'bad.glb', bytes: Buffer.from('no model') }]);
    await page.getByRole('alert').waitFor();
  }],
  ['a model with its details', async () => {
    await openModel();
    await page.keyboard.press('i');
    await page.getByRole('dialog').waitFor();
  }],
];

async function dragOver(): Promise<void> {
  const transfer = await page.evaluateHandle(() => {
    const data = new DataTransfer();
    data.items.add(new File(['x'], 'a.glb'));
    return data;
  });
  await page.dispatchEvent('body', 'dragenter', { dataTransfer: transfer });
  await page.locator('.drop-hint').waitFor();
}

async function openModel(): Promise<void> {
  await dropFiles(page, [helmet]);
  await status(/^(Ready|Drawing)/);
}

describe.each([['light', 1280], ['dark', 360]] as const)('%s at %i pixels', (colorScheme, width) => {
  it.each(STATES)('%s has no violation, and Tab comes to every control', async (_, reach) => {
    page = await pages.open({ colorScheme, viewport: { width, height: 800 } });
    await reach();
    expect(await violationsOf(page)).toEqual([]);
    expect(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)).toBe(false);
    expect(await unreachable()).toEqual([]);
  });
});

describe('every language', () => {
  it.each(['en', 'de', 'es', 'it', 'ja', 'zh'])('%s fits the panel, the sheets and the start page', async (locale) => {
    page = await pages.open({ locale, viewport: { width: 1280, height: 800 } });
    const tooWide = (): Promise<string[]> =>
      page.evaluate(() =>
        [...document.querySelectorAll('.landing-zone, .model-panel, .panel-foot, .download, .lod-head, .lod-marks, .sheet-body, .top-actions')]
          .filter((box) => box.scrollWidth > box.clientWidth + 1 || box.getBoundingClientRect().right > innerWidth)
          .map(({ className }) => `${className} at ${innerWidth}`),
      );
    await page.locator(`html[lang=${locale}]`).waitFor();
    await dropFiles(page, [helmet]);
    await page.locator('.lod-marks button').first().waitFor();
    const found: string[] = [];
    for (const width of [1280, 1050, 768, 360]) {
      await page.setViewportSize({ width, height: 800 });
      found.push(...(await tooWide()));
      for (const sheet of ['o', 'i']) {
        await page.keyboard.press(sheet);
        await page.getByRole('dialog').waitFor();
        found.push(...(await tooWide()));
        await page.keyboard.press(sheet);
      }
    }
    expect(found).toEqual([]);
  });
});

describe('pictures to look at', () => {
  const directory = at('.setup', 'screenshots');
  const sizes = [[360, 740], [768, 1024], [1440, 900]] as const;
  it.each(sizes.flatMap(([width, height]) => (['light', 'dark'] as const).map((theme) => [width, height, theme] as const)))(
    'at %i × %i, %s, without and with a model', async (width, height, theme) => {
      mkdirSync(directory, { recursive: true });
      page = await pages.open({ colorScheme: theme, viewport: { width, height }, picture: true });
      await page.locator('.mesh-field path[d^="M"]').waitFor({ state: 'attached' });
      await page.screenshot({ path: `${directory}/${width}-${theme}-start.png` });
      await dropFiles(page, [helmet]);
      await status(/^Ready/);
      await page.getByRole('button', { name: 'Keep 25 %' }).click();
      await status(/^Ready\. Showing/);
      await page.locator('.mesh-stats .pending').first().waitFor({ state: 'detached' });
      await page.screenshot({ path: `${directory}/${width}-${theme}-model.png` });
      expect(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)).toBe(false);
    },
  );
});
