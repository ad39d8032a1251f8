// Real files at half their triangles, as GLB: the Khronos validator finds no error that the file did not come with.
import { existsSync } from 'node:fs';
import { extname, relative } from 'node:path';
import { describe, expect, it } from 'vitest';
import { DecimeshError, init, openDocument } from 'decimesh';
import { assetPath } from './support/assets.ts';
import { loadModel, modelPaths } from './support/models.ts';
import { errorsOf } from './support/validate.ts';

// Larger ones take most of the time and have nothing that the others have not.
const LARGEST = 3e6;
// Some of the assets are parts of test suites that test just that.
const FAULTS_OF_FILES = new Set<string>(['no-triangles', 'unsupported', 'missing-resource', 'syntax', 'truncated', 'out-of-range', 'not-finite', 'unknown-format']);
const present = existsSync(assetPath('.'));

async function check(path: string): Promise<'valid' | 'refused' | 'large' | string[]> {
  const files = loadModel(path);
  if (files.reduce((sum, { bytes }) => sum + bytes.length, 0) > LARGEST) return 'large';
  try {
    using document = await openDocument(files.map(({ name, bytes }) => new File([bytes], name)));
    await document.simplify({ ratio: 0.5, preset: 'fast' });
    // What was not embedded, for it is of no known kind, is still a file beside it.
    const found = await errorsOf((await document.write({ format: 'glb' })).bytes, files);
    if (found.length === 0) return 'valid';
    // A fault of the file itself is carried through.
    const known = ['.glb', '.gltf'].includes(extname(path)) ? new Set((await errorsOf(files[0]!.bytes, files)).map(({ code }) => code)) : new Set();
    const ours = found.filter(({ code }) => !known.has(code));
    return ours.length === 0 ? 'valid' : ours.map(({ code, pointer, message }) => `${code} ${pointer} ${message}`);
  } catch (error) {
    if (error instanceof DecimeshError && FAULTS_OF_FILES.has(error.code)) return 'refused';
    throw new Error(`${path}: ${String(error)}`, { cause: error });
  }
}

describe('real files at half their triangles', () => {
  if (!present) console.log('skipped: real files at half their triangles: ../shared/assets is not there');

  it.skipIf(!present)('are valid GLB', { timeout: 300_000 }, async () => {
    await init();
    const counts = { valid: 0, refused: 0, large: 0 };
    const failures: string[] = [];
    for (const path of modelPaths()) {
      const name = relative(assetPath('.'), path);
      if (name.startsWith('invalid')) continue;
      const result = await check(path);
      if (typeof result === 'string') counts[result]++;
      else failures.push(`${name}: ${result.slice(0, 3).join('; ')}`);
    }
    console.log(`valid ${counts.valid}, refused ${counts.refused}, not looked at because they are large ${counts.large}`);
    expect(failures).toEqual([]);
    expect(counts.valid).toBeGreaterThan(200);
  });
});
