// Presets, levels beside the target, and the time budget, in Node against the real engine.
import { afterEach, beforeAll, describe, expect, it, vi } from 'vitest';
import { PRESETS, init, openDocument, simplify, simplifySequence, type SimplifiedMesh } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { glb, gltfOf } from './support/glb.ts';
import { expectWellFormed, hills } from './support/meshes.ts';
import { thrown } from './support/thrown.ts';

const SIZE = 100;
const TRIANGLES = 2 * SIZE * SIZE;
const file = (size = SIZE): Uint8Array => glb(gltfOf(hills(size)));
const invalid = (where: string): unknown => expect.objectContaining({ name: 'DecimeshError', code: 'invalid-argument', where });

beforeAll(() => init());
afterEach(() => {
  vi.restoreAllMocks();
});

describe('presets', () => {
  it('are named from the fastest to the best, each nearer to the original', async () => {
    expect(PRESETS).toEqual(['fast', 'balanced', 'best']);
    const rms: number[] = [];
    for (const preset of PRESETS) {
      using document = await openDocument(file());
      const level = await document.simplify({ ratio: 0.02, preset });
      expect(level).toMatchObject({ stopReason: 'target' });
      expect(level.triangles).toBeLessThanOrEqual(TRIANGLES * 0.02);
      const { groups, wedgeSets } = await document.geometry();
      expectWellFormed({ positions: wedgeSets[0]!.positions, indices: groups[0]!.indices });
      rms.push((await document.measure({ samples: 50_000 })).rms);
    }
    expect(rms).toEqual([...rms].sort((a, b) => b - a));
    expect(rms[2]! / rms[0]!).toBeLessThan(0.97);
  });

  it('of arrays and of documents are the same, and balanced is the default', async () => {
    const mesh = hills(SIZE);
    for (const preset of PRESETS) {
      using document = await openDocument(file());
      await document.simplify({ triangles: 400, preset });
      const { positions } = (await document.geometry()).wedgeSets[0]!;
      expect(simplify(mesh, { triangles: 400, preset }).positions, preset).toEqual(positions);
    }
    expect(simplify(mesh, { triangles: 400 })).toEqual(simplify(mesh, { triangles: 400, preset: 'balanced' }));
    expect(simplify(mesh, { triangles: 400 })).not.toEqual(simplify(mesh, { triangles: 400, preset: 'best' }));
  });

  it('keep to the error, whichever comes with it', () => {
    for (const preset of PRESETS) {
      const small = simplify(hills(SIZE), { error: '0.2%', preset });
      expect(small.stopReason).toBe('error');
      expect(small.estimatedError).toBeLessThanOrEqual(0.002 * 1.5);
      expect(small.indices.length / 3).toBeLessThan(TRIANGLES / 4);
    }
  });

  const { positions, indices } = hills(2);
  it.each([
    [{ preset: 'turbo' }, 'preset'],
    [{ preset: 1 }, 'preset'],
    [{ preset: null }, 'preset'],
    [{ timeBudget: -1 }, 'timeBudget'],
    [{ timeBudget: NaN }, 'timeBudget'],
    [{ timeBudget: Infinity }, 'timeBudget'],
    [{ timeBudget: '5' }, 'timeBudget'],
    [{ everyLevel: 1 }, 'everyLevel'],
    [{ keepLevels: 'yes' }, 'keepLevels'],
  ])('%j is refused by name', async (options, where) => {
    using document = await openDocument(file(4));
    await expect(document.simplify({ ratio: 0.5, ...options } as object)).rejects.toEqual(invalid(where));
    // What only makes sense for a document is unknown to the calls for arrays.
    expect(thrown(() => simplify({ positions, indices }, { ratio: 0.5, ...options } as object))).toEqual(invalid(where));
    expect(thrown(() => simplifySequence({ positions, indices }, options as object))).toEqual(invalid(where));
  });
});

