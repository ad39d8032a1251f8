// Chains of levels, targets in pixels and in bytes: all from one recorded history.
import { existsSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument, simplifySequence, type Report } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { testWithAsset } from './support/assets.ts';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';
import { thrown } from './support/thrown.ts';
import { gltfErrors } from './support/validate.ts';

const SIZE = 40;
const TRIANGLES = 2 * SIZE * SIZE;
const model = (): Uint8Array => glb(gltfOf(hills(SIZE)));

interface Tree {
  nodes: Array<{
    name?: string;
    mesh?: number;
    children?: number[];
    translation?: number[];
    extensions?: { MSFT_lod?: { ids: number[] } };
    extras?: { MSFT_screencoverage?: number[] };
  }>;
  meshes: Array<{ name?: string; primitives: Array<{ attributes: Record<string, number>; indices: number; material?: number }> }>;
  accessors: Array<{ count: number }>;
  animations?: Array<{ channels: Array<{ sampler: number; target: { node: number; path: string } }> }>;
  materials?: unknown[];
  images?: unknown[];
  skins?: unknown[];
  extensionsUsed?: string[];
}

const treeOf = (bytes: Uint8Array): Tree => glbTree(bytes) as unknown as Tree;

const trianglesOf = (tree: Tree, mesh: number): number =>
  (tree.meshes[mesh]?.primitives ?? []).reduce((sum, { indices }) => sum + (tree.accessors[indices]?.count ?? 0) / 3, 0);

beforeAll(() => init());

