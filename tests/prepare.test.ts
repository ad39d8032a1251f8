// Preparation beside simplification: what is there twice, what nobody needs, keys of animations, textures.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import sharp from 'sharp';
import { AnimationMixer, Mesh, Vector3, type SkinnedMesh } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { beforeAll, describe, expect, it } from 'vitest';
import { COMPRESSIONS, init, openDocument, type PrepareOptions, type WriteOptions, type Written } from 'decimesh';
import { remembering } from '../dist/prepare/encoded.js';
import { keysToKeep } from '../dist/prepare/resample.js';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';
import { gltfErrors } from './support/validate.ts';

const sample = (name: string): Uint8Array<ArrayBuffer> => new Uint8Array(readFileSync(fileURLToPath(new URL(`../www/samples/${name}`, import.meta.url))));

beforeAll(() => init());

async function prepared(file: Uint8Array, prepare: PrepareOptions, options: WriteOptions = {}): Promise<Written> {
  using document = await openDocument(file);
  const written = await document.write({ ...options, prepare });
  expect(await gltfErrors(written.bytes)).toEqual([]);
  return written;
}

interface Tree {
  accessors: Array<Record<string, unknown>>;
  bufferViews: unknown[];
  images: Array<{ name?: string; mimeType: string; bufferView: number }>;
  materials: Array<{ name?: string }>;
  meshes: Array<{ name?: string; primitives: Array<{ attributes: Record<string, number>; indices: number; material: number }> }>;
  nodes: Array<{ name: string; mesh?: number }>;
  textures: Array<{ source?: number; extensions?: Record<string, { source: number }> }>;
  extensionsUsed?: string[];
  extensionsRequired?: string[];
}

const treeOf = ({ bytes }: Pick<Written, 'bytes'>): Tree => glbTree(bytes) as unknown as Tree;

/** PNG of a pattern that no codec makes nothing of. */
async function picture(size: number, alpha = false): Promise<Uint8Array> {
  const channels = alpha ? 4 : 3;
  const pixels = Uint8Array.from({ length: size * size * channels }, (_, at) => (at * at * 7 + Math.floor(at / 97) * 13) % 251);
  return new Uint8Array(await sharp(pixels, { raw: { width: size, height: size, channels } }).png().toBuffer());
}

/** Two meshes of the same geometry, with materials, textures and images in pairs, and a third of each that nobody uses. */
async function pairs(change: (json: Record<string, unknown>) => void = () => {}): Promise<Uint8Array> {
  const { json, binary } = gltfOf(hills(8));
  const images = [await picture(64), await picture(64), await picture(32, true)];
  const pieces = [binary, binary, ...images];
  const { bufferViews, accessors } = json;
  const starts: number[] = [];
  let length = 0;
  for (const piece of pieces) {
    starts.push(length);
    length += Math.ceil(piece.length / 4) * 4;
  }
  const bytes = new Uint8Array(length);
  for (const [index, piece] of pieces.entries()) bytes.set(piece, starts[index]);
  const count = bufferViews.length;
  for (const view of bufferViews.slice(0, count)) bufferViews.push({ ...view, byteOffset: view.byteOffset + (starts[1] as number) });
  for (const accessor of accessors.slice(0, count)) accessors.push({ ...accessor, bufferView: accessor.bufferView + count });
  for (const [index, image] of images.entries()) {
    bufferViews.push({ buffer: 0, byteOffset: starts[2 + index] as number, byteLength: image.length } as never);
  }
  const [first] = json.meshes[0]?.primitives ?? [];
  const attributes = Object.fromEntries(Object.entries(first?.attributes ?? {}).map(([name, accessor]) => [name, (accessor as number) + count]));
  json.meshes.push({ name: 'second', primitives: [{ attributes, indices: (first?.indices ?? 0) + count, mode: 4, material: 1 }] });
  json.meshes.push({ name: 'nobody', primitives: [{ ...(first as NonNullable<typeof first>) }] });
  json.nodes.push({ mesh: 1, name: 'other' }, { mesh: 2, name: 'nowhere' });
  Object.assign(json.scenes[0] as object, { nodes: [0, 1] });
  const material = (texture: number, name: string): object => ({ name, pbrMetallicRoughness: { baseColorTexture: { index: texture } } });
  json.buffers = [{ byteLength: bytes.length }];
  const whole: Record<string, unknown> = {
    ...json,
    materials: [material(0, 'material'), material(1, 'material'), material(2, 'unused')],
    textures: [{ source: 0 }, { source: 1 }, { source: 2 }],
    images: images.map((_, index) => ({ bufferView: 2 * count + index, mimeType: 'image/png', name: `image ${index}` })),
  };
  change(whole);
  return glb({ json: whole, binary: bytes });
}

