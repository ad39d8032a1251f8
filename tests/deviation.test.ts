// The measured deviation of real models against an independent meter, where both are at hand.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gunzipSync } from 'node:zlib';
import { expect, it } from 'vitest';
import { openDocument } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { glb, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
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

it('a map has two figures for each vertex of the level, on the page as in the worker', async () => {
  const bytes = glb(gltfOf(hills(40)));
  using document = await openDocument(bytes);
  const { deviation: none, wedgeSets: whole } = await document.deviationMap();
  expect(none.max).toBe(0);
  expect(whole[0]!.distances).toEqual(new Float32Array(41 * 41));
  await document.simplify({ ratio: 0.1 });
  const fractions: number[] = [];
  const { deviation, wedgeSets } = await document.deviationMap({ samples: 50_000, onProgress: (share) => fractions.push(share) });
  expect(fractions.at(-1)).toBe(1);
  const { positions } = (await document.geometry()).wedgeSets[0]!;
  const [{ distances, surroundings }] = wedgeSets as [(typeof wedgeSets)[number]];
  expect(distances).toHaveLength(positions.length / 3);
  expect(Math.max(...surroundings)).toBe(Math.fround(deviation.max));
  expect(distances.every((distance, vertex) => distance >= 0 && distance <= surroundings[vertex]!)).toBe(true);
  expect(Math.max(...distances)).toBeGreaterThan(0);
  expect((await document.write()).report.deviation).toEqual(deviation);
  expect(await document.measure({ samples: 50_000 })).toEqual(deviation);

  const client = createWorkerClient();
  try {
    const remote = await client.openDocument(bytes);
    await remote.simplify({ ratio: 0.1 });
    expect(await remote.deviationMap({ samples: 50_000 })).toEqual({ deviation, wedgeSets });
    const controller = new AbortController();
    const run = remote.deviationMap({ samples: 1e8, signal: controller.signal });
    setTimeout(() => controller.abort(new Error('enough')), 20);
    await expect(run).rejects.toThrow('enough');
    expect((await remote.deviationMap({ samples: 1000 })).wedgeSets).toHaveLength(1);
  } finally {
    client.terminate();
  }
});
