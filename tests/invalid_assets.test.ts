// Every broken file of the assets, through the package: a typed error or a document, and the engine lives on.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { basename, dirname, join, relative } from 'node:path';
import { expect, it } from 'vitest';
import { DecimeshError, externalFiles, init, openDocument } from 'decimesh';
import { assetPath } from './support/assets.ts';
import { glb, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';

const root = assetPath('invalid');
const present = existsSync(root);
if (!present) console.log('skipped: broken files: ../shared/assets/invalid is not there');

/** Nothing takes this long, in milliseconds, but what does not end. */
const HANGS = 20_000;

it.skipIf(!present)('broken files are typed errors or documents', { timeout: 300_000 }, async () => {
  await init();
  const paths = readdirSync(root, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile()).map(({ parentPath, name }) => join(parentPath, name));
  const counts = new Map<string, number>();
  let slowest = { name: '', milliseconds: 0 };
  for (const path of paths.sort()) {
    const name = relative(root, path);
    const bytes = new Uint8Array(readFileSync(path));
    const files = [{ name: basename(path), bytes }];
    for (const uri of externalFiles(bytes)) {
      const found = join(dirname(path), uri);
      if (found.startsWith(root) && existsSync(found)) files.push({ name: uri, bytes: new Uint8Array(readFileSync(found)) });
    }
    const start = performance.now();
    let outcome = 'opened';
    try {
      using document = await openDocument(files);
      await document.simplify({ ratio: 0.5, preset: 'fast' });
      await document.write({ prepare: { dedup: true, prune: true, resample: true } }).catch((error: unknown) => {
        if (!(error instanceof DecimeshError && error.where === 'prepare')) throw error;
      });
    } catch (error) {
      if (!(error instanceof DecimeshError)) throw new Error(`${name}: ${String(error)}`, { cause: error });
      expect(['internal', 'out-of-memory'], `${name}: ${error.message}`).not.toContain(error.code);
      outcome = error.code;
    }
    const milliseconds = performance.now() - start;
    if (milliseconds > slowest.milliseconds) slowest = { name, milliseconds };
    expect(milliseconds, name).toBeLessThan(HANGS);
    counts.set(outcome, (counts.get(outcome) ?? 0) + 1);
  }
  expect(paths.length).toBeGreaterThan(50);
  console.log([...counts].map(([outcome, count]) => `${outcome} ${count}`).join(', '), `; slowest ${slowest.name}: ${Math.round(slowest.milliseconds)} ms`);
  using document = await openDocument(glb(gltfOf(hills(2))));
  expect(document.summary.triangles).toBe(8);
});
