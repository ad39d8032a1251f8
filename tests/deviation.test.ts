// The measured deviation of real models against an independent meter, where both are at hand.
import { expect, it } from 'vitest';
import { openDocument } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { glb, gltfOf } from './support/glb.ts';
import { hills, objOf } from './support/meshes.ts';
import { meter, testWithMeter } from './support/meter.ts';

// `node benches/deviation.mjs` does it for all of them.
for (const [name, ratio] of [['stanford-bunny', 0.02], ['rocker-arm', 0.1]] as const) {
  testWithMeter(name, 'an independent meter agrees on', async (original) => {
    using document = await openDocument([{ name: `${name}.obj`, bytes: original }]);
    await document.simplify({ ratio });
    const { max, mean, rms, relativeTo } = await document.measure();
    const theirs = meter(original, (await document.write({ format: 'obj' })).bytes);
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

it('attributes that both have are compared too', async () => {
  using document = await openDocument(glb(gltfOf(hills(30))));
  await document.simplify({ ratio: 0.05 });
  const { attributes } = await document.measure({ samples: 20_000 });
  expect(Object.keys(attributes ?? {})).toEqual(['normal', 'uv']);
  // The normals are all the same; what the texture shows goes along with the surface.
  expect(attributes!.normal!.max).toBeLessThan(0.1);
  expect(attributes!.uv!.mean).toBeGreaterThan(0);
  expect(attributes!.uv!.mean).toBeLessThan(0.02);
  using bare = await openDocument([{ name: 'a.obj', bytes: objOf(hills(10)) }]);
  expect(await bare.measure({ samples: 1000 })).not.toHaveProperty('attributes');
});
