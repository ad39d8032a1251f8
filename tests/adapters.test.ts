// The adapters, with the libraries they are for.
import { NodeIO } from '@gltf-transform/core';
import { simplify as simplifyGltf, weld } from '@gltf-transform/functions';
import { BoxGeometry, BufferAttribute, BufferGeometry, InstancedBufferAttribute, InterleavedBuffer, InterleavedBufferAttribute, LOD, Mesh, MeshBasicMaterial, PerspectiveCamera, Scene, TorusKnotGeometry, Vector3 } from 'three';
import { beforeAll, describe, expect, it } from 'vitest';
import { init } from 'decimesh';
import { DecimeshSimplifier } from 'decimesh/gltf-transform';
import { createLOD, simplifyGeometry } from 'decimesh/three';
import { MeshoptSimplifier } from 'meshoptimizer';
import { assetPath, testWithAsset } from './support/assets.ts';
import { glb, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { thrown } from './support/thrown.ts';
import { gltfErrors } from './support/validate.ts';

const SIZE = 40;

describe('decimesh/gltf-transform', () => {
  it('simplifies a document in the place of meshoptimizer', async () => {
    const io = new NodeIO();
    const document = await io.readBinary(glb(gltfOf(hills(SIZE))));
    await document.transform(weld(), simplifyGltf({ simplifier: DecimeshSimplifier, ratio: 0.25, error: 1 }));
    const [primitive] = document.getRoot().listMeshes()[0]!.listPrimitives();
    const count = primitive!.getIndices()!.getCount() / 3;
    expect(count).toBeLessThanOrEqual((2 * SIZE * SIZE) / 4);
    expect(count).toBeGreaterThan((2 * SIZE * SIZE) / 4.2);
    // Every vertex is one of the original, with all that it has.
    const { positions, attributes } = hills(SIZE);
    const originals = new Map<string, string>();
    for (let vertex = 0; vertex < positions.length / 3; vertex += 1) {
      originals.set(positions.subarray(3 * vertex, 3 * vertex + 3).join(' '), attributes.uv!.subarray(2 * vertex, 2 * vertex + 2).join(' '));
    }
    const [position, uv] = ['POSITION', 'TEXCOORD_0'].map((name) => primitive!.getAttribute(name)!);
    for (let vertex = 0; vertex < position!.getCount(); vertex += 1) {
      expect(originals.get(position!.getElement(vertex, []).join(' '))).toBe(uv!.getElement(vertex, []).join(' '));
    }
    expect(await gltfErrors(await io.writeBinary(document))).toEqual([]);
  });

  it('stops at the error, which is a share of the largest extent, and locks borders', async () => {
    const { positions, indices } = hills(SIZE);
    await DecimeshSimplifier.ready;
    expect(DecimeshSimplifier.supported).toBe(true);
    expect(DecimeshSimplifier.getScale(positions, 3)).toBe(MeshoptSimplifier.getScale(positions, 3));
    const [left, error] = DecimeshSimplifier.simplify(indices, positions, 3, 0, 0.002);
    expect(error).toBeGreaterThan(0.001);
    expect(error).toBeLessThanOrEqual(0.002);
    expect(left.length).toBeLessThan(indices.length);
    const scaled = positions.map((value) => value * 1000);
    const [again, relative] = DecimeshSimplifier.simplify(indices, scaled, 3, 0, 0.002);
    expect(again.length / left.length).toBeCloseTo(1, 1);
    expect(relative).toBeCloseTo(error, 4);
    const [absolute] = DecimeshSimplifier.simplify(indices, scaled, 3, 0, 2, ['ErrorAbsolute']);
    expect(absolute.length).toBe(again.length);
    const border = (list: Uint32Array): number => [...new Set(list)].filter((vertex) => positions[3 * vertex] === 0).length;
    const [locked] = DecimeshSimplifier.simplify(indices, positions, 3, 600, 1, ['LockBorder']);
    expect(border(locked)).toBe(SIZE + 1);
    expect(border(DecimeshSimplifier.simplify(indices, positions, 3, 600, 1)[0])).toBeLessThan(SIZE / 2);
  });

  it('keeps the sides of a seam together and apart', async () => {
    await DecimeshSimplifier.ready;
    // A grid cut along its middle: there every vertex is there twice.
    const { positions, indices } = hills(SIZE);
    const side = SIZE + 1;
    const twice = new Float32Array(2 * positions.length);
    twice.set(positions);
    twice.set(positions, positions.length);
    const cut = indices.map((index, at) => {
      const triangle = at - (at % 3);
      const columns = [0, 1, 2].map((corner) => (indices[triangle + corner] as number) % side);
      return Math.min(...columns) >= SIZE / 2 ? index + side * side : index;
    });
    const [left] = DecimeshSimplifier.simplify(cut, twice, 3, 300, 1);
    const place = (vertex: number): string => twice.subarray(3 * vertex, 3 * vertex + 3).join(' ');
    const sides: Array<Set<string>> = [new Set(), new Set()];
    for (let at = 0; at < left.length; at += 3) {
      const corners = [...left.subarray(at, at + 3)];
      const second = corners.map((vertex) => vertex >= side * side);
      expect(new Set(second).size).toBe(1);
      for (const vertex of corners) {
        if (twice[3 * vertex] === 0.5) sides[Number(second[0])]!.add(place(vertex));
      }
    }
    expect(sides[0]!.size).toBeGreaterThan(1);
    expect(sides[0]).toEqual(sides[1]);
  });

  it('leaves vertices where they are that are locked', async () => {
    await DecimeshSimplifier.ready;
    const { positions, indices, attributes } = hills(SIZE);
    const lock = Uint8Array.from({ length: positions.length / 3 }, (_, vertex) => (vertex % 7 === 0 ? 1 : 2));
    const locked = lock.reduce((sum, value) => sum + (value & 1), 0);
    const kept = (vertexLock: Uint8Array | null): number => {
      const [left] = DecimeshSimplifier.simplifyWithAttributes(indices, positions, 3, attributes.uv!, 2, [1, 1], vertexLock, 300, 1);
      return [...new Set(left)].filter((vertex) => lock[vertex] === 1).length;
    };
    expect(kept(lock)).toBe(locked);
    expect(kept(lock.map((value) => value & 2))).toBe(kept(null));
    expect(kept(null)).toBeLessThan(locked / 2);
  });

  it('has the other calls with meshoptimizer’s results', async () => {
    await Promise.all([DecimeshSimplifier.ready, MeshoptSimplifier.ready]);
    const [ours, theirs] = [[7, 3, 7, 5, 0, 3], [7, 3, 7, 5, 0, 3]].map((list) => Uint32Array.from(list));
    expect(DecimeshSimplifier.compactMesh(ours!)).toEqual(MeshoptSimplifier.compactMesh(theirs!));
    expect(ours).toEqual(theirs);
    const { positions, indices, attributes } = hills(SIZE);
    const interleaved = new Float32Array((positions.length / 3) * 5);
    for (let vertex = 0; vertex < positions.length / 3; vertex += 1) {
      interleaved.set(positions.subarray(3 * vertex, 3 * vertex + 3), 5 * vertex);
    }
    const plain = DecimeshSimplifier.simplify(indices, positions, 3, 300, 1);
    expect(DecimeshSimplifier.simplify(indices, interleaved, 5, 300, 1)).toEqual(plain);
    const { uv } = attributes;
    expect(DecimeshSimplifier.simplifyWithAttributes(indices, positions, 3, uv!, 2, [1, 1], null, 300, 1)).toEqual(plain);
    const lock = new Uint8Array(positions.length / 3);
    expect(DecimeshSimplifier.simplifyWithAttributes(indices, positions, 3, uv!, 2, [1, 1], lock, 300, 1)).toEqual(plain);
    expect(thrown(() => DecimeshSimplifier.simplifyWithAttributes(indices, positions, 3, uv!, 2, [1], lock.subarray(1), 300, 1)))
      .toMatchObject({ code: 'invalid-argument', where: 'vertexLock' });
    expect(DecimeshSimplifier.simplifyPoints(positions, 3, 10)).toHaveLength(positions.length / 3);
    for (const call of [
      () => DecimeshSimplifier.simplify(indices, positions, 2, 300, 1),
      () => DecimeshSimplifier.simplify(indices, positions, 3, -1, 1),
      () => DecimeshSimplifier.simplify(indices, positions, 3, 300, NaN),
      () => DecimeshSimplifier.simplify(indices, positions, 3, 300, 1, ['LockAll' as 'LockBorder']),
    ]) expect(thrown(call)).toMatchObject({ code: 'invalid-argument' });
    expect(thrown(() => DecimeshSimplifier.simplify(Uint32Array.of(0, 1, 99999), positions, 3, 300, 1))).toMatchObject({ code: 'out-of-range' });
  });

  testWithAsset('gltf/CesiumMan.glb', 'simplifies a skinned figure', async () => {
    const document = await new NodeIO().read(assetPath('gltf/CesiumMan.glb'));
    await document.transform(weld(), simplifyGltf({ simplifier: DecimeshSimplifier, ratio: 0.3, error: 1 }));
    // The weights of the file itself do not add up to 1.
    const errors = await gltfErrors(await new NodeIO().writeBinary(document));
    expect(errors.filter((error) => !error.startsWith('ACCESSOR_WEIGHTS'))).toEqual([]);
    const count = document.getRoot().listMeshes()[0]!.listPrimitives()[0]!.getIndices()!.getCount() / 3;
    expect(count).toBeLessThanOrEqual(0.3 * 4672);
  });
});

/** What must hold for a geometry of three.js. */
function expectSound(geometry: BufferGeometry): void {
  const { count } = geometry.attributes['position']!;
  const index = geometry.index!;
  for (let at = 0; at < index.count; at += 1) expect(index.getX(at)).toBeLessThan(count);
  for (const attribute of Object.values(geometry.attributes)) {
    if (!(attribute instanceof InstancedBufferAttribute)) expect(attribute.count).toBe(count);
  }
  geometry.computeBoundingSphere();
  expect(geometry.boundingSphere!.radius).toBeGreaterThan(0);
}

describe('decimesh/three', () => {
  beforeAll(() => init());

  it('gives a geometry of the same kind with fewer triangles, and leaves the other', () => {
    const knot = new TorusKnotGeometry(1, 0.3, 200, 24);
    const before = knot.index!.count;
    const small = simplifyGeometry(knot, { ratio: 0.2 });
    expectSound(small);
    expect(small.index!.count).toBeLessThanOrEqual(0.2 * before);
    expect(Object.keys(small.attributes).sort()).toEqual(['normal', 'position', 'uv']);
    const normal = new Vector3();
    for (let at = 0; at < small.attributes['normal']!.count; at += 1) {
      expect(normal.fromBufferAttribute(small.attributes['normal']!, at).length()).toBeCloseTo(1, 5);
    }
    expect(knot.index!.count).toBe(before);
  });

  it('keeps groups, and their borders together', () => {
    const box = new BoxGeometry(1, 1, 1, 12, 12, 12);
    const small = simplifyGeometry(box, { ratio: 0.05 });
    expectSound(small);
    expect(small.groups.map(({ materialIndex }) => materialIndex)).toEqual([0, 1, 2, 3, 4, 5]);
    expect(small.groups.reduce((sum, { count }) => sum + count, 0)).toBe(small.index!.count);
    // Each face of the box is its own group: flat, and whole.
    const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
    for (const { start, count } of small.groups) {
      let area = 0;
      for (let at = start; at < start + count; at += 3) {
        [a, b, c].forEach((corner, k) => corner.fromBufferAttribute(small.attributes['position']!, small.index!.getX(at + k)));
        area += b.clone().sub(a).cross(c.clone().sub(a)).length() / 2;
      }
      expect(area).toBeCloseTo(1, 4);
    }
  });

  it('takes groups of one smooth surface apart and leaves no gap', () => {
    const { positions, indices } = hills(SIZE);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setIndex(new BufferAttribute(indices, 1));
    geometry.addGroup(0, indices.length / 2, 3);
    geometry.addGroup(indices.length / 2, indices.length / 2, 1);
    const small = simplifyGeometry(geometry, { ratio: 0.1 });
    expectSound(small);
    expect(small.groups.map(({ materialIndex }) => materialIndex)).toEqual([3, 1]);
    const middles = small.groups.map(({ start, count }) => {
      const places = new Set<string>();
      for (let at = start; at < start + count; at += 1) {
        const vertex = small.index!.getX(at);
        const position = small.attributes['position']!;
        if (Math.abs(position.getY(vertex) - 0.5) < 1e-3) places.add([position.getX(vertex), position.getY(vertex), position.getZ(vertex)].join(' '));
      }
      return places;
    });
    expect(middles[0]!.size).toBeGreaterThan(1);
    expect(middles[0]).toEqual(middles[1]);
  });

  it('takes interleaved, normalised and instanced attributes, and no index', () => {
    const { positions, indices, attributes } = hills(20);
    const count = indices.length;
    const data = new Float32Array(count * 5);
    const color = new BufferAttribute(new Uint8Array(3 * count), 3, true);
    const id = new BufferAttribute(new Uint16Array(count), 1);
    for (let at = 0; at < count; at += 1) {
      const vertex = indices[at] as number;
      data.set(positions.subarray(3 * vertex, 3 * vertex + 3), 5 * at);
      data.set(attributes.uv!.subarray(2 * vertex, 2 * vertex + 2), 5 * at + 3);
      color.setXYZ(at, positions[3 * vertex] as number, 0.5, 1);
      id.setX(at, 7);
    }
    const buffer = new InterleavedBuffer(data, 5);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new InterleavedBufferAttribute(buffer, 3, 0));
    geometry.setAttribute('uv', new InterleavedBufferAttribute(buffer, 2, 3));
    geometry.setAttribute('color', color);
    geometry.setAttribute('featureId', id);
    geometry.setAttribute('offset', new InstancedBufferAttribute(new Float32Array([1, 2, 3]), 3));
    const small = simplifyGeometry(geometry, { ratio: 0.25 });
    expectSound(small);
    expect(small.index!.count).toBeLessThanOrEqual(count / 4);
    expect(small.index!.count).toBeGreaterThan(count / 5);
    expect(small.attributes['color']).toMatchObject({ normalized: true, itemSize: 3, array: expect.any(Uint8Array) });
    expect(small.attributes['featureId']!.array).toEqual(new Uint16Array(small.attributes['position']!.count).fill(7));
    expect(small.attributes['offset']!.array).toEqual(new Float32Array([1, 2, 3]));
    const [position, uv, shade] = ['position', 'uv', 'color'].map((name) => small.attributes[name]!);
    for (let at = 0; at < position!.count; at += 1) {
      expect(Math.abs(uv!.getX(at) - position!.getX(at))).toBeLessThan(0.15);
      expect(Math.abs(shade!.getX(at) - position!.getX(at))).toBeLessThan(0.15);
    }
  });

  it.each([true, false])('moves morph targets along, relative: %s', (relative) => {
    const { positions, indices } = hills(20);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setIndex(new BufferAttribute(indices, 1));
    geometry.morphTargetsRelative = relative;
    // Everything twice as high up.
    const target = positions.map((value, at) => (at % 3 === 2 ? 1 : 0) + (relative ? 0 : value));
    geometry.morphAttributes.position = [new BufferAttribute(target, 3)];
    const small = simplifyGeometry(geometry, { ratio: 0.2 });
    const [moved] = small.morphAttributes.position!;
    expect(small.morphTargetsRelative).toBe(relative);
    expect(moved!.count).toBe(small.attributes['position']!.count);
    for (let at = 0; at < moved!.count; at += 1) {
      const base = relative ? 0 : small.attributes['position']!.getZ(at);
      expect(moved!.getZ(at) - base).toBeCloseTo(1, 5);
      expect(moved!.getX(at) - (relative ? 0 : small.attributes['position']!.getX(at))).toBeCloseTo(0, 5);
    }
  });

  it('makes a LOD whose levels are shown where their error is a pixel', () => {
    const mesh = new Mesh(new TorusKnotGeometry(1, 0.3, 300, 32), new MeshBasicMaterial());
    mesh.name = 'knot';
    mesh.position.set(3, 0, 0);
    mesh.scale.setScalar(2);
    const scene = new Scene().add(mesh);
    const options = { levels: [0.1, 1, 0.4], pixels: 2, fieldOfView: 60, viewportHeight: 800 };
    const lod = createLOD(mesh, options);
    expect(lod).toBeInstanceOf(LOD);
    expect(lod).toMatchObject({ name: 'knot', position: { x: 3 }, scale: { x: 2 } });
    expect(mesh.parent).toBe(scene);
    expect(mesh.position.x).toBe(3);
    const counts = lod.levels.map(({ object }) => (object as Mesh).geometry.index!.count / 3);
    expect(counts[0]).toBe(mesh.geometry.index!.count / 3);
    expect(counts).toHaveLength(3);
    expect(counts[1]).toBeLessThanOrEqual(0.4 * counts[0]!);
    expect(counts[2]).toBeLessThanOrEqual(0.1 * counts[0]!);
    const distances = lod.levels.map(({ distance }) => distance);
    expect(distances[0]).toBe(0);
    expect([...distances].sort((a, b) => a - b)).toEqual(distances);
    for (const { object } of lod.levels) expect((object as Mesh).material).toBe(mesh.material);
    // Twice the pixels, half the distance; twice the size, twice the distance.
    expect(createLOD(mesh, { ...options, pixels: 4 }).levels[2]!.distance).toBeCloseTo(distances[2]! / 2, 6);
    mesh.scale.setScalar(4);
    expect(createLOD(mesh, options).levels[2]!.distance).toBeCloseTo(distances[2]! * 2, 6);
    // three.js takes the level that the distance says.
    const camera = new PerspectiveCamera(60);
    for (const [level, distance] of distances.entries()) {
      camera.position.set(3, 0, distance * 1.001 + 1e-6);
      camera.updateMatrixWorld();
      lod.updateMatrixWorld();
      lod.update(camera);
      expect(lod.getCurrentLevel()).toBe(level);
    }
    expect(createLOD(mesh).levels.length).toBeGreaterThan(2);
    // What a simplification takes, a chain takes too.
    expect(createLOD(mesh, { attributeWeights: { normal: 0 }, mergeDistance: 0, memoryLimit: 1e9, lockBorder: true }).levels.length).toBeGreaterThan(2);
  });

  it('refuses what it cannot do', () => {
    expect(thrown(() => simplifyGeometry(new BufferGeometry(), { ratio: 0.5 }))).toMatchObject({ code: 'invalid-argument', where: 'geometry' });
    expect(thrown(() => simplifyGeometry(new BoxGeometry(), {}))).toMatchObject({ code: 'invalid-argument' });
    const mesh = new Mesh(new BoxGeometry());
    for (const options of [{ levels: 0 }, { levels: [2] }, { levels: [] }, { pixels: 0 }, { fieldOfView: 0 }, { hysteresis: 2 }, { ratio: 0.5 }]) {
      expect(thrown(() => createLOD(mesh, options as object))).toMatchObject({ code: 'invalid-argument' });
    }
  });
});
