// The error-bounded mode: what is measured stays within the limit, and not much finer than it has to be.
import { readFileSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { gunzipSync } from 'node:zlib';
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument } from 'decimesh';
import { findWithin, lookClosely, tryRefusing } from '../dist/bounded.js';
import { Refusal } from '../dist/refusal.js';
import { testWithAsset } from './support/assets.ts';
import { glb, gltfOf } from './support/glb.ts';
import { hills, objOf, plyOf } from './support/meshes.ts';
import { hasMeter, meter, testWithMeter } from './support/meter.ts';
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

it('takes a model with vertices that no triangle has', async () => {
  const { indices, ...rest } = hills(24);
  const used = Uint32Array.from(indices.filter((_, at) => Math.floor(at / 3) % 100 !== 0 && at >= 60));
  using document = await openDocument(plyOf({ ...rest, indices: used }));
  const vertices = rest.positions.length / 3;
  expect(document.summary.wedgeSets.map((set) => set.vertices)).toEqual([vertices]);
  expect(new Set(used).size).toBeLessThan(vertices);
  const { triangles } = await document.simplify({ maximumDeviation: '1%' });
  expect(triangles).toBeLessThan(0.8 * document.summary.triangles);
  expect((await document.measure({ samples: 1_000_000 })).max).toBeLessThanOrEqual(0.01 * document.summary.diagonal);
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
}, 120_000);

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

