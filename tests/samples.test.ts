// The sample models are what their labels say, and valid.
import { readFileSync, statSync } from 'node:fs';
import { expect, it } from 'vitest';
import { openDocument } from 'decimesh';
import { at } from '../scripts/project.mjs';
import { gltfErrors } from './support/validate.ts';

// The bundler's addresses are nothing to import here: the labels are read as text.
const source = readFileSync(at('www', 'samples', 'samples.ts'), 'utf8');
const labels = [...source.matchAll(/fileName: '([^']+)'.*triangles: ([\d_]+), bytes: ([\d_]+)/g)].map(([, name = '', triangles = '', bytes = '']) => ({
  name, triangles: Number(triangles.replaceAll('_', '')), bytes: Number(bytes.replaceAll('_', '')),
}));

it('are four', () => {
  expect(labels).toHaveLength(4);
});

it.each(labels)('$name is valid and as large as it says', async ({ name, triangles, bytes }) => {
  const path = at('www', 'samples', name);
  expect(statSync(path).size).toBe(bytes);
  const file = new Uint8Array(readFileSync(path));
  using document = await openDocument(file);
  expect(document.summary.triangles).toBe(triangles);
  expect(await gltfErrors(file)).toEqual([]);
  expect(readFileSync(at('www', 'samples', 'README.md'), 'utf8')).toContain(`\`${name}\` | ${triangles.toLocaleString('en')} triangles`);
});
