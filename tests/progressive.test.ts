// Progressive meshes: the input comes back to the bit, every level on the way is the engine's, and nothing damaged is taken.
import { readFileSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { gunzipSync } from 'node:zlib';
import { MeshoptEncoder } from 'meshoptimizer';
import type { Mesh } from 'three';
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument, simplifySequence, type Document, type LevelGeometry } from 'decimesh';
import { boxRegion, decodeProgressive, frustumRegion, isProgressive, readProgressive } from 'decimesh/progressive';
import { ProgressiveLoader } from 'decimesh/progressive-three';
import { createWorkerClient } from 'decimesh/worker';
import { crc32 } from '../dist/checksum.js';
import { packChunks } from '../dist/progressive/container.js';
import { RangeDecoder, RangeEncoder, newModels } from '../dist/progressive/range_coder.js';
import { FloatModel, IntegerModel, gridOf } from '../dist/progressive/numbers.js';
import { testWithAsset } from './support/assets.ts';
import { glb, gltfOf } from './support/glb.ts';
import { hills, objOf, plyOf } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';
import { thrown } from './support/thrown.ts';
import { gltfErrors } from './support/validate.ts';

const coded = (code: string): unknown => expect.objectContaining({ name: 'DecimeshError', code });

async function recorded(bytes: Uint8Array, name = 'model'): Promise<Document> {
  const document = await openDocument([{ name, bytes }]);
  await document.simplify({ placement: 'subset' });
  return document;
}

/** Each triangle as text with all its values, the direction kept and nothing else of its order. */
function triangles({ groups, wedgeSets }: LevelGeometry): string[] {
  return groups
    .flatMap(({ indices, wedgeSet }, group) => {
      const { positions, attributes } = wedgeSets[wedgeSet]!;
      const values = Object.keys(attributes).sort().map((name) => attributes[name]!);
      const corner = (wedge: number): string =>
        [[...positions.subarray(3 * wedge, 3 * wedge + 3)].map((c) => c + 0), ...values.map(({ components, values }) => [...values.subarray(components * wedge, components * (wedge + 1))])].join(' ');
      return Array.from({ length: indices.length / 3 }, (_, t) => {
        const corners = [...indices.subarray(3 * t, 3 * t + 3)].map(corner);
        const first = corners.indexOf([...corners].sort()[0]!);
        return [group, ...corners.slice(first), ...corners.slice(0, first)].join(' | ');
      });
    })
    .sort();
}

/** Edges with other than two triangles, vertices being places. */
function openEdges({ groups, wedgeSets }: LevelGeometry): Set<string> {
  const counts = new Map<string, number>();
  for (const { indices, wedgeSet } of groups) {
    const { positions } = wedgeSets[wedgeSet]!;
    const place = (wedge: number): string => [...positions.subarray(3 * wedge, 3 * wedge + 3)].join(' ');
    for (let at = 0; at < indices.length; at += 3) {
      for (const [a, b] of [[0, 1], [1, 2], [2, 0]] as const) {
        const edge = [place(indices[at + a]!), place(indices[at + b]!)].sort().join(' – ');
        counts.set(edge, (counts.get(edge) ?? 0) + 1);
      }
    }
  }
  return new Set([...counts].filter(([, count]) => count !== 2).map(([edge]) => edge));
}

/** Two hemispheres' worth of a closed surface: a torus without attributes, as OBJ. */
function torus(around: number, across: number): Uint8Array {
  const positions: number[] = [];
  const indices: number[] = [];
  for (let i = 0; i < around; i += 1) {
    for (let j = 0; j < across; j += 1) {
      const [u, v] = [(2 * Math.PI * i) / around, (2 * Math.PI * j) / across];
      const radius = 2 + (0.7 + 0.05 * Math.sin(9 * u)) * Math.cos(v);
      positions.push(radius * Math.cos(u), radius * Math.sin(u), 0.7 * Math.sin(v));
      const [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([p, q]) => ((p! % around) * across) + (q! % across)) as [number, number, number, number];
      indices.push(a, b, c, a, c, d);
    }
  }
  return objOf({ positions: Float32Array.from(positions), indices: Uint32Array.from(indices), attributes: {} });
}