describe('images that were encoded before', () => {
  const request = { type: 'image/png', maxSize: 4, format: 'webp', quality: 0.8 } as const;

  it('are not encoded again, and are the caller’s own', async () => {
    let runs = 0;
    const codec = remembering((bytes) => {
      runs += 1;
      return Promise.resolve({ bytes: bytes.slice(1), format: 'webp' });
    });
    const image = Uint8Array.of(9, 1, 2, 3);
    const first = await codec(image, request);
    structuredClone(first.bytes, { transfer: [first.bytes.buffer as ArrayBuffer] });
    expect((await codec(image, request)).bytes).toEqual(Uint8Array.of(1, 2, 3));
    expect(runs).toBe(1);
    await codec(image, { ...request, quality: 0.7 });
    await codec(image, { ...request, maxSize: undefined });
    await codec(Uint8Array.of(9, 1, 2, 4), request);
    expect(runs).toBe(4);
  });

  it('make room for others', async () => {
    let runs = 0;
    const codec = remembering(() => {
      runs += 1;
      return Promise.resolve({ bytes: new Uint8Array(20 << 20), format: 'png' });
    });
    for (const image of [1, 2, 3, 4, 1]) await codec(Uint8Array.of(image), request);
    expect(runs).toBe(5);
    await codec(Uint8Array.of(1), request);
    await codec(Uint8Array.of(4), request);
    expect(runs).toBe(5);
  });
});

describe('dedup', () => {
  it('lets equal things be one, and numbers nothing anew', async () => {
    const { report, bytes } = await prepared(await pairs(), { dedup: true });
    const plain = await (await openDocument(await pairs())).write();
    const [before, after] = [plain.report.output.parts, report.output.parts];
    expect(after.geometry).toBeLessThan(0.55 * before.geometry);
    expect(after.textures).toBeLessThan(0.75 * before.textures);
    const { meshes, materials, images, textures } = treeOf({ bytes });
    expect(meshes[1]?.primitives[0]).toEqual(meshes[0]?.primitives[0]);
    expect([meshes.length, materials.length, images.length]).toEqual([3, 3, 3]);
    expect(textures.map(({ source }) => source)).toEqual([0, 0, 2]);
  });

  it('keeps materials of different names apart', async () => {
    const renamed = await pairs((json) => Object.assign((json['materials'] as object[])[1] as object, { name: 'of its own' }));
    const materialOf = async (bytes: Uint8Array): Promise<unknown> => treeOf(await prepared(bytes, { dedup: true })).meshes[1]?.primitives[0]?.material;
    expect([await materialOf(await pairs()), await materialOf(renamed)]).toEqual([0, 1]);
  });
});

