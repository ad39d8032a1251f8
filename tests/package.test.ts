// The package's calls in Node, against the real engine.
import { readFileSync } from 'node:fs';
import { beforeAll, describe, expect, it } from 'vitest';
import { DecimeshError, init, openDocument, simplify, simplifySequence, type LevelSummary } from 'decimesh';
import { glb, gltfOf } from './support/glb.ts';
import { INVALID_FILES } from './support/invalid_files.ts';
import { expectWellFormed, hills, objOf } from './support/meshes.ts';
import { runModule } from './support/program.ts';
import { thrown } from './support/thrown.ts';
import { gltfErrors } from './support/validate.ts';

const SIZE = 30;
const TRIANGLES = 2 * SIZE * SIZE;
const file = (size = SIZE): Uint8Array => glb(gltfOf(hills(size)));
const coded = (code: string, where?: string | RegExp): unknown =>
  expect.objectContaining({ name: 'DecimeshError', code, ...(where === undefined ? {} : { where: expect.stringMatching(where) }) });

beforeAll(() => init());

describe('init', () => {
  it('is needed before a synchronous call, runs once, and may fail before it succeeds', async () => {
    const { stdout, stderr } = await runModule(`
      import { init, simplify, DecimeshError } from 'decimesh';
      const mesh = { positions: new Float32Array(9) };
      const codeOf = (error) => error instanceof DecimeshError ? error.code : String(error);
      const codes = [];
      try { simplify(mesh, { ratio: 1 }); } catch (error) { codes.push(codeOf(error)); }
      for (const source of [new Uint8Array(8), 'nowhere.wasm', 'http://127.0.0.1:9/decimesh.wasm']) {
        await init(source).catch((error) => codes.push(codeOf(error)));
      }
      const first = init();
      const same = init() === first;
      await first;
      console.log(JSON.stringify({ codes, same, triangles: simplify({ positions: new Float32Array([0,0,0, 1,0,0, 0,1,0]) }, { ratio: 1 }).indices.length / 3 }));
    `);
    expect(stderr).toBe('');
    expect(JSON.parse(stdout)).toEqual({ codes: ['not-initialised', 'cannot-read', 'cannot-read', 'cannot-read'], same: true, triangles: 1 });
  });

  it('takes a path, an address, bytes or a module, and both builds give the same bytes', async () => {
    const source = (name: string): string => `dist/wasm/decimesh_${name}.wasm`;
    const outputs = await Promise.all(
      [
        `'${source('simd')}'`,
        `new URL('${new URL(`../${source('scalar')}`, import.meta.url).href}')`,
        `readFileSync('${source('scalar')}')`,
        `new WebAssembly.Module(readFileSync('${source('simd')}'))`,
      ].map(async (argument) => {
        const { stdout, stderr } = await runModule(`
          import { readFileSync } from 'node:fs';
          import { createHash } from 'node:crypto';
          import { init, openDocument } from 'decimesh';
          await init(${argument});
          const document = await openDocument(Buffer.from('${Buffer.from(file(16)).toString('base64')}', 'base64'));
          await document.simplify({ ratio: 0.2 });
          const { bytes } = await document.write();
          console.log(createHash('sha256').update(bytes).digest('hex'));
        `);
        expect(stderr).toBe('');
        return stdout;
      }),
    );
    expect(outputs[0]).toMatch(/^[0-9a-f]{64}\n$/);
    expect(new Set(outputs).size).toBe(1);
  });
});