/** The same triangles, each with vertices of its own. */
function soupOf({ positions, indices }: { positions: Float32Array; indices: Uint32Array }): { positions: Float32Array; indices: Uint32Array } {
  return { positions: Float32Array.from([...indices].flatMap((v) => [...positions.subarray(3 * v, 3 * v + 3)])), indices: Uint32Array.from(indices.keys()) };
}

beforeAll(() => init());

describe('what goes in comes out', () => {
  it('to the bit and in its order, with attributes', async () => {
    using document = await recorded(glb(gltfOf(hills(24))));
    using untouched = await openDocument(glb(gltfOf(hills(24))));
    const bytes = await document.writeProgressive();
    expect(isProgressive(bytes)).toBe(true);
    expect(decodeProgressive(bytes).geometry()).toEqual(await untouched.geometry());
    // Without the order it is the same triangles in fewer bytes.
    const shuffled = await document.writeProgressive({ keepOrder: false });
    expect(shuffled.length).toBeLessThan(bytes.length);
    expect(triangles(decodeProgressive(shuffled).geometry())).toEqual(triangles(await untouched.geometry()));
  });

  it('also what no level has: doubled vertices, triangles without three, vertices without one, negative zeros', async () => {
    const { positions, indices } = hills(9);
    // A triangle soup with every corner a vertex, a degenerate triangle, and a vertex that nothing uses.
    const soup = Float32Array.from([...indices].flatMap((index) => [...positions.subarray(3 * index, 3 * index + 3)]).concat([7, 8, 9]));
    soup[0] = -0;
    const corners = Uint32Array.from([...indices.keys(), 5, 5, 6]);
    using sequence = simplifySequence({ positions: soup, indices: corners }, { placement: 'subset' });
    const { groups, wedgeSets } = decodeProgressive(await sequence.writeProgressive()).geometry();
    expect(groups[0]!.indices).toEqual(corners);
    expect(new Uint32Array(wedgeSets[0]!.positions.buffer)).toEqual(new Uint32Array(soup.buffer));
  });

  it('from the worker, and not from a record that moved vertices', async () => {
    const file = plyOf(hills(12));
    using document = await recorded(file);
    const client = createWorkerClient();
    try {
      const remote = await client.openDocument(file);
      await expect(remote.writeProgressive()).rejects.toEqual(coded('wrong-state'));
      await remote.simplify();
      await expect(remote.writeProgressive()).rejects.toEqual(coded('wrong-state'));
      const level = await remote.simplify({ placement: 'subset' });
      expect(await remote.writeProgressive()).toEqual(await document.writeProgressive());
      expect((await remote.write()).report.output.triangles).toBe(level.triangles);
      await expect(remote.writeProgressive({ keepOrder: 1 as unknown as boolean })).rejects.toEqual(coded('invalid-argument'));
    } finally {
      client.terminate();
    }
  });
});