describe('prune', () => {
  it('removes what no scene needs and numbers the rest anew', async () => {
    const written = await prepared(await pairs(), { prune: true });
    const tree = treeOf(written);
    expect(tree.nodes.map(({ name }) => name)).toEqual(['node', 'other']);
    expect(tree.meshes.map(({ name }) => name)).toEqual(['mesh', 'second']);
    expect(tree.images.map(({ name }) => name)).toEqual(['image 0', 'image 1']);
    using document = await openDocument(written.bytes);
    using original = await openDocument(await pairs());
    expect(document.summary.triangles).toBe((original.summary.triangles / 3) * 2);
  });

  it('removes nothing where an extension may need it, and says which', async () => {
    const file = await pairs((json) => Object.assign(json, { extensionsUsed: ['ACME_picks'], extensions: { ACME_picks: { picked: [2] } } }));
    const written = await prepared(file, { dedup: true, prune: true });
    expect(written.report.warnings).toEqual([expect.objectContaining({ code: 'not-pruned', message: expect.stringContaining('ACME_picks') })]);
    const tree = glbTree(written.bytes);
    expect(tree['extensions']).toEqual({ ACME_picks: { picked: [2] } });
    expect((tree['meshes'] as object[]).length).toBe(3);
  });

  it('with dedup leaves each thing once', async () => {
    const tree = treeOf(await prepared(await pairs(), { dedup: true, prune: true }));
    const { accessors, images, textures, materials, meshes } = tree;
    expect([images.length, textures.length, materials.length, meshes.length]).toEqual([1, 1, 1, 2]);
    // Indices, positions, normals and texture coordinates.
    expect(accessors.length).toBe(4);
  });

  it('keeps a library of meshes without a scene', async () => {
    const file = await pairs((json) => {
      delete json['scene'];
      delete json['scenes'];
      delete json['nodes'];
    });
    expect(treeOf(await prepared(file, { prune: true })).meshes.length).toBe(3);
  });
});

describe('resample', () => {
  const track = (values: number[], kind: 'linear' | 'step' | 'rotation', width = 1) => ({
    times: Float32Array.from({ length: values.length / width }, (_, key) => key),
    values: Float32Array.from(values),
    width,
    kind,
  });

  it.each([
    ['a straight line', [0, 1, 2, 3, 4], 'linear', [0, 4]],
    ['a corner', [0, 1, 2, 1, 0], 'linear', [0, 2, 4]],
    ['what never changes', [5, 5, 5, 5], 'linear', [0, 3]],
    ['a step', [1, 1, 1, 2, 2, 2], 'step', [0, 3, 5]],
    ['a line in steps', [0, 1, 2, 3], 'step', [0, 1, 2, 3]],
    ['two keys', [0, 1], 'linear', [0, 1]],
  ] as const)('of %s keeps the keys that it needs', (_, values, kind, kept) => {
    expect(keysToKeep(track([...values], kind))).toEqual(kept);
  });

  it('knows the sphere of rotations and that a quaternion has two signs', () => {
    const turn = (angle: number): number[] => [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];
    const steady = [0, 0.3, 0.6, 0.9, 1.2].map(turn);
    expect(keysToKeep(track(steady.flat(), 'rotation', 4))).toEqual([0, 4]);
    const flipped = steady.map((quaternion, key) => quaternion.map((value) => (key % 2 === 0 ? value : -value)));
    expect(keysToKeep(track(flipped.flat(), 'rotation', 4))).toEqual([0, 4]);
    const uneven = [0, 0.1, 0.6, 0.9, 1.2].map(turn);
    expect(keysToKeep(track(uneven.flat(), 'rotation', 4)).length).toBeGreaterThan(2);
  });

  it('of a long track takes time in proportion to it', () => {
    const start = performance.now();
    const flat = Array.from({ length: 100_000 }, () => 1);
    expect(keysToKeep(track(flat, 'linear')).length).toBeLessThan(1000);
    expect(performance.now() - start).toBeLessThan(20_000);
  });

  it.each(COMPRESSIONS)('moves a real model as before, with %s', async (compress) => {
    const file = sample('desk-fan.glb');
    const options = { compress } as const;
    const before = await (await openDocument(file)).write(options);
    const after = await prepared(file, { resample: true, dedup: true, prune: true }, options);
    expect(after.report.output.parts.animation).toBeLessThanOrEqual(before.report.output.parts.animation);
    if (compress !== 'none') return;
    const [a, b] = [await poses(before.bytes), await poses(after.bytes)];
    const extent = Math.max(...a.flat().map(Math.abs));
    expect(b.length).toBe(a.length);
    for (const [time, positions] of a.entries()) {
      const moved = b[time] as number[];
      expect(moved.length).toBe(positions.length);
      expect(Math.max(...positions.map((value, at) => Math.abs(value - (moved[at] as number))))).toBeLessThan(1e-3 * extent);
    }
  });
});

