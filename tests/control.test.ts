// Weights, locks, merging of parts and the limit of memory: on this thread, in the worker, on the command line.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument, simplify, simplifySequence, type Report, type SimplifiedMesh } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { glb, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';
import { thrown } from './support/thrown.ts';

const SIZE = 32;
const VERTICES = (SIZE + 1) ** 2;

beforeAll(() => init());

/** Weights for the half of the hills where x is above a half. */
const half = (weight: number): Float32Array =>
  Float32Array.from({ length: VERTICES }, (_, vertex) => (vertex % (SIZE + 1) > SIZE / 2 ? weight : 0));

/** How many vertices are in that half. */
function right({ positions }: { readonly positions: Float32Array }): number {
  return positions.filter((value, index) => index % 3 === 0 && value > 0.5).length;
}

describe('weights', () => {
  it('keep more vertices where they are large', async () => {
    const mesh = hills(SIZE);
    const kept = (weight: number): number => right(simplify(mesh, { ratio: 0.2, weights: half(weight) }));
    expect(kept(0)).toBe(right(simplify(mesh, { ratio: 0.2 })));
    expect(kept(50)).toBeGreaterThan(1.5 * kept(0));
    const weights = half(50);
    using sequence = simplifySequence(mesh, { weights });
    expect(right(sequence.level({ triangles: 400 }))).toBeGreaterThan(1.5 * kept(0));
    const client = createWorkerClient();
    try {
      expect(right(await client.simplify(mesh, { ratio: 0.2, weights }))).toBe(kept(50));
    } finally {
      client.terminate();
    }
    expect(weights).toEqual(half(50));
  });

  it('come from an attribute of a file', async () => {
    using document = await openDocument(glb(gltfOf(hills(SIZE))));
    const kept = async (options: object): Promise<number> => {
      await document.simplify({ ratio: 0.2, ...options });
      return right((await document.geometry()).wedgeSets[0] ?? { positions: new Float32Array() });
    };
    const plain = await kept({});
    expect(await kept({ weightAttribute: 'TEXCOORD_0', weightScale: 0 })).toBe(plain);
    expect(await kept({ weightAttribute: 'TEXCOORD_0.x', weightScale: 1e3 })).toBeGreaterThan(1.1 * plain);
    await expect(kept({ weightAttribute: '_WEIGHT' })).rejects.toMatchObject({
      code: 'invalid-argument', where: 'weightAttribute', message: "no vertex has '_WEIGHT'; there is NORMAL, TEXCOORD_0",
    });
    await expect(kept({ weightScale: 2 })).rejects.toMatchObject({ code: 'invalid-argument', where: 'weightScale' });
  });

  it('are refused by name', () => {
    const mesh = hills(SIZE);
    const wrong: ReadonlyArray<readonly [object, string, string]> = [
      [{ weights: new Float32Array(3) }, 'invalid-argument', 'weights'],
      [{ weights: Array.from({ length: VERTICES }, () => 1) }, 'invalid-argument', 'weights'],
      [{ weights: half(-1) }, 'invalid-argument', `weights[${SIZE / 2 + 1}]`],
      [{ weights: half(Infinity) }, 'not-finite', `weights[${SIZE / 2 + 1}]`],
      [{ locked: new Float32Array(VERTICES) }, 'invalid-argument', 'locked'],
      [{ locked: new Uint8Array(VERTICES - 1) }, 'invalid-argument', 'locked'],
    ];
    for (const [options, code, where] of wrong) {
      expect(thrown(() => simplify(mesh, { ratio: 0.5, ...options }))).toMatchObject({ code, where });
    }
  });
});

it('locked vertices stay where they are', () => {
  const mesh = hills(SIZE);
  const locked = Uint8Array.from({ length: VERTICES }, (_, vertex) => (vertex % 5 === 0 ? 1 : 0));
  const small: SimplifiedMesh = simplify(mesh, { triangles: 0, preset: 'best', locked });
  expect(small.stopReason).toBe('constraints');
  expect(small.blockers?.locked).toBeGreaterThan(0);
  const place = new Map([...small.vertexMap].map((vertex, index) => [vertex, small.positions.slice(3 * index, 3 * index + 3)]));
  for (let vertex = 0; vertex < VERTICES; vertex += 5) {
    expect(place.get(vertex)).toEqual(mesh.positions.slice(3 * vertex, 3 * vertex + 3));
  }
});

it('the command line takes weights from an attribute', async () => {
  const input = join(temporaryDirectory(), 'hills.glb');
  writeFileSync(input, glb(gltfOf(hills(SIZE))));
  const run = async (...args: string[]) => decimesh(input, '-r', '0.2', '--json', ...args);
  const weighted = await run('--weight-attribute', 'TEXCOORD_0.x', '--weight-scale', '1000');
  expect(weighted).toMatchObject({ code: 0, stderr: '' });
  expect((JSON.parse(weighted.stdout) as Report).stopReason).toBe('target');
  expect(await run('--weight-scale', '2')).toMatchObject({ code: 2, stderr: 'usage: --weight-scale: needs --weight-attribute beside it\n' });
  expect(await run('--weight-attribute', 'COLOR_0')).toMatchObject({ code: 3 });
});

it('parts that nearly touch merge within the distance, and memory has a limit', async () => {
  // A sheet of hills and its mirror image, a tenth of a square apart.
  const [left, right] = [hills(SIZE), hills(SIZE)];
  const mirror = 2 + 0.1 / SIZE;
  const positions = new Float32Array([...left.positions, ...right.positions.map((value, index) => (index % 3 === 0 ? mirror - value : value))]);
  const indices = new Uint32Array([...left.indices, ...right.indices.map((vertex) => vertex + VERTICES)]);
  /** Whether a triangle has vertices of both sheets. */
  const joined = ({ indices: of, vertexMap }: SimplifiedMesh): boolean => {
    for (let at = 0; at < of.length; at += 3) {
      const sides = [0, 1, 2].map((k) => (vertexMap[of[at + k] as number] as number) < VERTICES);
      if (sides.includes(true) && sides.includes(false)) return true;
    }
    return false;
  };
  expect(joined(simplify({ positions, indices }, { triangles: 60 }))).toBe(false);
  expect(joined(simplify({ positions, indices }, { triangles: 60, mergeDistance: 0.2 / SIZE }))).toBe(true);
  expect(joined(simplify({ positions, indices }, { triangles: 60, mergeDistance: '1%' }))).toBe(true);
  expect(thrown(() => simplify({ positions, indices }, { ratio: 0.5, mergeDistance: -1 }))).toMatchObject({ code: 'invalid-argument', where: 'mergeDistance' });

  expect(thrown(() => simplify({ positions, indices }, { ratio: 0.5, memoryLimit: 1e5 }))).toMatchObject({
    code: 'too-large', where: 'mesh', message: expect.stringMatching(/^simplifying 2178 vertices and 4096 triangles takes about 1 MB of memory; 0 MB are allowed$/),
  });
  expect(simplify({ positions, indices }, { ratio: 0.5, memoryLimit: 1e9 }).stopReason).toBe('target');
  using document = await openDocument(glb(gltfOf(hills(SIZE))));
  await expect(document.simplify({ ratio: 0.5, memoryLimit: 1000 })).rejects.toMatchObject({ code: 'too-large' });
  expect((await document.simplify({ ratio: 0.5, mergeDistance: '0.1%' })).stopReason).toBe('target');
});