describe('levels beside the target', () => {
  const positionsAt = async (document: Awaited<ReturnType<typeof openDocument>>): Promise<Float32Array> =>
    (await document.geometry()).wedgeSets[0]!.positions;

  it('are as good as ever with everyLevel, and without a target', async () => {
    using all = await openDocument(file());
    await all.simplify();
    using whole = simplifySequence(hills(SIZE));
    using some = await openDocument(file());
    const target = await some.simplify({ ratio: 0.02, everyLevel: true });
    using part = simplifySequence(hills(SIZE), { ratio: 0.02 });
    for (const triangles of [5000, 1000, target.triangles]) {
      await all.level({ triangles });
      expect(whole.level({ triangles }).positions).toEqual(await positionsAt(all));
      await some.level({ triangles });
      expect(part.level({ triangles }).positions).toEqual(await positionsAt(some));
    }
    using end = await openDocument(file());
    await end.simplify({ ratio: 0.02 });
    expect(await positionsAt(end)).not.toEqual(await positionsAt(some));
    using none = await openDocument(file());
    await none.simplify({ everyLevel: false });
    await none.level({ triangles: 1000 });
    await all.level({ triangles: 1000 });
    expect(await positionsAt(none)).not.toEqual(await positionsAt(all));
  });

  it('are better than rough: a level on the way has less error with everyLevel', async () => {
    const rms = async (everyLevel: boolean): Promise<number> => {
      using document = await openDocument(file());
      await document.simplify({ triangles: 100, everyLevel });
      await document.level({ triangles: 1000 });
      return (await document.measure({ samples: 50_000 })).rms;
    };
    expect(await rms(true)).toBeLessThan(await rms(false));
  });

  it('stay with keepLevels, while the selected level is the new run’s', async () => {
    using document = await openDocument(file());
    // Nothing to keep yet: as without.
    await document.simplify({ everyLevel: true, keepLevels: true });
    await document.level({ triangles: 1000 });
    const recorded = await positionsAt(document);
    const before = await document.measure({ samples: 20_000 });

    const level = await document.simplify({ triangles: 1000, preset: 'best', keepLevels: true });
    const fitted = await positionsAt(document);
    expect(fitted).toEqual(simplify(hills(SIZE), { triangles: 1000, preset: 'best' }).positions);
    expect((await document.write()).report).toMatchObject({ deviation: null, output: { triangles: level.triangles } });
    const after = await document.measure({ samples: 20_000 });
    expect(after.rms).toBeLessThan(before.rms);
    expect((await document.write()).report.deviation).toEqual(after);

    // The same count, but another level: what was measured is not of it.
    await document.level({ triangles: 1000 });
    expect(await positionsAt(document)).toEqual(recorded);
    expect((await document.write()).report.deviation).toBeNull();
    expect((await document.level({ triangles: 5000 })).triangles).toBeGreaterThan(4900);

    const controller = new AbortController();
    controller.abort(new Error('enough'));
    await expect(document.simplify({ triangles: 50, keepLevels: true, signal: controller.signal })).rejects.toThrow('enough');
    expect((await document.level({ triangles: 10 })).triangles).toBeLessThanOrEqual(10);
    await document.simplify({ triangles: 2000 });
    expect((await document.level({ triangles: 10 })).triangles).toBeGreaterThan(1900);
  });

  it('and presets cross to the worker', async () => {
    const client = createWorkerClient();
    try {
      const document = await client.openDocument(file());
      await document.simplify();
      await document.simplify({ triangles: 1000, preset: 'best', keepLevels: true });
      const { positions } = (await document.geometry()).wedgeSets[0]!;
      expect(positions).toEqual(simplify(hills(SIZE), { triangles: 1000, preset: 'best' }).positions);
      expect((await document.level({ triangles: 10 })).triangles).toBeLessThanOrEqual(10);
      await expect(document.simplify({ preset: 'turbo' as 'best' })).rejects.toEqual(invalid('preset'));
      expect(await document.simplify({ ratio: 0.1, timeBudget: 0 })).toMatchObject({ triangles: TRIANGLES, stopReason: 'time' });
      expect(await client.simplify(hills(SIZE), { ratio: 0.1, timeBudget: 0 })).toMatchObject({ stopReason: 'time' });
    } finally {
      client.terminate();
    }
  });
});

