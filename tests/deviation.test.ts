// The measured deviation of real models against an independent meter, where both are at hand.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gunzipSync } from 'node:zlib';
import { expect } from 'vitest';
import { openDocument } from 'decimesh';
import { testWithAsset } from './support/assets.ts';
import { temporaryDirectory } from './support/program.ts';

const meter = process.env['MESHDIST'] ?? fileURLToPath(new URL('../../shared/tools/meshdist', import.meta.url));

interface Metered {
  readonly mean: number;
  readonly rms: number;
  readonly haus: number;
}

// `node benches/deviation.mjs` does it for all of them.
for (const [name, ratio] of [['stanford-bunny', 0.02], ['rocker-arm', 0.1]] as const) {
  testWithAsset(`bench/${name}.obj.gz`, `an independent meter agrees on ${name}`, async (path) => {
    if (!existsSync(meter)) return console.log(`skipped: there is no meter at ${meter}`);
    const original = gunzipSync(readFileSync(path));
    const document = await openDocument([{ name: `${name}.obj`, bytes: original }]);
    await document.simplify({ ratio });
    const { max, mean, rms, relativeTo } = await document.measure();
    const directory = temporaryDirectory();
    const files = [original, (await document.write({ format: 'obj' })).bytes].map((bytes, index) => {
      const file = join(directory, `${index}.obj`);
      writeFileSync(file, bytes);
      return file;
    });
    document.dispose();
    const theirs = JSON.parse(execFileSync(meter, files, { encoding: 'utf8' })) as Metered;
    const share = (ours: number, metered: number): number => Math.abs((100 * ours) / relativeTo / metered - 1);
    expect(share(mean, theirs.mean)).toBeLessThan(0.02);
    expect(share(rms, theirs.rms)).toBeLessThan(0.02);
    expect(share(max, theirs.haus)).toBeLessThan(0.05);
  });
}
