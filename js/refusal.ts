// Collapses that would break a limit of the measured deviation are refused where they would, and go on elsewhere.
//
// Which collapse is to blame for a distance is not known. So the places of the level that are too far away make the
// original's vertices around them dear, more so each time that it happens there again; the next run spends its triangles
// there. Locking them would be simpler: it leaves islands at full detail that cost more than they save.

import { yieldToEvents } from './platform.js';

/** A level's wedge set: its positions, and how far the surfaces are apart around each of its vertices. */
export interface MeasuredSet {
  readonly positions: Float32Array;
  readonly surroundings: Float32Array;
}

/** Triangles of a level in one of its wedge sets. */
export interface MeasuredGroup {
  readonly wedgeSet: number;
  readonly indices: Uint32Array;
}

/** Near the limit is not far from being above it, with a few triangles less elsewhere. */
const NEAR = 0.95;

/** What the costs around a place too far away are multiplied by: the square of how far, in these bounds; and around one that is near. */
const LEAST_FACTOR = 4;
const MOST_FACTOR = 16;
const NEAR_FACTOR = 2;

/** No collapse is dearer than this: where everything is, nothing is. */
const DEAREST = 1024;

/** A place that stays far is mended from farther around: by this much for each time that it was made dearer before. */
const FARTHER = 0.2;

/** Of a level's vertices, so many may be places too far away; a level with more of them is too coarse everywhere. */
const MOST_FAR = 0.04;

/** Places between two times that others get their turn. */
const PLACES_AT_ONCE = 256;

/** What has been refused so far, for each of the original's vertices. */
export class Refusal {
  readonly #grids: readonly PointGrid[];
  readonly #starts: readonly number[];
  readonly #factors: Float32Array;
  readonly #given: Float32Array | undefined;

  /**
   * `positions` are those of the original's wedge sets; `given` are weights that the runs have in any case. From another
   * refusal: a copy, which goes on from there without changing it.
   */
  constructor(positions: readonly Float32Array[] | Refusal, given?: Float32Array) {
    if (positions instanceof Refusal) {
      this.#grids = positions.#grids;
      this.#starts = positions.#starts;
      this.#factors = positions.#factors.slice();
      this.#given = positions.#given;
      return;
    }
    this.#grids = positions.map((points) => new PointGrid(points));
    let count = 0;
    this.#starts = positions.map((points) => (count += points.length / 3) - points.length / 3);
    this.#factors = new Float32Array(count).fill(1);
    this.#given = given;
  }

  /** Weights for the next run; a copy. */
  weights(): Float32Array {
    return this.#factors.map((factor, at) => factor * (1 + (this.#given?.[at] ?? 0)) - 1);
  }

