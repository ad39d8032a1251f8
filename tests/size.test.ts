// The level whose output fits: found in three encodes where the bytes go with the triangles as encodings have it.
import { describe, expect, it } from 'vitest';
import { findSize } from '../dist/size.js';

const MOST = 100_000;
const LEAST = 12;

/** Looks for `limit` where `triangles` take `geometry(triangles)` bytes beside `rest`, and counts the encodes. */
async function search(limit: number, geometry: (triangles: number) => number, { rest = 0, first = MOST / 4 } = {}) {
  const tried: number[] = [];
  const found = await findSize(limit, { least: LEAST, most: MOST, first }, (wanted) => {
    tried.push(wanted);
    const bytes = Math.round(geometry(wanted));
    return { triangles: wanted, bytes: bytes + rest, geometry: bytes, output: wanted };
  });
  return { ...found, tried };
}

describe('the search for a size', () => {
  it.each([
    ['a line', (t: number) => 20 * t],
    ['a line that does not begin at 0', (t: number) => 20 * t + 30_000],
    ['a power', (t: number) => 30 * t ** 0.8],
    ['steps', (t: number) => 20 * (t - (t % 50)) + 400],
  ])('takes three encodes at most, with %s, where the first guess is wrong by half', async (_, geometry) => {
    for (const rest of [0, 400_000]) {
      for (const share of [0.1, 0.2, 0.5, 0.9]) {
        const limit = Math.round(rest + geometry(MOST) * share + geometry(LEAST) * (1 - share));
        for (const first of [0.5, 1, 1.5]) {
          const { bytes, tried } = await search(limit, geometry, { rest, first: first * share * MOST });
          expect(bytes).toBeLessThanOrEqual(limit);
          expect(bytes).toBeGreaterThan(0.97 * limit);
          expect(tried.length).toBeLessThanOrEqual(3);
        }
      }
    }
  });

  it('takes everything if that fits, and the smallest level if nothing does', async () => {
    const line = (t: number): number => 20 * t;
    expect((await search(1e9, line)).triangles).toBe(MOST);
    const { triangles, bytes, tried } = await search(50_000, line, { rest: 60_000 });
    expect([triangles, bytes]).toEqual([LEAST, 60_000 + 20 * LEAST]);
    expect(tried.length).toBe(2);
  });

  it('goes on until something fits, whatever the bytes do', async () => {
    // A cliff: more than half of the triangles take ten times as much.
    const cliff = (t: number): number => (t > MOST / 2 ? 200 * t : 20 * t);
    const { bytes, triangles } = await search(1_100_000, cliff, { first: MOST });
    expect(bytes).toBeLessThanOrEqual(1_100_000);
    expect(triangles).toBeLessThanOrEqual(MOST / 2);
    // Nothing but the smallest level fits, and no estimate says so.
    const all = await search(1000, (t) => (t <= LEAST ? 10 : 1_000_000 + t), { first: MOST });
    expect(all.triangles).toBe(LEAST);
    expect(all.tried.length).toBeLessThanOrEqual(9);
  });

  it('tries no level twice', async () => {
    for (let seed = 1; seed < 200; seed += 1) {
      const noise = (t: number): number => 20 * t * (1 + 0.2 * Math.sin(t * seed));
      const { tried, bytes } = await search(2_000_000 * ((seed % 20) / 20 + 0.03), noise, { first: (MOST * (seed % 7)) / 7 });
      expect(new Set(tried).size).toBe(tried.length);
      expect(bytes).toBeGreaterThan(0);
    }
  });
});
