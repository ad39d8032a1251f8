// Positions and attributes of what a split makes, predicted from what is around it; the same code writes and reads.

import { isDirection, type Description } from './description.js';
import { FloatModel } from './numbers.js';
import type { Coder } from './range_coder.js';
import { NONE, type SplitMesh, type WedgeSetState } from './state.js';

/** Models of positions and attributes; they go on learning from chunk to chunk. */
export class ValueCoder {
  readonly #positions: FloatModel;
  readonly #values: readonly (readonly FloatModel[])[];
  readonly #directions: readonly (readonly boolean[])[];
  readonly #prediction: number[] = [];

  constructor({ wedgeSets, positionGrid }: Description) {
    this.#positions = new FloatModel(positionGrid, 3);
    this.#values = wedgeSets.map((set) => set.attributes.map(({ grid, components }) => new FloatModel(grid, components)));
    this.#directions = wedgeSets.map((set) => set.attributes.map(isDirection));
  }

  /** The position of vertex `t`, new from `s`: near the mean of its neighbours. */
  codePosition(coder: Coder, mesh: SplitMesh, s: number, t: number): void {
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

function normalise(direction: number[]): void {
  const [x, y, z] = direction as [number, number, number];
  const length = Math.sqrt(x * x + y * y + z * z);
  for (let k = 0; k < 3 && length > 0; k += 1) direction[k] = (direction[k] as number) / length;
}
