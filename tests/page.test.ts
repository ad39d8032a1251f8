// The page as people use it: a real browser, real files, found by role and name. Any console error fails a test.
import { readFileSync, readdirSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { zipSync } from 'fflate';
import { describe, expect, it } from 'vitest';
import { openDocument } from 'decimesh';
import { readFirstPrimitive, subdivide, writeGlb } from '../benches/support/subdivide.mjs';
import { at } from '../scripts/project.mjs';
import { dropFiles } from './support/browser.mjs';
import { INVALID_FILES, WITHOUT_TRIANGLES } from './support/invalid_files.ts';
import { ONE_PIXEL, hills, plyOf } from './support/meshes.ts';
import { LONG, sample, usePages, type PageOptions } from './support/pages.ts';
import { pictureNow, stillPicture } from './support/picture.ts';
import { gltfErrors } from './support/validate.ts';

const fixture = (...path: string[]): Buffer => readFileSync(at('tests', 'fixtures', ...path));
const fan = sample('desk-fan.glb');
const nefertiti = sample('nefertiti.glb');

const pages = usePages({ viewport: { width: 1100, height: 760 }, serviceWorkers: 'block', plainGround: true });
const { glimpse, status } = pages;
let page: Page;

async function openPage(options: PageOptions = {}): Promise<void> {
  page = await pages.open(options);
}

const slider = () => page.getByRole('slider', { name: 'Triangles', exact: true });
const ready = () => status(/^Ready/);
const wanted = async (): Promise<number> => Number(await slider().inputValue());
const figure = async (name: string): Promise<string> =>
  page.getByRole('term').filter({ hasText: name }).locator('xpath=following-sibling::dd').locator('.after').innerText();
const shownTriangles = async (): Promise<number> => Number((await figure('Triangles')).replaceAll(',', ''));
const quality = (name: string) => page.getByRole('radio', { name, exact: true });
const sizeIsMeasured = () => page.locator('.mesh-stats .pending').first().waitFor({ ...LONG, state: 'detached' });

async function drop(...files: Array<{ name: string; bytes: Uint8Array }>): Promise<void> {
  await dropFiles(page, files);
}

async function download(): Promise<{ name: string; bytes: Buffer }> {
  const [saved] = await Promise.all([
    page.waitForEvent('download', LONG),
    page.getByRole('button', { name: 'Download', exact: true }).click(),
  ]);
  return { name: saved.suggestedFilename(), bytes: readFileSync(await saved.path()) };
}

describe('the main job', () => {
  it('drops a GLB, moves the slider by keyboard, downloads a valid smaller file and opens it again', async () => {
    await openPage();
    await drop(fan);
    await ready();
    expect(await wanted()).toBe(21_080);
    expect(await figure('File size')).toBe('1.66 MB');

    await slider().focus();
    await page.keyboard.press('PageDown');
    await page.keyboard.press('PageDown');
    const target = await wanted();
    expect(target).toBeLessThan(21_080);
    await status(/^Ready\. Showing/);
    const shown = await shownTriangles();
    expect(shown).toBeLessThanOrEqual(target);
    expect(shown).toBeGreaterThan(target - 20);
    expect(await figure('Estimated error')).toMatch(/^(?!0 %)[\d.]+ %$/);
    await sizeIsMeasured();
    expect(await figure('File size')).not.toBe('1.66 MB');

    const saved = await download();
    // The level that was saved is the one on screen now.
    const fitted = await shownTriangles();
    expect(fitted).toBeLessThanOrEqual(target);
    expect(fitted).toBeGreaterThan(target - 20);
    expect(saved.name).toBe('desk-fan.glb');
    expect(saved.bytes.length).toBeLessThan(fan.bytes.length);
    expect(await gltfErrors(new Uint8Array(saved.bytes))).toEqual([]);

    await drop({ name: 'again.glb', bytes: saved.bytes });
    await ready();
    expect(await wanted()).toBe(fitted);
    await expect.poll(() => page.title(), LONG).toContain('again');
    expect(await page.getByRole('combobox', { name: 'Animation' }).locator('option').count()).toBe(4);
  });

  it('opens compressed models, keeps their compression, and saves with another', async () => {
    await openPage();
    for (const compression of ['meshopt', 'draco'] as const) {
      if (compression === 'meshopt') await drop({ name: 'box.glb', bytes: fixture('codecs', 'BoxMeshopt.glb') });
      else await drop({ name: 'box.gltf', bytes: fixture('codecs', 'BoxDraco', 'BoxDraco.gltf') }, { name: '0.bin', bytes: fixture('codecs', 'BoxDraco', '0.bin') });
      await ready();
      expect(await page.getByRole('combobox', { name: 'Compression' }).inputValue()).toBe(compression);
      using kept = await openDocument(new Uint8Array((await download()).bytes));
      expect(kept.summary.compression).toBe(compression);
    }
    await page.getByRole('combobox', { name: 'Compression' }).selectOption('Meshopt, quantised');
    const saved = await download();
    expect(await gltfErrors(new Uint8Array(saved.bytes))).toEqual([]);
    using packed = await openDocument(new Uint8Array(saved.bytes));
    expect(packed.summary).toMatchObject({ compression: 'meshopt', triangles: 12 });
    await page.getByRole('combobox', { name: 'File format' }).selectOption('OBJ');
    expect(await page.getByRole('combobox', { name: 'Compression' }).count()).toBe(0);
  });

  it('saves OBJ under the original name', async () => {
    await openPage();
    await drop({ name: 'my model.v2.obj', bytes: fixture('obj', 'concave.obj') });
    await ready();
    await page.getByRole('combobox', { name: 'File format' }).selectOption('OBJ');
    const saved = await download();
    expect(saved.name).toBe('my model.v2.obj');
    expect(saved.bytes.toString()).toMatch(/^f /m);
    await drop(saved);
    await ready();
  });

  it.each(['ply', 'stl', 'off', 'smf'] as const)('opens %s, whatever it is called, and saves the same format', async (format) => {
    using document = await openDocument(plyOf(hills(8)));
    const { bytes } = await document.write({ format });
    await openPage();
    await drop({ name: `scan.${format}`, bytes });
    await ready();
    expect(await wanted()).toBe(128);
    expect(await page.getByRole('combobox', { name: 'File format' }).inputValue()).toBe(format);
    const saved = await download();
    expect(saved.name).toBe(`scan.${format}`);
    using again = await openDocument(new Uint8Array(saved.bytes));
    expect(again.summary).toMatchObject({ format, triangles: 128 });
  });

  it('says what a format cannot hold when it saves it', async () => {
    await openPage();
    await drop(fan);
    await ready();
    await page.getByRole('combobox', { name: 'File format' }).selectOption('STL');
    const saved = await download();
    expect(saved.name).toBe('desk-fan.stl');
    await status(/Saved desk-fan\.stl\. STL cannot hold what the file has: .*materials/);
    using again = await openDocument(new Uint8Array(saved.bytes));
    expect(again.summary.format).toBe('stl');
  });

  it('takes an OBJ with its materials and textures', async () => {
    await openPage();
    const obj = 'mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl wood\nf 1/1 2/2 3/3\n';
    await drop(
      { name: 'wood.png', bytes: ONE_PIXEL },
      { name: 'a.mtl', bytes: Buffer.from('newmtl wood\nmap_Kd wood.png\n') },
      { name: 'a.obj', bytes: Buffer.from(obj) },
    );
    await ready();
    await page.getByRole('combobox', { name: 'File format' }).selectOption('GLB');
    const saved = await download();
    expect(await gltfErrors(new Uint8Array(saved.bytes))).toEqual([]);
    expect(saved.bytes.includes(ONE_PIXEL)).toBe(true);
  });

  it('takes a zip of a model with its files', async () => {
    await openPage();
    const obj = 'mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n';
    const bytes = zipSync({ 'model/a.mtl': Buffer.from('newmtl red\nKd 1 0 0\n'), 'model/a.obj': Buffer.from(obj) });
    await drop({ name: 'triangle.zip', bytes });
    await ready();
    await expect.poll(() => page.title(), LONG).toContain('triangle');
    expect(await page.getByRole('combobox', { name: 'File format' }).inputValue()).toBe('obj');
  });

  it('takes a glTF with its files', async () => {
    await openPage();
    await drop(
      { name: '18_variants.bin', bytes: fixture('gltf', '18_variants', '18_variants.bin') },
      { name: '18_variants.gltf', bytes: fixture('gltf', '18_variants', '18_variants.gltf') },
    );
    await ready();
    expect(await wanted()).toBe(12);
    expect((await download()).name).toBe('18_variants.glb');
  });

  it('opens a chosen folder with the files that its model refers to, from the start and from the bar', async () => {
    const folder = at('tests', 'fixtures', 'gltf', '18_variants');
    await openPage();
    const chooser = page.getByLabel('Choose a folder');
    expect(await chooser.getAttribute('webkitdirectory')).not.toBeNull();
    await chooser.setInputFiles(folder);
    await ready();
    expect(await wanted()).toBe(12);
    await page.reload();
    await page.getByLabel('Choose a model').setInputFiles(at('tests', 'fixtures', 'gltf', 'cubevc.glb'));
    await ready();
    await page.getByLabel('Choose a folder').setInputFiles(folder);
    await expect.poll(wanted).toBe(12);
    await ready();
  });

  it('opens a chosen file and a sample', async () => {
    await openPage();
    await page.getByLabel('Choose a model').setInputFiles(at('tests', 'fixtures', 'gltf', 'cubevc.glb'));
    await ready();
    expect(await wanted()).toBe(48);
    await page.reload();
    await page.getByRole('button', { name: /^Nefertiti/ }).click();
    await ready();
    expect(await wanted()).toBe(70_000);
    await page.getByText('public domain').waitFor();
  });
});

describe('?model=', () => {
  it('opens a model from an address', async () => {
    const asset = readdirSync(at('site', 'assets')).find((name) => /^nefertiti.*\.glb$/.test(name));
    await openPage({ path: `?model=assets/${asset}` });
    await ready();
    expect(await wanted()).toBe(70_000);
  });

  it('opens a glTF with the files beside it', async () => {
    await openPage();
    await page.route('**/models/*', (route) => {
      const name = new URL(route.request().url()).pathname.split('/').pop() ?? '';
      return route.fulfill({ body: fixture('gltf', '18_variants', name) });
    });
    await page.goto(`${pages.url}?model=models/18_variants.gltf`);
    await ready();
    expect(await wanted()).toBe(12);
    expect((await download()).name).toBe('18_variants.glb');
  });

  it('says what is wrong with an address', async () => {
    await openPage({ path: '?model=assets/missing.glb' });
    await page.getByRole('alert').filter({ hasText: 'cannot-read' }).waitFor();
    expect(await page.getByRole('alert').innerText()).toContain('404');
    // The browser itself reports the 404.
    pages.forgive('404');
    await drop(nefertiti);
    await ready();
  });
});

describe('bad files', () => {
  const good = fixture('gltf', 'cubevc.glb');

  it('gives each its notice with a code, and keeps the model and the page working', async () => {
    await openPage();
    await drop({ name: 'good.glb', bytes: good });
    await ready();
    for (const { name, bytes, code, place } of [...INVALID_FILES, ...WITHOUT_TRIANGLES]) {
      await drop({ name, bytes });
      const notice = page.getByRole('alert');
      await notice.waitFor(LONG);
      expect(await notice.locator('code').innerText(), name).toBe(code);
      expect(await notice.innerText(), name).toMatch(place);
      await notice.getByRole('button', { name: 'Dismiss' }).click();
      await notice.waitFor({ state: 'detached' });
      expect(await wanted(), `the model after ${name}`).toBe(48);
    }
    await slider().focus();
    await page.keyboard.press('Home');
    await status(/^Ready\. Showing/);
    await drop(nefertiti);
    await ready();
    expect(await wanted()).toBe(70_000);
  });

  it('puts the notice away by Escape, without a model too', async () => {
    await openPage();
    await drop({ name: 'text.glb', bytes: Buffer.from('nothing') });
    await page.getByRole('alert').waitFor();
    await page.keyboard.press('Escape');
    await page.getByRole('alert').waitFor({ state: 'detached' });
    await page.getByRole('button', { name: /^Desk fan/ }).waitFor();
  });
});

describe('the slider', () => {
  it('goes by arrows, pages, Home and End, and can be undone', async () => {
    await openPage();
    await drop(nefertiti);
    await ready();
    await slider().focus();
    const press = async (key: string): Promise<number> => {
      await page.keyboard.press(key);
      return wanted();
    };
    const arrow = await press('ArrowLeft');
    expect(arrow).toBeLessThan(70_000);
    const paged = await press('PageDown');
    expect(paged).toBeLessThan(arrow * 0.6);
    expect(await press('Shift+ArrowRight')).toBe(paged + 1);
    const fewest = await press('Home');
    expect(fewest).toBe(Number(await slider().getAttribute('min')));
    await status(/^Ready\. Showing/);
    expect(await slider().getAttribute('aria-valuetext')).toMatch(/^[\d,]+ of 70,000 triangles/);
    expect(await press('End')).toBe(70_000);
    expect(await press('Control+z')).toBe(fewest);
    expect(await press('Control+z')).toBe(paged + 1);
    expect(await press('Control+Shift+z')).toBe(fewest);

    const field = page.getByRole('textbox', { name: 'Exact triangle count' });
    await field.fill('12,345');
    await field.press('Enter');
    expect(await wanted()).toBe(12_345);
    await page.getByRole('button', { name: 'Keep 10 %' }).click();
    await status(/^Ready\. Showing (7,000|6,9\d\d) of 70,000/);
    // A script or a screen reader may set the value itself.
    await slider().fill('500');
    await status(/^Ready\. Showing (500|49\d) of/);
  });

  it('follows the pointer, and one drag is one step to undo', async () => {
    await openPage();
    await drop(nefertiti);
    await ready();
    const box = await slider().boundingBox();
    if (box === null) throw new Error('the slider is not visible');
    await page.mouse.move(box.x + box.width - 13, box.y + box.height / 2);
    await page.mouse.down();
    for (const part of [0.9, 0.7, 0.5]) await page.mouse.move(box.x + box.width * part, box.y + box.height / 2);
    await page.mouse.up();
    expect(await wanted()).toBeLessThan(7000);
    await page.getByRole('button', { name: 'Undo' }).click();
    expect(await wanted()).toBe(70_000);
  });

  it('may be moved while the history is recorded, which Escape stops', async () => {
    await openPage();
    const large = writeGlb(subdivide(readFirstPrimitive(nefertiti.bytes), 1));
    await drop({ name: 'large.glb', bytes: large });
    await glimpse('[role=progressbar][aria-label^="Simplifying"]');
    await page.keyboard.press('Escape');
    await status(/^Cancelled/);
    await slider().focus();
    await page.keyboard.press('PageDown');
    await status(/^Simplifying/);
    await page.keyboard.press('PageDown');
    const target = await wanted();
    await status(/^Ready\. Showing/);
    expect(await shownTriangles()).toBeLessThanOrEqual(target);
  });
});

describe('measuring', () => {
  const measure = () => page.getByRole('button', { name: 'Measure', exact: true });
  const cancel = () => page.getByRole('button', { name: 'Cancel measuring' });

  it('shows what is between the level and the original, until another level is wanted', async () => {
    await openPage();
    await drop(nefertiti);
    await ready();
    await slider().fill('2000');
    await status(/^Ready\. Showing/);
    await measure().focus();
    await page.keyboard.press('Enter');
    await status(/^Measured: 0\.\d+ % of the diagonal at most, 0\.0\d+ % on average\.$/);
    expect(await figure('Measured error')).toMatch(/^0\.[1-9]\d* % at most$/);
    await page.getByText(/^mean 0\.0\d+ % · rms 0\.0\d+ %$/).waitFor();
    // The download is of the same level, unless it is to be better.
    await quality('Fast').check();
    await download();
    await page.getByRole('term').filter({ hasText: 'Measured error' }).waitFor();
    await slider().fill('1000');
    await status(/^Ready\. Showing/);
    expect(await page.getByText('Measured error').count()).toBe(0);
    expect(await figure('Estimated error')).toMatch(/ %$/);
    await measure().click();
    await status(/^Measured/);
  });

  it('has a bar, keeps the focus, and is stopped by its button, by Escape or by another wish', async () => {
    await openPage();
    await drop({ name: 'large.glb', bytes: writeGlb(subdivide(readFirstPrimitive(nefertiti.bytes), 1)) });
    await ready();
    const bar = '[role=progressbar][aria-label="Measuring"]';
    await measure().focus();
    await page.keyboard.press('Enter');
    await glimpse(bar);
    expect(await cancel().evaluate((button) => button === document.activeElement)).toBe(true);
    await page.keyboard.press('Enter');
    await status(/^Cancelled measuring/);
    await measure().click();
    await glimpse(bar);
    await page.keyboard.press('Escape');
    await status(/^Cancelled measuring/);
    await measure().click();
    await glimpse(bar);
    await slider().fill('3000');
    await status(/^Ready\. Showing/);
    expect(await page.locator(bar).count()).toBe(0);
    await measure().click();
    await status(/^Measured/);
  });
});

describe('the quality', () => {
  const trianglesOf = async ({ bytes }: { bytes: Buffer }): Promise<number> => {
    using document = await openDocument(new Uint8Array(bytes));
    return document.summary.triangles;
  };

  it('is one choice of three with a name, by keyboard too, and is remembered', async () => {
    await openPage();
    await drop(fan);
    await ready();
    const group = page.getByRole('group', { name: 'Quality' });
    expect(await group.getByRole('radio').count()).toBe(3);
    expect(await quality('Balanced').isChecked()).toBe(true);
    await quality('Balanced').focus();
    await page.keyboard.press('ArrowRight');
    expect(await quality('Best').isChecked()).toBe(true);
    await page.reload();
    await drop(fan);
    await ready();
    expect(await quality('Best').isChecked()).toBe(true);
  });

  it('fits the level to the original before it is saved, shows it, and leaves the slider its levels', async () => {
    await openPage();
    await drop(nefertiti);
    await ready();
    await slider().fill('2000');
    await status(/^Ready\. Showing/);
    const measured = async (): Promise<string> => {
      await page.getByRole('button', { name: 'Measure', exact: true }).click();
      await status(/^Measured/);
      return page.getByText(/^mean .* rms/).innerText();
    };
    const asShown = await measured();
    await quality('Fast').check();
    const fast = await download();
    // What is on screen was saved: what was measured still holds.
    expect(await page.getByText(/^mean .* rms/).innerText()).toBe(asShown);

    await quality('Best').check();
    const best = await download();
    expect(best.name).toBe('nefertiti.glb');
    expect(best.bytes.equals(fast.bytes)).toBe(false);
    expect(await trianglesOf(best)).toBeLessThanOrEqual(2000);
    expect(await trianglesOf(best)).toBeGreaterThan(1900);
    expect(await gltfErrors(new Uint8Array(best.bytes))).toEqual([]);
    expect(await page.getByText('Measured error').count()).toBe(0);
    const fitted = await measured();
    const rms = (text: string): number => Number(/rms ([\d.]+)/.exec(text)?.[1]);
    expect(rms(fitted)).toBeLessThan(rms(asShown));
    // Again, without another run: the level is there.
    expect((await download()).bytes.equals(best.bytes)).toBe(true);

    await slider().fill('20000');
    await status(/^Ready\. Showing (20,000|19,9\d\d)/);
    await slider().fill('2000');
    await status(/^Ready\. Showing (2,000|1,9\d\d)/);
    expect(await measured()).toBe(asShown);
    await quality('Fast').check();
    expect((await download()).bytes.equals(fast.bytes)).toBe(true);
  });

  it('may be waited for, cancelled, or overtaken by another wish', async () => {
    await openPage();
    await drop({ name: 'large.glb', bytes: writeGlb(subdivide(readFirstPrimitive(nefertiti.bytes), 1)) });
    await ready();
    await slider().fill('20000');
    await status(/^Ready\. Showing/);
    await quality('Best').check();
    const saved: string[] = [];
    page.on('download', (file) => saved.push(file.suggestedFilename()));
    const start = () => page.getByRole('button', { name: 'Download', exact: true }).click();
    await start();
    await status(/^Fitting large\.glb/);
    await glimpse('[role=progressbar]');
    await page.getByRole('button', { name: 'Cancel', exact: true }).click();
    await status(/^(Cancelled|Ready)/);
    expect(saved).toEqual([]);
    await ready();

    await start();
    await status(/^Fitting large\.glb/);
    const coming = page.waitForEvent('download', LONG);
    await slider().fill('10000');
    const file = await coming;
    using document = await openDocument(new Uint8Array(readFileSync(await file.path())));
    expect(document.summary.triangles).toBeLessThanOrEqual(10_000);
    expect(await shownTriangles()).toBe(document.summary.triangles);
    expect(saved).toHaveLength(1);
  });
});

describe('the view', () => {
  const AREA = { x: 200, y: 100, width: 700, height: 380 };
  const picture = (): Promise<Buffer> => stillPicture(page, AREA);
  const pictureBecomes = (test: (now: Buffer) => boolean) => expect.poll(async () => test(await pictureNow(page, AREA)), LONG).toBe(true);

  it('shows the model, orbits, draws edges and compares with the original', async () => {
    await openPage();
    const empty = await picture();
    await drop(nefertiti);
    await ready();
    await pictureBecomes((now) => !now.equals(empty));
    const original = await picture();

    await slider().focus();
    await page.keyboard.press('Home');
    await status(/^Ready\. Showing/);
    await pictureBecomes((now) => !now.equals(original));
    const coarse = await picture();
    await page.keyboard.down('c');
    await pictureBecomes((now) => now.equals(original));
    await page.keyboard.up('c');
    await pictureBecomes((now) => now.equals(coarse));
    const compare = page.getByRole('button', { name: 'Hold to compare with the original' });
    await compare.focus();
    await page.keyboard.down(' ');
    await pictureBecomes((now) => now.equals(original));
    await page.keyboard.up(' ');
    await pictureBecomes((now) => now.equals(coarse));

    const edges = page.getByRole('button', { name: 'Wireframe' });
    await edges.click();
    expect(await edges.getAttribute('aria-pressed')).toBe('true');
    await pictureBecomes((now) => !now.equals(coarse));
    await edges.click();
    await pictureBecomes((now) => now.equals(coarse));

    await page.getByRole('application').focus();
    await page.keyboard.press('ArrowLeft');
    await pictureBecomes((now) => !now.equals(coarse));
    await page.keyboard.press('f');
    await page.getByRole('button', { name: 'Fit to view' }).focus();
    await pictureBecomes((now) => now.equals(coarse));
    await page.mouse.move(500, 250);
    await page.mouse.down();
    await page.mouse.move(620, 260);
    await page.mouse.up();
    await pictureBecomes((now) => !now.equals(coarse));
  });

  it('plays and pauses an animation', async () => {
    await openPage();
    await drop(fan);
    await ready();
    const still = await picture();
    await page.getByRole('combobox', { name: 'Animation' }).selectOption('fanRunning');
    await page.getByRole('button', { name: 'Play animation' }).click();
    await pictureBecomes((now) => !now.equals(still));
    await page.getByRole('button', { name: 'Pause animation' }).click();
    await page.getByRole('button', { name: 'Play animation' }).waitFor();
  });

  it('draws skins and morph targets at a lower level too', async () => {
    await openPage();
    for (const name of ['AnimatedMorphCube.glb', 'SimpleSkin.gltf']) {
      await drop({ name, bytes: fixture('gltf', name) });
      await ready();
      await slider().focus();
      await page.keyboard.press('Home');
      await status(/^Ready\. Showing/);
      expect(await shownTriangles()).toBe(await wanted());
    }
  });

  it('works on the page itself where canvases cannot be given to workers, and survives a lost context', async () => {
    await openPage();
    await page.addInitScript(() => Reflect.deleteProperty(HTMLCanvasElement.prototype, 'transferControlToOffscreen'));
    await page.reload();
    const empty = await picture();
    await drop(nefertiti);
    await ready();
    await pictureBecomes((now) => !now.equals(empty));
    const before = await picture();
    await page.evaluate(() => {
      const gl = document.querySelector('canvas')?.getContext('webgl2');
      const loser = gl?.getExtension('WEBGL_lose_context');
      Object.assign(globalThis, { restore: () => loser?.restoreContext() });
      loser?.loseContext();
    });
    await status(/graphics card/);
    await page.evaluate(() => (globalThis as unknown as { restore(): void }).restore());
    await ready();
    await pictureBecomes((now) => now.equals(before));
  });

  it('goes on without WebGL', async () => {
    await openPage();
    await page.addInitScript(() => {
      Reflect.deleteProperty(HTMLCanvasElement.prototype, 'transferControlToOffscreen');
      HTMLCanvasElement.prototype.getContext = () => null;
    });
    await page.reload();
    await page.getByRole('alert').filter({ hasText: 'no-webgl' }).waitFor();
    // three says it too.
    pages.forgive('WebGL');
    await drop(fan);
    await ready();
    await slider().focus();
    await page.keyboard.press('PageDown');
    await status(/^Ready\. Showing/);
    expect((await download()).bytes.length).toBeLessThan(fan.bytes.length);
  });
});

describe('for everyone', () => {
  const scrollsSideways = () => page.evaluate(() => document.documentElement.scrollWidth > innerWidth);

  it('names everything that can be used', async () => {
    await openPage();
    const unnamed = async (): Promise<string[]> => {
      const found: string[] = [];
      for (const role of ['button', 'link', 'slider', 'combobox', 'textbox', 'progressbar', 'application', 'toolbar'] as const) {
        for (const element of await page.getByRole(role).all()) {
          // Playwright computes names as assistive technology does: the snapshot's line has it in quotes.
          const line = (await element.ariaSnapshot()).split('\n')[0] ?? '';
          if (!/"[^"]+"/.test(line)) found.push(`${role}: ${await element.evaluate((node) => node.outerHTML.slice(0, 120))}`);
        }
      }
      return found;
    };
    expect(await unnamed()).toEqual([]);
    expect(await page.getByRole('heading', { level: 1 }).count()).toBe(1);
    expect(await page.getByRole('main').count()).toBe(1);
    expect(await page.getByRole('listitem').getByRole('button').count()).toBeGreaterThanOrEqual(3);
    expect(await page.getByLabel('Choose a model').getAttribute('type')).toBe('file');
    await drop(fan);
    await ready();
    expect(await unnamed()).toEqual([]);
    expect(await page.getByRole('status').count()).toBe(1);
    expect(await page.locator('html').getAttribute('lang')).toBe('en');
    expect(await page.evaluate(() => {
      const ids = [...document.querySelectorAll('[id]')].map(({ id }) => id);
      return ids.length - new Set(ids).size;
    })).toBe(0);
  });

  it('fits 360 pixels, with room for fingers', async () => {
    await openPage({ viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true });
    expect(await scrollsSideways()).toBe(false);
    await drop(fan);
    await ready();
    expect(await scrollsSideways()).toBe(false);
    for (const target of [slider(), page.locator('.quality label').first(), page.locator('.quality label').last(), page.getByRole('button', { name: 'Download', exact: true }), page.getByRole('button', { name: 'Wireframe' })]) {
      const box = await target.boundingBox();
      expect(box?.height).toBeGreaterThanOrEqual(36);
      expect(box?.x).toBeGreaterThanOrEqual(0);
      expect((box?.x ?? 0) + (box?.width ?? 0)).toBeLessThanOrEqual(360);
    }
    await drop({ name: 'a-very-long-name-that-fits-into-no-bar-of-any-telephone-at-all.glb', bytes: Buffer.from('no model') });
    await page.getByRole('alert').waitFor();
    expect(await scrollsSideways()).toBe(false);
  });

  it('remembers dark and light', async () => {
    await openPage({ colorScheme: 'light' });
    const paper = () => page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--paper').trim());
    const light = await paper();
    await page.getByRole('button', { name: 'Theme: system' }).click();
    await page.getByRole('button', { name: 'Theme: light' }).click();
    await page.getByRole('button', { name: 'Theme: dark' }).waitFor();
    expect(await paper()).not.toBe(light);
    await page.reload();
    await page.getByRole('button', { name: 'Theme: dark' }).waitFor();
    expect(await paper()).not.toBe(light);
  });
});