describe('what is refused', () => {
  /** A grid of points in the plane, two triangles a cell, and what is too far away around each. */
  const plane = (size: number, far: (x: number, y: number) => number): { positions: Float32Array; indices: Uint32Array; surroundings: Float32Array } => {
    const [positions, indices, surroundings]: [number[], number[], number[]] = [[], [], []];
    for (let y = 0; y <= size; y += 1) {
      for (let x = 0; x <= size; x += 1) {
        positions.push(x / size, y / size, 0);
        surroundings.push(far(x, y));
        const at = y * (size + 1) + x;
        if (x < size && y < size) indices.push(at, at + 1, at + size + 1, at + 1, at + size + 2, at + size + 1);
      }
    }
    return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices), surroundings: Float32Array.from(surroundings) };
  };
  const original = plane(100, () => 0);
  const weighted = (weights: Float32Array): Array<[number, number]> =>
    [...weights.keys()].filter((at) => weights[at]! > 0).map((at) => [original.positions[3 * at]!, original.positions[3 * at + 1]!]);

  it('is what is nearest to the place that is too far away, and more of it each time', async () => {
    const refusal = new Refusal([original.positions]);
    const level = plane(10, (x, y) => (x === 3 && y === 7 ? 1.5 : 0.2));
    const refuse = (): Promise<number> => refusal.refuse([level], [{ wedgeSet: 0, indices: level.indices }], 1);
    expect(await refuse()).toBe(1);
    const first = refusal.weights();
    const places = weighted(first);
    expect(places.length).toBeGreaterThan(60);
    for (const [x, y] of places) expect(Math.max(Math.abs(x - 0.3), Math.abs(y - 0.7))).toBeLessThan(0.051);
    expect(await refuse()).toBe(1);
    expect(weighted(refusal.weights()).length).toBeGreaterThan(places.length);
    expect(Math.max(...refusal.weights())).toBeGreaterThan(3 * Math.max(...first));
  });

  it('is nothing where most places are too far away, and comes on top of what was asked for', async () => {
    const given = new Float32Array(original.positions.length / 3).fill(2);
    const refusal = new Refusal([original.positions], given);
    const coarse = plane(5, () => 3);
    expect(await refusal.refuse([coarse], [{ wedgeSet: 0, indices: coarse.indices }], 1)).toBe(36);
    expect(refusal.weights()).toEqual(given);
    const level = plane(10, (x) => (x + 10 === 10 ? 0.97 : 0));
    expect(await refusal.refuse([level], [{ wedgeSet: 0, indices: level.indices }], 1)).toBe(0);
    // Near the limit counts, too.
    expect(new Set(refusal.weights())).toEqual(new Set([2, 5]));
  });

  it('takes the tip of a fan of any number of triangles', async () => {
    const count = 200_000;
    const positions = new Float32Array(3 * (count + 2));
    const indices = new Uint32Array(3 * count);
    for (let at = 0; at <= count; at += 1) {
      positions.set([Math.cos(at), Math.sin(at), 1], 3 * (at + 1));
      if (at < count) indices.set([0, at + 1, at + 2], 3 * at);
    }
    const surroundings = new Float32Array(count + 2);
    surroundings[0] = 2;
    const refusal = new Refusal([Float32Array.of(0, 0, 0)]);
    expect(await refusal.refuse([{ positions, surroundings }], [{ wedgeSet: 0, indices }], 1)).toBe(1);
    expect(refusal.weights()).toEqual(Float32Array.of(3));
  });

  it('is nothing after an abort', async () => {
    const refusal = new Refusal([original.positions]);
    const level = plane(100, (x, y) => (x % 5 === 0 && y % 5 === 0 && y < 90 ? 2 : 0));
    const controller = new AbortController();
    const refused = refusal.refuse([level], [{ wedgeSet: 0, indices: level.indices }], 1, controller.signal);
    controller.abort(new Error('enough'));
    await expect(refused).rejects.toThrow('enough');
    expect(weighted(refusal.weights())).toEqual([]);
  });

  it('lets the others go on: fewer triangles than any level of the record within the limit', async () => {
    // A narrow strip with a few spikes to its side.
    const { positions, indices } = hills(40);
    const spiked = positions.map((value, at) => (at % 3 === 1 ? 0.02 * value + (Math.floor(at / 3) % 397 === 200 ? 0.03 : 0) : value));
    using document = await openDocument([{ name: 'spikes.obj', bytes: objOf({ positions: spiked, indices, attributes: {} }) }]);
    const limit = 0.002 * document.summary.diagonal;
    const { triangles } = await document.simplify({ maximumDeviation: limit });
    expect((await document.measure()).max).toBeLessThanOrEqual(limit);
    await document.level({ triangles });
    expect((await document.measure()).max).toBeGreaterThan(limit);
    // A time budget is for one run: there the record is searched.
    const searched = await document.simplify({ maximumDeviation: limit, timeBudget: 60_000 });
    expect(searched.triangles).toBeGreaterThan(triangles);
  }, 120_000);

  it('is tried again with more triangles until nothing is too far, then with fewer', async () => {
    const asked: number[] = [];
    await tryRefusing({ least: 10, most: 5000, start: 1000 }, async (triangles) => {
      asked.push(triangles);
      return { triangles, far: triangles < 1100 ? 4 : 0 };
    });
    expect(asked.length).toBeLessThanOrEqual(12);
    expect(Math.min(...asked.filter((triangles) => triangles >= 1100))).toBeLessThan(1300);
    const few: number[] = [];
    await tryRefusing({ least: 10, most: 5000, start: 12 }, async (triangles) => (few.push(triangles), { triangles: Math.max(triangles, 14), far: 0 }));
    expect(few).toEqual([11]);
    let never = 0;
    await tryRefusing({ least: 10, most: 50, start: 40 }, async (triangles) => ((never += 1), { triangles, far: 100 }));
    expect(never).toBeLessThan(12);
  });

  it('goes on from a copy without changing it', async () => {
    const refusal = new Refusal([original.positions], new Float32Array(original.positions.length / 3).fill(1));
    const refuseAt = (of: Refusal, at: number): Promise<number> => {
      const level = plane(10, (x, y) => (x === at && y === at ? 1.5 : 0));
      return of.refuse([level], [{ wedgeSet: 0, indices: level.indices }], 1);
    };
    await refuseAt(refusal, 3);
    const before = refusal.weights();
    const copy = new Refusal(refusal);
    expect(copy.weights()).toEqual(before);
    await refuseAt(copy, 7);
    expect(refusal.weights()).toEqual(before);
    const more = copy.weights();
    const places = [...more.keys()].filter((at) => more[at] !== before[at]).map((at) => original.positions.slice(3 * at, 3 * at + 2));
    expect(places.length).toBeGreaterThan(60);
    for (const [x, y] of places) expect(Math.max(Math.abs(x! - 0.7), Math.abs(y! - 0.7))).toBeLessThan(0.051);
  });
});

