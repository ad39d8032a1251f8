// The error-bounded mode: what is measured stays within the limit, and not much finer than it has to be.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument } from 'decimesh';
import { findWithin } from '../dist/bounded.js';
import { glb, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { meter, testWithMeter } from './support/meter.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';

beforeAll(() => init());

describe('the search', () => {
  const run = async (maxOf: (triangles: number) => number, limit: number, least = 10, start = 500): Promise<{ found: number; asked: number }> => {
    let asked = 0;
    const found = await findWithin(limit, { least, most: 10_000, start }, async (wanted) => {
      asked += 1;
      const triangles = Math.max(wanted, least);
      return { triangles, max: maxOf(triangles) };
    });
    return { found, asked };
  };

  it('finds the place where a falling maximum passes the limit', async () => {
    for (const limit of [0.2, 1, 3, 9]) {
      const { found, asked } = await run((n) => 1000 / n, limit);
      expect(1000 / found).toBeLessThanOrEqual(limit);
      expect(found).toBeLessThanOrEqual((1000 / limit) * 1.03 + 1);
      expect(asked).toBeLessThan(20);
    }
  });

  it('ends at full detail, at the coarsest there is, and with a maximum that goes up and down', async () => {
    expect((await run(() => 5, 1)).found).toBe(10_000);
    expect((await run(() => 0, 1)).found).toBe(10);
    const { found } = await run((n) => 1000 / n + (n % 7 === 0 ? 0.5 : 0), 2);
    expect(1000 / found + (found % 7 === 0 ? 0.5 : 0)).toBeLessThanOrEqual(2);
  });
});

it('the level that is selected was measured and is within the limit', async () => {
  using document = await openDocument(glb(gltfOf(hills(40))));
  const fractions: number[] = [];
  const level = await document.simplify({ maximumDeviation: '0.5%', onProgress: (fraction) => fractions.push(fraction) });
  const { max } = await document.measure({ samples: 1_000_000 });
  expect(max).toBeLessThanOrEqual(0.005 * document.summary.diagonal);
  expect(level.triangles).toBeLessThan(0.8 * document.summary.triangles);
  expect(level.stopReason).toBe('error');
  expect(fractions).toEqual([...fractions].sort((a, b) => a - b));
  expect(fractions.filter((fraction) => fraction === 1)).toEqual([1]);
  // Much coarser is over the limit.
  await document.level({ triangles: Math.floor(level.triangles / 1.5) });
  expect((await document.measure()).max).toBeGreaterThan(0.005 * document.summary.diagonal * 0.9);
  // Of several targets the first that is reached counts.
  const both = await document.simplify({ maximumDeviation: '0.5%', ratio: 0.9 });
  expect(both.triangles / document.summary.triangles).toBeGreaterThan(0.88);
  expect(both.stopReason).toBe('target');
  for (const options of [{ maximumDeviation: 0 }, { maximumDeviation: -1 }, { maximumDeviation: 1, keepLevels: true }, { maximumDeviation: 1, everyLevel: false }]) {
    await expect(document.simplify(options)).rejects.toMatchObject({ code: 'invalid-argument' });
  }
  const controller = new AbortController();
  const aborted = document.simplify({ maximumDeviation: '0.1%', signal: controller.signal, onProgress: (fraction) => fraction > 0.4 && controller.abort(new Error('enough')) });
  await expect(aborted).rejects.toThrow('enough');
  expect((await document.write()).report.output.triangles).toBe(document.summary.triangles);
});

it('on the command line', async () => {
  const directory = temporaryDirectory();
  const [input, output] = ['in.glb', 'out.glb'].map((name) => join(directory, name)) as [string, string];
  writeFileSync(input, glb(gltfOf(hills(30))));
  const { code, stdout } = await decimesh(input, '-o', output, '--max-deviation', '1%', '--json');
  expect(code).toBe(0);
  const report = JSON.parse(stdout) as { deviation: { max: number; relativeTo: number }; stopReason: string };
  expect(report.deviation.max).toBeLessThan(0.01 * report.deviation.relativeTo);
  expect((await decimesh(input, '-o', output, '--max-deviation', 'much')).code).toBe(2);
  expect((await decimesh(input, '-o', output, '--max-deviation', '1%', '--size', '1k')).code).toBe(2);
});

for (const name of ['fandisk', 'rocker-arm'] as const) {
  testWithMeter(name, 'an independent meter says so too:', async (bytes) => {
    using document = await openDocument([{ name: 'model.obj', bytes }]);
    const level = await document.simplify({ maximumDeviation: '0.5%' });
    const written = await document.write({ format: 'obj' });
    const { haus } = meter(bytes, written.bytes);
    expect(haus).toBeLessThanOrEqual(0.5);
    // `best` with fewer by a quarter is farther away than this.
    await document.simplify({ triangles: Math.floor(level.triangles / 1.25), preset: 'best', keepLevels: true });
    const { max } = await document.measure();
    expect(max).toBeGreaterThan(written.report.deviation?.max ?? Infinity);
  });
}