describe('levels', () => {
  for (const [name, bytes] of [['with attributes', plyOf(hills(30))], ['closed', torus(60, 24)]] as const) {
    it(`are those of the engine: ${name}`, async () => {
      using document = await recorded(bytes);
      const mesh = decodeProgressive(await document.writeProgressive());
      expect(mesh.levels.length).toBeGreaterThan(5);
      // Backwards and forwards: going to a level leaves no trace.
      for (const { splits, triangles: count, error } of [...mesh.levels].reverse().concat(mesh.levels).slice(1, -1)) {
        const level = await document.level({ triangles: count });
        expect([level.triangles, Math.fround(level.estimatedError)]).toEqual([count, error]);
        expect(triangles(mesh.geometry(splits))).toEqual(triangles(await document.geometry()));
      }
      expect(mesh.geometry(mesh.splitsFor(500)).groups[0]!.indices.length / 3).toBeLessThanOrEqual(500);
      expect(thrown(() => mesh.geometry(mesh.splits + 1))).toEqual(coded('out-of-range'));
    });
  }

  it('arrive while the bytes do, the first with few of them', async () => {
    using document = await recorded(torus(200, 80));
    const bytes = await document.writeProgressive();
    let given = 0;
    const pieces = new ReadableStream<Uint8Array>({
      pull(controller) {
        const piece = bytes.subarray(given, given + 500);
        given += piece.length;
        if (piece.length === 0) controller.close();
        else controller.enqueue(piece);
      },
    });
    const seen: number[] = [];
    let first: number | undefined;
    for await (const mesh of readProgressive(pieces)) {
      first ??= given;
      seen.push(mesh.triangles);
      expect(mesh.geometry().groups[0]!.indices.length / 3).toBe(mesh.triangles);
    }
    expect(first!).toBeLessThan(0.05 * bytes.length + 1000);
    expect(seen).toEqual([...seen].sort((a, b) => a - b));
    expect(seen.at(-1)).toBe(32_000);
  });

  it('have the surface’s normals before their own', async () => {
    using document = await recorded(glb(gltfOf(hills(24))));
    const bytes = await document.writeProgressive();
    const normals: Float32Array[] = [];
    const triangles: number[] = [];
    for await (const mesh of readProgressive(bytes)) {
      const values = mesh.geometry().wedgeSets[0]?.attributes['NORMAL']?.values;
      if (values === undefined) throw new Error('no normals');
      for (let at = 0; at < values.length; at += 3) expect(Math.hypot(...values.subarray(at, at + 3))).toBeCloseTo(1, 3);
      normals.push(values);
      triangles.push(mesh.triangles);
      if (normals.length === 2) break;
    }
    expect(triangles[1]).toBe(triangles[0]);
    expect(normals[1]).not.toEqual(normals[0]);
    // Without them what follows cannot be decoded.
    const view = new DataView(bytes.buffer, bytes.byteOffset);
    const end = (at: number): number => at + 12 + view.getUint32(at + 4, true);
    const [base, directions] = [end(8), end(end(8))];
    expect(String.fromCharCode(...bytes.subarray(base, base + 4), ...bytes.subarray(directions, directions + 4))).toBe('BASENORM');
    const without = Uint8Array.from([...bytes.subarray(0, directions), ...bytes.subarray(end(directions))]);
    expect(thrown(() => decodeProgressive(without))).toEqual(coded('syntax'));
  });

  it('morph into each other', async () => {
    using document = await recorded(torus(40, 20));
    const mesh = decodeProgressive(await document.writeProgressive());
    const [coarse, fine] = [mesh.levels[3]!, mesh.levels[6]!];
    const morph = mesh.geomorph(coarse.splits, fine.splits);
    expect(triangles(morph.to)).toEqual(triangles(mesh.geometry(fine.splits)));
    const places = (positions: Float32Array): Set<string> => new Set(Array.from({ length: positions.length / 3 }, (_, v) => [...positions.subarray(3 * v, 3 * v + 3)].join(' ')));
    const [start] = morph.from.wedgeSets;
    // At its start each vertex is one of the coarser level's, and the triangles that have an area are that level's.
    expect(places(start!.positions)).toEqual(places(mesh.geometry(coarse.splits).wedgeSets[0]!.positions));
    const drawn = triangles(morph.from).filter((text) => new Set(text.split(' | ').slice(1)).size === 3);
    expect(drawn).toEqual(triangles(mesh.geometry(coarse.splits)));
    const middle = morph.positions(0, 0.5, new Float32Array(start!.positions.length));
    expect(middle[0]).toBeCloseTo((start!.positions[0]! + morph.to.wedgeSets[0]!.positions[0]!) / 2, 6);
    expect(thrown(() => mesh.geomorph(5, 4))).toEqual(coded('out-of-range'));
  });

  it('are fine in a region alone, without cracks', async () => {
    using document = await recorded(torus(120, 48));
    const bytes = await document.writeProgressive();
    const mesh = decodeProgressive(bytes, { selective: true });
    const all = mesh.refined(boxRegion([-9, -9, -9], [9, 9, 9]));
    expect(triangles(all)).toEqual(triangles(mesh.geometry(mesh.splits)));
    const none = mesh.refined(boxRegion([90, 90, 90], [91, 91, 91]));
    expect(triangles(none)).toEqual(triangles(mesh.geometry(0)));
    const part = mesh.refined(boxRegion([1, -9, -9], [9, 9, 9]));
    expect(openEdges(part)).toEqual(new Set());
    const count = part.groups[0]!.indices.length / 3;
    expect(count).toBeGreaterThan(0.2 * mesh.triangles);
    expect(count).toBeLessThan(0.7 * mesh.triangles);
    // In the region every triangle is one of the whole, well inside of its border.
    const inside = (text: string): boolean => text.split(' | ').slice(1).every((corner) => Number(corner.split(',')[0]) > 1);
    const whole = triangles(mesh.geometry(mesh.splits)).filter(inside);
    const there = new Set(triangles(part));
    expect(whole.filter((text) => !there.has(text)).length / whole.length).toBeLessThan(0.05);
    // A frustum that looks from outside at one side: clip x > 1 in an orthographic projection.
    const clip = [0.25, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1, 0, -1.25, 0, 0, 1];
    expect(openEdges(mesh.refined(frustumRegion(clip)))).toEqual(new Set());
    const coarser = mesh.refined(boxRegion([1, -9, -9], [9, 9, 9], mesh.levels[8]!.error));
    expect(coarser.groups[0]!.indices.length / 3).toBeLessThan(count);
    expect(thrown(() => decodeProgressive(bytes).refined(boxRegion([0, 0, 0], [1, 1, 1])))).toEqual(coded('wrong-state'));
  });
});

