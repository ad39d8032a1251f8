// Meshes made up for the tests, and what must hold for any mesh.
import { expect } from 'vitest';
import type { ArrayMesh } from './glb.ts';

/** A PNG of one brown pixel. */
export const ONE_PIXEL = Buffer.from(
  'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNoSHAAAAKEASFpy73iAAAAAElFTkSuQmCC',
  'base64',
);

/** An open grid of `size` × `size` squares with hills and fine bumps: 2 size² triangles, one normal and uv a vertex. */
export function hills(size: number): ArrayMesh {
  const side = size + 1;
  const positions = new Float32Array(3 * side * side);
  const uv = new Float32Array(2 * side * side);
  const normal = new Float32Array(3 * side * side);
  for (let row = 0; row < side; row += 1) {
    for (let column = 0; column < side; column += 1) {
      const vertex = row * side + column;
      const [x, y] = [column / size, row / size];
      const height = 0.1 * Math.sin(7 * x) * Math.cos(5 * y) + 0.004 * Math.sin(91 * x + 3) * Math.sin(83 * y);
      positions.set([x, y, height], 3 * vertex);
      uv.set([x, y], 2 * vertex);
      normal.set([0, 0, 1], 3 * vertex);
    }
  }
  const indices = new Uint32Array(6 * size * size);
  for (let row = 0; row < size; row += 1) {
    for (let column = 0; column < size; column += 1) {
      const corner = row * side + column;
      const square = [corner, corner + 1, corner + side, corner + 1, corner + side + 1, corner + side];
      indices.set(square, 6 * (row * size + column));
    }
  }
  return { positions, indices, attributes: { normal, uv } };
}

/** `mesh` as an OBJ file of positions and triangles. */
export function objOf({ positions, indices }: ArrayMesh): Uint8Array {
  const lines: string[] = [];
  for (let at = 0; at < positions.length; at += 3) lines.push(`v ${positions.subarray(at, at + 3).join(' ')}`);
  for (let at = 0; at < indices.length; at += 3) {
    lines.push(`f ${Array.from(indices.subarray(at, at + 3), (index) => index + 1).join(' ')}`);
  }
  return new TextEncoder().encode(`${lines.join('\n')}\n`);
}

/** `mesh` as PLY text with normals, texture coordinates and a colour from the position. */
export function plyOf({ positions, indices, attributes }: ArrayMesh): Uint8Array {
  const header = ['ply', 'format ascii 1.0', `element vertex ${positions.length / 3}`];
  for (const name of ['x', 'y', 'z', 'nx', 'ny', 'nz', 's', 't']) header.push(`property float ${name}`);
  for (const name of ['red', 'green', 'blue']) header.push(`property uchar ${name}`);
  header.push(`element face ${indices.length / 3}`, 'property list uchar int vertex_indices', 'end_header');
  const lines = Array.from({ length: positions.length / 3 }, (_, vertex) => {
    const at = positions.subarray(3 * vertex, 3 * vertex + 3);
    const color = [...at].map((c) => Math.round(255 * Math.min(Math.max(c, 0), 1)));
    const normal = attributes?.normal?.subarray(3 * vertex, 3 * vertex + 3) ?? [0, 0, 1];
    const uv = attributes?.uv?.subarray(2 * vertex, 2 * vertex + 2) ?? [0, 0];
    return [...at, ...normal, ...uv, ...color].join(' ');
  });
  for (let at = 0; at < indices.length; at += 3) lines.push(`3 ${indices.subarray(at, at + 3).join(' ')}`);
  return new TextEncoder().encode(`${[...header, ...lines].join('\n')}\n`);
}

/** Fails unless the indices are in range, every vertex is used, no triangle repeats a vertex, all numbers are finite. */
export function expectWellFormed({ positions, indices }: { positions: Float32Array; indices: Uint32Array }): void {
  const vertices = positions.length / 3;
  const used = new Set<number>();
  let degenerate = 0;
  for (let at = 0; at < indices.length; at += 3) {
    const [a, b, c] = indices.subarray(at, at + 3);
    if (a === b || b === c || c === a) degenerate += 1;
    for (const index of [a, b, c]) used.add(index as number);
  }
  expect({ remainder: indices.length % 3, degenerate }).toEqual({ remainder: 0, degenerate: 0 });
  expect(used.size).toBe(vertices);
  expect(Math.max(...used)).toBe(vertices - 1);
  expect(positions.every(Number.isFinite)).toBe(true);
}
