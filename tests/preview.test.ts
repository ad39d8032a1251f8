// What the view decides without a graphics card: which edges are of which class, and which part of the canvas shows what.
import { describe, expect, it } from 'vitest';
import { classifyEdges } from '../www/preview/edge-classes.ts';
import { panesOf } from '../www/preview/panes.ts';

describe('classes of edges', () => {
  // Two triangles of a unit square: 0-1-2 and 0-2-3.
  const square = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0];

  it('finds borders around a sheet, and none where triangles share an edge', () => {
    const found = classifyEdges([{ positions: square, indices: [0, 1, 2, 0, 2, 3] }]);
    expect(found?.counts).toEqual({ border: 4, seam: 0, nonManifold: 0 });
    expect([...(found?.edges[0]?.border ?? [])]).toEqual([0, 1, 1, 2, 2, 3, 3, 0]);
  });

  it('tells a seam, where vertices differ at the same place, from a border', () => {
    const apart = [...square.slice(0, 9), ...square.slice(0, 3), ...square.slice(6, 12)];
    expect(classifyEdges([{ positions: apart, indices: null }])?.counts).toEqual({ border: 4, seam: 1, nonManifold: 0 });
    // The same with a vertex buffer for each, as primitives of one mesh have them; -0 is 0.
    const first = { positions: [-0, 0, 0, 1, 0, 0, 1, 1, 0], indices: [0, 1, 2] };
    const second = { positions: [0, 0, 0, 1, 1, 0, 0, 1, 0], indices: [0, 1, 2] };
    const found = classifyEdges([first, second]);
    expect(found?.counts).toEqual({ border: 4, seam: 1, nonManifold: 0 });
    expect(found?.edges.map(({ border, seam }) => [border.length, seam.length])).toEqual([[4, 2], [4, 0]]);
    // Primitives that share their vertices and differ in material.
    expect(classifyEdges([{ positions: square, indices: [0, 1, 2] }, { positions: square, indices: [0, 2, 3] }])?.counts.seam).toBe(1);
  });

  it('finds edges of three triangles, and passes over triangles without edges', () => {
    const fan = [0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, 0, 0];
    expect(classifyEdges([{ positions: fan, indices: [0, 1, 2, 0, 1, 3, 0, 1, 4] }])?.counts).toEqual({ border: 6, seam: 0, nonManifold: 1 });
    expect(classifyEdges([{ positions: fan, indices: [0, 0, 1, 2, 3, 2] }])?.counts).toEqual({ border: 0, seam: 0, nonManifold: 0 });
    expect(classifyEdges([])?.counts).toEqual({ border: 0, seam: 0, nonManifold: 0 });
  });
});

describe('panes', () => {
  const insets = { top: 0, right: 200, bottom: 0, left: 0 };
  const at = { layout: 'split', comparing: false, split: 0.25, width: 1000, insets } as const;

  it('divides what panels leave free, on one picture', () => {
    const whole = { left: 0, width: 1000 };
    expect(panesOf(at)).toEqual([
      { side: 'original', viewport: whole, visible: { left: 0, width: 200 } },
      { side: 'result', viewport: whole, visible: { left: 200, width: 800 } },
    ]);
    expect(panesOf({ ...at, split: 0 }).map(({ side }) => side)).toEqual(['result']);
    expect(panesOf({ ...at, comparing: true })).toEqual([{ side: 'original', viewport: whole, visible: whole }]);
    expect(panesOf({ ...at, layout: 'single' })).toEqual([{ side: 'result', viewport: whole, visible: whole }]);
  });

  it('puts two pictures of the same size side by side', () => {
    const panes = panesOf({ ...at, layout: 'beside' });
    expect(panes.map(({ side, viewport }) => [side, viewport])).toEqual([
      ['original', { left: 0, width: 400 }],
      ['result', { left: 400, width: 400 }],
    ]);
    expect(panesOf({ ...at, layout: 'beside', comparing: true }).map(({ side }) => side)).toEqual(['original', 'original']);
  });
});