describe('lifetimes', () => {
  for (const [name, mesh] of [['with attributes', hills(20)], ['a soup', soupOf(hills(10))]] as const) {
    it(`of triangles make the level of any error: ${name}`, () => {
      using sequence = simplifySequence(mesh, { placement: 'subset' });
      const { indices, births, deaths } = sequence.lifetimes();
      expect(indices.length / 3).toBeLessThan(6 * (mesh.indices.length / 3));
      const errors = [...new Set(births)].sort((a, b) => a - b);
      expect(errors.length).toBeGreaterThan(20);
      const at = (vertex: number): string => [...mesh.positions.subarray(3 * vertex, 3 * vertex + 3)].join(' ');
      const turned = (corners: string[]): string => {
        const first = corners.indexOf([...corners].sort()[0]!);
        return [...corners.slice(first), ...corners.slice(0, first)].join(' | ');
      };
      for (let k = 0; k < errors.length; k += 7) {
        const error = errors[k]!;
        const level = sequence.level({ error });
        const wanted = Array.from({ length: level.indices.length / 3 }, (_, t) => turned([...level.indices.subarray(3 * t, 3 * t + 3)].map((v) => at(level.vertexMap[v]!))));
        const alive = [...births.keys()].filter((t) => births[t]! <= error && error < deaths[t]!);
        expect(alive.map((t) => turned([...indices.subarray(3 * t, 3 * t + 3)].map(at))).sort()).toEqual(wanted.sort());
      }
    });
  }

  it('need vertices that stay', () => {
    using sequence = simplifySequence(hills(10));
    expect(thrown(() => sequence.lifetimes())).toEqual(coded('wrong-state'));
  });
});

