// Compressed glTF: decoded on the way in, with everything else of the file kept; corrupt data is a typed error.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { MeshoptEncoder } from 'meshoptimizer';
import { beforeAll, describe, expect, it } from 'vitest';
import { DecimeshError, init, openDocument, type NamedBytes } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { testWithAsset } from './support/assets.ts';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';
import { gltfErrors } from './support/validate.ts';

const fixture = (name: string): string => fileURLToPath(new URL(`fixtures/codecs/${name}`, import.meta.url));
const read = (name: string): Uint8Array => new Uint8Array(readFileSync(fixture(name)));
const coded = (code: string | RegExp, where: RegExp): unknown =>
  expect.objectContaining({ name: 'DecimeshError', code: expect.stringMatching(code), where: expect.stringMatching(where) });
const BOX_DRACO = (): NamedBytes[] => ['BoxDraco.gltf', '0.bin'].map((name) => ({ name, bytes: read(`BoxDraco/${name}`) }));
const META_DRACO = (): NamedBytes[] =>
  ['BoxMetaDraco.gltf', 'buffer0.bin', 'Texture0_MeshFeatures.png', 'Texture1_MeshFeatures.png'].map((name) => ({
    name,
    bytes: read(`BoxMetaDraco/${name}`),
  }));
const jsonOf = (bytes: Uint8Array): Record<string, unknown> => JSON.parse(new TextDecoder().decode(bytes)) as Record<string, unknown>;
const textBytes = (json: unknown): Uint8Array => new TextEncoder().encode(JSON.stringify(json));
const COMPRESSION = /meshopt_compression|KHR_draco/;

beforeAll(async () => {
  await init();
  await MeshoptEncoder.ready;
});

/** Hills whose views are all compressed, by the extension named, in version 0 or 1 of the codec. */
function packedHills(extension: string, version: number, size = 12) {
  const { json, binary } = gltfOf(hills(size));
  const pieces: Uint8Array[] = [];
  let offset = 0;
  for (const [index, view] of json.bufferViews.entries()) {
    const count = json.accessors[index]?.count ?? 0;
    const byteStride = view.byteLength / count;
    const mode = index === 0 ? 'TRIANGLES' : 'ATTRIBUTES';
    const packed = MeshoptEncoder.encodeGltfBuffer(binary.subarray(view.byteOffset, view.byteOffset + view.byteLength), count, byteStride, mode, version);
    Object.assign(view, {
      buffer: 1,
      ...(index === 0 ? {} : { byteStride }),
      extensions: { [extension]: { buffer: 0, byteOffset: offset, byteLength: packed.length, byteStride, count, mode } },
    });
    const padded = new Uint8Array(Math.ceil(packed.length / 4) * 4);
    padded.set(packed);
    pieces.push(padded);
    offset += padded.length;
  }
  const tree = {
    ...json,
    extensionsUsed: [extension],
    extensionsRequired: [extension],
    buffers: [{ byteLength: offset }, { byteLength: binary.length, extensions: { [extension]: { fallback: true } } }],
  };
  return { tree, binary: new Uint8Array(Buffer.concat(pieces)) };
}

