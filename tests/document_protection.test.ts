// Weights and locks of a document's vertices, in Node against the real engine.
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { openDocument, type Document } from 'decimesh';
import { at } from '../scripts/project.mjs';

const open = (): Promise<Document> => openDocument(new Uint8Array(readFileSync(at('www', 'samples', 'flight-helmet.glb'))));

/** A number for each vertex of `document`: `value` in the wedge sets of mesh `mesh`, else 0. */
function marks<Marks extends Uint8Array | Float32Array>(document: Document, make: (length: number) => Marks, mesh: number, value: number): Marks {
  const { groups, wedgeSets } = document.summary;
  const all = make(wedgeSets.reduce((sum, { vertices }) => sum + vertices, 0));
  const sets = new Set(groups.filter((group) => group.mesh === mesh).map((group) => group.wedgeSet));
  let start = 0;
  for (const [set, { vertices }] of wedgeSets.entries()) {
    if (sets.has(set)) all.fill(value, start, start + vertices);
    start += vertices;
  }
  return all;
}

const trianglesOf = async (document: Document, mesh: number): Promise<number> =>
  (await document.geometry()).groups.filter((group) => group.mesh === mesh).reduce((sum, { indices }) => sum + indices.length / 3, 0);

describe('the protection of a document', () => {
  it('keeps a locked mesh whole while the others get coarser', async () => {
    using document = await open();
    const before = [await trianglesOf(document, 0), await trianglesOf(document, 1)] as const;
    await document.simplify({ ratio: 0.3, locked: marks(document, (length) => new Uint8Array(length), 1, 1) });
    expect(await trianglesOf(document, 1)).toBe(before[1]);
    expect(await trianglesOf(document, 0)).toBeLessThan(before[0] * 0.6);
    // Nothing of it is left for the next run.
    await document.simplify({ ratio: 0.3 });
    expect(await trianglesOf(document, 1)).toBeLessThan(before[1] * 0.9);
  });

  it('makes what is weighted go later', async () => {
    using document = await open();
    await document.simplify({ ratio: 0.1 });
    const even = await trianglesOf(document, 1);
    await document.simplify({ ratio: 0.1, weights: marks(document, (length) => new Float32Array(length), 1, 100) });
    expect(await trianglesOf(document, 1)).toBeGreaterThan(even * 1.5);
  });

  it('is refused where it does not fit', async () => {
    using document = await open();
    for (const [options, where] of [
      [{ locked: new Uint8Array(3) }, 'locked'],
      [{ weights: new Float32Array(3) }, 'weights'],
      [{ weights: [0] as unknown as Float32Array }, 'weights'],
    ] as const) {
      await expect(document.simplify({ ratio: 0.5, ...options })).rejects.toMatchObject({ code: 'invalid-argument', where });
    }
    const weights = marks(document, (length) => new Float32Array(length), 0, 1);
    await expect(document.simplify({ weights, weightAttribute: 'COLOR_0' })).rejects.toMatchObject({ where: 'weights' });
  });
});