describe('a time budget', () => {
  /** A clock that shows 10 ms more each time somebody looks: every step of a run takes as long as it is meant to. */
  function steadyClock(): void {
    let now = 0;
    vi.spyOn(performance, 'now').mockImplementation(() => (now += 10));
  }
  const count = ({ indices }: SimplifiedMesh): number => indices.length / 3;

  it('of nothing leaves the mesh as it is, and says why', async () => {
    const mesh = hills(SIZE);
    const same = simplify(mesh, { ratio: 0.1, timeBudget: 0 });
    expect(same).toMatchObject({ stopReason: 'time', estimatedError: 0 });
    expect(count(same)).toBe(TRIANGLES);
    expect(same.vertexMap).toHaveLength((SIZE + 1) ** 2);
    using sequence = simplifySequence(mesh, { timeBudget: 0 });
    expect(sequence.level({ triangles: 10 })).toMatchObject({ stopReason: 'time' });
    using document = await openDocument(file());
    expect(await document.simplify({ error: '5%', timeBudget: 0 })).toEqual({
      triangles: TRIANGLES, vertices: (SIZE + 1) ** 2, estimatedError: 0, stopReason: 'time', blockers: null,
    });
    expect((await document.write()).report).toMatchObject({ stopReason: 'time', output: { triangles: TRIANGLES } });
    // Nothing is missing at full detail.
    expect(await document.simplify({ ratio: 1, timeBudget: 0 })).toMatchObject({ stopReason: 'target' });
  });

  it('that is enough changes nothing', () => {
    const mesh = hills(20);
    expect(simplify(mesh, { ratio: 0.1, timeBudget: 600_000 })).toEqual(simplify(mesh, { ratio: 0.1 }));
  });

  it('ends a run at any stage with a sound mesh; more time, fewer triangles', () => {
    const mesh = hills(150);
    const all = count(simplify(mesh, { ratio: 1 }));
    const counts: number[] = [];
    const reasons = new Set<string>();
    for (let budget = 20; budget <= 5120; budget *= 2) {
      steadyClock();
      const small = simplify(mesh, { triangles: 500, timeBudget: budget, preset: 'best' });
      vi.restoreAllMocks();
      expectWellFormed(small);
      counts.push(count(small));
      reasons.add(small.stopReason);
      expect(small.stopReason, `${budget} ms, ${count(small)} triangles`).toBe(count(small) <= 500 ? 'target' : 'time');
    }
    expect(counts).toEqual([...counts].sort((a, b) => b - a));
    expect(counts[0]).toBe(all);
    expect(counts.filter((triangles) => triangles < all && triangles > 500).length).toBeGreaterThan(0);
    expect(counts.at(-1)).toBeLessThanOrEqual(500);
    expect([...reasons].sort()).toEqual(['target', 'time']);
  });

  it('leaves every level down to where it ended', async () => {
    const mesh = hills(150);
    steadyClock();
    using sequence = simplifySequence(mesh, { timeBudget: 320 });
    using document = await openDocument(glb(gltfOf(mesh)));
    const whole = await document.simplify({ timeBudget: 320, onProgress: () => {} });
    vi.restoreAllMocks();
    expect(whole).toMatchObject({ triangles: 45_000, stopReason: 'target' });
    const last = sequence.level({ triangles: 10 });
    expect(last.stopReason).toBe('time');
    expect(count(last)).toBeLessThan(45_000);
    expect(count(last)).toBeGreaterThan(10);
    expectWellFormed(last);
    const between = sequence.level({ triangles: Math.round((45_000 + count(last)) / 2) });
    expect(between.stopReason).toBe('target');
    expectWellFormed(between);
    expect(await document.level({ triangles: 10 })).toMatchObject({ stopReason: 'time' });
  });

  it('is no target', () => {
    expect(thrown(() => simplify(hills(2), { timeBudget: 5 }))).toEqual(invalid('options'));
  });
});