describe('compressed input', () => {
  it.each([
    ['draco', 'BoxDraco', BOX_DRACO, 12],
    ['draco', 'BoxMetaDraco', META_DRACO, 12],
    ['meshopt', 'BoxMeshopt', () => read('BoxMeshopt.glb'), 12],
  ] as const)('of %s is decoded: %s', async (compression, _, input, triangles) => {
    const files = input();
    using document = await openDocument(files);
    const given = files instanceof Uint8Array ? files.length : files.reduce((sum, { bytes }) => sum + bytes.byteLength, 0);
    expect(document.summary).toMatchObject({ compression, triangles, bytes: given });
    const { bytes } = await document.write({ format: 'glb', compress: 'none' });
    expect(await gltfErrors(bytes)).toEqual([]);
    expect(JSON.stringify(glbTree(bytes))).not.toMatch(COMPRESSION);
    const { wedgeSets } = await document.geometry();
    const extent = Math.max(...(wedgeSets[0]?.positions ?? []).map(Math.abs));
    expect(extent).toBeGreaterThan(0.4);
  });

  it('gives the coordinates that were compressed', async () => {
    const { wedgeSets } = await (await openDocument(BOX_DRACO())).geometry();
    const set = wedgeSets[0];
    // A unit box: every coordinate is half a unit, every normal an axis.
    expect(set?.positions.length).toBe(72);
    for (const value of set?.positions ?? []) expect(Math.abs(value)).toBeCloseTo(0.5, 3);
    const normals = set?.attributes['NORMAL']?.values ?? [];
    expect(normals.length).toBe(72);
    for (let at = 0; at < normals.length; at += 3) {
      const lengths = [0, 1, 2].map((axis) => Math.abs(normals[at + axis] as number)).sort();
      expect(lengths[2]).toBeCloseTo(1, 2);
      expect(lengths[1]).toBeCloseTo(0, 2);
    }
  });

  it.each([['EXT_meshopt_compression', 0], ['KHR_meshopt_compression', 0], ['KHR_meshopt_compression', 1]])('of %s, codec version %i, is what was encoded', async (extension, version) => {
    const { tree, binary } = packedHills(extension, version);
    const plain = gltfOf(hills(12));
    using packed = await openDocument(glb({ json: tree, binary }));
    using reference = await openDocument(glb({ json: plain.json, binary: plain.binary }));
    expect(packed.summary.compression).toBe('meshopt');
    expect(reference.summary.compression).toBe('none');
    // The codec may turn a triangle to another corner.
    const [a, b] = [await packed.geometry(), await reference.geometry()];
    expect(a.wedgeSets).toEqual(b.wedgeSets);
    expect(trianglesOf(a.groups[0]?.indices)).toEqual(trianglesOf(b.groups[0]?.indices));
  });

  it('keeps names, extras, unknown extensions, required extensions and their order', async () => {
    const [main, binary] = BOX_DRACO();
    const json = jsonOf(main?.bytes as Uint8Array);
    const extras = { ünïcode: ['x', null, 1.5], nested: { deep: [[]] } };
    Object.assign(json, {
      zebra: 1,
      extras,
      extensionsUsed: ['EXT_unknown', ...(json['extensionsUsed'] as string[]), 'KHR_materials_unlit'],
      extensions: { EXT_unknown: { value: 7 } },
    });
    const [accessors, meshes] = [json['accessors'], json['meshes']] as Array<Array<Record<string, unknown>>>;
    Object.assign(accessors?.[0] ?? {}, { name: 'the indices', extras });
    Object.assign(meshes?.[0] ?? {}, { name: 'Würfel', extras });
    const before = Object.keys(json);
    using document = await openDocument([{ name: 'BoxDraco.gltf', bytes: textBytes(json) }, binary as NamedBytes]);
    const tree = glbTree((await document.write({ format: 'glb', compress: 'none' })).bytes);
    expect(tree).toMatchObject({ zebra: 1, extras, extensions: { EXT_unknown: { value: 7 } }, meshes: [{ name: 'Würfel', extras }] });
    expect(tree).toMatchObject({ accessors: [{ name: 'the indices', extras }, {}, {}] });
    expect(tree['extensionsUsed']).toEqual(['EXT_unknown', 'KHR_materials_unlit']);
    expect(tree).not.toHaveProperty('extensionsRequired');
    expect(Object.keys(tree)).toEqual(before.filter((key) => key !== 'extensionsRequired'));
  });

  it('stays quantised, and says so', async () => {
    using document = await openDocument(read('BoxMeshopt.glb'));
    const tree = glbTree((await document.write({ format: 'glb', compress: 'none' })).bytes);
    expect(tree['extensionsRequired']).toEqual(['KHR_mesh_quantization']);
  });

  it('keeps feature ids with their vertices', async () => {
    using document = await openDocument(META_DRACO());
    const { wedgeSets } = await document.geometry();
    expect(Object.keys(wedgeSets[0]?.attributes ?? {})).toEqual(expect.arrayContaining(['_FEATURE_ID_0', '_FEATURE_ID_1', '_FEATURE_ID_2']));
    const tree = glbTree((await document.write({ format: 'glb', compress: 'none' })).bytes);
    expect(JSON.stringify(tree)).toContain('EXT_mesh_features');
  });

  it('is decoded in the worker and by the command line', async () => {
    const client = createWorkerClient();
    try {
      for (const input of [BOX_DRACO(), read('BoxMeshopt.glb')]) {
        const document = await client.openDocument(input);
        expect(document.summary.triangles).toBe(12);
        expect(document.summary.compression).not.toBe('none');
      }
    } finally {
      client.terminate();
    }
    const output = join(temporaryDirectory(), 'box.glb');
    const { code, stderr } = await decimesh(fixture('BoxDraco/BoxDraco.gltf'), '-o', output, '-r', '1');
    expect([code, stderr]).toEqual([0, '']);
    expect(await gltfErrors(readFileSync(output))).toEqual([]);
  });

  testWithAsset('gltf/cave.glb', 'a large Draco file is decoded and simplified', async (path) => {
    using document = await openDocument(new Uint8Array(readFileSync(path)));
    expect(document.summary).toMatchObject({ triangles: 595410, compression: 'draco' });
    expect((await document.simplify({ ratio: 0.1, preset: 'fast' })).triangles).toBeLessThanOrEqual(59541);
  });
});