describe('a chain', () => {
  it('is one valid GLB whose nodes name the coarser levels, with falling coverages', async () => {
    const document = await openDocument(model());
    await document.simplify({});
    const { bytes, report } = await document.write({ lods: [0.5, 1, { triangles: 100 }, { error: '5%' }] });
    expect(await gltfErrors(bytes)).toEqual([]);
    const tree = treeOf(bytes);
    expect(tree.extensionsUsed).toContain('MSFT_lod');
    const [node] = tree.nodes;
    const ids = node?.extensions?.MSFT_lod?.ids ?? [];
    const counts = [0, ...ids].map((id) => trianglesOf(tree, tree.nodes[id]?.mesh as number));
    expect(counts).toEqual(report.lods?.map(({ triangles }) => triangles));
    expect(counts[0]).toBe(TRIANGLES);
    expect(counts[1]).toBeLessThanOrEqual(TRIANGLES / 2);
    expect(counts.length).toBe(4);
    expect([...counts].sort((a, b) => b - a)).toEqual(counts);
    const coverages = node?.extras?.MSFT_screencoverage ?? [];
    expect(coverages).toEqual(report.lods?.map(({ screenCoverage }) => screenCoverage));
    expect(coverages.at(-1)).toBe(0);
    for (const [index, coverage] of coverages.slice(0, -1).entries()) {
      expect(coverage).toBeGreaterThan(coverages[index + 1] as number);
      expect(coverage).toBeLessThanOrEqual(1);
    }
    // The first level is the selected one afterwards, and what the report counts.
    expect(report.output).toMatchObject({ triangles: TRIANGLES, bytes: bytes.byteLength });
    expect((await document.geometry()).groups[0]?.indices.length).toBe(3 * TRIANGLES);
    document.dispose();
  });

  it('switches where the error of the next level is so many pixels', async () => {
    const document = await openDocument(model());
    await document.simplify({});
    const coverage = async (lodSwitch: object): Promise<number> =>
      (await document.write({ lods: [1, 0.01], lodSwitch })).report.lods?.[0]?.screenCoverage as number;
    const error = (await document.level({ ratio: 0.01 })).estimatedError;
    const { diagonal } = document.summary;
    // The picture is this many model units high where the error is two of its 500 pixels.
    const height = (error * 500) / 2;
    const expected = (Math.PI * (diagonal / 2) ** 2) / (height * height * 1.5);
    expect(await coverage({ pixels: 2, viewportHeight: 500, aspectRatio: 1.5 })).toBeCloseTo(Math.min(1, expected), 9);
    expect(await coverage({ pixels: 0.01, viewportHeight: 500 })).toBeLessThan(await coverage({ pixels: 0.02, viewportHeight: 500 }));
    for (const lodSwitch of [{ pixels: 0 }, { viewportHeight: NaN }, { aspect: 1 }]) {
      await expect(document.write({ lods: [1, 0.1], lodSwitch })).rejects.toMatchObject({ code: 'invalid-argument' });
    }
    document.dispose();
  });

  it('stores vertices of original places once', async () => {
    const document = await openDocument(model());
    await document.simplify({ placement: 'subset' });
    const { bytes } = await document.write({ lods: [1, 0.5, 0.1] });
    expect(await gltfErrors(bytes)).toEqual([]);
    const tree = treeOf(bytes);
    const [first, ...others] = tree.meshes.map(({ primitives }) => primitives[0]);
    expect(others).toHaveLength(2);
    for (const primitive of others) expect(primitive?.attributes).toEqual(first?.attributes);
    // Their indices name the same triangles as in a file of their own.
    const alone = async (ratio: number): Promise<string[]> => {
      await document.level({ ratio });
      const { groups, wedgeSets } = await document.geometry();
      const { positions } = wedgeSets[0]!;
      return [...groups[0]!.indices].map((index) => positions.subarray(3 * index, 3 * index + 3).join(' '));
    };
    const scene = await new GLTFLoader().parseAsync(bytes.slice().buffer, '');
    for (const [mesh, ratio] of [[1, 0.5], [2, 0.1]] as const) {
      const loaded = (await scene.parser.getDependency('mesh', mesh)) as import('three').Mesh;
      const { position } = loaded.geometry.attributes;
      const corners = [...loaded.geometry.index!.array].map((index) =>
        [position!.getX(index), position!.getY(index), position!.getZ(index)].join(' '));
      expect(corners).toEqual(await alone(ratio));
    }
    document.dispose();
  });

  it('gives a mesh with children a node of its own, and animates every level', async () => {
    const { json, binary } = gltfOf(hills(SIZE));
    const times = new Float32Array([0, 1, 0, 0, 0, 1, 1, 1]);
    const all = new Uint8Array(binary.length + times.byteLength);
    all.set(binary);
    all.set(new Uint8Array(times.buffer), binary.length);
    const view = json.bufferViews.push({ buffer: 0, byteOffset: binary.length, byteLength: 8, target: 34962 }) - 1;
    json.bufferViews.push({ buffer: 0, byteOffset: binary.length + 8, byteLength: 24, target: 34962 });
    for (const each of json.bufferViews.slice(view)) delete (each as { target?: number }).target;
    json.accessors.push({ bufferView: view, componentType: 5126, count: 2, type: 'SCALAR', min: [0], max: [1] });
    json.accessors.push({ bufferView: view + 1, componentType: 5126, count: 2, type: 'VEC3' });
    json.buffers = [{ byteLength: all.length }];
    const accessor = json.accessors.length - 2;
    const tree = {
      ...json,
      nodes: [
        { mesh: 0, name: 'parent', children: [1], extras: { mine: true } },
        { mesh: 0, name: 'leaf', translation: [5, 0, 0] },
      ],
      animations: [
        {
          samplers: [{ input: accessor, output: accessor + 1 }],
          channels: [0, 1].map((node) => ({ sampler: 0, target: { node, path: 'translation' } })),
        },
      ],
    };
    const document = await openDocument(glb({ json: tree, binary: all }));
    await document.simplify({});
    const { bytes } = await document.write({ lods: [1, 0.2] });
    expect(await gltfErrors(bytes)).toEqual([]);
    const { nodes, animations, meshes } = treeOf(bytes);
    expect(meshes).toHaveLength(2);
    const [parent, leaf] = nodes;
    expect(parent).not.toHaveProperty('mesh');
    expect(parent).toMatchObject({ name: 'parent', extras: { mine: true } });
    const holder = nodes[parent?.children?.at(-1) as number];
    expect(holder).toMatchObject({ mesh: 0, extensions: { MSFT_lod: { ids: [expect.any(Number)] } } });
    expect(leaf).toMatchObject({ mesh: 0, translation: [5, 0, 0] });
    const coarse = leaf?.extensions?.MSFT_lod?.ids[0] as number;
    expect(nodes[coarse]).toMatchObject({ mesh: 1, translation: [5, 0, 0], name: 'leaf_LOD1' });
    expect(animations?.[0]?.channels.map(({ target }) => target.node).sort()).toEqual([0, 1, coarse]);
    document.dispose();
  });

  it('passes over what is no animation', async () => {
    const { json, binary } = gltfOf(hills(8));
    const odd = { animations: [null, 3, { channels: 'none' }, { channels: [null, 7, { target: null }, { target: { node: 0, path: 'scale' } }] }], extensionsUsed: 5 };
    using document = await openDocument(glb({ json: { ...json, ...odd }, binary }));
    await document.simplify();
    const tree = treeOf((await document.write({ lods: [1, 0.5] })).bytes);
    expect([tree.extensionsUsed, tree.animations?.[3]?.channels.length]).toEqual([['MSFT_lod'], 5]);
  });

  it('refuses what makes no chain', async () => {
    const document = await openDocument(model());
    await expect(document.write({ lods: [1, 0.5] })).rejects.toMatchObject({ code: 'wrong-state' });
    await document.simplify({});
    for (const options of [{ lods: [1] }, { lods: [1, 2] }, { lods: [1, 0.5], format: 'obj' as const }, { lods: [1, 0.5], size: 1e6 }]) {
      await expect(document.write(options)).rejects.toMatchObject({ code: 'invalid-argument' });
    }
    // Levels that are the same are one; a chain of one is a plain file.
    const { bytes, report } = await document.write({ lods: [1, 1] });
    expect(report.lods).toHaveLength(1);
    expect(await gltfErrors(bytes)).toEqual([]);
    document.dispose();
  });

  testWithAsset('gltf/CesiumMan.glb', 'shares materials, skins, images and animations of a figure', async (path) => {
    const document = await openDocument(readFileSync(path));
    await document.simplify({});
    const plain = treeOf((await document.write({ format: 'glb' })).bytes);
    const { bytes } = await document.write({ lods: [1, 0.3] });
    expect(await gltfErrors(bytes)).toEqual([]);
    const tree = treeOf(bytes);
    for (const key of ['materials', 'images', 'skins'] as const) expect(tree[key]).toEqual(plain[key]);
    expect(bytes.byteLength).toBeLessThan(1.6 * (await document.write({ format: 'glb' })).bytes.byteLength);
    document.dispose();
  });
});

