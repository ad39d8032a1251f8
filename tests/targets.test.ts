// Morph targets that are stored as the few elements that are not zero: the same in every encoding and level.
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument, type WriteOptions } from 'decimesh';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { gltfErrors } from './support/validate.ts';

/** Vertices of the hills that the target lifts, by 0.5. */
const LIFTED = [3, 40, 41, 42, 200];

/** Hills with a target of which only the lifted vertices are stored, and another of nothing but zeros. */
function liftedHills(): Uint8Array {
  const { json, binary } = gltfOf(hills(20));
  const count = json.accessors[1]?.count as number;
  const indices = Uint16Array.from([...LIFTED, 0]);
  const values = Float32Array.from(LIFTED.flatMap(() => [0, 0.5, 0]));
  const bytes = new Uint8Array(binary.length + indices.byteLength + values.byteLength);
  bytes.set(binary);
  bytes.set(new Uint8Array(indices.buffer), binary.length);
  bytes.set(new Uint8Array(values.buffer), binary.length + indices.byteLength);
  const views: unknown[] = json.bufferViews;
  views.push({ buffer: 0, byteOffset: binary.length, byteLength: 2 * LIFTED.length });
  views.push({ buffer: 0, byteOffset: binary.length + indices.byteLength, byteLength: values.byteLength });
  const sparse = { count: LIFTED.length, indices: { bufferView: views.length - 2, componentType: 5123 }, values: { bufferView: views.length - 1 } };
  const accessors: unknown[] = json.accessors;
  accessors.push({ componentType: 5126, count, type: 'VEC3', min: [0, 0, 0], max: [0, 0.5, 0], sparse });
  accessors.push({ componentType: 5126, count, type: 'VEC3', min: [0, 0, 0], max: [0, 0, 0] });
  (json.buffers[0] as { byteLength: number }).byteLength = bytes.length;
  const primitive = json.meshes[0]?.primitives[0] as Record<string, unknown>;
  primitive['targets'] = [{ POSITION: accessors.length - 2 }, { POSITION: accessors.length - 1 }];
  return glb({ json, binary: bytes });
}

/** The vertices that are lifted, x and y and by how much, in the scene, sorted. */
async function liftedOf(bytes: Uint8Array): Promise<string[]> {
  const [node] = glbTree(bytes)['nodes'] as Array<{ scale?: number[]; translation?: number[] }>;
  const { scale: [scale = 1] = [], translation: [x = 0, y = 0] = [] } = node ?? {};
  using document = await openDocument(bytes);
  const { wedgeSets } = await document.geometry();
  return wedgeSets.flatMap(({ positions, attributes }) => {
    const lift = attributes['TARGET_0/POSITION']?.values ?? new Float32Array();
    return Array.from({ length: positions.length / 3 }, (_, vertex) => vertex)
      .filter((vertex) => Math.abs(lift[3 * vertex + 1] as number) > 1e-3)
      .map((vertex) => {
        const scaled = [positions[3 * vertex], positions[3 * vertex + 1], lift[3 * vertex + 1]].map((value) => scale * (value as number));
        return scaled.map((value, axis) => (value + ([x, y, 0][axis] as number)).toFixed(2)).join(' ');
      });
  }).sort();
}

const sparseCount = (bytes: Uint8Array): number => (glbTree(bytes)['accessors'] as object[]).filter((json) => 'sparse' in json).length;

beforeAll(() => init());

describe('a target of few elements', () => {
  it('stays one where nothing is encoded', async () => {
    using document = await openDocument(liftedHills());
    const { bytes } = await document.write();
    expect(await gltfErrors(bytes)).toEqual([]);
    expect(sparseCount(bytes)).toBe(1);
    expect(await liftedOf(bytes)).toEqual(await liftedOf(liftedHills()));
    expect((await liftedOf(bytes)).length).toBe(LIFTED.length);
  });

  it.each<WriteOptions>([{ compress: 'meshopt' }, { quantize: true }, { compress: 'meshopt', quantize: true }, { compress: 'draco' }, { format: 'gltf' }])('is the same with %o', async (options) => {
    using document = await openDocument(liftedHills());
    const written = await document.write(options);
    if (written.files.length === 0) {
      expect(await gltfErrors(written.bytes)).toEqual([]);
      expect(await liftedOf(written.bytes)).toEqual(await liftedOf(liftedHills()));
    } else {
      using again = await openDocument([{ name: 'a.gltf', bytes: written.bytes }, ...written.files]);
      expect(await liftedOf((await again.write()).bytes)).toEqual(await liftedOf(liftedHills()));
    }
    expect(written.report.warnings).toEqual([]);
  });

  it.each(['optimal', 'subset'] as const)('is part of every level of a chain, %s', async (placement) => {
    using document = await openDocument(liftedHills());
    await document.simplify({ placement });
    const { bytes } = await document.write({ lods: [1, 0.5, 0.25] });
    expect(await gltfErrors(bytes)).toEqual([]);
    const { meshes } = glbTree(bytes) as { meshes: Array<{ primitives: Array<{ targets: unknown[] }> }> };
    expect(meshes.map(({ primitives }) => primitives[0]?.targets.length)).toEqual([2, 2, 2]);
    using again = await openDocument(bytes);
    const { wedgeSets } = await again.geometry();
    expect(wedgeSets.length).toBe(3);
    for (const { attributes } of wedgeSets) expect(Math.max(...(attributes['TARGET_0/POSITION']?.values ?? []))).toBeGreaterThan(0.3);
  });

  it('is the same after chains are compressed', async () => {
    using document = await openDocument(liftedHills());
    await document.simplify({ placement: 'subset' });
    const plain = await document.write({ lods: [1, 0.5], compress: 'none' });
    for (const options of [{ compress: 'meshopt' }, { compress: 'draco' }, { compress: 'meshopt', quantize: true }] as const) {
      const { bytes } = await document.write({ lods: [1, 0.5], ...options });
      expect(await gltfErrors(bytes)).toEqual([]);
      expect(bytes.length).toBeLessThan(plain.bytes.length);
      using again = await openDocument(bytes);
      expect(again.summary.groups.length).toBe(2);
      const both = await liftedOf(plain.bytes);
      expect((await liftedOf(bytes)).length).toBe(both.length);
    }
  });
});