describe('a document', () => {
  it('is opened from a buffer, a view, a File or several files', async () => {
    const bytes = file();
    const { json, binary } = gltfOf(hills(SIZE));
    json.buffers[0]!.uri = 'mesh.bin';
    const inputs = [
      bytes,
      bytes.buffer as ArrayBuffer,
      new File([bytes as Uint8Array<ArrayBuffer>], 'a.glb'),
      [{ name: 'mesh.bin', bytes: binary }, { name: 'a.gltf', bytes: new TextEncoder().encode(JSON.stringify(json)) }],
    ];
    for (const input of inputs) {
      using document = await openDocument(input);
      expect(document.summary).toMatchObject({ triangles: TRIANGLES, vertices: (SIZE + 1) ** 2, meshes: 1 });
    }
  });

  it('is simplified, looked at in every level and written without simplifying again', async () => {
    using document = await openDocument(file());
    const level = await document.simplify({ ratio: 0.1 });
    expect(level).toMatchObject({ stopReason: 'target' });
    expect(level.triangles).toBeLessThanOrEqual(TRIANGLES / 10);
    let errorBefore = 0;
    for (const triangles of [TRIANGLES, 1500, 700, 300, level.triangles, 0]) {
      const at = await document.level({ triangles });
      expect(at.triangles).toBeLessThanOrEqual(Math.max(triangles, level.triangles));
      expect(at.estimatedError).toBeGreaterThanOrEqual(errorBefore);
      errorBefore = at.estimatedError;
      const { groups, wedgeSets } = await document.geometry();
      expect(groups[0]!.indices.length / 3).toBe(at.triangles);
      expect(wedgeSets[0]!.positions.length / 3).toBe(at.vertices);
      expectWellFormed({ positions: wedgeSets[0]!.positions, indices: groups[0]!.indices });
      const { bytes, report } = await document.write();
      expect(await gltfErrors(bytes)).toEqual([]);
      expect(report).toMatchObject({ input: { path: null, triangles: TRIANGLES }, output: { path: null, triangles: at.triangles, bytes: bytes.length } });
      using again = await openDocument(bytes);
      expect(again.summary.triangles).toBe(at.triangles);
    }
    expect(await document.level({})).toMatchObject({ triangles: TRIANGLES, estimatedError: 0 });
    expect((await document.level({ error: errorBefore / 2 })).estimatedError).toBeLessThanOrEqual(errorBefore / 2);
  });

  it('records everything and shows full detail when there is no target', async () => {
    using document = await openDocument(file());
    expect((await document.simplify()).triangles).toBe(TRIANGLES);
    expect((await document.level({ triangles: 10 })).triangles).toBeLessThanOrEqual(10);
  });

  it('takes an error as a share of the diagonal or in model units', async () => {
    using document = await openDocument(file());
    const relative = await document.simplify({ error: '0.5%' });
    const absolute = await document.simplify({ error: 0.005 * document.summary.diagonal });
    expect(absolute).toEqual(relative);
    expect(relative.stopReason).toBe('error');
    expect(relative.triangles).toBeLessThan(TRIANGLES);
  });

  it('reports progress that rises, and 1 once and last', async () => {
    using document = await openDocument(file(200));
    const fractions: number[] = [];
    await document.simplify({ ratio: 0.1, onProgress: (fraction) => fractions.push(fraction) });
    expect(fractions).toEqual([...new Set(fractions)].sort((a, b) => a - b));
    expect(fractions.at(-1)).toBe(1);
    expect(fractions.some((fraction) => fraction > 0.02 && fraction < 0.98)).toBe(true);
  });

  it('writes OBJ for OBJ unless told otherwise', async () => {
    using document = await openDocument([{ name: 'a.obj', bytes: objOf(hills(4)) }]);
    expect((await document.write()).report.output.format).toBe('obj');
    expect((await document.write({ format: 'glb' })).report.output.format).toBe('glb');
  });

  const wrongOptions: Array<[options: object, where: string]> = [
    [{ ratio: -0.1 }, 'ratio'],
    [{ ratio: NaN }, 'ratio'],
    [{ ratio: '0.5' }, 'ratio'],
    [{ triangles: 1.5 }, 'triangles'],
    [{ triangles: -1 }, 'triangles'],
    [{ error: -1 }, 'error'],
    [{ error: Infinity }, 'error'],
    [{ error: '5 cm' }, 'error'],
    [{ lockBorder: 1 }, 'lockBorder'],
    [{ placement: 'best' }, 'placement'],
    [{ onProgress: true }, 'onProgress'],
    [{ signal: {} }, 'signal'],
    [{ ratoi: 0.5 }, 'ratoi'],
  ];
  it.each(wrongOptions)('names the wrong option in %o', async (options, where) => {
    using document = await openDocument(file(4));
    await expect(document.simplify(options)).rejects.toEqual(coded('invalid-argument', where));
  });

  it('refuses levels before simplification, unknown formats and what is not built yet', async () => {
    using document = await openDocument(file(4));
    await expect(document.level({ triangles: 5 })).rejects.toEqual(coded('wrong-state'));
    await expect(document.write({ format: 'fbx' as 'glb' })).rejects.toEqual(coded('invalid-argument', 'format'));
    await expect(document.write({ compress: 'zip' as 'none' })).rejects.toEqual(coded('invalid-argument', 'compress'));
    await expect(document.write({ format: 'obj', compress: 'draco' })).rejects.toEqual(coded('invalid-argument', 'compress'));
    await expect(document.write({ format: 'stl', quantize: true })).rejects.toEqual(coded('invalid-argument', 'quantize'));
    await expect(openDocument('file.glb' as unknown as ArrayBuffer)).rejects.toEqual(coded('invalid-argument', 'input'));
    await expect(openDocument([])).rejects.toEqual(coded('invalid-argument', 'input'));
  });

  it('says so when it was disposed', async () => {
    const document = await openDocument(file(4));
    document.dispose();
    document.dispose();
    for (const call of [document.simplify({ ratio: 0.5 }), document.level({}), document.geometry(), document.write()]) {
      await expect(call).rejects.toEqual(coded('disposed'));
    }
  });

  it.each(INVALID_FILES)('is not opened from $name: $code', async ({ name, bytes, code }) => {
    await expect(openDocument([{ name, bytes }])).rejects.toEqual(coded(code));
    using next = await openDocument(file(4));
    expect(next.summary.triangles).toBe(32);
  });
});

