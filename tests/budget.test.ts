// The page's budgets: what counts as what, and that too much is told.
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterEach, expect, it } from 'vitest';
import { overBudget, partOf, partSizes } from '../scripts/page-budget.mjs';

const directory = mkdtempSync(join(tmpdir(), 'decimesh-budget-'));
afterEach(() => rmSync(directory, { recursive: true, force: true }));

it('counts every file whose name it does not know as part of the app', () => {
  expect(partOf('index.html')).toBe('shell');
  expect(partOf('assets/index-A1.js')).toBe('shell');
  expect(partOf('assets/view-worker-A1.js')).toBe('app');
  expect(partOf('assets/decimesh_simd-A1.wasm')).toBe('app');
  expect(partOf('assets/decimesh_scalar-A1.wasm')).toBe('instead');
  expect(partOf('assets/draco_decoder-A1.wasm')).toBe('on demand');
  expect(partOf('assets/painter-A1.js')).toBe('on demand');
  expect(partOf('assets/painting-A1.css')).toBe('on demand');
  expect(partOf('assets/nefertiti-A1.glb')).toBe('samples');
  expect(partOf('assets/something-new-A1.js')).toBe('app');
});

it('adds up the gzipped bytes of a built page, the shell in the app', () => {
  mkdirSync(join(directory, 'assets'), { recursive: true });
  const noise = Buffer.from(Array.from({ length: 4000 }, (_, index) => Math.imul(index + 1, 0x9e3779b1) >>> 24));
  writeFileSync(join(directory, 'index.html'), noise);
  writeFileSync(join(directory, 'assets', 'engine-A1.wasm'), noise);
  const sizes = partSizes(directory);
  expect(sizes.shell).toBeGreaterThan(0);
  expect(sizes.app).toBe(sizes.shell);
  const { shell } = sizes;
  expect(overBudget(sizes, { shell, app: 2 * shell })).toEqual([]);
  expect(overBudget(sizes, { shell: shell - 1, app: 2 * shell })).toEqual([expect.stringMatching(/^The page's shell is \d+ bytes gzipped/)]);
  expect(overBudget(sizes, { shell, app: 2 * shell - 1 })).toEqual([expect.stringContaining("page's app")]);
});
