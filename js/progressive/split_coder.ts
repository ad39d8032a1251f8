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
import type { Description } from './description.js';
import { IntegerModel } from './numbers.js';
import { newModels, type Coder } from './range_coder.js';
import { ArcCoder, codeIndex, type Gap } from './split_arcs.js';
import type { SplitEffect, SplitPlan } from './split_plan.js';
import { NONE, Ring, type SplitMesh } from './state.js';
import { ValueCoder } from './value_coder.js';

const DONE = { group: 0, wedges: [0, 0, 0] as [number, number, number] };

/** Models of everything in a split; they go on learning from chunk to chunk. */
export class SplitCoder {
  readonly #flags = newModels(8);
  readonly #integers = new IntegerModel();
  readonly #arcs = new ArcCoder(this.#integers);
  readonly #groupSets: readonly number[];
  /** Positions and attributes. */
  readonly values: ValueCoder;
  /** The triangles around the vertex that was split last, before that. */
  readonly ring = new Ring();

  constructor(description: Description) {
    this.values = new ValueCoder(description);
    this.#groupSets = description.groups.map(({ wedgeSet }) => wedgeSet);
  }

  /** Codes the split of vertex `s` and does it. */
  code(coder: Coder, mesh: SplitMesh, s: number, plan?: SplitPlan): SplitEffect {
    const { ring } = this;
    mesh.rebound.length = 0;
    ring.read(mesh, s);
    const moves = this.#arcs.codeArcs(coder, ring, plan);
    const t = mesh.addVertex(s);
    const gaps = this.#arcs.codeGaps(coder, ring, moves, s, t, plan);
    return this.#finish(coder, mesh, s, t, moves, gaps, plan);
  }

  /** Wedges and groups, then positions and attributes, all put into the mesh. */
  #finish(
    coder: Coder,
    mesh: SplitMesh,
    s: number,
    t: number,
    moves: readonly boolean[],
    gaps: readonly Gap[],
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
    this.values.codePosition(coder, mesh, s, t);
    for (let wedge = firstWedge; wedge < mesh.wedgeCount; wedge += 1) this.values.codeValues(coder, mesh, wedge);
    return { from: s, vertex: t, moved, movedTo, formerly, firstTriangle };
  }

  /** Whether everything is as it would be predicted. */
  #isRegular(mesh: SplitMesh, moves: readonly boolean[], gaps: readonly Gap[], plan: SplitPlan, stays: ReadonlySet<number>): boolean {
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
    { atT, atS, third, planned }: Gap,
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
    { planned }: Gap,
    split: Map<number, number>,
    t: number,
    plan: SplitPlan | undefined,
  ): { group: number; wedges: [number, number, number] } {
    const group = codeIndex(coder, this.#integers, this.#groupSets.length, planned?.group ?? 0, 'group');
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
    if (coder.bit(this.#flags, 6, number === undefined ? 1 : 0) === 0) return codeIndex(coder, this.#integers, mesh.wedgeCount, number ?? 0, 'wedge');
    const wantedParent = name === undefined || plan === undefined ? NONE : plan.parentOf(name);
    const root = coder.bit(this.#flags, 7, wantedParent === NONE ? 1 : 0) === 1;
    const parent = root ? NONE : codeIndex(coder, this.#integers, mesh.wedgeCount, wantedParent, 'wedge');
    const wedge = mesh.addWedge(root ? set : (mesh.setOf[parent] as number), parent, vertex);
    if (plan !== undefined && name !== undefined) plan.named(name, wedge);
    return wedge;
  }
}

/** The wedge at vertex `third` of the triangle of a corner. */
function thirdWedge(mesh: SplitMesh, corner: number, third: number): number {
  const next = mesh.nextWedge(corner);
  return mesh.vertexOf[next] === third ? next : mesh.previousWedge(corner);
}
