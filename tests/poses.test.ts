// Skins that move: what counts is not the pose at rest alone.
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument } from 'decimesh';
import type { AttributeWeights } from 'decimesh';
import { eigen, largestEigen, solve } from '../dist/poses/matrices.js';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { gltfErrors } from './support/validate.ts';

const SIDE = 24;

/**
 * A flat strip with a hinge in the middle, straight at rest: two joints, of which an animation turns the second by a right
 * angle. At rest any triangles will do; when it is bent the hinge shows.
 */
function hinge(animated: boolean): Uint8Array {
  const positions: number[] = [];
  const weights: number[] = [];
  for (let y = 0; y <= SIDE; y += 1) {
    for (let x = 0; x <= 4 * SIDE; x += 1) {
      positions.push(x / (4 * SIDE) - 0.5, y / (4 * SIDE), 0);
      // From one joint to the other over a tenth of the length.
      const second = Math.min(1, Math.max(0, (x / (4 * SIDE) - 0.5) * 10 + 0.5));
      weights.push(1 - second, second, 0, 0);
    }
  }
  const indices: number[] = [];
  const across = 4 * SIDE + 1;
  for (let y = 0; y < SIDE; y += 1) {
    for (let x = 0; x < 4 * SIDE; x += 1) {
      const a = y * across + x;
      indices.push(a, a + 1, a + across, a + across, a + 1, a + across + 1);
    }
  }
  const { json, binary } = gltfOf({ positions: Float32Array.from(positions), indices: Uint32Array.from(indices), attributes: {} });
  const half = Math.SQRT1_2;
  const columns = [
    { values: Uint8Array.from(weights, (_, at) => (at % 4 === 1 ? 1 : 0)), componentType: 5121, type: 'VEC4', size: 4, target: 34962 },
    { values: Float32Array.from(weights), componentType: 5126, type: 'VEC4', size: 4, target: 34962 },
    { values: Float32Array.from([0, 1]), componentType: 5126, type: 'SCALAR', size: 1, bounds: true },
    { values: Float32Array.from([0, 0, 0, 1, 0, half, 0, half]), componentType: 5126, type: 'VEC4', size: 4 },
  ];
  const chunks: Uint8Array[] = [binary];
  let length = binary.length;
  for (const { values, componentType, type, size, target, bounds } of columns) {
    json.bufferViews.push({ buffer: 0, byteOffset: length, byteLength: values.byteLength, ...(target ? { target } : {}) } as never);
    const count = values.length / size;
    json.accessors.push({ bufferView: json.bufferViews.length - 1, componentType, count, type, ...(bounds ? { min: [0], max: [1] } : {}) });
    chunks.push(new Uint8Array(values.buffer));
    length += values.byteLength;
  }
  const first = json.accessors.length - 4;
  Object.assign(json.meshes[0]?.primitives[0]?.attributes as object, { JOINTS_0: first, WEIGHTS_0: first + 1 });
  json.nodes.push({ name: 'root' } as never, { name: 'end' } as never);
  Object.assign(json.nodes[0] as object, { skin: 0 });
  Object.assign(json.nodes[1] as object, { children: [2] });
  Object.assign(json.scenes[0] as object, { nodes: [0, 1] });
  const animation = { samplers: [{ input: first + 2, output: first + 3 }], channels: [{ sampler: 0, target: { node: 2, path: 'rotation' } }] };
  Object.assign(json, { skins: [{ joints: [1, 2] }], ...(animated ? { animations: [animation] } : {}) });
  (json.buffers[0] as { byteLength: number }).byteLength = length;
  const bytes = new Uint8Array(length);
  for (const chunk of chunks.reverse()) bytes.set(chunk, (length -= chunk.length));
  return glb({ json, binary: bytes });
}

/** Vertices of a level of 40 triangles inside of the hinge, where the weights change. */
async function inHinge(animated: boolean, attributeWeights: AttributeWeights = {}): Promise<number> {
  using document = await openDocument(hinge(animated));
  await document.simplify({ triangles: 40, attributeWeights });
  const { bytes } = await document.write();
  expect(await gltfErrors(bytes)).toEqual([]);
  // Poses are nothing that is written.
  const [mesh] = glbTree(bytes)['meshes'] as Array<{ primitives: Array<{ attributes: object }> }>;
  expect(Object.keys(mesh?.primitives[0]?.attributes ?? {})).toEqual(['POSITION', 'JOINTS_0', 'WEIGHTS_0']);
  const [set] = (await document.geometry()).wedgeSets;
  return Array.from({ length: (set?.positions.length ?? 0) / 3 }, (_, vertex) => set?.positions[3 * vertex] as number).filter((x) => Math.abs(x) < 0.08).length;
}

beforeAll(() => init());

describe('poses', () => {
  it('keep the vertices of a hinge that an animation bends', async () => {
    const [still, moving] = [await inHinge(false), await inHinge(true)];
    expect(moving).toBeGreaterThan(2 * still + 4);
  });

  it('do not count where morphing weighs nothing, and count more where it weighs more', async () => {
    expect(await inHinge(true, { morph: 0 })).toBe(await inHinge(false));
    expect(await inHinge(true, { morph: 1 })).toBe(await inHinge(true));
    expect(await inHinge(true, { morph: 0.01 })).toBeLessThan(await inHinge(true));
  });

  it('leave runs, levels and chains as they are otherwise', async () => {
    using document = await openDocument(hinge(true));
    await document.simplify();
    expect((await document.level({ triangles: 500 })).triangles).toBeLessThanOrEqual(500);
    expect(await gltfErrors((await document.write({ lods: [1, 0.3, 0.1] })).bytes)).toEqual([]);
    const again = await document.simplify({ triangles: 100, keepLevels: true });
    expect(again.triangles).toBeLessThanOrEqual(100);
    expect((await document.level({})).triangles).toBe(document.summary.triangles);
    using other = await openDocument(hinge(true));
    await other.simplify({ triangles: 100 });
    expect((await other.geometry()).wedgeSets[0]?.positions.length).toBeGreaterThan(0);
    const late = AbortSignal.abort(new Error('no'));
    await expect(other.simplify({ triangles: 100, signal: late })).rejects.toThrow('no');
  });
});

describe('the maths of poses', () => {
  it('finds the axes of a symmetric matrix', () => {
    const { values, vectors } = eigen(Float64Array.from([2, 1, 0, 1, 2, 0, 0, 0, 5]), 3);
    expect(values.map((value) => Math.round(1e9 * value) / 1e9)).toEqual([5, 3, 1]);
    expect(Math.abs(vectors[1]?.[0] ?? 0)).toBeCloseTo(Math.SQRT1_2);
  });

  it('finds the largest of many axes', () => {
    const size = 40;
    const matrix = new Float64Array(size * size);
    for (let row = 0; row < size; row += 1) for (let column = 0; column < size; column += 1) matrix[row * size + column] = Math.exp(-Math.abs(row - column) / 8) / (1 + row + column);
    const [all, some] = [eigen(matrix, size), largestEigen(matrix, size, 4)];
    for (let k = 0; k < 4; k += 1) expect(some.values[k]).toBeCloseTo(all.values[k] as number, 6);
  });

  it('solves equations', () => {
    const column = Float64Array.from([3, 5]);
    solve(Float64Array.from([2, 1, 1, 3]), 2, [column]);
    expect([...column].map((value) => Math.round(1e9 * value) / 1e9)).toEqual([0.8, 1.4]);
  });
});
