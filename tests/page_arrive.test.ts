// A model arriving as a progressive mesh, as people watch it: played, paused, begun again, saved, refused, and left.
import { readFileSync } from 'node:fs';
import { decodeProgressive } from 'decimesh/progressive';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { Connection } from '../www/arrival/connection.ts';
import { violationsOf } from './support/axe.ts';
import { dropFiles } from './support/browser.mjs';
import { hills, plyOf } from './support/meshes.ts';
import { LONG, sample, usePages, type PageOptions } from './support/pages.ts';

const land = { name: 'land.ply', bytes: plyOf(hills(120)) };

const pages = usePages({ viewport: { width: 1280, height: 900 } });
const { status } = pages;
let page: Page;

const panel = () => page.getByRole('region', { name: 'Watch it arrive' });
const slider = () => page.getByRole('slider', { name: 'Triangles', exact: true });
const figure = async (name: string): Promise<string> => panel().locator('.figure').filter({ hasText: name }).locator('.after').innerText();
const count = (text: string): number => Number(text.replace(/\D/g, ''));

async function openModel(file: { readonly name: string; readonly bytes: Uint8Array } = land, options: PageOptions = {}): Promise<number> {
  page = await pages.open(options);
  await dropFiles(page, [file]);
  await status(/^Ready/);
  return Number(await slider().inputValue());
}

async function watch(): Promise<void> {
  await page.getByRole('button', { name: 'Details', exact: true }).click();
  await page.getByRole('button', { name: 'Watch it arrive' }).click();
  await panel().waitFor(LONG);
}

const over = (speed: string): Promise<string[]> => panel().getByRole('combobox', { name: 'Connection' }).selectOption(speed);
describe('a model that arrives', () => {
  it('is seen coarse at first and whole at last, and gives the panel back', async () => {
    const all = await openModel();
    await slider().fill('1000');
    await status(/^Ready\. Showing/);
    await watch();
    await over('slow');
    await status(/^First picture after/);
    const early = count(await figure('Triangles'));
    expect(early).toBeGreaterThan(0);
    expect(early).toBeLessThan(all);
    expect(await page.getByRole('button', { name: 'Download', exact: true }).count()).toBe(0);
    await over('none');
    await status(/^land has arrived/);
    expect(count(await figure('Triangles'))).toBe(all);
    expect(await figure('Received')).toBe('100 %');
    await page.keyboard.press('Escape');
    await status(/^Ready\. Showing/);
    expect(await slider().inputValue()).toBe('1000');
  }, 120_000);

  it('waits and goes on by keyboard, and comes again', async () => {
    await openModel();
    await watch();
    await over('slow');
    await status(/^First picture after/);
    await page.locator('#view').focus();
    await page.keyboard.press(' ');
    await status(/^Paused/);
    // What was on its way is told once more.
    await page.waitForTimeout(300);
    const before = await figure('Time');
    await page.waitForTimeout(500);
    expect(await figure('Time')).toBe(before);
    await page.keyboard.press(' ');
    await expect.poll(() => figure('Time'), LONG).not.toBe(before);
    await status(/^land has arrived/);
    await panel().getByRole('button', { name: 'Once more' }).click();
    // Slowly enough to be seen.
    await status(/^First picture after/);
    await status(/^land has arrived/);
  }, 120_000);

  it('waits already before its first picture', async () => {
    await openModel();
    await watch();
    await panel().locator('.primary:enabled').waitFor(LONG);
    // Begun again and paused in one task: the reader has not even started.
    await panel().evaluate((element) => {
      const choice = element.querySelector('select') as HTMLSelectElement;
      choice.value = 'slow';
      choice.dispatchEvent(new Event('change', { bubbles: true }));
      (element.querySelector('.primary') as HTMLButtonElement).click();
    });
    await status(/^Paused/);
    await page.waitForTimeout(1500);
    expect(await figure('Received')).toBe('0 %');
    await panel().getByRole('button', { name: 'Go on' }).click();
    await status(/^First picture after/);
  });

  it('has its file: what is saved is a progressive mesh, which the page opens', async () => {
    const all = await openModel(sample('desk-fan.glb'), { picture: false });
    await watch();
    const button = panel().getByRole('button', { name: 'Download .pmesh' });
    await expect.poll(() => button.isEnabled(), LONG).toBe(true);
    const [saved] = await Promise.all([page.waitForEvent('download', LONG), button.click()]);
    expect(saved.suggestedFilename()).toBe('desk-fan.pmesh');
    const bytes = new Uint8Array(readFileSync(await saved.path()));
    expect(decodeProgressive(bytes).triangles).toBe(all);
    // Another model ends it.
    await dropFiles(page, [{ name: 'again.pmesh', bytes }]);
    await slider().waitFor(LONG);
    await status(/^Ready/);
    expect(Number(await slider().inputValue())).toBe(all);
    expect(await panel().count()).toBe(0);
  });

  it('comes in steps where less motion is asked for', async () => {
    await openModel(land, { picture: false });
    await watch();
    const smooth = panel().getByRole('checkbox', { name: 'Smooth transitions' });
    expect([await smooth.isChecked(), await smooth.isDisabled()]).toEqual([false, true]);
  });

  it('is refused in a sentence where it cannot come', async () => {
    await openModel(land, { picture: false, serviceWorkers: 'block' });
    await page.context().route('**/arrival-worker-*.js', (route) => route.abort());
    await watch();
    await page.locator('.notice').filter({ hasText: 'worker-lost' }).waitFor(LONG);
    expect(await slider().isVisible()).toBe(true);
    pages.forgive('ERR_FAILED');
  });

  it.each(['light', 'dark'] as const)('has nothing that axe-core objects to, in the %s', async (colorScheme) => {
    await openModel(land, { colorScheme, viewport: { width: 360, height: 760 } });
    await watch();
    expect(await violationsOf(page)).toEqual([]);
    await status(/^land has arrived/);
    expect(await violationsOf(page)).toEqual([]);
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(360);
  });
});

describe('a connection', () => {
  it('hands over what is due by its clock, nothing while it is paused, and all at infinite speed', async () => {
    let now = 0;
    const bytes = Uint8Array.from({ length: 5000 }, (_, index) => index);
    const connection = new Connection(bytes, 1000, () => now);
    const pieces: Uint8Array[] = [];
    const done = (async () => {
      for await (const piece of connection) pieces.push(piece);
    })();
    const rest = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 60));
    now = 2000;
    await rest();
    expect(connection.received).toBe(2000);
    connection.pause();
    now = 60_000;
    await rest();
    expect([connection.received, connection.elapsed]).toEqual([2000, 2000]);
    connection.resume();
    now = 63_000;
    await done;
    expect(connection.elapsed).toBe(5000);
    expect(Buffer.concat(pieces)).toEqual(Buffer.from(bytes));
    let received = 0;
    for await (const piece of new Connection(bytes, Infinity, () => 0)) received += piece.length;
    expect(received).toBe(5000);
  });
});
