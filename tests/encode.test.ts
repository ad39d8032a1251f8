// Encodings of the output: valid files that decode to what was written, within the step of their grid.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { AnimationMixer, BufferAttribute, BufferGeometry, Mesh, Vector3, type Group, type SkinnedMesh } from 'three';
import type { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { beforeAll, describe, expect, it } from 'vitest';
import { COMPRESSIONS, init, openDocument, type Document, type WriteOptions } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { newDracoDecoder } from '../dist/codecs/modules.js';
import { testWithAsset } from './support/assets.ts';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';
import { gltfErrors } from './support/validate.ts';

const fixture = (name: string): string => fileURLToPath(new URL(`fixtures/${name}`, import.meta.url));
const read = (name: string): Uint8Array => new Uint8Array(readFileSync(fixture(name)));
const hillsFile = (size = 30): Uint8Array => glb(gltfOf(hills(size)));
/** The step of the grid that positions are put on: 14 bits of the extent; half of it is what they move. */
const STEP = 1 / (2 ** 14 - 2);

beforeAll(() => init());

async function encoded(document: Document, options: WriteOptions): Promise<Uint8Array<ArrayBuffer>> {
  const { bytes } = await document.write({ format: 'glb', ...options });
  expect(await gltfErrors(bytes)).toEqual([]);
  return bytes;
}

/** Every triangle's corners with all attributes, each from its smallest corner on, in order. */
async function corners(bytes: Uint8Array): Promise<number[][]> {
  using document = await openDocument(bytes);
  const { groups, wedgeSets } = await document.geometry();
  const triangles: number[][] = [];
  for (const { indices, wedgeSet } of groups) {
    const set = wedgeSets[wedgeSet];
    const row = (wedge: number): number[] => [
      ...(set?.positions ?? []).slice(3 * wedge, 3 * wedge + 3),
      ...Object.values(set?.attributes ?? {}).flatMap(({ components, values }) => [...values.slice(components * wedge, components * (wedge + 1))]),
    ];
    for (let at = 0; at < indices.length; at += 3) {
      const rows = [...indices.subarray(at, at + 3)].map(row);
      const first = rows.indexOf([...rows].sort(compare)[0] as number[]);
      triangles.push([0, 1, 2].flatMap((corner) => rows[(first + corner) % 3] as number[]));
    }
  }
  return triangles.sort(compare);
}

function compare(a: number[], b: number[]): number {
  const at = a.findIndex((value, index) => value !== b[index]);
  return at < 0 ? 0 : (a[at] as number) - (b[at] as number);
}

describe('meshopt', () => {
  it('loses nothing', async () => {
    using document = await openDocument(hillsFile());
    const plain = await encoded(document, { compress: 'none' });
    const packed = await encoded(document, { compress: 'meshopt' });
    expect(packed.length).toBeLessThan(0.8 * plain.length);
    expect(await corners(packed)).toEqual(await corners(plain));
    expect(glbTree(packed)).toMatchObject({ extensionsUsed: ['EXT_meshopt_compression'], extensionsRequired: ['EXT_meshopt_compression'] });
  });

  it('still loses nothing when it is read and written again', async () => {
    using document = await openDocument(hillsFile(10));
    const once = await encoded(document, { compress: 'meshopt' });
    using again = await openDocument(once);
    expect(await corners(await encoded(again, {}))).toEqual(await corners(once));
  });

  it('puts vertices in the order of their use', async () => {
    using document = await openDocument(hillsFile());
    using again = await openDocument(await encoded(document, { compress: 'meshopt' }));
    const { groups } = await again.geometry();
    let next = 0;
    for (const index of groups[0]?.indices ?? []) {
      expect(index).toBeLessThanOrEqual(next);
      if (index === next) next += 1;
    }
  });
});

describe('draco', () => {
  it('keeps every triangle within the grid', async () => {
    using document = await openDocument(hillsFile(20));
    const plain = await encoded(document, { compress: 'none' });
    const packed = await encoded(document, { compress: 'draco' });
    expect(packed.length).toBeLessThan(0.3 * plain.length);
    using again = await openDocument(packed);
    expect(again.summary).toMatchObject({ compression: 'draco', triangles: document.summary.triangles, vertices: document.summary.vertices });
    const [a, b] = [await positionsIn(document), await positionsIn(again)];
    const extent = Math.max(...[0, 1, 2].map((axis) => Math.max(...everyThird(a, axis)) - Math.min(...everyThird(a, axis))));
    expect(Math.max(beyond(a, b), beyond(b, a))).toBeLessThan(extent * STEP);
  });

  it('splits vertices that primitives share, and keeps custom attributes exactly', async () => {
    const { json, binary } = gltfOf(hills(8));
    const indices = json.accessors[0] as { count: number };
    const half = indices.count / 2;
    json.accessors.push({ ...(json.accessors[0] as object), count: half, byteOffset: 4 * half } as never);
    indices.count = half;
    const primitives = json.meshes[0]?.primitives as Array<Record<string, unknown>>;
    // Feature ids are floats in many files; a grid would make others of them.
    const ids = Float32Array.from({ length: json.accessors[1]?.count ?? 0 }, (_, vertex) => 70001 + 3 * vertex);
    const bytes = new Uint8Array(binary.length + ids.byteLength);
    bytes.set(binary);
    bytes.set(new Uint8Array(ids.buffer), binary.length);
    json.bufferViews.push({ buffer: 0, byteOffset: binary.length, byteLength: ids.byteLength, target: 34962 });
    json.accessors.push({ bufferView: json.bufferViews.length - 1, componentType: 5126, count: ids.length, type: 'SCALAR' });
    (json.buffers[0] as { byteLength: number }).byteLength = bytes.length;
    const attributes = { ...(primitives[0]?.['attributes'] as object), _ID: json.accessors.length - 1 };
    primitives.splice(0, 1, { attributes, indices: 0 }, { attributes, indices: json.accessors.length - 2 });
    using document = await openDocument(glb({ json, binary: bytes }));
    using again = await openDocument(await encoded(document, { compress: 'draco' }));
    expect(again.summary.groups.length).toBe(2);
    const found = (await again.geometry()).wedgeSets.flatMap(({ attributes: named }) => [...(named['_ID']?.values ?? [])]);
    expect(new Set(found)).toEqual(new Set(ids));
  });

  it.each(['gltf/SimpleSkin.gltf', 'gltf/cubevc.glb', 'gltf/BoxPrimitiveOutline.gltf'])('%s looks the same in three.js', async (name) => {
    using document = await openDocument(read(name));
    const plain = await vertices(await encoded(document, { compress: 'none' }));
    const packed = await vertices(await encoded(document, { compress: 'draco' }));
    const extent = Math.max(...plain.flat().map(Math.abs));
    for (const [time, positions] of plain.entries()) {
      expect(positions.length).toBeGreaterThan(0);
      const found = packed[time] ?? [];
      expect(Math.max(beyond(positions, found), beyond(found, positions))).toBeLessThan(4 * extent * STEP);
    }
  });

  it('keeps the order of vertices that morph targets number', async () => {
    using document = await openDocument(read('gltf/AnimatedMorphCube.glb'));
    const { bytes, report } = await document.write({ compress: 'draco' });
    expect(await gltfErrors(bytes)).toEqual([]);
    expect(report.warnings).toEqual([]);
    expect(JSON.stringify(glbTree(bytes))).toContain('KHR_draco');
    const plain = await vertices(await encoded(document, { compress: 'none' }));
    const extent = Math.max(...plain.flat().map(Math.abs));
    const packed = await vertices(bytes);
    expect(packed.length).toBe(plain.length);
    for (const [time, positions] of packed.entries()) {
      expect(farthest(positions, plain[time] ?? [])).toBeLessThan(2 * extent * STEP);
    }
    using again = await openDocument(bytes);
    expect(again.summary.wedgeSets[0]?.attributes.map(({ name }) => name)).toEqual(document.summary.wedgeSets[0]?.attributes.map(({ name }) => name));
  });
});

describe('the default', () => {
  it.each(COMPRESSIONS)('keeps %s', async (compress) => {
    using document = await openDocument(hillsFile(10));
    using again = await openDocument(await encoded(document, { compress }));
    await again.simplify({ ratio: 0.5 });
    using third = await openDocument(await encoded(again, {}));
    expect(third.summary.compression).toBe(compress);
    expect((await again.write({ format: 'obj' })).bytes.length).toBeGreaterThan(0);
  });
});

describe('quantised', () => {
  it.each([
    ['gltf/AnimatedMorphCube.glb', 'morph targets under an animation'],
    ['gltf/SimpleSkin.gltf', 'a skin under an animation'],
    ['gltf/cubevc.glb', 'vertex colours'],
    ['gltf/BoxPrimitiveOutline.gltf', 'a matrix'],
  ])('%s (%s) looks the same', async (name) => {
    using document = await openDocument(read(name));
    const plain = await vertices(await encoded(document, { compress: 'none' }));
    const quantized = await encoded(document, { compress: 'none', quantize: true });
    expect(glbTree(quantized)['extensionsRequired']).toContain('KHR_mesh_quantization');
    const extent = Math.max(...plain.flat().map(Math.abs));
    const found = await vertices(quantized);
    expect(found.length).toBe(plain.length);
    // Twice: morph targets and joints add their own steps.
    for (const [time, positions] of plain.entries()) expect(farthest(positions, found[time] ?? [])).toBeLessThan(2 * extent * STEP);
    // With the vertices in another order, at least the box.
    const packed = await vertices(await encoded(document, { compress: 'meshopt', quantize: true }));
    expect(packed.length).toBe(plain.length);
    for (const [time, positions] of packed.entries()) {
      expect(farthest(boxOf(positions), boxOf(plain[time] ?? []))).toBeLessThan(2 * extent * STEP);
    }
  });

  it('keeps children, cameras and turned nodes in their places', async () => {
    const { json, binary } = gltfOf(hills(6));
    const nodes = [
      { name: 'root', rotation: [0, 0.6, 0, 0.8], scale: [1, 2, 3], translation: [5, 6, 7], mesh: 0, children: [1, 2] },
      { name: 'child', translation: [1, 0, 0], mesh: 0 },
      { name: 'turned', matrix: [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 3, 2, 1, 1], mesh: 0 },
    ];
    using document = await openDocument(glb({ json: { ...json, nodes }, binary }));
    const [plain = []] = await vertices(await encoded(document, { compress: 'none' }));
    const bytes = await encoded(document, { compress: 'none', quantize: true });
    const [found = []] = await vertices(bytes);
    const sorted = (list: number[]): number[] => [...list].sort((a, b) => a - b);
    // The mesh of the root is in a node of its own now: the order of the nodes changed.
    expect(farthest(sorted(found), sorted(plain))).toBeLessThan(60 * STEP);
    expect((glbTree(bytes)['nodes'] as Array<{ name?: string }>).map(({ name }) => name)).toEqual(['root', 'child', 'turned', undefined]);
  });

  it('is smaller, and smallest with meshopt', async () => {
    using document = await openDocument(hillsFile());
    const size = async (options: WriteOptions): Promise<number> => (await encoded(document, options)).length;
    const [plain, quantized, packed, both] = [await size({}), await size({ quantize: true }), await size({ compress: 'meshopt' }), await size({ compress: 'meshopt', quantize: true })];
    expect(quantized).toBeLessThan(plain);
    expect(both).toBeLessThan(Math.min(quantized, packed));
  });
});

it('encodes in the worker and from the command line', async () => {
  const client = createWorkerClient();
  try {
    const document = await client.openDocument(hillsFile());
    const { bytes, report } = await document.write({ compress: 'draco' });
    expect(report.output.bytes).toBe(bytes.length);
    using again = await openDocument(bytes);
    expect(again.summary.compression).toBe('draco');
  } finally {
    client.terminate();
  }
  const directory = temporaryDirectory();
  const output = join(directory, 'box.glb');
  const draco = fixture('codecs/BoxDraco/BoxDraco.gltf');
  const kept = await decimesh(draco, '-o', output, '-r', '1');
  expect([kept.code, kept.stderr]).toEqual([0, '']);
  expect(JSON.stringify(glbTree(readFileSync(output)))).toContain('KHR_draco_mesh_compression');
  const { code } = await decimesh(draco, '-o', output, '-r', '1', '--compress', 'meshopt', '--quantize');
  expect(code).toBe(0);
  expect(JSON.stringify(glbTree(readFileSync(output)))).not.toContain('KHR_draco_mesh_compression');
  expect(await gltfErrors(readFileSync(output))).toEqual([]);
  const wrong = await decimesh(draco, '-o', join(directory, 'box.obj'), '-r', '1', '--compress', 'draco');
  expect([wrong.code, wrong.stderr]).toEqual([2, expect.stringContaining('--compress')]);
});

testWithAsset('gltf/lamborghini.glb', 'a model of many parts is encoded in every way', async (path) => {
  using document = await openDocument(new Uint8Array(readFileSync(path)));
  for (const options of [{ compress: 'meshopt' }, { compress: 'draco' }, { compress: 'meshopt', quantize: true }] as const) {
    using again = await openDocument(await encoded(document, options));
    expect(again.summary.triangles).toBe(document.summary.triangles);
    expect(again.summary.groups).toEqual(document.summary.groups);
  }
});

/** World coordinates of every vertex as three.js shows them, at rest and at half a second of every animation. */
async function vertices(bytes: Uint8Array<ArrayBuffer>): Promise<number[][]> {
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).setDRACOLoader(dracoWithoutWorkers);
  const { scene, animations } = await loader.parseAsync(bytes.buffer, '');
  const mixer = new AnimationMixer(scene);
  for (const clip of animations) mixer.clipAction(clip).play();
  return [0, 0.5].map((seconds) => {
    if (seconds > 0) mixer.setTime(seconds);
    return positionsOf(scene);
  });
}