describe('what only many samples find', () => {
  interface Run {
    readonly triangles: number;
    readonly mended: number;
  }
  const runs = [3000, 1000, 2000].map((triangles) => ({ triangles, mended: 0 }));
  const looking = async (farOf: (run: Run) => number, most = 5000): Promise<{ found: Run | undefined; looked: Run[] }> => {
    const looked: Run[] = [];
    const found = await lookClosely<Run>(runs, most, async (run) => {
      looked.push(run);
      return { far: farOf(run), mend: (triangles) => ({ triangles, mended: run.mended + 1 }) };
    });
    return { found, looked };
  };

  it('is refused too, in runs to a few triangles more', async () => {
    expect((await looking(() => 0)).looked).toEqual([{ triangles: 1000, mended: 0 }]);
    const { found, looked } = await looking(({ mended }) => Math.max(2 - mended, 0));
    expect(found).toMatchObject({ mended: 2 });
    expect(found!.triangles).toBeLessThan(1030);
    expect(looked.map(({ mended }) => mended)).toEqual([0, 1, 2]);
  });

  it('leads to the next run when it takes more triangles than that, and ends', async () => {
    const { found, looked } = await looking(({ triangles }) => (triangles < 2000 ? 300 : 0));
    expect(found).toEqual({ triangles: 2000, mended: 0 });
    expect(looked.map(({ triangles }) => triangles)).toEqual([...looked.map(({ triangles }) => triangles)].sort((a, b) => a - b));
    const never = await looking(() => 1, 1_000_000);
    expect(never.found).toBeUndefined();
    expect(never.looked.length).toBeLessThan(20);
    // The last chance is what was found without it, and nothing that is not coarser than full detail.
    expect(never.looked).toContainEqual({ triangles: 3000, mended: 0 });
    expect(Math.max(...(await looking(() => 9000, 3100)).looked.map(({ triangles }) => triangles))).toBeLessThan(3100);
  });
});

// Both have a spot or two that few samples miss: the level must not become fine everywhere for them.
for (const [name, share] of [['bench/beast.obj.gz', 0.3], ['scans/JRC2018M.ply', 0.9]] as const) {
  testWithAsset(
    name,
    `what few samples miss is refused where it is: ${name}`,
    async (path) => {
      const file = readFileSync(path);
      const [bytes, base] = path.endsWith('.gz') ? [gunzipSync(file), basename(path, '.gz')] : [file, basename(path)];
      using document = await openDocument([{ name: base, bytes }]);
      const original = (await document.write({ format: 'obj' })).bytes;
      const { triangles } = await document.simplify({ maximumDeviation: '0.1%' });
      expect(triangles).toBeLessThan(share * document.summary.triangles);
      // The report has the last measurement, which is of this level.
      const written = await document.write({ format: 'obj' });
      expect(written.report.deviation?.max).toBeLessThanOrEqual(0.001 * document.summary.diagonal);
      for (const samples of [400_000, 1_000_000]) {
        expect((await document.measure({ samples })).max).toBeLessThanOrEqual(0.001 * document.summary.diagonal);
      }
      if (hasMeter) expect(meter(original, written.bytes).haus).toBeLessThanOrEqual(0.1);
    },
    240_000,
  );
}