describe('pixels', () => {
  it('are an error at a distance', async () => {
    const document = await openDocument(model());
    await document.simplify({});
    const view = { distance: 10, fieldOfView: 60, viewportHeight: 1000 };
    const error = (2 * 2 * 10 * Math.tan(Math.PI / 6)) / 1000;
    expect(await document.level({ pixels: 2, view })).toEqual(await document.level({ error }));
    // Nearer, finer; and without a view the whole model fits the picture.
    const near = await document.level({ pixels: 2, view: { ...view, distance: 1 } });
    expect(near.triangles).toBeGreaterThan((await document.level({ pixels: 2, view })).triangles);
    const { diagonal } = document.summary;
    const fitting = diagonal / 2 / Math.sin(Math.PI / 8);
    expect(await document.level({ pixels: 1 })).toEqual(
      await document.level({ pixels: 1, view: { distance: fitting, fieldOfView: 45, viewportHeight: 1080 } }));
    for (const targets of [{ pixels: -1 }, { pixels: NaN }, { pixels: 1, view: { fieldOfView: 180 } }, { pixels: 1, view: { distance: 0 } }, { pixels: 1, view: { far: 1 } }]) {
      await expect(document.level(targets as object)).rejects.toMatchObject({ code: 'invalid-argument' });
    }
    document.dispose();
    const sequence = simplifySequence(hills(SIZE));
    expect(sequence.level({ pixels: 2, view }).indices.length).toBe(sequence.level({ error }).indices.length);
    expect(thrown(() => sequence.level({ pixels: -1 }))).toMatchObject({ code: 'invalid-argument', where: 'pixels' });
    sequence.dispose();
  });
});

