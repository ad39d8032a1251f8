// One vertex split as bits, and its effect on the mesh; the same code writes and reads (see `Coder`).
//
//          b                     b
//        / | \                 / | \          The triangles around s are in two arcs: those that go to t and
//       /  |  \               / / \ \         those that stay at s. Where the arcs meet, at a and b, there is
//      <   s   >     →       < t---s >        a new triangle on both. On a border a new triangle may stand at the
//       \  |  /               \ \ / /         end of a fan; anything else is spelt out.
//        \ | /                 \ | /
//          a                     a
//
// Wedges follow from the neighbours: at s and t from the triangles beside a new one, and a wedge of s that has corners
// in the arc of t splits too. One bit says that all of this is so, which it nearly always is.

import { DecimeshError } from '../errors.js';
import { FloatModel, IntegerModel } from './numbers.js';
import { newModels, type Coder } from './range_coder.js';
import { NONE, Ring, type SplitMesh, type WedgeSetState } from './state.js';
import { isDirection, type Description } from './description.js';

/** A triangle that a split makes, as the writer knows it; wedges by the names that {@link SplitPlan} has for them. */
export interface PlannedTriangle {
  /** Vertex of the mesh beside s and t. */
  readonly third: number;
  /** Whether s, t, third is its direction, and not t, s, third. */
  readonly forward: boolean;
  readonly group: number;
  /** Names of the wedges at s, t and third. */
  readonly wedges: readonly [number, number, number];
  /** Called with the triangle's number once it has one, and the places of s, t and third in it. */
  made(triangle: number, places: readonly [number, number, number]): void;
}

/** What the writer knows of a split. */
export interface SplitPlan {
  /** The name of the wedge that a corner at s has afterwards, at t; undefined for a corner that stays. */
  moved(corner: number): number | undefined;
  readonly triangles: readonly PlannedTriangle[];
  /** The number of a wedge with this name; undefined before it has one. */
  numberOf(name: number): number | undefined;
  /** The wedge that a new one came from, {@link NONE} if nothing of its set is there yet. */
  parentOf(name: number): number;
  setOf(name: number): number;
  /** A wedge has got its number: its name, and its values are put into the mesh. */
  named(name: number, wedge: number): void;
  /** Puts the position of the new vertex into the mesh. */
  place(vertex: number): void;
}

/** What a split changed. */
export interface SplitEffect {
  readonly from: number;
  readonly vertex: number;
  /** Corners that went over, and their wedges afterwards. */
  readonly moved: readonly number[];
  readonly movedTo: readonly number[];
  /** The wedges that they had. */
  readonly formerly: readonly number[];
  readonly firstTriangle: number;
}

/** A place where arcs meet, or the end of a fan. */
interface Gap {
  readonly third: number;
  readonly forward: boolean;
  /** The triangle of t's arc and that of s's beside it, as places in the ring; −1 if there is none. */
  readonly atT: number;
  readonly atS: number;
}

const DONE = { group: 0, wedges: [0, 0, 0] as [number, number, number] };

/** Models of everything in a split; they go on learning from chunk to chunk. */
export class SplitCoder {
  readonly #moved = newModels(13 * 13 * 3 * 2);
  readonly #gaps = newModels(8);
  readonly #flags = newModels(32);
  readonly #integers = new IntegerModel();
  readonly #positions: FloatModel;
  readonly #values: readonly (readonly FloatModel[])[];
  readonly #directions: readonly (readonly boolean[])[];
  readonly #groupSets: readonly number[];
  /** The triangles around the vertex that was split last, before that. */
  readonly ring = new Ring();
  readonly #prediction: number[] = [];

  constructor({ wedgeSets, groups, positionGrid }: Description) {
    this.#positions = new FloatModel(positionGrid, 3);
    this.#values = wedgeSets.map((set) => set.attributes.map(({ grid, components }) => new FloatModel(grid, components)));
    this.#directions = wedgeSets.map((set) => set.attributes.map(isDirection));
    this.#groupSets = groups.map(({ wedgeSet }) => wedgeSet);
  }

  /** Codes the split of vertex `s` and does it. */
  code(coder: Coder, mesh: SplitMesh, s: number, plan?: SplitPlan): SplitEffect {
    const { ring } = this;
    mesh.rebound.length = 0;
    ring.read(mesh, s);
    const moves = this.#codeArcs(coder, ring, plan);
    const t = mesh.addVertex(s);
    const gaps = this.#codeGaps(coder, ring, moves, s, t, plan);
    return this.#finish(coder, mesh, s, t, moves, gaps, plan);
  }