describe('textures', () => {
  it('are scaled and encoded, and a reader is told what it needs', async () => {
    const written = await prepared(await pairs(), { textures: { maxSize: 16, format: 'webp' } });
    const tree = treeOf(written);
    expect(tree.images.map(({ mimeType }) => mimeType)).toEqual(Array.from({ length: 3 }, () => 'image/webp'));
    expect(tree.textures).toEqual([0, 1, 2].map((source) => ({ extensions: { EXT_texture_webp: { source } } })));
    expect([tree.extensionsUsed, tree.extensionsRequired]).toEqual([['EXT_texture_webp'], ['EXT_texture_webp']]);
    expect(written.report.output.parts.textures).toBeLessThan(0.3 * written.report.input.parts.textures);
    const { files } = await (await openDocument(written.bytes)).write({ format: 'gltf' });
    const sizes = await Promise.all(files.filter(({ name }) => name.endsWith('.webp')).map(({ bytes }) => sharp(bytes).metadata()));
    expect(sizes.map(({ width, height }) => [width, height])).toEqual([[16, 16], [16, 16], [16, 16]]);
    // And back: the extension is not needed for PNG.
    const back = treeOf(await prepared(written.bytes, { textures: { maxSize: 4, format: 'png' } }));
    expect(back.textures).toEqual([0, 1, 2].map((source) => ({ source })));
  });

  it('with alpha do not become JPEG', async () => {
    const { images } = treeOf(await prepared(await pairs(), { textures: { maxSize: 16, format: 'jpeg' } }));
    expect(images.map(({ mimeType }) => mimeType)).toEqual(['image/jpeg', 'image/jpeg', 'image/png']);
  });

  it('that cannot be decoded stay, with a warning', async () => {
    const file = await pairs();
    const { images, bufferViews } = glbTree(file) as unknown as { images: Array<{ bufferView: number }>; bufferViews: Array<{ byteOffset: number; byteLength: number }> };
    const view = bufferViews[images[0]?.bufferView ?? 0];
    const binary = 28 + new DataView(file.buffer).getUint32(12, true);
    file.fill(7, binary + (view?.byteOffset ?? 0) + 40, binary + (view?.byteOffset ?? 0) + (view?.byteLength ?? 0) - 20);
    using document = await openDocument(file);
    const { report } = await document.write({ prepare: { textures: { maxSize: 8 } } });
    expect(report.warnings.filter(({ code }) => code === 'texture-kept').map(({ where }) => where)).toEqual(['images[0]']);
  });

  it('are left as they are when that is smaller', async () => {
    const { report } = await prepared(sample('flight-helmet.glb'), { textures: { format: 'png', quality: 1 } });
    expect(report.output.parts.textures).toBeLessThanOrEqual(report.input.parts.textures);
  });
});

it('goes with everything else that is written', async () => {
  using document = await openDocument(await pairs());
  await document.simplify();
  const prepare = { dedup: true, prune: true, textures: { maxSize: 16 } } as const;
  const { report, bytes } = await document.write({ size: 6000, prepare, compress: 'meshopt', quantize: true });
  expect(report.output.bytes).toBeLessThanOrEqual(6000);
  expect(await gltfErrors(bytes)).toEqual([]);
  const chain = await document.write({ lods: [1, 0.5], prepare });
  expect(await gltfErrors(chain.bytes)).toEqual([]);
  expect(JSON.stringify(glbTree(chain.bytes))).toContain('MSFT_lod');
  const parts = await document.write({ format: 'gltf', prepare });
  // Pruned and equal images are no files any more.
  expect(parts.files.map(({ name }) => name).sort()).toEqual(['model.bin', 'model_image_0.png']);
});