describe('levels of a run to one target', () => {
  it('are made ready in steps, with progress, and an abort leaves the selected one', async () => {
    const document = await openDocument(glb(gltfOf(hills(200))));
    const last = await document.simplify({ ratio: 0.1 });
    const controller = new AbortController();
    controller.abort(new Error('enough'));
    await expect(document.level({ ratio: 0.5 }, { signal: controller.signal })).rejects.toThrow('enough');
    expect((await document.geometry()).groups[0]?.indices.length).toBe(3 * last.triangles);
    const fractions: number[] = [];
    const { triangles } = await document.level({ ratio: 0.5 }, { onProgress: (fraction) => fractions.push(fraction) });
    expect(triangles).toBeLessThanOrEqual(40_000);
    expect(fractions.at(-1)).toBe(1);
    document.dispose();
  });
});

describe('in the worker', () => {
  it('chains, sizes and pixels are what they are without', async () => {
    const client = createWorkerClient();
    const [there, here] = await Promise.all([client.openDocument(model()), openDocument(model())]);
    await Promise.all([there.simplify(), here.simplify()]);
    for (const options of [{ lods: [1, 0.3] }, { size: 20_000 }]) {
      const [a, b] = [await there.write(options), await here.write(options)];
      expect(a.bytes).toEqual(b.bytes);
      expect(a.report.lods).toEqual(b.report.lods);
    }
    expect(await there.level({ pixels: 3 })).toEqual(await here.level({ pixels: 3 }));
    await expect(there.level({ pixels: 3 }, { signal: AbortSignal.abort(new Error('enough')) })).rejects.toThrow('enough');
    client.terminate();
    here.dispose();
  });
});

describe('a size', () => {
  it.each(['glb', 'ply', 'obj', 'stl'] as const)('is met within three per cent below as %s', async (format) => {
    const document = await openDocument(glb(gltfOf(hills(120))));
    await document.simplify({});
    const full = (await document.write({ format })).bytes.byteLength;
    for (const share of [0.9, 0.5, 0.2, 0.05]) {
      const size = Math.floor(share * full);
      const { bytes, report } = await document.write({ format, size });
      expect(bytes.byteLength).toBeLessThanOrEqual(size);
      expect(bytes.byteLength).toBeGreaterThan(0.97 * size);
      expect(report).toMatchObject({ stopReason: 'target', output: { bytes: bytes.byteLength } });
      expect(report.warnings.filter(({ code }) => code !== 'not-carried')).toEqual([]);
      // What was written is selected.
      expect((await document.geometry()).groups[0]?.indices.length).toBe(3 * report.output.triangles);
    }
    document.dispose();
  });

  it('beyond the whole file is the whole file, and below the smallest level is that, with a warning', async () => {
    const document = await openDocument(model());
    await expect(document.write({ size: 1000 })).rejects.toMatchObject({ code: 'wrong-state' });
    await document.simplify({});
    expect((await document.write({ size: 1e9 })).report.output.triangles).toBe(TRIANGLES);
    const { bytes, report } = await document.write({ size: 10 });
    expect(bytes.byteLength).toBeGreaterThan(10);
    expect(report.warnings).toMatchObject([{ code: 'size-not-reached' }]);
    expect(report.stopReason).toBe('constraints');
    for (const size of [0, -1, NaN, '1k' as unknown as number]) {
      await expect(document.write({ size })).rejects.toMatchObject({ code: 'invalid-argument', where: 'size' });
    }
    document.dispose();
  });

  for (const name of ['gltf/CesiumMan.glb', 'gltf/Fox.glb', 'gltf/2CylinderEngine.glb', 'gltf/BrainStem.glb']) {
    testWithAsset(name, `is met for ${name}`, async (path) => {
      const document = await openDocument(readFileSync(path));
      await document.simplify({});
      const full = (await document.write({ format: 'glb' })).bytes.byteLength;
      const { triangles } = await document.level({ triangles: 0 });
      const least = (await document.write({ format: 'glb' })).bytes.byteLength;
      expect(triangles).toBeLessThan(document.summary.triangles / 4);
      const size = Math.floor(least + (full - least) / 3);
      const { bytes } = await document.write({ format: 'glb', size });
      expect(bytes.byteLength).toBeLessThanOrEqual(size);
      expect(bytes.byteLength).toBeGreaterThan(0.97 * size);
      document.dispose();
    });
  }
});

