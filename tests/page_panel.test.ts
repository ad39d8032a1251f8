// The panel beside the view as people use it: limits, options, parts of a model, levels, results, undo, the address.
import { readFileSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { dropFiles } from './support/browser.mjs';
import { glbTree } from './support/glb.ts';
import { hills, plyOf } from './support/meshes.ts';
import { LONG, sample, usePages, type PageOptions } from './support/pages.ts';
import { gltfErrors } from './support/validate.ts';

const fan = sample('desk-fan.glb');
const helmet = sample('flight-helmet.glb');

const pages = usePages({ viewport: { width: 1280, height: 900 }, permissions: ['clipboard-read', 'clipboard-write'], picture: false });
const { glimpse, status } = pages;
let page: Page;

async function openPage(options: PageOptions = {}): Promise<void> {
  page = await pages.open(options);
}

const slider = () => page.getByRole('slider', { name: 'Triangles', exact: true });
const ready = () => status(/^Ready/);
const wanted = async (): Promise<number> => Number(await slider().inputValue());
const query = (): URLSearchParams => new URL(page.url()).searchParams;
const options = () => page.getByRole('dialog', { name: 'Options' });
const fold = (name: string) => options().locator('summary').filter({ hasText: name }).click();

async function openWithOptions(file = fan): Promise<void> {
  await openPage();
  await dropFiles(page, [file]);
  await ready();
  await page.getByRole('button', { name: 'Options', exact: true }).click();
  await options().waitFor();
}

async function download(): Promise<{ name: string; bytes: Uint8Array }> {
  const [saved] = await Promise.all([
    page.waitForEvent('download', LONG),
    page.getByRole('button', { name: 'Download', exact: true }).click(),
  ]);
  return { name: saved.suggestedFilename(), bytes: new Uint8Array(readFileSync(await saved.path())) };
}

describe('limits', () => {
  it('set the slider by the error, until it is moved', async () => {
    await openWithOptions();
    const field = page.getByRole('textbox', { name: 'Largest error' });
    await field.fill('0.5');
    await field.press('Enter');
    await status(/^Ready\. Showing/);
    const coarse = await wanted();
    expect(coarse).toBeLessThan(15_000);
    // A German comma is a point.
    await field.fill('0,05');
    await field.press('Enter');
    await expect.poll(wanted, LONG).toBeGreaterThan(coarse);
    await expect.poll(() => query().get('error')).toBe('0.05');
    await slider().fill('3000');
    expect(await field.inputValue()).toBe('');
    await expect.poll(() => query().get('triangles')).toBe('3000');
    expect(query().has('error')).toBe(false);
    await page.keyboard.press('Control+z');
    expect(await field.inputValue()).toBe('0.05');
  });

  it('keep a download within a size, with another compression too', async () => {
    await openWithOptions();
    const field = page.getByRole('textbox', { name: 'Largest file' });
    await field.fill('1.4');
    await field.press('Enter');
    await status(/^Ready\. Showing/);
    const plain = await wanted();
    const saved = await download();
    expect(saved.bytes.length).toBeLessThanOrEqual(1.4e6);
    expect(saved.bytes.length).toBeGreaterThan(1.3e6);
    await page.getByRole('combobox', { name: 'Compression' }).selectOption('Meshopt');
    await expect.poll(wanted, LONG).toBeGreaterThan(plain);
    expect((await download()).bytes.length).toBeLessThanOrEqual(1.4e6);
    await field.fill('0.1');
    await field.press('Enter');
    await status(/The smallest level there is takes/);
  });
});

describe('options', () => {
  it('record again with progress, until Escape, and again with the next wish', async () => {
    await openPage();
    await dropFiles(page, [{ name: 'plate.ply', bytes: plyOf(hills(420)) }]);
    await ready();
    await slider().fill('2000');
    await status(/^Ready\. Showing/);
    await page.keyboard.press('o');
    await page.getByRole('checkbox', { name: /^Lock open borders/ }).check();
    await glimpse('[role=progressbar][aria-label^="Simplifying"]');
    // The options stay: Escape stops what is under way first.
    await page.keyboard.press('Escape');
    await status(/^Cancelled/);
    expect(await options().count()).toBe(1);
    await slider().fill('1900');
    await status(/^Ready\. (Showing|3)/);
    // What is locked is still there: a border of 4 × 420 edges.
    expect(Number(await slider().getAttribute('min'))).toBeGreaterThan(1500);
  }, 150_000);

  it('record again with what was changed, which undo takes back', async () => {
    await openWithOptions();
    await slider().fill('4000');
    await status(/^Ready\. Showing/);
    const before = await download();
    await page.getByRole('checkbox', { name: /^Lock open borders/ }).check();
    await expect.poll(() => query().get('lock-border')).toBe('1');
    await status(/^Ready\. Showing/);
    const locked = await download();
    expect(Buffer.from(locked.bytes).equals(before.bytes)).toBe(false);
    await page.keyboard.press('Control+z');
    expect(await page.getByRole('checkbox', { name: /^Lock open borders/ }).isChecked()).toBe(false);
    await status(/^Ready\. Showing/);
    expect(Buffer.from((await download()).bytes).equals(before.bytes)).toBe(true);
    await page.keyboard.press('Control+Shift+z');
    expect(await page.getByRole('checkbox', { name: /^Lock open borders/ }).isChecked()).toBe(true);
    await page.getByRole('button', { name: 'Reset options' }).click();
    expect(await page.getByRole('checkbox', { name: /^Lock open borders/ }).isChecked()).toBe(false);
    await status(/^Ready\. Showing/);
  });

  it('weigh attributes by keyboard, and are there on the next visit', async () => {
    await openWithOptions();
    const texture = page.getByRole('slider', { name: 'Texture', exact: true });
    await texture.focus();
    await page.keyboard.press('Home');
    await expect.poll(() => query().get('weights')).toBe('uv:0');
    await ready();
    await page.reload();
    await dropFiles(page, [fan]);
    await ready();
    await page.keyboard.press('o');
    expect(await texture.getAttribute('aria-valuetext')).toBe('× 0');
  });

  it('keep parts of the model as they are', async () => {
    await openWithOptions(helmet);
    await fold('Parts of the model');
    const first = options().locator('.scene-tree input').first();
    const count = options().locator('.scene-count').last();
    const whole = await count.innerText();
    await options().locator('.scene-tree input').last().uncheck();
    await ready();
    await page.getByRole('button', { name: 'Keep 25 %' }).click();
    await status(/^Ready\. Showing/);
    expect(await count.innerText()).toBe(whole);
    expect(await options().locator('.scene-count').first().innerText()).toMatch(/^[\d,]+ \/ [\d,]+$/);
    expect(query().get('keep')).toMatch(/^\d+$/);
    expect(await first.isChecked()).toBe(true);
    const saved = await download();
    expect(await gltfErrors(saved.bytes)).toEqual([]);
  });

  it('save a chain of levels in a GLB', async () => {
    await openWithOptions();
    await fold('Levels of detail');
    await page.getByRole('checkbox', { name: /^Save a chain of levels/ }).check();
    const shares = page.getByRole('textbox', { name: 'Triangles in each, in %' });
    expect(await shares.inputValue()).toBe('100, 50, 25, 10');
    await shares.fill('60 20');
    await shares.press('Enter');
    const saved = await download();
    expect(await gltfErrors(saved.bytes)).toEqual([]);
    expect(glbTree(saved.bytes)['extensionsUsed']).toContain('MSFT_lod');
    await options().getByRole('cell', { name: /^4,2\d\d$/ }).waitFor();
    await page.getByRole('combobox', { name: 'File format' }).selectOption('OBJ');
    expect(await page.getByRole('checkbox', { name: /^Save a chain of levels/ }).isDisabled()).toBe(true);
  });

  it('can be had as a command and as code', async () => {
    await openWithOptions();
    await slider().fill('4000');
    await page.getByRole('radio', { name: 'Best', exact: true }).check();
    await fold('Command and code');
    await page.getByRole('button', { name: 'Copy as command' }).click();
    await status(/^Copied/);
    const copied = () => page.evaluate(() => navigator.clipboard.readText());
    expect(await copied()).toBe('npx decimesh desk-fan.glb -o desk-fan-small.glb --triangles 4000 --preset best --compress none');
    await page.getByRole('button', { name: 'Copy as code' }).click();
    await expect.poll(copied).toContain("await document.simplify({ triangles: 4000, preset: 'best' });");
  });
});

describe('details', () => {
  it('say what was saved, where the bytes are and why there are no fewer triangles', async () => {
    await openPage();
    await dropFiles(page, [fan]);
    await ready();
    await page.getByRole('button', { name: 'Keep 10 %' }).click();
    await status(/^Ready\. Showing/);
    await page.getByRole('button', { name: 'Details' }).click();
    const sheet = page.getByRole('dialog', { name: 'Details' });
    await sheet.getByText(/^\d+(\.\d)? %, [\d.]+ [kM]B$/).waitFor();
    await sheet.getByText(/^[\d.]+ s instead of 1\.5 s$/).waitFor();
    expect(await sheet.getByRole('row', { name: /^Textures/ }).innerText()).toMatch(/kB|MB/);
    await sheet.getByText(/^This model goes down to [\d,]+ triangles\.$/).waitFor();
    expect(await sheet.getByRole('listitem').first().innerText()).toMatch(/^\d+ % of the remaining edges .+\. .+\.$/);
    await page.keyboard.press('Escape');
    await sheet.waitFor({ state: 'detached' });
    expect(await page.getByRole('button', { name: 'Details' }).evaluate((button) => button === document.activeElement)).toBe(true);
  });
});

describe('the address', () => {
  it('brings a sample back as it was left', async () => {
    await openPage({ path: '?sample=desk-fan&triangles=5000&quality=fast&compression=meshopt&prune=1&weights=normal:2,wrong:3&junk=1' });
    await status(/^Ready\. Showing/);
    expect(await wanted()).toBe(5000);
    expect(await page.getByRole('radio', { name: 'Fast', exact: true }).isChecked()).toBe(true);
    expect(await page.getByRole('combobox', { name: 'Compression' }).inputValue()).toBe('meshopt');
    await page.keyboard.press('o');
    expect(await page.getByRole('checkbox', { name: /^Let tiny parts vanish/ }).isChecked()).toBe(true);
    await page.waitForTimeout(500);
    expect(Object.fromEntries(query())).toEqual({
      sample: 'desk-fan', triangles: '5000', quality: 'fast', compression: 'meshopt', prune: '1', weights: 'normal:2', junk: '1',
    });
    await page.reload();
    await status(/^Ready\. Showing/);
    expect(await wanted()).toBe(5000);
    // Another model is not the one that the address was about.
    await dropFiles(page, [helmet]);
    await status(/^Ready\. 94,722/);
    await expect.poll(() => query().has('sample')).toBe(false);
  });

  it('that makes no sense changes nothing', async () => {
    await openPage({ path: '?sample=nothing&triangles=-3&error=abc&size=&quality=worst&compression=zip&lods=1&keep=-1,x&weights=uv:99' });
    await dropFiles(page, [fan]);
    await status(/^Ready\. 21,080/);
  });
});

describe('keys and languages', () => {
  it('shows its keys at ?, in the language that is chosen, and remembers that', async () => {
    await openPage();
    await page.keyboard.press('?');
    const help = page.getByRole('dialog', { name: 'Keys' });
    await help.waitFor();
    await page.keyboard.press('Escape');
    await help.waitFor({ state: 'detached' });
    await page.getByRole('combobox', { name: 'Language' }).selectOption('de');
    await page.getByRole('heading', { name: 'Weniger Dreiecke, gleiches Aussehen' }).waitFor();
    expect(await page.locator('html').getAttribute('lang')).toBe('de');
    await page.reload();
    await page.getByRole('button', { name: 'Modell auswählen' }).or(page.getByLabel('Modell auswählen')).first().waitFor();
    await dropFiles(page, [fan]);
    await status(/^Bereit\. 21\.080 Dreiecke\.$/);
  });

  it.each([['es-MX', 'Elegir un modelo'], ['it', 'Scegli un modello'], ['ja-JP', 'モデルを選ぶ'], ['zh-CN', '选择模型']])('speaks %s where the browser does', async (locale, text) => {
    await openPage({ locale });
    await page.getByLabel(text).waitFor({ state: 'attached' });
    expect(locale.startsWith((await page.locator('html').getAttribute('lang')) ?? '?')).toBe(true);
  });
});

describe('the file and its textures', () => {
  const field = (name: string) => options().getByRole('group', { name: 'Textures' }).getByRole('combobox', { name });

  it('are smaller by what is chosen: in the download, in the figures, in the address and as a command; undone too', async () => {
    await openWithOptions(helmet);
    await fold('File and textures');
    await page.getByRole('button', { name: 'Keep 5 %' }).click();
    await status(/^Ready\. Showing/);
    const quality = options().getByRole('slider', { name: 'Quality' });
    expect(await quality.isDisabled()).toBe(true);
    await field('At most').selectOption('256');
    await field('Format').selectOption('webp');
    await options().getByRole('checkbox', { name: /^Tidy/ }).check();
    await quality.fill('60');
    await expect.poll(() => query().toString()).toContain('prepare=1&texture-size=256&texture-format=webp&texture-quality=60');
    await fold('Command and code');
    await options().getByText('--prepare dedup,prune,resample --texture-size 256 --texture-format webp --texture-quality 0.6').waitFor();
    await page.getByRole('button', { name: 'Copy as code' }).click();
    await options().getByText("textures: { maxSize: 256, format: 'webp', quality: 0.6 }").waitFor();

    const { bytes } = await download();
    expect(await gltfErrors(bytes)).toEqual([]);
    expect(Buffer.from(bytes).includes('"image/webp"')).toBe(true);
    expect(bytes.length).toBeLessThan(0.3 * helmet.bytes.length);
    await page.keyboard.press('i');
    // What the figures tell is the same file.
    const parts = page.getByRole('table').filter({ hasText: 'Textures' });
    const textures = async (): Promise<string[]> => parts.getByRole('row', { name: /^Textures/ }).getByRole('cell').allInnerTexts();
    const kilobytes = (text: string | undefined): number => Number.parseFloat(text ?? '') * (/MB/.test(text ?? '') ? 1000 : 1);
    await expect.poll(async () => kilobytes((await textures()).at(-1)), LONG).toBeLessThan(0.5 * kilobytes((await textures()).at(-2)));
    await expect.poll(async () => (await textures()).at(-1), LONG).not.toBe('');

    await page.keyboard.press('o');
    await fold('File and textures');
    await page.keyboard.press('Control+z');
    expect(await quality.inputValue()).toBe('80');
    for (let step = 0; step < 3; step += 1) await page.keyboard.press('Control+z');
    expect(await field('At most').inputValue()).toBe('');
    expect(await field('Format').inputValue()).toBe('');
    await expect.poll(() => query().has('texture-size')).toBe(false);
  });

  it('are kept for the next visit, refused where the format has none, and taken from an address', async () => {
    await openPage({ path: '?texture-size=300&texture-format=jpeg&texture-quality=abc&prepare=0' });
    await dropFiles(page, [helmet]);
    await ready();
    await page.keyboard.press('o');
    await fold('File and textures');
    expect(await field('At most').inputValue()).toBe('300');
    expect(await field('Format').inputValue()).toBe('jpeg');
    expect(await options().getByRole('checkbox', { name: /^Tidy/ }).isChecked()).toBe(false);
    await page.getByRole('combobox', { name: 'File format' }).selectOption('ply');
    expect(await field('At most').isDisabled()).toBe(true);
    await options().getByText('Only GLB can have it').waitFor();
    await page.goto(pages.url);
    await dropFiles(page, [fan]);
    await ready();
    await page.keyboard.press('o');
    await fold('File and textures');
    expect(await field('At most').inputValue()).toBe('300');
    await page.getByRole('button', { name: 'Reset options' }).click();
    expect(await field('At most').inputValue()).toBe('');
  });
});
