// The smooth way from one level to a finer one: Hoppe's geomorph (1996, section 3.2).

import type { LevelGeometry } from '../types.js';
import type { Description } from './description.js';
import { geometryOf, positionsOf, valuesOf, wedgesInUse, type View } from './levels.js';
import { NONE, type SplitMesh, type WedgeSetState } from './state.js';

/** Arrays at the beginning and at the end of the way, of the same vertices and triangles. */
export class Geomorph {
  /** The finer level. */
  readonly to: LevelGeometry;
  /** The same triangles with the positions and attributes of the coarser level. */
  readonly from: LevelGeometry;

  /** @internal Use `ProgressiveMesh.geomorph`. Of the coarser level there are so many vertices and wedges. */
  constructor(mesh: SplitMesh, description: Description, view: View, vertices: number, wedges: number) {
    const used = wedgesInUse(mesh, view);
    this.to = geometryOf(mesh, description, view, used);
    const vertexBefore = new Uint32Array(view.vertexOf.length);
    for (let wedge = 0; wedge < vertexBefore.length; wedge += 1) {
      vertexBefore[wedge] = ancestor(mesh.parentVertices, view.vertexOf[wedge] as number, vertices);
    }
    this.from = {
      groups: this.to.groups,
      wedgeSets: this.to.wedgeSets.map(({ attributes }, set) => {
        const now = used.wedges[set] as Uint32Array;
        const before = now.map((wedge) => ancestor(mesh.parentWedges, wedge, wedges));
        return {
          positions: positionsOf(mesh, now, vertexBefore),
          attributes: Object.fromEntries(
            Object.entries(attributes).map(([name, { components }], index) => [
              name,
              { components, values: valuesOf(mesh, mesh.sets[set] as WedgeSetState, index, before) },
            ]),
          ),
        };
      }),
    };
  }

  /** Positions of a wedge set at `share` of the way, 0 to 1, written into `target`. */
  positions(set: number, share: number, target: Float32Array): Float32Array {
    return between(this.from.wedgeSets[set]?.positions, this.to.wedgeSets[set]?.positions, share, target);
  }

  /** Values of an attribute of a wedge set likewise; directions are not of unit length on the way. */
  attribute(set: number, name: string, share: number, target: Float32Array): Float32Array {
    return between(this.from.wedgeSets[set]?.attributes[name]?.values, this.to.wedgeSets[set]?.attributes[name]?.values, share, target);
  }
}

function ancestor(parents: Uint32Array, start: number, count: number): number {
  let at = start;
  while (at >= count && parents[at] !== NONE) at = parents[at] as number;
  return at;
}

function between(from: Float32Array | undefined, to: Float32Array | undefined, share: number, target: Float32Array): Float32Array {
  if (from === undefined || to === undefined) return target;
  for (let at = 0; at < target.length; at += 1) {
    const start = from[at] as number;
    target[at] = share >= 1 ? (to[at] as number) : start + ((to[at] as number) - start) * share;
  }
  return target;
}