describe('the command line', () => {
  function workspace(): { at: (name: string) => string; input: string } {
    const directory = temporaryDirectory();
    const at = (name: string): string => join(directory, name);
    writeFileSync(at('in.glb'), model());
    return { at, input: at('in.glb') };
  }

  it('writes a chain into one GLB', async () => {
    const { at, input } = workspace();
    const result = await decimesh(input, '-o', at('out.glb'), '--lods', '1,0.25,0.05', '--json');
    expect(result).toMatchObject({ code: 0, stderr: '' });
    const { lods, output } = JSON.parse(result.stdout) as Report;
    expect(lods).toHaveLength(3);
    expect(output).toMatchObject({ triangles: TRIANGLES, path: at('out.glb') });
    const bytes = readFileSync(at('out.glb'));
    expect(await gltfErrors(bytes)).toEqual([]);
    expect(treeOf(bytes).nodes[0]?.extensions?.MSFT_lod?.ids).toHaveLength(2);
    const { scene } = await new GLTFLoader().parseAsync(bytes.slice().buffer, '');
    expect(scene.children).toHaveLength(1);
  });

  it('writes one file each into a directory', async () => {
    const { at, input } = workspace();
    const result = await decimesh(input, '-d', at('out'), '--lods', '0.5,0.1');
    expect(result).toMatchObject({ code: 0, stderr: '' });
    expect(result.stdout).toContain('in_LOD1.glb');
    expect(readdirSync(at('out')).sort()).toEqual(['in_LOD0.glb', 'in_LOD1.glb']);
    const counts = await Promise.all(['in_LOD0.glb', 'in_LOD1.glb'].map(async (name) => {
      const document = await openDocument(readFileSync(join(at('out'), name)));
      const { triangles } = document.summary;
      document.dispose();
      return triangles;
    }));
    expect(counts[0]).toBeLessThanOrEqual(TRIANGLES / 2);
    expect(counts[1]).toBeLessThanOrEqual(TRIANGLES / 10);
    expect(counts[1]).toBeGreaterThan(TRIANGLES / 12);
  });

  it('finds a size', async () => {
    const { at, input } = workspace();
    const result = await decimesh(input, '-o', at('out.glb'), '-s', '20k', '--measure', '--json');
    expect(result).toMatchObject({ code: 0, stderr: '' });
    const { output, deviation } = JSON.parse(result.stdout) as Report;
    expect(output.bytes).toBeLessThanOrEqual(20_000);
    expect(output.bytes).toBeGreaterThan(19_400);
    expect(readFileSync(at('out.glb')).byteLength).toBe(output.bytes);
    expect(deviation?.max).toBeGreaterThan(0);
    // Another target that is reached first ends it.
    const first = await decimesh(input, '-s', '1k', '-r', '0.5', '--json');
    expect((JSON.parse(first.stdout) as Report).output.triangles).toBeGreaterThan(0.49 * TRIANGLES);
  });

  it.each([
    [['-s', '0'], '--size'],
    [['-s', '5 parsecs'], '--size'],
    [['--lods', '1'], '--lods'],
    [['--lods', '1,2'], '--lods'],
    [['--lods', '1,,0.5'], '--lods'],
    [['--lods', '1,0.5', '-r', '0.5'], '--lods'],
    [['--lods', '1,0.5', '--measure'], '--measure'],
  ])('refuses %j', async (args, where) => {
    const { at, input } = workspace();
    const result = await decimesh(input, '-o', at('out.glb'), ...args);
    expect(result.code).toBe(2);
    expect(result.stderr).toContain(where);
    expect(existsSync(at('out.glb'))).toBe(false);
  });

  it('refuses a chain in a format that holds one mesh', async () => {
    const { at, input } = workspace();
    expect(await decimesh(input, '-o', at('out.obj'), '--lods', '1,0.5')).toMatchObject({ code: 2 });
  });
});
