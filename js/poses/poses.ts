// Where the skin moves each vertex over the file's animations, in few numbers, for the cost of a simplification.
//
// In every pose the position of a skinned vertex is another function over the surface, and like a morph target it should
// be interpolated well by fewer triangles. Thirty-two poses are 96 numbers a vertex; what the quadric cannot see, the affine
// part of each, is taken off, and the rest is given in its principal components.

import { GltfData } from '../codecs/gltf_data.js';
import { objects, uint } from '../codecs/tree.js';
import type { EngineObject } from '../engine.js';
import { yieldToEvents } from '../platform.js';
import type { DocumentSummary } from '../types.js';
import type { Model } from '../wasm/decimesh.js';
import { largestEigen, longestAxis, solve } from './matrices.js';
import { Stage, type Joints } from './skeleton.js';

/**
 * Triples of components that are kept at most: each costs about as much as normals do. With one, what only some poses do
 * is lost: on CesiumMan and Fox at a quarter of the triangles 2.1 and 2.2 times the deviation at rest, with two 1.4 and 1.2.
 */
const MOST_TRIPLES = 3;

/** Components beyond this share of the motion are left out. */
const ENOUGH = 0.99;

/**
 * What the motion of all poses together weighs beside the shape at rest, as a multiple of the mean pose. Of 0, 0.5, 1, 2,
 * 3, 4 and 16 the largest deviation of CesiumMan in a pose was 1.64, 0.74, 0.74, 0.52, 0.48, 0.51 and 0.49 % of the
 * diagonal; more makes what is at rest worse.
 */
const WEIGHT = 3;

/** Motion below this share of the extent is none. */
const RIGID = 1e-4;

/** Vertices that the components are found from, at most. */
const MOST_SAMPLES = 20_000;

/** Vertices between two looks at other events. */
const AT_ONCE = 10_000;

/** Tells the engine the poses of every skinned wedge set. The document must be at full detail. */
export async function addPoses(model: EngineObject<Model>, summary: DocumentSummary, signal: AbortSignal | undefined): Promise<void> {
  const data = new GltfData(model.call((object) => object.write('glb')));
  const stage = new Stage(data);
  if (!stage.moves) return;
  const skinOf = new Map<unknown, number>();
  for (const { mesh, skin } of objects(data.tree, 'nodes')) if (uint(skin) !== undefined && !skinOf.has(mesh)) skinOf.set(mesh, skin as number);
  const meshOf = new Map(summary.groups.map(({ wedgeSet, mesh }) => [wedgeSet, mesh]));
  const skeletons = new Map<number, Joints[] | undefined>();
  for (const [set, { attributes }] of summary.wedgeSets.entries()) {
    const skin = skinOf.get(meshOf.get(set));
    const index = (name: string): number => attributes.findIndex((attribute) => attribute.name === name);
    const pairs = [0, 1].map((number) => [index(`JOINTS_${number}`), index(`WEIGHTS_${number}`)] as const).filter(([a, b]) => a >= 0 && b >= 0);
    if (skin === undefined || pairs.length === 0) continue;
    if (!skeletons.has(skin)) skeletons.set(skin, stage.jointsOf(skin));
    const [rest, ...moments] = skeletons.get(skin) ?? [];
    if (rest === undefined) continue;
    const values = (attribute: number): Float32Array => model.call((object) => object.levelAttribute(set, attribute));
    const skinned = new Skinned(
      model.call((object) => object.levelPositions(set)),
      pairs.map(([joints, weights]) => ({ joints: values(joints), weights: values(weights) })),
      moments,
    );
    const scale = longestAxis(rest[0] as ArrayLike<number>);
    for (const pose of await skinned.poses(scale, signal)) model.call((object) => object.addPose(set, pose));
  }
}

interface Influences {
  readonly joints: Float32Array;
  readonly weights: Float32Array;
}

/** Vertices with their influences, at some moments. */
class Skinned {
  readonly #positions: Float32Array;
  readonly #influences: readonly Influences[];
  readonly #moments: readonly Joints[];
  readonly #size: number;
  /** For each number of the poses, its affine function of the position: a constant and three factors. */
  #affine: Float64Array[] = [];