describe('measuring', () => {
  // The unit square in four triangles that meet in a peak.
  const pyramid = (height: number): Uint8Array =>
    objOf({
      positions: new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, height]),
      indices: new Uint32Array([0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]),
      attributes: {},
    });

  it('is nothing before the first simplification, and then what the surfaces are apart', async () => {
    using document = await openDocument(pyramid(0.3));
    expect((await document.write()).report).toMatchObject({ deviation: null, timings: { measure: 0 } });
    expect(await document.measure({ samples: 1000 })).toMatchObject({ max: 0, mean: 0, rms: 0 });
    await document.simplify({ triangles: 2, placement: 'subset' });
    expect((await document.geometry()).groups[0]?.indices).toHaveLength(6);
    const { max, mean, rms, relativeTo, originalToSimplified } = await document.measure();
    expect(relativeTo).toBeCloseTo(Math.hypot(1, 1, 0.3), 6);
    expect(max).toBeGreaterThan(0.1);
    expect(max).toBeLessThanOrEqual(0.31);
    expect(mean).toBeLessThan(rms);
    expect(rms).toBeLessThan(max);
    expect(originalToSimplified.samples).toBeGreaterThanOrEqual(400_000);
  });

  it('is in the report until another level is selected', async () => {
    using document = await openDocument(file());
    await document.simplify();
    await document.level({ ratio: 0.2 });
    const deviation = await document.measure({ samples: 2000 });
    const { report } = await document.write();
    expect(report.deviation).toEqual(deviation);
    expect(report.timings.measure).toBeGreaterThan(0);
    await document.level({ ratio: 0.2 });
    expect((await document.write()).report.deviation).toEqual(deviation);
    await document.level({ ratio: 0.1 });
    expect((await document.write()).report).toMatchObject({ deviation: null, timings: { measure: 0 } });
    expect((await document.measure({ samples: 2000 })).mean).toBeGreaterThan(deviation.mean);
    await document.simplify({ ratio: 0.1 });
    expect((await document.write()).report.deviation).toBeNull();
  });

  it('measures the level selected at the call, and does not take it for a later one', async () => {
    using document = await openDocument(file());
    await document.simplify();
    await document.level({ ratio: 0.2 });
    const expected = await document.measure({ samples: 300_000 });
    const fractions: number[] = [];
    const measuring = document.measure({ samples: 300_000, onProgress: (fraction) => fractions.push(fraction) });
    await document.level({ ratio: 0.05 });
    expect(await measuring).toEqual(expected);
    expect((await document.write()).report.deviation).toBeNull();
    expect(fractions.filter((fraction) => fraction === 1)).toEqual([1]);
    expect(fractions).toEqual([...fractions].sort((a, b) => a - b));
    expect(fractions.length).toBeGreaterThan(2);
  });

  it('can be aborted at any time and started again', async () => {
    using document = await openDocument(file(200));
    await document.simplify({ ratio: 0.1 });
    const controller = new AbortController();
    let abortedAt = 0;
    const onProgress = (fraction: number): void => {
      if (fraction < 0.01 || controller.signal.aborted) return;
      abortedAt = performance.now();
      controller.abort(new Error('enough'));
    };
    const first = document.measure({ samples: 1e7, signal: controller.signal, onProgress });
    const ended = expect(first).rejects.toThrow('enough');
    await expect(document.measure()).rejects.toEqual(coded('wrong-state', /^measure$/));
    await ended;
    expect(performance.now() - abortedAt).toBeLessThan(1000);
    expect((await document.write()).report.deviation).toBeNull();
    const again = new AbortController();
    const second = document.measure({ samples: 1e8, signal: again.signal });
    again.abort(new Error('and again'));
    const third = document.measure({ samples: 1000 });
    await expect(second).rejects.toThrow('and again');
    expect((await third).max).toBeGreaterThan(0);
    await expect(document.measure({ signal: AbortSignal.abort(new Error('before')) })).rejects.toThrow('before');
  });

  it('and simplifying may go on side by side', async () => {
    using document = await openDocument(file(100));
    await document.simplify({ ratio: 0.1 });
    const [deviation, level] = await Promise.all([document.measure(), document.simplify({ ratio: 0.3 })]);
    expect(deviation.max).toBeGreaterThan(0);
    expect(level.triangles).toBeGreaterThan(5000);
    expect((await document.write()).report.deviation).toBeNull();
  });

  it('ends with the document', async () => {
    const document = await openDocument(file(100));
    await document.simplify({ ratio: 0.1 });
    const measuring = document.measure({ samples: 1e8 });
    document.dispose();
    await expect(measuring).rejects.toEqual(coded('disposed'));
    await expect(document.measure()).rejects.toEqual(coded('disposed'));
  });

  it.each([
    [{ samples: 0 }, 'samples'],
    [{ samples: 1.5 }, 'samples'],
    [{ samples: '100' }, 'samples'],
    [{ samples: 2e9 }, 'samples'],
    [{ sample: 1 }, 'sample'],
    [{ onProgress: 1 }, 'onProgress'],
    [{ signal: {} }, 'signal'],
  ])('refuses %j', async (options, where) => {
    using document = await openDocument(file(4));
    await expect(document.measure(options as never)).rejects.toMatchObject({ code: 'invalid-argument', where });
  });
});