describe('what is damaged', () => {
  it('is told, wherever it is cut', async () => {
    using document = await recorded(plyOf(hills(8)));
    const bytes = await document.writeProgressive();
    for (let length = 0; length < bytes.length; length += 7) {
      expect(thrown(() => decodeProgressive(bytes.subarray(0, length))), `${length} bytes`).toEqual(coded('truncated'));
    }
    const text = thrown(() => decodeProgressive(new TextEncoder().encode('ply\nformat')));
    expect(text).toEqual(coded('unknown-format'));
    expect(thrown(() => decodeProgressive(Uint8Array.from([...bytes, 0])))).toEqual(coded('syntax'));
    for (let at = 8; at < bytes.length; at += 11) {
      const damaged = bytes.slice();
      damaged[at] = (damaged[at] as number) ^ 16;
      expect(thrown(() => decodeProgressive(damaged)), `byte ${at}`).toMatchObject({ name: 'DecimeshError' });
    }
  });

  it('is told or a mesh all the same, when the checksums are right', async () => {
    using document = await recorded(plyOf(hills(8)));
    const bytes = await document.writeProgressive();
    let state = 1;
    const random = (most: number): number => {
      state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
      return Math.floor((state / 2 ** 32) * most);
    };
    const outcomes = new Set<string>();
    for (let run = 0; run < 400; run += 1) {
      const damaged = bytes.slice();
      const view = new DataView(damaged.buffer);
      for (let at = 8; at < damaged.length; ) {
        const length = view.getUint32(at + 4, true);
        // The header is text, which is checked by itself below.
        if (at > 8 && length > 0 && random(2) === 0) damaged[at + 8 + random(length)] = random(256);
        view.setUint32(at + 8 + length, crc32(damaged.subarray(at, at + 8 + length)), true);
        at += 12 + length;
      }
      const error = thrown(() => decodeProgressive(damaged, { selective: true }).refined(boxRegion([0, 0, 0], [1, 1, 1]))) as { name?: string; code?: string } | undefined;
      if (error !== undefined) expect(error.name, String((error as Error).stack)).toBe('DecimeshError');
      outcomes.add(error?.code ?? 'none');
    }
    expect(outcomes.size).toBeGreaterThan(2);
  });

  it('is a header with counts that nothing bears out', () => {
    const header = { version: 2, vertices: 2 ** 29, triangles: 2 ** 29, baseTriangles: 2 ** 29, splits: 0, diagonal: 1, positionGrid: 0, keepsOrder: false, attributes: [[]], names: [], wedgeSets: [[2 ** 29, 0]], groups: [[2 ** 29, 0, 0, 0, -1, -1]] };
    const file = (fields: object): Uint8Array => packChunks([
      { type: 'HEAD', payload: new TextEncoder().encode(JSON.stringify({ ...header, ...fields })) },
      { type: 'BASE', payload: new Uint8Array(64) },
    ]);
    expect(thrown(() => decodeProgressive(file({})))).toMatchObject({ name: 'DecimeshError' });
    expect(thrown(() => decodeProgressive(file({ version: 3 })))).toEqual(coded('unsupported'));
    expect(thrown(() => decodeProgressive(file({ version: 1 })))).toEqual(coded('unsupported'));
    expect(thrown(() => decodeProgressive(file({ vertices: 1e300 })))).toEqual(coded('too-large'));
    expect(thrown(() => decodeProgressive(file({ groups: [[1, 4, 0, 0, -1, -1]] })))).toEqual(coded('out-of-range'));
    for (const fields of [{ groups: [[1, 0, 0, 0, 0, -1]] }, { groups: [[1, 0, 0, 0, -1]] }, { groups: [7] }, { wedgeSets: [[1, 1]] }, { wedgeSets: [[1, 'length']] }, { names: 3 }]) {
      expect(thrown(() => decodeProgressive(file(fields))), JSON.stringify(fields)).toEqual(coded('syntax'));
    }
    expect(thrown(() => decodeProgressive(file({ wedgeSets: 'none' })))).toEqual(coded('syntax'));
  });
});