  constructor(positions: Float32Array, influences: readonly Influences[], moments: readonly Joints[]) {
    [this.#positions, this.#influences, this.#moments] = [positions, influences, moments];
    this.#size = 3 * moments.length;
  }

  /** Triples of principal components, each three numbers a vertex, in the mesh's own unit of which `scale` is one. */
  async poses(scale: number, signal: AbortSignal | undefined): Promise<Float32Array[]> {
    const count = this.#positions.length / 3;
    const step = Math.max(1, Math.floor(count / MOST_SAMPLES));
    const samples = Array.from({ length: Math.ceil(count / step) }, (_, sample) => sample * step);
    if (!(scale > 0) || samples.length < 8) return [];
    this.#fitAffine(samples);
    const size = this.#size;
    const covariance = new Float64Array(size * size);
    const row = new Float64Array(size);
    for (const vertex of samples) {
      this.#residual(vertex, row);
      for (let a = 0; a < size; a += 1) for (let b = 0; b <= a; b += 1) covariance[a * size + b] = (covariance[a * size + b] as number) + (row[a] as number) * (row[b] as number);
    }
    for (let a = 0; a < size; a += 1) for (let b = a + 1; b < size; b += 1) covariance[a * size + b] = covariance[b * size + a] as number;
    // What hangs on one joint moves as a whole, but for rounding.
    const trace = Array.from({ length: size }, (_, k) => covariance[k * size + k] as number).reduce((sum, value) => sum + value, 0);
    if (!(trace > RIGID ** 2 * this.#moments.length * scale ** 2 * this.#spread(samples))) return [];
    const { values, vectors } = largestEigen(covariance, size, 3 * MOST_TRIPLES);
    if (!Number.isFinite(trace)) return [];
    let wanted = 0;
    for (let sum = 0; wanted < Math.min(3 * MOST_TRIPLES, values.length) && sum < ENOUGH * trace; wanted += 1) sum += Math.max(0, values[wanted] as number);
    const found = Array.from({ length: Math.ceil(wanted / 3) }, () => new Float32Array(3 * count));
    const unit = Math.sqrt(WEIGHT / this.#moments.length) / scale;
    for (let vertex = 0; vertex < count; vertex += 1) {
      if (vertex % AT_ONCE === AT_ONCE - 1) {
        await yieldToEvents();
        signal?.throwIfAborted();
      }
      this.#residual(vertex, row);
      for (let component = 0; component < wanted; component += 1) {
        const vector = vectors[component] as Float64Array;
        let sum = 0;
        for (let k = 0; k < size; k += 1) sum += (vector[k] as number) * (row[k] as number);
        (found[Math.floor(component / 3)] as Float32Array)[3 * vertex + (component % 3)] = unit * sum;
      }
    }
    return found.every((pose) => pose.every(Number.isFinite)) ? found : [];
  }

  /** The sum of the squared distances of the samples from their centre. */
  #spread(samples: readonly number[]): number {
    let total = 0;
    for (let axis = 0; axis < 3; axis += 1) {
      const values = samples.map((vertex) => this.#positions[3 * vertex + axis] as number);
      const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
      total += values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
    }
    return total;
  }

  /** The positions of a vertex in all poses. */
  #skin(vertex: number, out: Float64Array): void {
    out.fill(0);
    const positions = this.#positions;
    const [x, y, z] = [positions[3 * vertex] as number, positions[3 * vertex + 1] as number, positions[3 * vertex + 2] as number];
    for (const { joints, weights } of this.#influences) {
      for (let at = 4 * vertex; at < 4 * vertex + 4; at += 1) {
        const weight = weights[at] as number;
        if (weight === 0) continue;
        for (let moment = 0; moment < this.#moments.length; moment += 1) {
          const m = this.#moments[moment]?.[joints[at] as number];
          if (m === undefined) continue;
          for (let axis = 0; axis < 3; axis += 1) {
            const k = 3 * moment + axis;
            const moved = (m[axis] as number) * x + (m[4 + axis] as number) * y + (m[8 + axis] as number) * z + (m[12 + axis] as number);
            out[k] = (out[k] as number) + weight * moved;
          }
        }
      }
    }
  }

  /** What no affine function of the position gives. */
  #residual(vertex: number, out: Float64Array): void {
    this.#skin(vertex, out);
    const positions = this.#positions;
    const [x, y, z] = [positions[3 * vertex] as number, positions[3 * vertex + 1] as number, positions[3 * vertex + 2] as number];
    for (let k = 0; k < this.#size; k += 1) {
      const f = this.#affine[k] as Float64Array;
      out[k] = (out[k] as number) - (f[0] as number) - (f[1] as number) * x - (f[2] as number) * y - (f[3] as number) * z;
    }
  }

  #fitAffine(samples: readonly number[]): void {
    const normal = new Float64Array(16);
    const columns = Array.from({ length: this.#size }, () => new Float64Array(4));
    const row = new Float64Array(this.#size);
    for (const vertex of samples) {
      const terms = [1, ...this.#positions.subarray(3 * vertex, 3 * vertex + 3)];
      this.#skin(vertex, row);
      for (let a = 0; a < 4; a += 1) {
        for (let b = 0; b < 4; b += 1) normal[4 * a + b] = (normal[4 * a + b] as number) + (terms[a] as number) * (terms[b] as number);
        for (let k = 0; k < this.#size; k += 1) {
          const column = columns[k] as Float64Array;
          column[a] = (column[a] as number) + (terms[a] as number) * (row[k] as number);
        }
      }
    }
    // A flat mesh leaves a direction open.
    for (let a = 0; a < 4; a += 1) normal[5 * a] = (normal[5 * a] as number) * (1 + 1e-9) + 1e-12;
    solve(normal, 4, columns);
    this.#affine = columns;
  }
}