describe('abort and overlap', () => {
  it('rejects with the reason within 100 ms and leaves the former level', async () => {
    using document = await openDocument(file(500));
    const former = await document.simplify({ error: '0.01%' });
    const controller = new AbortController();
    const fractions: number[] = [];
    let abortedAt = 0;
    setTimeout(() => {
      abortedAt = performance.now();
      controller.abort(new Error('enough'));
    }, 150);
    const run = document.simplify({ triangles: 10, signal: controller.signal, onProgress: (fraction) => fractions.push(fraction) });
    await expect(run).rejects.toThrow('enough');
    expect(performance.now() - abortedAt).toBeLessThan(100);
    expect(fractions).not.toContain(1);
    expect((await document.write()).report.output.triangles).toBe(former.triangles);
    // At once after an abort, without waiting for it.
    const second = new AbortController();
    const cancelled = document.simplify({ triangles: 10, signal: second.signal });
    second.abort();
    const next = document.simplify({ ratio: 0.5 });
    await expect(cancelled).rejects.toHaveProperty('name', 'AbortError');
    expect((await next).triangles).toBeLessThanOrEqual(250_000);
  });

  it('does not keep events waiting for 100 ms', async () => {
    using document = await openDocument(file(200));
    let longest = 0;
    let last = performance.now();
    const timer = setInterval(() => {
      longest = Math.max(longest, performance.now() - last);
      last = performance.now();
    }, 1);
    await document.simplify({ triangles: 100 });
    clearInterval(timer);
    expect(longest).toBeGreaterThan(0);
    expect(longest).toBeLessThan(100);
  });

  it('does not start for a signal that is aborted already', async () => {
    using document = await openDocument(file(4));
    const signal = AbortSignal.abort(new Error('before'));
    await expect(document.simplify({ signal })).rejects.toThrow('before');
    await expect(openDocument(file(4), { signal })).rejects.toThrow('before');
  });

  it('refuses a second run while one is under way, and the first goes on', async () => {
    using document = await openDocument(file(100));
    const first = document.simplify({ ratio: 0.5 });
    await expect(document.simplify({ ratio: 0.1 })).rejects.toEqual(coded('wrong-state'));
    expect((await first).triangles).toBeLessThanOrEqual(10_000);
  });

  it('ends a run whose document is disposed, or whose onProgress throws', async () => {
    const document = await openDocument(file(100));
    const onProgress = (): void => {
      throw new Error('from the callback');
    };
    await expect(document.simplify({ ratio: 0.1, onProgress })).rejects.toThrow('from the callback');
    const run = document.simplify({ ratio: 0.1 });
    document.dispose();
    await expect(run).rejects.toEqual(coded('disposed'));
  });
});