describe('the coder', () => {
  it('gives back any bits and numbers', () => {
    const encoder = new RangeEncoder();
    const [models, integers] = [newModels(4), new IntegerModel()];
    const numbers = [0, 1, 2, 3, 255, 65536, 2 ** 31, 2 ** 32 - 1];
    for (let k = 0; k < 3000; k += 1) {
      encoder.bit(models, k & 3, k % 7 === 0 ? 1 : 0);
      integers.unsigned(encoder, k % 18, numbers[k % numbers.length]!);
      integers.signed(encoder, 3, (k * 7919 * (k & 1 ? -1 : 1)) | 0);
      encoder.direct(12, k & 4095);
    }
    const decoder = new RangeDecoder(encoder.finish());
    const [again, read] = [newModels(4), new IntegerModel()];
    for (let k = 0; k < 3000; k += 1) {
      expect(decoder.bit(again, k & 3, 0)).toBe(k % 7 === 0 ? 1 : 0);
      expect(read.unsigned(decoder, k % 18, 0)).toBe(numbers[k % numbers.length]);
      expect(read.signed(decoder, 3, 0)).toBe((k * 7919 * (k & 1 ? -1 : 1)) | 0);
      expect(decoder.direct(12, 0)).toBe(k & 4095);
    }
  });

  it('keeps every float to the bit, on a grid or not', () => {
    const hard = [0, -0, 1e-45, -1e-45, 3.4e38, -3.4e38, 1, -1, 0.1, 1e-20, 123456.789];
    for (const values of [Float32Array.from(hard), Float32Array.from([0.1, 0.25, -3.7, 0]), Float32Array.from([1 / 255, 3 / 255, 1])]) {
      const grid = gridOf(values);
      const encoder = new RangeEncoder();
      const model = new FloatModel(grid, 1);
      for (let at = 0; at < values.length; at += 1) model.code(encoder, values, at, [0.1], 0.01);
      const decoder = new RangeDecoder(encoder.finish());
      const read = new Float32Array(values.length);
      const again = new FloatModel(grid, 1);
      for (let at = 0; at < values.length; at += 1) again.code(decoder, read, at, [0.1], 0.01);
      expect(new Uint32Array(read.buffer)).toEqual(new Uint32Array(values.buffer));
    }
    expect(gridOf(Float32Array.from(hard))).toBe(0);
    expect(gridOf(Float32Array.from({ length: 40 }, (_, k) => Math.fround(k / 100)))).toBe(100);
  });
});

for (const name of ['bench/stanford-bunny.obj.gz', 'bench/igea.obj.gz', 'gltf/FlightHelmet/FlightHelmet.gltf', 'gltf/BrainStem.glb'] as const) {
  testWithAsset(name, `${name} is at most 1.3 times what Meshopt makes of it, and shows with 5 % of it`, async (path) => {
    const raw = readFileSync(path);
    const bytes = path.endsWith('.gz') ? gunzipSync(raw) : raw;
    const beside = path.endsWith('.gltf') ? [{ name: basename(path).replace('.gltf', '.bin'), bytes: readFileSync(path.replace('.gltf', '.bin')) }] : [];
    using document = await openDocument([{ name: basename(path).replace('.gz', ''), bytes }, ...beside]);
    const original = await document.geometry();
    await document.simplify({ placement: 'subset' });
    const file = await document.writeProgressive();
    await MeshoptEncoder.ready;
    // What EXT_meshopt_compression stores: vertices and triangles in the order of the caches, floats as they are.
    let meshopt = 0;
    const done = new Set<number>();
    for (const { indices, wedgeSet } of original.groups) {
      const [remap, unique] = MeshoptEncoder.reorderMesh(indices.slice(), true, true);
      const moved = indices.map((index) => remap[index]!);
      meshopt += MeshoptEncoder.encodeGltfBuffer(new Uint8Array(moved.buffer), moved.length, 4, 'TRIANGLES').length;
      if (done.has(wedgeSet)) continue;
      done.add(wedgeSet);
      const { positions, attributes } = original.wedgeSets[wedgeSet]!;
      for (const { components, values } of [{ components: 3, values: positions }, ...Object.values(attributes)]) {
        const ordered = new Float32Array(unique * components);
        for (const [index, place] of remap.entries()) if (place < unique) ordered.set(values.subarray(components * index, components * (index + 1)), components * place);
        meshopt += MeshoptEncoder.encodeGltfBuffer(new Uint8Array(ordered.buffer), unique, 4 * components, 'ATTRIBUTES').length;
      }
    }
    expect(file.length).toBeLessThan(1.3 * meshopt);
    let [given, first] = [0, 0];
    async function* pieces(): AsyncGenerator<Uint8Array> {
      for (; given < file.length; given += 1000) yield file.subarray(given, given + 1000);
    }
    let last: LevelGeometry | undefined;
    for await (const mesh of readProgressive(pieces())) {
      first ||= given + 1000;
      if (mesh.complete) last = mesh.geometry();
    }
    expect(last).toEqual(original);
    expect(first).toBeLessThan(0.05 * file.length);
  });
}