  #codeArcs(coder: Coder, ring: Ring, plan: SplitPlan | undefined): boolean[] {
    const moves: boolean[] = [];
    const size = Math.min(ring.count, 12);
    let [turns, last] = [0, 0];
    for (let i = 0; i < ring.count; i += 1) {
      const context = ((size * 13 + Math.min(i, 12)) * 3 + turns) * 2 + last;
      const wanted = plan?.moved(ring.corners[i] as number) === undefined ? 0 : 1;
      const moved = coder.bit(this.#moved, context, wanted);
      if (i > 0 && moved !== last && turns < 2) turns += 1;
      last = moved;
      moves.push(moved === 1);
    }
    return moves;
  }

  #codeGaps(coder: Coder, ring: Ring, moves: readonly boolean[], s: number, t: number, plan?: SplitPlan): Array<Gap & { planned: PlannedTriangle | undefined }> {
    const left = plan === undefined ? [] : [...plan.triangles];
    const take = (third: number, forward: boolean): PlannedTriangle | undefined => {
      const at = left.findIndex((triangle) => triangle.third === third && triangle.forward === forward);
      return at < 0 ? undefined : left.splice(at, 1)[0];
    };
    const made: Array<Gap & { planned: PlannedTriangle | undefined }> = [];
    const offer = (context: number, third: number, forward: boolean, atT: number, atS: number): void => {
      if (third === s) return;
      const planned = take(third, forward);
      if (coder.bit(this.#gaps, context, planned === undefined ? 0 : 1) === 1) made.push({ third, forward, atT, atS, planned });
    };
    for (const [fan, start] of ring.fanStarts.entries()) {
      const end = ring.fanStarts[fan + 1] ?? ring.count;
      const closes = ring.fanCloses[fan] as boolean;
      if (!closes) {
        const moved = moves[start] as boolean;
        offer(moved ? 2 : 3, ring.next[start] as number, !moved, moved ? start : -1, moved ? -1 : start);
      }
      for (let i = start; i < end; i += 1) {
        const follower = i + 1 < end ? i + 1 : start;
        if (i + 1 === end && !closes) break;
        const moved = moves[i] as boolean;
        if (moved === moves[follower]) continue;
        offer(closes ? 0 : 1, ring.previous[i] as number, moved, moved ? i : follower, moved ? follower : i);
      }
      if (!closes) {
        const moved = moves[end - 1] as boolean;
        offer(moved ? 4 : 5, ring.previous[end - 1] as number, moved, moved ? end - 1 : -1, moved ? -1 : end - 1);
      }
    }
    // What is beside nothing.
    while (coder.bit(this.#gaps, 6, left.length === 0 ? 0 : 1) === 1) {
      const planned = left.shift();
      const third = this.#index(coder, t, planned?.third ?? 0, 'triangle');
      if (third === s) throw new DecimeshError('syntax', 'a triangle has a corner twice', `splits[${t}]`);
      const forward = coder.bit(this.#flags, 0, planned?.forward === true ? 1 : 0) === 1;
      made.push({ third, forward, atT: -1, atS: -1, planned });
      if (made.length > 1e6) throw new DecimeshError('too-large', 'a split makes more than a million triangles', `splits[${t}]`);
    }
    return made;
  }

  /** Wedges and groups, then positions and attributes, all put into the mesh. */
  #finish(
    coder: Coder,
    mesh: SplitMesh,
    s: number,
    t: number,
    moves: readonly boolean[],
    gaps: ReadonlyArray<Gap & { planned: PlannedTriangle | undefined }>,
    plan: SplitPlan | undefined,
  ): SplitEffect {
    const { ring } = this;
    const { corners } = mesh;
    const firstWedge = mesh.wedgeCount;
    // What becomes, at t, of each wedge of s that is in t's arc or beside it.
    const split = new Map<number, number>();
    const stays = new Set<number>();
    for (let i = 0; i < ring.count; i += 1) if (!moves[i]) stays.add(corners[ring.corners[i] as number] as number);
    const regular = coder.bit(this.#flags, 1, plan !== undefined && !this.#isRegular(mesh, moves, gaps, plan, stays) ? 1 : 0) === 0;
    const create = (parent: number, name: number | undefined, set: number): number => {
      const wedge = mesh.addWedge(set, parent, t);
      if (plan !== undefined && name !== undefined) plan.named(name, wedge);
      return wedge;
    };
    const atT = (w: number, name: number | undefined): number => {
      let result = split.get(w);
      if (result === undefined) {
        // A wedge without another corner may go over itself.
        const goes = !stays.has(w) && coder.bit(this.#flags, 2, name !== undefined && plan?.numberOf(name) === w ? 1 : 0) === 1;
        result = goes ? w : create(w, name, mesh.setOf[w] as number);
        split.set(w, result);
      }
      return result;
    };
    const moved: number[] = [];
    const movedTo: number[] = [];
    for (let i = 0; i < ring.count; i += 1) {
      if (!moves[i]) continue;
      const corner = ring.corners[i] as number;
      const w = corners[corner] as number;
      const name = plan?.moved(corner);
      moved.push(corner);
      movedTo.push(regular ? atT(w, name) : this.#wedge(coder, mesh, split.get(w) ?? NONE, mesh.setOf[w] as number, name, t, plan));
      if (!regular) split.set(w, movedTo.at(-1) as number);
    }
    const made: Array<{ group: number; wedges: [number, number, number] }> = [];
    for (const gap of gaps) made.push(regular ? this.#predicted(coder, mesh, gap, atT, plan) : this.#spelt(coder, mesh, gap, split, t, plan));

    // The corners anew, those that stay in their order.
    mesh.unlink(s);
    const formerly = moved.map((corner) => mesh.corners[corner] as number);
    for (const [index, corner] of moved.entries()) {
      mesh.corners[corner] = movedTo[index] as number;
      mesh.bind(movedTo[index] as number, t);
    }
    for (let i = ring.count - 1; i >= 0; i -= 1) mesh.link(ring.corners[i] as number, moves[i] ? t : s);
    const firstTriangle = mesh.triangleCount;
    for (const [index, { third, forward, planned }] of gaps.entries()) {
      const { group, wedges: [atS, atNew, atThird] } = made[index] ?? DONE;
      const triangle = forward
        ? mesh.addTriangle(group, [atS, atNew, atThird], [s, t, third])
        : mesh.addTriangle(group, [atNew, atS, atThird], [t, s, third]);
      planned?.made(triangle, forward ? [0, 1, 2] : [1, 0, 2]);
    }
    plan?.place(t);
    this.#codePosition(coder, mesh, s, t);
    for (let wedge = firstWedge; wedge < mesh.wedgeCount; wedge += 1) this.codeValues(coder, mesh, wedge);
    return { from: s, vertex: t, moved, movedTo, formerly, firstTriangle };
  }

  /** Whether everything is as it would be predicted. */
  #isRegular(mesh: SplitMesh, moves: readonly boolean[], gaps: ReadonlyArray<Gap & { planned: PlannedTriangle | undefined }>, plan: SplitPlan, stays: ReadonlySet<number>): boolean {
    const { ring } = this;
    const names = new Map<number, number>();
    // The same wedge twice would be two of the same name.
    const used = new Map<number, number>();
    const fits = (w: number, name: number): boolean => {
      const known = names.get(w);
      if (known !== undefined) return known === name;
      const number = plan.numberOf(name);
      if (number === undefined ? plan.parentOf(name) !== w || used.has(name) : number !== w || stays.has(w)) return false;
      names.set(w, name);
      used.set(name, w);
      return true;
    };
    for (let i = 0; i < ring.count; i += 1) {
      if (!moves[i]) continue;
      const corner = ring.corners[i] as number;
      if (!fits(mesh.corners[corner] as number, plan.moved(corner) as number)) return false;
    }
    return gaps.every(({ atT, atS, planned }) => {
      if (planned === undefined || (atT < 0 && atS < 0)) return false;
      const beside = [atS, atT].filter((place) => place >= 0).map((place) => ring.corners[place] as number);
      const [wedgeS, wedgeT, wedgeThird] = planned.wedges;
      const thirds = beside.map((corner) => thirdWedge(mesh, corner, planned.third));
      const groups = beside.map((corner) => mesh.groupOf[Math.floor(corner / 3)] as number);
      if (!groups.includes(planned.group) || !thirds.includes(plan.numberOf(wedgeThird) ?? NONE)) return false;
      const ownS = mesh.corners[beside[0] as number] as number;
      const ownT = mesh.corners[beside.at(-1) as number] as number;
      if (plan.numberOf(wedgeS) !== ownS || !fits(ownT, wedgeT)) return false;
      // A wedge that goes over is not at s any more.
      return names.get(ownS) !== wedgeS && this.#setsAgree(planned.group, [ownS, ownT, plan.numberOf(wedgeThird) as number], mesh);
    });
  }

  #setsAgree(group: number, wedges: readonly number[], mesh: SplitMesh): boolean {
    return wedges.every((wedge) => mesh.setOf[wedge] === this.#groupSets[group]);
  }

  #predicted(
    coder: Coder,
    mesh: SplitMesh,
    { atT, atS, third, planned }: Gap & { planned: PlannedTriangle | undefined },
    splitOf: (wedge: number, name: number | undefined) => number,
    plan: SplitPlan | undefined,
  ): { group: number; wedges: [number, number, number] } {
    const { ring } = this;
    if (atT < 0 && atS < 0) throw new DecimeshError('syntax', 'nothing tells the wedges of a triangle', 'splits');
    const besideS = ring.corners[atS >= 0 ? atS : atT] as number;
    const besideT = ring.corners[atT >= 0 ? atT : atS] as number;
    // Arcs have not moved yet: both corners are at s.
    const wedgeS = mesh.corners[besideS] as number;
    const wedgeT = splitOf(mesh.corners[besideT] as number, planned?.wedges[1]);
    const either = (context: number, first: number, second: number, wanted: number): number =>
      first === second || coder.bit(this.#flags, context, wanted === first ? 0 : 1) === 0 ? first : second;
    const groupOf = (corner: number): number => mesh.groupOf[Math.floor(corner / 3)] as number;
    const group = either(3, groupOf(besideS), groupOf(besideT), planned?.group ?? 0);
    const wantedThird = planned === undefined ? 0 : (plan?.numberOf(planned.wedges[2]) ?? 0);
    const wedgeThird = either(4, thirdWedge(mesh, besideS, third), thirdWedge(mesh, besideT, third), wantedThird);
    if (!this.#setsAgree(group, [wedgeS, wedgeT, wedgeThird], mesh) || wedgeS === wedgeT) throw new DecimeshError('syntax', 'a triangle has wedges of several sets', 'splits');
    return { group, wedges: [wedgeS, wedgeT, wedgeThird] };
  }

  #spelt(
    coder: Coder,
    mesh: SplitMesh,
    { planned }: Gap & { planned: PlannedTriangle | undefined },
    split: Map<number, number>,
    t: number,
    plan: SplitPlan | undefined,
  ): { group: number; wedges: [number, number, number] } {
    const group = this.#index(coder, this.#groupSets.length, planned?.group ?? 0, 'group');
    const set = this.#groupSets[group] as number;
    const names = planned?.wedges;
    const guess = split.size === 1 ? ([...split.values()][0] as number) : NONE;
    const wedges: [number, number, number] = [
      this.#wedge(coder, mesh, NONE, set, names?.[0], t, plan),
      this.#wedge(coder, mesh, guess, set, names?.[1], t, plan),
      this.#wedge(coder, mesh, NONE, set, names?.[2], t, plan),
    ];
    if (!this.#setsAgree(group, wedges, mesh) || new Set(wedges).size < 3) {
      throw new DecimeshError('syntax', 'a triangle has wedges that do not go together', `splits[${t}]`);
    }
    return { group, wedges };
  }

  /** A wedge spelt out: the one guessed, another one, or a new one with its parent. */
  #wedge(coder: Coder, mesh: SplitMesh, guess: number, set: number, name: number | undefined, vertex: number, plan?: SplitPlan): number {
    const number = name === undefined ? undefined : plan?.numberOf(name);
    if (guess !== NONE && coder.bit(this.#flags, 5, number === guess ? 1 : 0) === 1) return guess;
    if (coder.bit(this.#flags, 6, number === undefined ? 1 : 0) === 0) return this.#index(coder, mesh.wedgeCount, number ?? 0, 'wedge');
    const wantedParent = name === undefined || plan === undefined ? NONE : plan.parentOf(name);
    const root = coder.bit(this.#flags, 7, wantedParent === NONE ? 1 : 0) === 1;
    const parent = root ? NONE : this.#index(coder, mesh.wedgeCount, wantedParent, 'wedge');
    const wedge = mesh.addWedge(root ? set : (mesh.setOf[parent] as number), parent, vertex);
    if (plan !== undefined && name !== undefined) plan.named(name, wedge);
    return wedge;
  }

  /** A number below `count`, about which nothing is known. */
  #index(coder: Coder, count: number, value: number, what: string): number {
    const index = this.#integers.unsigned(coder, 0, value);
    if (index >= count) throw new DecimeshError('out-of-range', `there is no ${what} ${index}`, 'splits');
    return index;
  }

  #codePosition(coder: Coder, mesh: SplitMesh, s: number, t: number): void {
    const { positions, vertexOf } = mesh;
    const sum = this.#prediction;
    sum[0] = sum[1] = sum[2] = 0;
    const corners: number[] = [];
    const count = mesh.cornersAt(t, corners);
    for (let i = 0; i < count; i += 1) {
      const corner = corners[i] as number;
      for (const wedge of [mesh.nextWedge(corner), mesh.previousWedge(corner)]) {
        const at = 3 * (vertexOf[wedge] as number);
        for (let k = 0; k < 3; k += 1) sum[k] = (sum[k] as number) + (positions[at + k] as number);
      }
    }
    let scale = 0;
    for (let k = 0; k < 3; k += 1) {
      const from = positions[3 * s + k] as number;
      sum[k] = count === 0 ? from : (sum[k] as number) / (2 * count);
      scale = Math.max(scale, Math.abs((sum[k] as number) - from));
    }
    this.#positions.code(coder, positions, 3 * t, sum, scale);
  }

  /** The attributes of a wedge that is new, after its corners are there: all, or only directions or others. */
  codeValues(coder: Coder, mesh: SplitMesh, wedge: number, which?: 'directions' | 'others'): void {
    const set = mesh.setOf[wedge] as number;
    const state = mesh.sets[set] as WedgeSetState;
    if (state.components.length === 0) return;
    const corners: number[] = [];
    const around: number[] = [];
    const count = mesh.cornersAt(mesh.vertexOf[wedge] as number, corners);
    for (let i = 0; i < count; i += 1) {
      const corner = corners[i] as number;
      if (mesh.corners[corner] !== wedge) continue;
      // Its own values are not known yet, and those of wedges behind it neither.
      for (const other of [mesh.nextWedge(corner), mesh.previousWedge(corner)]) {
        if (other < wedge && mesh.setOf[other] === set) around.push(mesh.placeOf[other] as number);
      }
    }
    const parent = mesh.parentWedges[wedge] as number;
    const parentPlace = parent === NONE ? -1 : (mesh.placeOf[parent] as number);
    if (around.length === 0 && parentPlace >= 0) around.push(parentPlace);
    const place = mesh.placeOf[wedge] as number;
    const sum = this.#prediction;
    for (const [index, components] of state.components.entries()) {
      const directed = this.#directions[set]?.[index] === true;
      if (which !== undefined && directed !== (which === 'directions')) continue;
      const values = state.attributes[index] as Float32Array<ArrayBuffer>;
      for (let k = 0; k < components; k += 1) {
        sum[k] = 0;
        for (const other of around) sum[k] = (sum[k] as number) + (values[other * components + k] as number);
        sum[k] = (sum[k] as number) / Math.max(around.length, 1);
      }
      if (directed) normalise(sum);
      let scale = 0;
      for (let k = 0; k < components && parentPlace >= 0; k += 1) {
        scale = Math.max(scale, Math.abs((sum[k] as number) - (values[parentPlace * components + k] as number)));
      }
      ((this.#values[set] as readonly FloatModel[])[index] as FloatModel).code(coder, values, place * components, sum, scale);
    }
  }
}

/** The wedge at vertex `third` of the triangle of a corner. */
function thirdWedge(mesh: SplitMesh, corner: number, third: number): number {
  const next = mesh.nextWedge(corner);
  return mesh.vertexOf[next] === third ? next : mesh.previousWedge(corner);
}

function normalise(direction: number[]): void {
  const [x, y, z] = direction as [number, number, number];
  const length = Math.sqrt(x * x + y * y + z * z);
  for (let k = 0; k < 3 && length > 0; k += 1) direction[k] = (direction[k] as number) / length;
}