  /**
   * Refuses what made `sets` and `groups`, a level, farther than `limit` from the original, unless that is in too many places.
   * Resolves to how many they were; rejects with the signal's reason, and then nothing more has been refused.
   */
  async refuse(sets: readonly MeasuredSet[], groups: readonly MeasuredGroup[], limit: number, signal?: AbortSignal): Promise<number> {
    const far = sets.reduce((all, { surroundings }) => surroundings.reduce((sum, distance) => sum + (distance > limit ? 1 : 0), all), 0);
    if (far > MOST_FAR * sets.reduce((sum, { surroundings }) => sum + surroundings.length, 0)) return far;
    // Of places whose surroundings overlap, the farthest counts, and what was before this level.
    const raises = new Float32Array(this.#factors.length).fill(1);
    let count = 0;
    for (const [set, { positions, surroundings }] of sets.entries()) {
      const isNear = (at: number): boolean => (surroundings[at] as number) > NEAR * limit;
      for (const [at, ring] of ringsOf(isNear, groups.filter(({ wedgeSet }) => wedgeSet === set))) {
        const distance = (surroundings[at] as number) / limit;
        const factor = distance > 1 ? Math.min(Math.max(distance * distance, LEAST_FACTOR), MOST_FACTOR) : NEAR_FACTOR;
        this.#raise(set, at, ring, positions, factor, raises);
        count += 1;
        if (count % PLACES_AT_ONCE !== 0) continue;
        await yieldToEvents();
        signal?.throwIfAborted();
      }
    }
    for (let vertex = 0; vertex < raises.length; vertex += 1) {
      if ((raises[vertex] as number) === 1) continue;
      this.#factors[vertex] = Math.min((this.#factors[vertex] as number) * (raises[vertex] as number), DEAREST);
    }
    return far;
  }

  /** The original's vertices that are nearer to the place than to its neighbours, or not much farther. */
  #raise(set: number, at: number, ring: ReadonlySet<number>, positions: Float32Array, factor: number, raises: Float32Array): void {
    const grid = this.#grids[set] as PointGrid;
    const start = this.#starts[set] as number;
    const place = positions.subarray(3 * at, 3 * at + 3);
    const neighbours = [...ring].map((vertex) => positions.subarray(3 * vertex, 3 * vertex + 3));
    // The tip of a fan has more neighbours than a call may have arguments.
    const longest = Math.sqrt(neighbours.reduce((most, neighbour) => Math.max(most, squaredDistance(place, neighbour)), 0));
    const around = (share: number, act: (vertex: number) => void): void =>
      grid.within(place, share * longest, (point, position) => {
        const own = squaredDistance(position, place);
        if (neighbours.every((neighbour) => own <= share * share * squaredDistance(position, neighbour))) act(start + point);
      });
    let before = 1;
    around(1, (vertex) => (before = Math.max(before, this.#factors[vertex] as number)));
    const times = Math.log(before) / Math.log(LEAST_FACTOR);
    around(1 + FARTHER * times, (vertex) => (raises[vertex] = Math.max(raises[vertex] as number, factor)));
  }
}

/** The neighbours of each vertex that is `wanted`. */
function ringsOf(wanted: (vertex: number) => boolean, groups: readonly MeasuredGroup[]): Map<number, Set<number>> {
  const rings = new Map<number, Set<number>>();
  for (const { indices } of groups) {
    for (let corner = 0; corner < indices.length; corner += 1) {
      const vertex = indices[corner] as number;
      if (!wanted(vertex)) continue;
      const first = corner - (corner % 3);
      const ring = rings.get(vertex) ?? new Set();
      rings.set(vertex, ring);
      for (let k = first; k < first + 3; k += 1) if (k !== corner) ring.add(indices[k] as number);
    }
  }
  return rings;
}

const squaredDistance = (a: Float32Array, b: Float32Array): number =>
  ((a[0] as number) - (b[0] as number)) ** 2 + ((a[1] as number) - (b[1] as number)) ** 2 + ((a[2] as number) - (b[2] as number)) ** 2;

/** Points to a cell of the grid, about; and most cells along an axis. */
const POINTS_PER_CELL = 4;
const MOST_CELLS = 128;

/** Points by cells of a uniform grid over their box. */
class PointGrid {
  readonly #points: Float32Array;
  readonly #low = [0, 0, 0];
  readonly #cells = [1, 1, 1];
  #size = 1;
  /** Where each cell's points begin in `#sorted`. */
  readonly #starts: Uint32Array;
  readonly #sorted: Uint32Array;

  constructor(points: Float32Array) {
    this.#points = points;
    const count = points.length / 3;
    const extent = [0, 1, 2].map((axis) => {
      let [low, high] = [Infinity, -Infinity];
      for (let at = axis; at < points.length; at += 3) [low, high] = [Math.min(low, points[at] as number), Math.max(high, points[at] as number)];
      this.#low[axis] = count === 0 ? 0 : low;
      return count === 0 ? 0 : high - low;
    });
    // Of a surface, not of a volume: as many cells along an axis as the square root.
    const along = Math.min(Math.max(Math.round(Math.sqrt(count / POINTS_PER_CELL)), 1), MOST_CELLS);
    this.#size = Math.max(...extent) / along || 1;
    for (const [axis, length] of extent.entries()) this.#cells[axis] = Math.floor(length / this.#size) + 1;
    const [, rows = 1, columns = 1] = this.#cells;
    this.#starts = new Uint32Array((this.#cells[0] as number) * rows * columns + 1);
    const cellOf = new Uint32Array(count);
    for (let point = 0; point < count; point += 1) {
      const [x, y, z] = [0, 1, 2].map((axis) => this.#cell(points[3 * point + axis] as number, axis)) as [number, number, number];
      const cell = (x * rows + y) * columns + z;
      cellOf[point] = cell;
      this.#starts[cell + 1] = (this.#starts[cell + 1] as number) + 1;
    }
    for (let cell = 1; cell < this.#starts.length; cell += 1) this.#starts[cell] = (this.#starts[cell] as number) + (this.#starts[cell - 1] as number);
    const ends = this.#starts.slice();
    this.#sorted = new Uint32Array(count);
    for (let point = 0; point < count; point += 1) {
      const cell = cellOf[point] as number;
      this.#sorted[ends[cell] as number] = point;
      ends[cell] = (ends[cell] as number) + 1;
    }
  }

  /** Calls `act` with each point at most `reach` from `place`. */
  within(place: Float32Array, reach: number, act: (point: number, position: Float32Array) => void): void {
    const [low, high] = [-reach, reach].map((by) => [0, 1, 2].map((axis) => this.#cell((place[axis] as number) + by, axis))) as [number[], number[]];
    const [, rows = 1, columns = 1] = this.#cells;
    for (let x = low[0] as number; x <= (high[0] as number); x += 1) {
      for (let y = low[1] as number; y <= (high[1] as number); y += 1) {
        const row = (x * rows + y) * columns;
        const end = this.#starts[row + (high[2] as number) + 1] as number;
        for (let at = this.#starts[row + (low[2] as number)] as number; at < end; at += 1) {
          const point = this.#sorted[at] as number;
          const position = this.#points.subarray(3 * point, 3 * point + 3);
          if (squaredDistance(position, place) <= reach * reach) act(point, position);
        }
      }
    }
  }

  #cell(coordinate: number, axis: number): number {
    return Math.min(Math.max(Math.floor((coordinate - (this.#low[axis] as number)) / this.#size), 0), (this.#cells[axis] as number) - 1);
  }
}