it.each<[PrepareOptions, RegExp]>([
  [{ textures: { maxSize: 0 } }, /maxSize/],
  [{ textures: { format: 'gif' as never } }, /format/],
  [{ textures: { quality: 2 } }, /quality/],
  [{ prune: 1 as never }, /prune/],
  [{ shrink: true } as never, /shrink/],
])('refuses %o', async (prepare, where) => {
  using document = await openDocument(glb(gltfOf(hills(2))));
  await expect(document.write({ prepare })).rejects.toMatchObject({ code: 'invalid-argument', where: expect.stringMatching(where) as string });
  await expect(document.write({ format: 'obj', prepare: { dedup: true } })).rejects.toMatchObject({ where: 'prepare' });
});

it('is asked for on the command line', async () => {
  const directory = temporaryDirectory();
  const [input, output] = [join(directory, 'in.glb'), join(directory, 'out.glb')];
  writeFileSync(input, await pairs());
  const options = ['-r', '0.5', '--prepare', 'dedup,prune,resample', '--texture-size', '16', '--texture-format', 'webp', '--texture-quality', '0.5', '--json'];
  const { code, stdout } = await decimesh(input, '-o', output, ...options);
  expect(code).toBe(0);
  const { input: before, output: after } = JSON.parse(stdout) as Written['report'];
  expect(after.parts.textures).toBeLessThan(0.2 * before.parts.textures);
  expect(treeOf({ bytes: new Uint8Array(readFileSync(output)) }).images.length).toBe(1);
  for (const wrong of [['--prepare', 'weld'], ['--texture-size', '0'], ['--texture-format', 'gif'], ['--texture-quality', '1.5']]) {
    const refused = await decimesh(input, '-o', output, '-r', '0.5', ...wrong);
    expect([refused.code, refused.stderr]).toEqual([2, expect.stringContaining(wrong[0] as string)]);
  }
  const other = await decimesh(input, '-o', join(directory, 'out.obj'), '-r', '0.5', '--prepare', 'dedup');
  expect([other.code, other.stderr]).toEqual([2, expect.stringContaining('--prepare')]);
});

/** World coordinates of every vertex at five times of every animation together. */
async function poses(bytes: Uint8Array<ArrayBuffer>): Promise<number[][]> {
  // Images are for browsers.
  const tree = JSON.parse(JSON.stringify(glbTree(bytes), (key, value: unknown) => (key === 'material' ? undefined : value))) as Record<string, unknown>;
  for (const list of ['materials', 'textures', 'images']) delete tree[list];
  const binary = bytes.subarray(28 + new DataView(bytes.buffer).getUint32(12, true));
  const { scene, animations } = await new GLTFLoader().parseAsync(glb({ json: tree, binary }).buffer as ArrayBuffer, '');
  const mixer = new AnimationMixer(scene);
  for (const clip of animations) mixer.clipAction(clip).play();
  const point = new Vector3();
  const length = Math.max(...animations.map(({ duration }) => duration));
  return [0, 0.13, 0.37, 0.61, 0.89].map((share) => {
    mixer.setTime(share * length);
    scene.updateMatrixWorld(true);
    const found: number[] = [];
    scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      (object as Partial<SkinnedMesh>).skeleton?.update();
      const { count } = object.geometry.getAttribute('position');
      for (let vertex = 0; vertex < count; vertex += 7) found.push(...object.getVertexPosition(vertex, point).applyMatrix4(object.matrixWorld));
    });
    return found;
  });
}