describe('in use', () => {
  it('the command line writes it and reads it back, to the bit', async () => {
    const directory = temporaryDirectory();
    const [input, output, back] = ['in.glb', 'out.pmesh', 'back.glb'].map((name) => join(directory, name)) as [string, string, string];
    writeFileSync(input, glb(gltfOf(hills(20))));
    const { code, stdout } = await decimesh(input, '-o', output, '--json');
    expect(code).toBe(0);
    const report = JSON.parse(stdout) as { output: { format: string; bytes: number; triangles: number; path: string } };
    const bytes = readFileSync(output);
    expect(report.output).toMatchObject({ format: 'pmesh', bytes: bytes.length, triangles: 800, path: output });
    expect((await decimesh(output, '-o', back, '-r', '1')).code).toBe(0);
    using original = await openDocument(readFileSync(input));
    using returned = await openDocument(readFileSync(back));
    expect(await returned.geometry()).toEqual(await original.geometry());
    expect(await gltfErrors(readFileSync(back))).toEqual([]);
    for (const wrong of [['--size', '1k'], ['--placement', 'optimal'], ['--lods', '1,0.5'], ['--measure']]) {
      expect((await decimesh(input, '-o', output, ...wrong)).code, wrong[0]).toBe(2);
    }
    writeFileSync(output, bytes.subarray(0, bytes.length - 20));
    expect((await decimesh(output, '-o', back, '-r', '1')).code).toBe(3);
  });

  it('three.js shows each level as it comes', async () => {
    using document = await recorded(glb(gltfOf(hills(20))));
    const bytes = await document.writeProgressive();
    const loader = new ProgressiveLoader();
    const counts: number[] = [];
    const objects = new Set<unknown>();
    loader.onLevel = (object) => {
      objects.add(object);
      const [part] = object.children as Mesh[];
      counts.push(part!.geometry.index!.count / 3);
    };
    async function* pieces(): AsyncGenerator<Uint8Array> {
      for (let at = 0; at < bytes.length; at += 200) yield bytes.subarray(at, at + 200);
    }
    const object = await loader.read(pieces());
    expect(objects).toEqual(new Set([object]));
    expect(counts.length).toBeGreaterThan(5);
    expect(counts.at(-1)).toBe(800);
    expect(counts[0]).toBeLessThan(50);
    const [part] = loader.parse(bytes).children as Mesh[];
    expect(Object.keys(part!.geometry.attributes).sort()).toEqual(['normal', 'position', 'uv']);
    await expect(loader.read(bytes.subarray(0, 900))).rejects.toEqual(coded('truncated'));
  });
});