describe('arrays', () => {
  it('come back smaller, well-formed, in arrays of their own', () => {
    const mesh = hills(SIZE);
    const before = structuredClone(mesh);
    const small = simplify(mesh, { ratio: 0.1 });
    expect(mesh).toEqual(before);
    expectWellFormed(small);
    expect(small.indices.length / 3).toBeLessThanOrEqual(TRIANGLES / 10);
    expect(small.stopReason).toBe('target');
    expect(small.estimatedError).toBeGreaterThan(0);
    const vertices = small.positions.length / 3;
    expect(small.vertexMap).toHaveLength(vertices);
    expect(Math.max(...small.vertexMap)).toBeLessThan(mesh.positions.length / 3);
    expect(small.attributes['uv']).toHaveLength(2 * vertices);
    for (const array of [small.positions, small.indices, small.vertexMap, ...Object.values(small.attributes)]) {
      // A view of the engine's memory would have a far larger buffer, and die when that grows.
      expect(array.buffer.byteLength).toBe(array.byteLength);
    }
  });

  it('may be bare triangles', () => {
    const { positions, indices } = hills(4);
    const bare = Float32Array.from(indices, (index) => index).length;
    const soup = new Float32Array(3 * bare);
    for (const [at, index] of indices.entries()) soup.set(positions.subarray(3 * index, 3 * index + 3), 3 * at);
    const small = simplify({ positions: soup }, { ratio: 0.5 });
    expect(small.indices.length / 3).toBeLessThanOrEqual(16);
    expectWellFormed(small);
  });

  it('keep the type of every attribute, and never mix integers of unknown meaning', () => {
    const mesh = hills(SIZE);
    const vertices = mesh.positions.length / 3;
    const ids = Uint16Array.from({ length: vertices }, (_, vertex) => (vertex % 7) * 1000);
    const attributes = {
      ...mesh.attributes,
      color: Uint8Array.from({ length: 4 * vertices }, (_, index) => index % 256),
      weights: Float32Array.from({ length: 4 * vertices }, (_, index) => (index % 4 === 0 ? 1 : 0)),
      joints: Uint16Array.from({ length: 4 * vertices }, (_, index) => (index % 4 === 0 ? index % 9 : 0)),
      tangent: Float32Array.from({ length: 4 * vertices }, (_, index) => (index % 4 === 0 || index % 4 === 3 ? 1 : 0)),
      feature: ids,
      heat: Float64Array.from({ length: vertices }, (_, vertex) => vertex),
    };
    const small = simplify({ ...mesh, attributes }, { ratio: 0.2 });
    const kept = small.positions.length / 3;
    for (const [name, values] of Object.entries(attributes)) {
      expect(small.attributes[name]?.constructor, name).toBe(values.constructor);
      expect(small.attributes[name]?.length, name).toBe((values.length / vertices) * kept);
    }
    expect([...(small.attributes['feature'] as Uint16Array)].filter((id) => id % 1000 !== 0)).toEqual([]);
    const normals = small.attributes['normal'] as Float32Array;
    for (let at = 0; at < normals.length; at += 3) expect(Math.hypot(...normals.subarray(at, at + 3))).toBeCloseTo(1, 3);
  });

  it('are recorded once for any level', () => {
    using sequence = simplifySequence(hills(SIZE));
    const first = sequence.level({ triangles: 500 });
    const coarse = sequence.level({ ratio: 0.05 });
    expect(coarse.indices.length).toBeLessThan(first.indices.length);
    expect(sequence.level({ triangles: 500 })).toEqual(first);
    expect(sequence.level({}).indices).toHaveLength(3 * TRIANGLES);
    expect(thrown(() => sequence.level({ triangles: -1 }))).toEqual(coded('invalid-argument', 'triangles'));
    sequence.dispose();
    expect(thrown(() => sequence.level({}))).toEqual(coded('disposed'));
  });

  const { positions, indices } = hills(2);
  const wrongMeshes: Array<[title: string, mesh: object, code: string, where: RegExp]> = [
    ['no positions', {}, 'invalid-argument', /^positions$/],
    ['a plain array', { positions: [0, 0, 0] }, 'invalid-argument', /^positions$/],
    ['two numbers a vertex', { positions: new Float32Array(8) }, 'invalid-argument', /^positions$/],
    ['an incomplete triangle', { positions, indices: new Uint32Array(4) }, 'invalid-argument', /^indices$/],
    ['signed indices', { positions, indices: new Int32Array(3) }, 'invalid-argument', /^indices$/],
    ['an index without a vertex', { positions, indices: new Uint32Array([0, 1, 99]) }, 'out-of-range', /triangles\[0\]/],
    ['a NaN', { positions: positions.map((value, at) => (at === 4 ? NaN : value)), indices }, 'not-finite', /positions\[1\]/],
    ['an infinity', { positions: positions.map((value, at) => (at === 4 ? Infinity : value)), indices }, 'not-finite', /positions\[1\]/],
    ['a short attribute', { positions, indices, attributes: { uv: new Float32Array(3) } }, 'invalid-argument', /^attributes\.uv$/],
    ['an attribute of no known type', { positions, indices, attributes: { uv: [0, 1] } }, 'invalid-argument', /^attributes\.uv$/],
    ['a NaN in an attribute', { positions, indices, attributes: { uv: new Float32Array(18).fill(NaN) } }, 'not-finite', /uv/],
    ['joints without weights', { positions, indices, attributes: { joints: new Uint8Array(36) } }, 'invalid-argument', /^attributes\.joints$/],
  ];
  it.each(wrongMeshes)('with %s are refused by name', (_, mesh, code, where) => {
    expect(thrown(() => simplify(mesh as typeof wrongMeshes & { positions: Float32Array }, { ratio: 0.5 }))).toEqual(coded(code, where));
  });

  it('need a target', () => {
    expect(thrown(() => simplify({ positions, indices }, {}))).toEqual(coded('invalid-argument', 'options'));
    expect(thrown(() => simplify({ positions, indices }, { onProgress: () => {} } as object))).toEqual(coded('invalid-argument', 'onProgress'));
  });
});

it('has an error class with a stable shape', () => {
  const error = new DecimeshError('syntax', 'no', 'a.obj:1');
  expect(error).toBeInstanceOf(Error);
  expect({ ...error }).toMatchObject({ name: 'DecimeshError', code: 'syntax', where: 'a.obj:1' });
});

// Keeps the fixtures honest: a level summary has these fields and no others.
it('summarises a level', async () => {
  using document = await openDocument(readFileSync(new URL('fixtures/gltf/cubevc.glb', import.meta.url)));
  const level: LevelSummary = await document.simplify({ ratio: 0.5 });
  expect(Object.keys(level).sort()).toEqual(['blockers', 'estimatedError', 'stopReason', 'triangles', 'vertices']);
});