describe('corrupt compressed input', () => {
  /** Opens the file; a typed error is returned, a valid document is none, anything else fails the test. */
  async function outcome(input: NamedBytes[] | Uint8Array): Promise<DecimeshError | undefined> {
    try {
      (await openDocument(input)).dispose();
      return undefined;
    } catch (error) {
      if (error instanceof DecimeshError && error.code !== 'internal' && error.code !== 'out-of-memory') return error;
      throw error;
    }
  }

  it('is a typed error or a valid document, whichever byte of Draco data is wrong', async () => {
    const [main, binary] = BOX_DRACO() as [NamedBytes, NamedBytes];
    const good = new Uint8Array(binary.bytes as Uint8Array);
    let errors = 0;
    for (let at = 0; at < good.length; at += 1) {
      for (const value of [0, 0xff, (good[at] as number) ^ 0x10]) {
        const bytes = good.slice();
        bytes[at] = value;
        const error = await outcome([main, { ...binary, bytes }]);
        if (error === undefined) continue;
        errors += 1;
        expect(error.where).toMatch(/^BoxDraco\.gltf: (meshes\[0\]|accessors\[|bufferViews\[)/);
      }
    }
    expect(errors).toBeGreaterThan(50);
  });

  it('is a typed error or a valid document, whichever byte of meshopt data is wrong', async () => {
    const { tree, binary } = packedHills('EXT_meshopt_compression', 0, 6);
    let errors = 0;
    for (let at = 0; at < binary.length; at += 3) {
      const bytes = binary.slice();
      bytes[at] = (bytes[at] as number) ^ 0xff;
      const error = await outcome(glb({ json: tree, binary: bytes }));
      if (error === undefined) continue;
      errors += 1;
      expect(error.where).not.toBe('');
    }
    expect(errors).toBeGreaterThan(10);
    const cut = structuredClone(tree);
    const extension = cut.bufferViews[1] as unknown as { extensions: { EXT_meshopt_compression: { byteLength: number } } };
    extension.extensions.EXT_meshopt_compression.byteLength -= 20;
    expect(await outcome(glb({ json: cut, binary }))).toEqual(coded('syntax', /^bufferViews\[1\]\.extensions\.EXT_meshopt_compression$/));
  });

  it.each([
    ['count', 4e9, /too-large/],
    ['count', 1e300, /syntax/],
    ['count', -3, /syntax/],
    ['byteStride', 3, /syntax/],
    ['byteLength', 1e9, /out-of-range/],
    ['byteOffset', 2 ** 52, /out-of-range/],
    ['buffer', 9, /out-of-range/],
    ['mode', 'POINTS', /syntax/],
    ['filter', 'MAGIC', /syntax/],
  ])('names a meshopt view whose %s is %s', async (key, value, code) => {
    const { tree, binary } = packedHills('EXT_meshopt_compression', 0, 6);
    const view = tree.bufferViews[1] as unknown as { extensions: { EXT_meshopt_compression: Record<string, unknown> } };
    view.extensions.EXT_meshopt_compression[key] = value;
    expect(await outcome(glb({ json: tree, binary }))).toEqual(coded(code, /^bufferViews\[1\]/));
  });

  it('does not believe a Draco header that promises billions', async () => {
    const [main, binary] = BOX_DRACO() as [NamedBytes, NamedBytes];
    const bytes = new Uint8Array(binary.bytes as Uint8Array);
    const view = (jsonOf(main.bytes as Uint8Array)['bufferViews'] as Array<{ byteOffset?: number }>)[0];
    const start = view?.byteOffset ?? 0;
    const method = bytes[start + 8];
    // Header of eleven bytes; edgebreaker has its traversal first and then the vertices and the faces.
    bytes.set([0xff, 0xff, 0xff, 0xff, 0x0f, 0xff, 0xff, 0xff, 0xff, 0x0f], start + 11 + (method === 1 ? 1 : 0));
    expect(await outcome([main, { ...binary, bytes }])).toEqual(coded('too-large', /^BoxDraco\.gltf: meshes\[0\]\.primitives\[0\]\.extensions\.KHR_draco_mesh_compression$/));
  });

  it.each([
    ['an attribute that is not there', { bufferView: 0, attributes: { NORMAL: 0, POSITION: 77 } }, 'out-of-range', /attributes\.POSITION$/],
    ['an attribute without an accessor', { bufferView: 0, attributes: { POSITION: 1, COLOR_0: 0 } }, 'out-of-range', /attributes\.COLOR_0$/],
    ['a view that is not there', { bufferView: 5, attributes: {} }, 'out-of-range', /\.bufferView$/],
    ['no view', { attributes: {} }, 'out-of-range', /\.bufferView$/],
  ])('names a primitive with %s', async (_, extension, code, where) => {
    const [main, binary] = BOX_DRACO() as [NamedBytes, NamedBytes];
    const json = jsonOf(main.bytes as Uint8Array) as { meshes: Array<{ primitives: Array<{ extensions: object }> }> };
    Object.assign(json.meshes[0]?.primitives[0]?.extensions ?? {}, { KHR_draco_mesh_compression: extension });
    expect(await outcome([{ ...main, bytes: textBytes(json) }, binary])).toEqual(coded(code, where));
  });

  it('names a buffer that was not given', async () => {
    expect(await outcome(BOX_DRACO().slice(0, 1))).toEqual(coded('missing-resource', /^BoxDraco\.gltf: buffers\[0\]\.uri$/));
  });

  it('does not keep the next file from being opened', async () => {
    const [main, binary] = BOX_DRACO() as [NamedBytes, NamedBytes];
    const bytes = new Uint8Array(binary.bytes as Uint8Array).fill(0xaa, 40, 80);
    await outcome([main, { ...binary, bytes }]);
    expect(await outcome(BOX_DRACO())).toBeUndefined();
  });
});

/** Every triangle from its smallest corner on, in order. */
function trianglesOf(indices: Uint32Array = new Uint32Array()): string[] {
  const triangles: string[] = [];
  for (let at = 0; at < indices.length; at += 3) {
    const corners = [...indices.subarray(at, at + 3)];
    while (corners[0] !== Math.min(...corners)) corners.push(corners.shift() as number);
    triangles.push(corners.join(' '));
  }
  return triangles.sort();
}
