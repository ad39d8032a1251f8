// Classes of edges that matter to a simplifier, found in the drawn triangles: borders, seams, non-manifold edges.
import type { EdgeCounts } from './protocol.ts';

/** Triangles of one geometry. `positions` may be shared by several; without `indices` every three vertices are one. */
export interface Triangles {
  readonly positions: ArrayLike<number>;
  readonly indices: ArrayLike<number> | null;
}

/** Pairs of vertices to draw lines between, for one of the geometries given. */
export interface ClassifiedEdges {
  readonly border: Uint32Array;
  readonly seam: Uint32Array;
  readonly nonManifold: Uint32Array;
}

/** Largest number of slots of a hash table: 2^26 slots are 256 MB, enough for 30 million edges. */
const SLOT_LIMIT = 2 ** 26;

/**
 * Classifies the edges of `parts`, the primitives of one mesh: where two of them meet is a seam and no border.
 *
 * Vertices at exactly the same position are one. Each edge is listed once, at the first triangle that has it; a
 * triangle with two corners in one place has no edges. Null when there are too many to be classified.
 */
export function classifyEdges(parts: readonly Triangles[]): { edges: ClassifiedEdges[]; counts: EdgeCounts } | null {
  const places = weld(parts);
  if (places === null) return null;
  const cornersOf = (part: Triangles): number => part.indices?.length ?? part.positions.length / 3;
  const corners = parts.reduce((sum, part) => sum + cornersOf(part), 0);
  const table = makeTable(corners);
  if (table === null) return null;

  // One record for each edge in place: its ends as vertices of the first triangle, how many triangles it has, and
  // whether another triangle has other vertices there.
  const low = new Uint32Array(corners);
  const high = new Uint32Array(corners);
  const firstA = new Uint32Array(corners);
  const firstB = new Uint32Array(corners);
  const owner = new Uint16Array(corners);
  const faces = new Uint8Array(corners);
  const split = new Uint8Array(corners);
  let count = 0;
  const mask = table.length - 1;

  parts.forEach((part, index) => {
    const placeOf = places[index];
    if (placeOf === undefined) return;
    const { indices } = part;
    const total = cornersOf(part);
    const addEdge = (a: number, b: number): void => {
      const placeA = placeOf[a] ?? 0;
      const placeB = placeOf[b] ?? 0;
      const from = Math.min(placeA, placeB);
      const to = Math.max(placeA, placeB);
      for (let slot = hash(from, to, 0) & mask; ; slot = (slot + 1) & mask) {
        const found = (table[slot] ?? 0) - 1;
        if (found < 0) {
          table[slot] = count + 1;
          low[count] = from;
          high[count] = to;
          firstA[count] = a;
          firstB[count] = b;
          owner[count] = index;
          faces[count] = 1;
          count += 1;
          return;
        }
        if (low[found] !== from || high[found] !== to) continue;
        faces[found] = Math.min((faces[found] ?? 0) + 1, 3);
        const same = owner[found] === index && ((firstA[found] === a && firstB[found] === b) || (firstA[found] === b && firstB[found] === a));
        if (!same) split[found] = 1;
        return;
      }
    };
    for (let corner = 0; corner + 2 < total; corner += 3) {
      const a = indices === null ? corner : (indices[corner] ?? 0);
      const b = indices === null ? corner + 1 : (indices[corner + 1] ?? 0);
      const c = indices === null ? corner + 2 : (indices[corner + 2] ?? 0);
      if (placeOf[a] === placeOf[b] || placeOf[b] === placeOf[c] || placeOf[c] === placeOf[a]) continue;
      addEdge(a, b);
      addEdge(b, c);
      addEdge(c, a);
    }
  });

  const counts = { border: 0, seam: 0, nonManifold: 0 };
  const lists = parts.map(() => ({ border: [] as number[], seam: [] as number[], nonManifold: [] as number[] }));
  for (let edge = 0; edge < count; edge += 1) {
    const kind = faces[edge] === 1 ? 'border' : faces[edge] === 3 ? 'nonManifold' : split[edge] === 1 ? 'seam' : null;
    if (kind === null) continue;
    counts[kind] += 1;
    lists[owner[edge] ?? 0]?.[kind].push(firstA[edge] ?? 0, firstB[edge] ?? 0);
  }
  const edges = lists.map(({ border, seam, nonManifold }) => ({
    border: Uint32Array.from(border),
    seam: Uint32Array.from(seam),
    nonManifold: Uint32Array.from(nonManifold),
  }));
  return { edges, counts };
}

/** For each part a number for each vertex: the same for all vertices of all parts at the same position. */
function weld(parts: readonly Triangles[]): Uint32Array[] | null {
  const vertices = parts.reduce((sum, part) => sum + part.positions.length / 3, 0);
  const table = makeTable(vertices);
  if (table === null) return null;
  const mask = table.length - 1;
  const coordinates = new Float32Array(vertices * 3);
  // The same numbers as bits, to be hashed.
  const bits = new Uint32Array(coordinates.buffer);
  // Parts that share their vertices are welded once.
  const done = new Map<ArrayLike<number>, Uint32Array>();
  let count = 0;
  return parts.map(({ positions }) => {
    const known = done.get(positions);
    if (known !== undefined) return known;
    const places = new Uint32Array(positions.length / 3);
    for (let vertex = 0; vertex < places.length; vertex += 1) {
      // Adding zero makes -0 and 0 the same.
      coordinates[3 * count] = (positions[3 * vertex] ?? 0) + 0;
      coordinates[3 * count + 1] = (positions[3 * vertex + 1] ?? 0) + 0;
      coordinates[3 * count + 2] = (positions[3 * vertex + 2] ?? 0) + 0;
      const x = bits[3 * count] ?? 0;
      const y = bits[3 * count + 1] ?? 0;
      const z = bits[3 * count + 2] ?? 0;
      let slot = hash(x, y, z) & mask;
      for (; ; slot = (slot + 1) & mask) {
        const found = (table[slot] ?? 0) - 1;
        if (found < 0) {
          table[slot] = count + 1;
          places[vertex] = count;
          count += 1;
          break;
        }
        if (bits[3 * found] === x && bits[3 * found + 1] === y && bits[3 * found + 2] === z) {
          places[vertex] = found;
          break;
        }
      }
    }
    done.set(positions, places);
    return places;
  });
}

/** An open-addressing table that stays half empty with `entries` in it; null when it would be too large. */
function makeTable(entries: number): Uint32Array | null {
  let slots = 16;
  while (slots < entries * 2) slots *= 2;
  return slots > SLOT_LIMIT ? null : new Uint32Array(slots);
}

/** Mixes three integers; odd multipliers and shifts as in MurmurHash3's finalizer (A. Appleby, public domain). */
function hash(x: number, y: number, z: number): number {
  let mixed = Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca77) ^ Math.imul(z, 0xc2b2ae3d);
  mixed = Math.imul(mixed ^ (mixed >>> 16), 0x85ebca6b);
  mixed = Math.imul(mixed ^ (mixed >>> 13), 0xc2b2ae35);
  return (mixed ^ (mixed >>> 16)) >>> 0;
}
