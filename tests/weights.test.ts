// What attributes weigh: the option in the package, for arrays and for documents, in Node against the real engine.
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument, simplify, type AttributeWeights, type MeshInput } from 'decimesh';
import { glb, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { thrown } from './support/thrown.ts';

beforeAll(() => init());

const SIZE = 40;

/** A flat plate, red where x is below the middle, blue behind it. */
function flag(): MeshInput {
  const { positions: heights, indices } = hills(SIZE);
  const positions = heights.map((value, at) => (at % 3 === 2 ? 0 : value));
  const middle = (Math.max(...positions) + Math.min(...positions)) / 2;
  const color = new Float32Array(positions.length);
  for (let at = 0; at < positions.length; at += 3) color[at + (positions[at]! < middle ? 0 : 2)] = 1;
  return { positions, indices, attributes: { color } };
}

/** How many vertices are neither red nor blue. */
const mixed = (color: ArrayLike<number>): number =>
  Array.from(color).filter((value, at) => at % 3 === 0 && value > 0.1 && value < 0.9).length;

describe('attributeWeights', () => {
  it('keep what positions do not show, and 0 leaves it out', () => {
    const kept = simplify(flag(), { triangles: 60 }).attributes!['color']!;
    const lost = simplify(flag(), { triangles: 60, attributeWeights: { color: 0 } }).attributes!['color']!;
    expect(mixed(kept)).toBeLessThan(0.25 * (kept.length / 3));
    expect(mixed(lost)).toBeGreaterThan(mixed(kept));
  });

  it('of 1 are the default', () => {
    const all = { normal: 1, uv: 1, color: 1, morph: 1 };
    expect(simplify(flag(), { triangles: 60, attributeWeights: all })).toEqual(simplify(flag(), { triangles: 60 }));
  });

  it('reach a document', async () => {
    using document = await openDocument(glb(gltfOf(hills(SIZE))));
    const level = await document.simplify({ ratio: 0.1, attributeWeights: { uv: 0.5 } });
    expect(level.stopReason).toBe('target');
  });

  it.each([
    [{ attributeWeights: 2 }, 'attributeWeights'],
    [{ attributeWeights: { uvs: 1 } }, 'uvs'],
    [{ attributeWeights: { uv: -1 } }, 'attributeWeights.uv'],
    [{ attributeWeights: { normal: Number.NaN } }, 'attributeWeights.normal'],
    [{ attributeWeights: { color: 1e39 } }, 'attributeWeights.color'],
    [{ attributeWeights: { morph: '1' } }, 'attributeWeights.morph'],
  ])('of %j are refused', (options, where) => {
    const error = thrown(() => simplify(flag(), { triangles: 60, ...(options as { attributeWeights: AttributeWeights }) }));
    expect(error).toMatchObject({ name: 'DecimeshError', code: 'invalid-argument', where });
  });
});