/** In place of three's own, which wants workers of a browser: the same decoder, asked for what the file names. */
const dracoWithoutWorkers = {
  preload: () => dracoWithoutWorkers,
  async decodeDracoFile(data: ArrayBuffer, done: (geometry: BufferGeometry) => void, ids: Record<string, number>) {
    const draco = await newDracoDecoder();
    const [decoder, mesh] = [new draco.Decoder(), new draco.Mesh()];
    const bytes = new Int8Array(data);
    expect(decoder.DecodeArrayToMesh(bytes, bytes.length, mesh).ok()).toBe(true);
    const copy = (length: number, fill: (pointer: number) => boolean): ArrayBuffer => {
      const pointer = draco._malloc(length);
      expect(fill(pointer)).toBe(true);
      return draco.HEAPU8.slice(pointer, pointer + length).buffer as ArrayBuffer;
    };
    const geometry = new BufferGeometry();
    const faces = 12 * mesh.num_faces();
    geometry.setIndex(new BufferAttribute(new Uint32Array(copy(faces, (at) => decoder.GetTrianglesUInt32Array(mesh, faces, at))), 1));
    for (const [name, id] of Object.entries(ids)) {
      const attribute = decoder.GetAttributeByUniqueId(mesh, id);
      const components = attribute.num_components();
      const length = 4 * components * mesh.num_points();
      const values = copy(length, (at) => decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, draco.DT_FLOAT32, length, at));
      geometry.setAttribute(name, new BufferAttribute(new Float32Array(values), components));
    }
    done(geometry);
  },
} as unknown as DRACOLoader;

