// Several files at once: a queue with a result for each, one zip, and one bad file that does not stop the rest.
import { readFileSync } from 'node:fs';
import { unzipSync } from 'fflate';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { openDocument } from 'decimesh';
import { at } from '../scripts/project.mjs';
import { dropFiles } from './support/browser.mjs';
import { hills, plyOf } from './support/meshes.ts';
import { LONG, sample, usePages } from './support/pages.ts';

const fixture = (...path: string[]): Buffer => readFileSync(at('tests', 'fixtures', ...path));
const plate = (size: number): Uint8Array => plyOf(hills(size));

const pages = usePages({ viewport: { width: 1280, height: 900 }, picture: false });
const { glimpse, status } = pages;
let page: Page;

const open = async (): Promise<void> => {
  page = await pages.open();
};
const items = () => page.getByRole('list', { name: 'Several models' }).getByRole('listitem');

describe('a queue', () => {
  it('is worked through by keyboard, tells of each model, and gives one zip', async () => {
    await open();
    await dropFiles(page, [
      { name: 'a.ply', bytes: plate(20) },
      { name: 'bad.glb', bytes: Buffer.from('no model') },
      { name: '18_variants.gltf', bytes: fixture('gltf', '18_variants', '18_variants.gltf') },
      { name: '18_variants.bin', bytes: fixture('gltf', '18_variants', '18_variants.bin') },
      { name: 'A.ply', bytes: plate(30) },
    ]);
    await page.getByRole('heading', { level: 1, name: '4 models' }).waitFor();
    await page.getByRole('radio', { name: '25 %' }).check();
    await page.getByRole('button', { name: 'Simplify all' }).focus();
    await page.keyboard.press('Enter');
    await status(/^Done: 3 simplified, 1 failed\.$/);
    expect(await items().count()).toBe(4);
    expect(await items().nth(0).innerText()).toMatch(/a\.ply[\s\S]*800 to 1\d\d|200/);
    expect(await items().nth(1).innerText()).toContain('unknown-format');
    const [saved] = await Promise.all([page.waitForEvent('download', LONG), page.getByRole('button', { name: 'Download ZIP' }).click()]);
    expect(saved.suggestedFilename()).toBe('decimesh.zip');
    const files = unzipSync(new Uint8Array(readFileSync(await saved.path())));
    expect(Object.keys(files).sort()).toEqual(['18_variants.glb', 'A-2.ply', 'a.ply']);
    using small = await openDocument(files['a.ply'] as Uint8Array);
    expect(small.summary.triangles).toBeLessThanOrEqual(200);
    expect(small.summary.triangles).toBeGreaterThan(150);
    await page.getByRole('button', { name: 'Close the queue' }).click();
    await page.getByLabel('Choose a model').waitFor({ state: 'attached' });
  });

  it('has its textures made as they were chosen, where the format can have that', async () => {
    page = await pages.open({ path: '?texture-size=64&texture-format=webp' });
    const helmet = sample('flight-helmet.glb');
    await dropFiles(page, [helmet, { name: 'plate.ply', bytes: plate(10) }]);
    await page.getByRole('radio', { name: '5 %', exact: true }).check();
    await page.getByRole('button', { name: 'Simplify all' }).click();
    await status(/^Done: 2 simplified, 0 failed\.$/);
    const [saved] = await Promise.all([page.waitForEvent('download', LONG), page.getByRole('button', { name: 'Download ZIP' }).click()]);
    const files = unzipSync(new Uint8Array(readFileSync(await saved.path())));
    expect(Object.keys(files).sort()).toEqual(['flight-helmet.glb', 'plate.ply']);
    const made = Buffer.from(files['flight-helmet.glb'] as Uint8Array);
    expect(made.includes('"image/webp"')).toBe(true);
    expect(made.length).toBeLessThan(0.15 * helmet.bytes.length);
  });

  it('can be cancelled, keeps what was done, and makes room for one model', async () => {
    await open();
    await dropFiles(page, [{ name: 'small.ply', bytes: plate(10) }, { name: 'large.ply', bytes: plate(500) }, { name: 'last.ply', bytes: plate(10) }]);
    await page.getByRole('button', { name: 'Simplify all' }).click();
    await glimpse('.batch-item', /^large\.ply.*simplifying/);
    await page.keyboard.press('Escape');
    await status(/^Cancelled/);
    expect(await items().nth(2).innerText()).toContain('cancelled');
    const [saved] = await Promise.all([page.waitForEvent('download', LONG), page.getByRole('button', { name: 'Download ZIP' }).click()]);
    expect(Object.keys(unzipSync(new Uint8Array(readFileSync(await saved.path()))))).toEqual(['small.ply']);
    await dropFiles(page, [{ name: 'one.ply', bytes: plate(10) }]);
    await status(/^Ready|^Drawing/);
    await expect.poll(() => page.title(), LONG).toContain('one');
    expect(await items().count()).toBe(0);
  });
});
