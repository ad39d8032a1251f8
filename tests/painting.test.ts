// What painting rests on, without a picture: finding places on a mesh, and going to and fro between states of paint.
import { describe, expect, it } from 'vitest';
import { DEFAULT_RUN, runKey } from '../www/choices.ts';
import { PaintHistory, changeBetween } from '../www/paint/history.ts';
import { LOCKING } from '../www/paint/mode.ts';
import { PaintSurface } from '../www/paint/surface.ts';
import type { Point } from '../www/paint/surface.ts';
import { simplifyOptions } from '../www/wishes.ts';
import { hills } from './support/meshes.ts';

describe('a surface', () => {
  const { positions, indices } = hills(30);
  const surface = new PaintSurface(positions, indices);
  const corners = Array.from({ length: indices.length / 3 }, (_, triangle) => 3 * triangle);

  it.each([[0.5, 0.5], [0.31, 0.717], [0.9, 0.12]])('is hit where a search of every triangle finds it, through %f, %f', (x, y) => {
    for (const direction of [[0, 0, -1], [0.2, -0.1, -2], [0, 0, 0.5], [1, 0.3, 0.01], [0, 1, 0]] as const) {
      const origin: Point = [x - 10 * direction[0], y - 10 * direction[1], -10 * direction[2]];
      // A triangle alone has a box of its own: nothing is passed over.
      const expected = Math.min(...corners.map((corner) => new PaintSurface(positions, indices.slice(corner, corner + 3)).hit(origin, direction)));
      if (direction[0] === 0 && direction[1] === 0) expect(expected).toBeLessThan(Infinity);
      expect(surface.hit(origin, direction)).toBe(expected);
    }
  });

  it('is not hit beyond a limit, behind the origin, or beside it', () => {
    const origin: Point = [0.4, 0.4, 10];
    const found = surface.hit(origin, [0, 0, -1]);
    expect(found).toBeCloseTo(10, 0);
    expect(surface.hit(origin, [0, 0, -1], found * 0.99)).toBe(Infinity);
    expect(surface.hit(origin, [0, 0, 1])).toBe(Infinity);
    expect(surface.hit([2, 0.4, 10], [0, 0, -1])).toBe(Infinity);
  });

  it('finds every vertex in a ball, and far from all of them', () => {
    const at = 3 * 700;
    const point: Point = [positions[at] ?? 0, positions[at + 1] ?? 0, positions[at + 2] ?? 0];
    const inBall = (vertex: number): boolean => Math.hypot(...[0, 1, 2].map((axis) => (positions[3 * vertex + axis] ?? 0) - (point[axis] ?? 0))) < 0.1;
    const visited: number[] = [];
    surface.near(point, 0.1, (vertex) => visited.push(vertex));
    const wanted = Array.from({ length: positions.length / 3 }, (_, vertex) => vertex).filter(inBall);
    expect(wanted.length).toBeGreaterThan(0);
    expect(visited.filter(inBall)).toEqual(wanted);
    expect(visited.length).toBeLessThan(positions.length / 3);
  });

  it('without triangles is never hit', () => {
    const empty = new PaintSurface(new Float32Array(), null);
    expect(empty.hit([0, 0, 1], [0, 0, -1])).toBe(Infinity);
    empty.near([0, 0, 0], 1, () => expect.unreachable());
    expect(new PaintSurface(Float32Array.of(0, 0, 0, 0, 0, 0, 0, 0, 0), null).hit([0, 0, 1], [0, 0, -1])).toBe(Infinity);
  });
});

describe('the history of paint', () => {
  it('goes from any state to any other, over strokes small and large and after a clear', () => {
    const history = new PaintHistory(100);
    const states = new Map<number, Uint8Array>([[0, new Uint8Array(100)]]);
    const paint = (from: number, change: (painted: Uint8Array) => void): number => {
      const before = history.at(from).slice();
      const after = before.slice();
      change(after);
      const stroke = changeBetween(before, after);
      if (stroke === null) throw new Error('nothing was painted');
      const number = history.add(from, stroke);
      states.set(number, after);
      return number;
    };
    const first = paint(0, (painted) => painted.fill(255, 3, 6));
    const second = paint(first, (painted) => painted.fill(100));
    const third = paint(second, (painted) => painted.fill(0, 50, 52));
    // Cleared, and painted again; and a stroke in the place of one that was undone.
    paint(0, (painted) => painted.fill(9, 90, 95));
    paint(first, (painted) => painted.fill(1, 0, 40));
    expect([first, second, third]).toEqual([1, 2, 3]);
    for (const from of states.keys()) {
      for (const [to, expected] of states) {
        history.at(from);
        expect(history.at(to)).toEqual(expected);
      }
    }
  });

  it('forgets strokes that nothing leads to any more, and goes between the others as before', () => {
    const history = new PaintHistory(10);
    const stroke = (value: number) => ({ indices: Uint32Array.of(value), values: Uint8Array.of(value) });
    const first = history.add(0, stroke(1));
    const second = history.add(first, stroke(2));
    const undone = history.add(second, stroke(3));
    const third = history.add(second, stroke(4));
    const other = history.add(0, stroke(5));
    expect(history.at(third)).toEqual(Uint8Array.of(0, 1, 2, 0, 4, 0, 0, 0, 0, 0));
    history.keep([0, third, other]);
    expect(history.size).toBe(4);
    expect(history.at(undone)).toEqual(new Uint8Array(10));
    expect(history.at(other)).toEqual(Uint8Array.of(0, 0, 0, 0, 0, 5, 0, 0, 0, 0));
    expect(history.at(first)).toEqual(Uint8Array.of(0, 1, 0, 0, 0, 0, 0, 0, 0, 0));
    expect(history.add(first, stroke(6))).toBe(other + 1);
  });

  it('says what was changed in the smaller form, and that nothing was', () => {
    const before = new Uint8Array(100);
    expect(changeBetween(before, before.slice())).toBeNull();
    const few = before.slice().fill(7, 10, 12);
    expect(changeBetween(before, few)).toEqual({ indices: Uint32Array.of(10, 11), values: Uint8Array.of(7, 7) });
    expect(changeBetween(few, before.slice().fill(3))?.indices).toBeNull();
  });
});

describe('what the package is told', () => {
  const summary = {
    groups: [{ mesh: 0, wedgeSet: 0 }, { mesh: 1, wedgeSet: 1 }],
    wedgeSets: [{ vertices: 2 }, { vertices: 3 }],
  } as unknown as Parameters<typeof simplifyOptions>[1];

  it('has weights for paint, locks for the strongest, and locks for parts that are kept', () => {
    const options = simplifyOptions({ ...DEFAULT_RUN, kept: [0], paint: 4 }, summary, Uint8Array.of(0, 10, LOCKING, 128, 0));
    expect(options.locked).toEqual(Uint8Array.of(1, 1, 1, 0, 0));
    expect(options.weights?.[4]).toBe(0);
    expect(options.weights?.[3]).toBeGreaterThan(options.weights?.[1] ?? Infinity);
    expect(simplifyOptions(DEFAULT_RUN, summary)).not.toHaveProperty('weights');
    expect(simplifyOptions({ ...DEFAULT_RUN, kept: [1] }, summary)).toMatchObject({ locked: Uint8Array.of(0, 0, 1, 1, 1) });
  });

  it('is another run for another state of paint', () => {
    expect(runKey({ ...DEFAULT_RUN, paint: 1 })).not.toBe(runKey(DEFAULT_RUN));
  });
});