function positionsOf(scene: Group): number[] {
  const found: number[] = [];
  const point = new Vector3();
  scene.updateMatrixWorld(true);
  scene.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    (object as Partial<SkinnedMesh>).skeleton?.update();
    const { count } = object.geometry.getAttribute('position');
    for (let vertex = 0; vertex < count; vertex += 1) found.push(...object.getVertexPosition(vertex, point).applyMatrix4(object.matrixWorld));
  });
  return found;
}

const positionsIn = async (document: Document): Promise<Float32Array> => (await document.geometry()).wedgeSets[0]?.positions ?? new Float32Array();

/** How far the farthest point of `a` is from the nearest of `b`, along the axes. */
function beyond(a: ArrayLike<number>, b: ArrayLike<number>): number {
  let most = 0;
  for (let i = 0; i < a.length; i += 3) {
    let least = Infinity;
    for (let j = 0; j < b.length; j += 3) {
      least = Math.min(least, Math.max(...[0, 1, 2].map((axis) => Math.abs((a[i + axis] as number) - (b[j + axis] as number)))));
    }
    most = Math.max(most, least);
  }
  return most;
}

const everyThird = (values: ArrayLike<number>, axis: number): number[] => Array.from(values).filter((_, at) => at % 3 === axis);

const boxOf = (positions: number[]): number[] =>
  [0, 1, 2].flatMap((axis) => [Math.min(...everyThird(positions, axis)), Math.max(...everyThird(positions, axis))]);

/** The largest difference of two lists; infinite if they are not of one length. */
function farthest(a: ArrayLike<number>, b: ArrayLike<number>): number {
  if (a.length !== b.length) return Infinity;
  return Array.from(a).reduce((most, value, at) => Math.max(most, Math.abs(value - (b[at] as number))), 0);
}
