// Which dropped files the view may show as they are: plain ones that the engine reads vertex by vertex.
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { openDocument } from 'decimesh';
import { at } from '../scripts/project.mjs';
import { agrees, readEarly } from '../www/early.ts';
import { plainParts, readPlainGlb } from '../www/preview/plain.ts';
import type { PlainModel, View } from '../www/preview/view.ts';

const sample = (name: string): Uint8Array<ArrayBuffer> => new Uint8Array(readFileSync(at('www', 'samples', name)));
const fixture = (...path: string[]): Uint8Array<ArrayBuffer> => new Uint8Array(readFileSync(at('tests', 'fixtures', ...path)));

const primitive = { attributes: { POSITION: 0 }, indices: 1 };
const plain = {
  buffers: [{}],
  accessors: [{ bufferView: 0, count: 4 }, { bufferView: 1, count: 6 }],
  meshes: [{ primitives: [primitive] }],
};

describe('plain glTF', () => {
  it('has its primitives counted', () => {
    expect(plainParts(plain)).toEqual([{ mesh: 0, primitive: 0, vertices: 4, triangles: 2 }]);
    const without = { ...plain, meshes: [{ primitives: [] }, { primitives: [primitive, { attributes: { POSITION: 1 } }] }] };
    expect(plainParts(without)).toEqual([
      { mesh: 1, primitive: 0, vertices: 4, triangles: 2 },
      { mesh: 1, primitive: 1, vertices: 6, triangles: 2 },
    ]);
    expect(plainParts({ ...plain, extensionsUsed: ['KHR_materials_clearcoat', 'KHR_texture_transform', 'EXT_texture_webp'] })).not.toBeNull();
  });

  it.each([
    ['compression', { extensionsUsed: ['KHR_draco_mesh_compression'] }],
    ['quantisation', { extensionsRequired: ['KHR_mesh_quantization'] }],
    ['instances in buffers', { extensionsUsed: ['EXT_mesh_gpu_instancing'] }],
    ['a buffer elsewhere', { buffers: [{ uri: 'https://example.org/model.bin' }] }],
    ['an image elsewhere', { images: [{ uri: 'https://example.org/spy.png' }] }],
    ['numbers without bytes', { accessors: [{ count: 4_000_000_000 }, { bufferView: 1, count: 6 }] }],
    ['sparse numbers', { accessors: [{ bufferView: 0, count: 4, sparse: {} }, { bufferView: 1, count: 6 }] }],
    ['lines', { meshes: [{ primitives: [primitive, { ...primitive, mode: 1 }] }] }],
    ['strips', { meshes: [{ primitives: [{ ...primitive, mode: 5 }] }] }],
  ])('has no %s', (_, change) => {
    expect(plainParts({ ...plain, ...change })).toBeNull();
  });

  it.each([
    ['text', new TextEncoder().encode('solid nothing\nendsolid nothing\n')],
    ['nothing', new Uint8Array()],
    ['a GLB that ends in its JSON', sample('desk-fan.glb').subarray(0, 200)],
    ['a compressed GLB', fixture('codecs', 'BoxMeshopt.glb')],
  ])('is not %s', async (_, bytes) => {
    await expect(readPlainGlb(new Blob([bytes as Uint8Array<ArrayBuffer>]))).rejects.toThrow();
  });
});

describe('the model that is read early', () => {
  const summaryOf = async (bytes: Uint8Array): Promise<Awaited<ReturnType<typeof openDocument>>['summary']> => {
    using document = await openDocument(bytes);
    return document.summary;
  };

  it.each(['desk-fan.glb', 'nefertiti.glb'])('is %s as the engine reads it', async (name) => {
    const { bytes, parts } = await readPlainGlb(new Blob([sample(name)]));
    expect(Buffer.from(bytes).equals(sample(name))).toBe(true);
    expect(agrees(await summaryOf(bytes), parts)).toBe(true);
  });

  it('is not one that the engine has changed or remarked on', async () => {
    const { parts } = await readPlainGlb(new Blob([sample('desk-fan.glb')]));
    const summary = await summaryOf(sample('desk-fan.glb'));
    const [first, ...rest] = parts;
    if (first === undefined) throw new Error('no parts');
    expect(agrees(summary, rest)).toBe(false);
    expect(agrees(summary, [{ ...first, vertices: first.vertices + 1 }, ...rest])).toBe(false);
    expect(agrees(summary, [{ ...first, triangles: first.triangles + 1 }, ...rest])).toBe(false);
    expect(agrees({ ...summary, warnings: [{ code: 'schema', message: '', where: '' }] }, parts)).toBe(false);
  });

  it('is freed when it is not taken', async () => {
    const { parts } = await readPlainGlb(new Blob([sample('desk-fan.glb')]));
    const summary = await summaryOf(sample('desk-fan.glb'));
    let discarded = 0;
    const model = { model: { animations: [], show: () => Promise.resolve(), discard: () => { discarded += 1; } }, parts, scene: [] } satisfies PlainModel;
    const view = { loadPlain: () => Promise.resolve(model) } as unknown as View;
    const file = new File([], 'fan.glb');
    expect(await readEarly(view, [file]).take(summary)).toBe(model);
    expect(discarded).toBe(0);
    expect(await readEarly(view, [file]).take({ ...summary, triangles: 1 })).toBeNull();
    expect(discarded).toBe(1);
    readEarly(view, [file]).drop();
    await Promise.resolve();
    expect(discarded).toBe(2);
    // Files that refer to one another are not for the view.
    expect(await readEarly(view, [file, file]).take(summary)).toBeNull();
    expect(discarded).toBe(2);
  });
});
