// The skins of a glTF at moments of its animations: where every joint takes what hangs on it.

import type { GltfData } from '../codecs/gltf_data.js';
import { objectOr, objects, uint, type Tree } from '../codecs/tree.js';
import { compose, multiply, type Matrix, type Placement } from './matrices.js';

/** Matrices of every joint of a skin: world from the mesh in its bind pose. */
export type Joints = readonly Matrix[];

/** Moments that are looked at, over all animations. */
const MOMENTS = 32;

interface Channel {
  readonly node: number;
  readonly path: 'translation' | 'rotation' | 'scale';
  readonly times: Float32Array;
  readonly values: Float32Array;
  readonly width: number;
  readonly interpolation: string;
}

/** The nodes' places in their parents, and in the world as far as they were asked for. */
interface Scene {
  readonly places: ReadonlyArray<Placement | Matrix>;
  readonly world: Map<number, Matrix>;
}

/** Where the nodes of a file stand, at rest and at moments of its animations. */
export class Stage {
  readonly #data: GltfData;
  readonly #parents: ReadonlyArray<number | undefined>;
  /** At rest, and then at each moment. */
  readonly #scenes: readonly Scene[];

  constructor(data: GltfData) {
    const nodes = objects(data.tree, 'nodes');
    const places = nodes.map(placementOf);
    this.#data = data;
    this.#parents = parentsOf(nodes);
    this.#scenes = [places, ...momentsOf(data, places)].map((own) => ({ places: own, world: new Map<number, Matrix>() }));
  }

  /** Whether anything moves. */
  get moves(): boolean {
    return this.#scenes.length > 1;
  }

  /** The joints of a skin at rest, and then at each moment; undefined where they cannot be found. */
  jointsOf(skin: number): Joints[] | undefined {
    const { joints: list, inverseBindMatrices } = objects(this.#data.tree, 'skins')[skin] ?? {};
    const joints = (Array.isArray(list) ? list : []).map((joint) => uint(joint) ?? -1);
    if (joints.length === 0 || joints.some((joint) => this.#scenes[0]?.places[joint] === undefined)) return undefined;
    const layout = uint(inverseBindMatrices) === undefined ? undefined : this.#data.layout(inverseBindMatrices as number);
    if (layout !== undefined && (layout.componentType !== 5126 || layout.count < joints.length || layout.components !== 16)) return undefined;
    const inverse = layout && (this.#data.values(layout) as Float32Array);
    return this.#scenes.map((_, scene) =>
      joints.map((joint, at) => {
        const world = this.#worldOf(scene, joint);
        return inverse === undefined ? world : multiply(world, inverse.subarray(16 * at, 16 * at + 16));
      }),
    );
  }

  #worldOf(scene: number, node: number): Matrix {
    const { places, world } = this.#scenes[scene] as Scene;
    const path: number[] = [];
    // Up to what is known; a ring of nodes has no place in the world.
    for (let at: number | undefined = node; at !== undefined && !world.has(at) && path.length <= places.length; at = this.#parents[at]) path.push(at);
    for (const at of path.reverse()) {
      const place = places[at] as Placement | Matrix;
      const local = place instanceof Float64Array ? place : compose(place);
      const parent = world.get(this.#parents[at] ?? -1);
      world.set(at, parent === undefined ? local : multiply(parent, local));
    }
    return world.get(node) as Matrix;
  }
}

/** The nodes' places at each moment; none without an animation that moves nodes. */
function momentsOf(data: GltfData, places: ReadonlyArray<Placement | Matrix>): Array<Array<Placement | Matrix>> {
  const clips = objects(data.tree, 'animations').map((animation) => channelsOf(data, animation)).filter((channels) => channels.length > 0);
  if (clips.length === 0) return [];
  return Array.from({ length: MOMENTS }, (_, moment) => {
    const channels = clips[moment % clips.length] as Channel[];
    const share = (Math.floor(moment / clips.length) + 0.25) / Math.ceil(MOMENTS / clips.length);
    const end = channels.reduce((last, { times }) => Math.max(last, times.at(-1) as number), 0);
    const moved = [...places];
    for (const channel of channels) {
      const place = moved[channel.node];
      if (place === undefined || place instanceof Float64Array) continue;
      moved[channel.node] = { ...place, [channel.path]: valueAt(channel, share * end) };
    }
    return moved;
  });
}

function parentsOf(nodes: readonly Tree[]): Array<number | undefined> {
  const parents: Array<number | undefined> = nodes.map(() => undefined);
  for (const [index, { children }] of nodes.entries()) {
    for (const child of Array.isArray(children) ? children : []) if (uint(child) !== undefined) parents[child as number] ??= index;
  }
  return parents;
}

function placementOf({ matrix, translation, rotation, scale }: Tree): Placement | Matrix {
  const numbers = (value: unknown, otherwise: number[]): number[] => (Array.isArray(value) ? value.map(Number) : otherwise);
  if (Array.isArray(matrix)) return Float64Array.from(numbers(matrix, []));
  return { translation: numbers(translation, [0, 0, 0]), rotation: numbers(rotation, [0, 0, 0, 1]), scale: numbers(scale, [1, 1, 1]) };
}

function channelsOf(data: GltfData, animation: Tree): Channel[] {
  const samplers = objects(animation, 'samplers');
  return objects(animation, 'channels').flatMap((channel) => {
    const { node, path } = objectOr(channel['target']);
    const sampler = samplers[uint(channel['sampler']) ?? -1];
    const [input, output] = [uint(sampler?.['input']), uint(sampler?.['output'])];
    if (uint(node) === undefined || input === undefined || output === undefined) return [];
    if (path !== 'translation' && path !== 'rotation' && path !== 'scale') return [];
    const [times, values] = [data.layout(input), data.layout(output)];
    if (times?.componentType !== 5126 || times.components !== 1 || values === undefined) return [];
    const interpolation = String(sampler?.['interpolation'] ?? 'LINEAR');
    const width = path === 'rotation' ? 4 : 3;
    if (values.components !== width || values.count < times.count * (interpolation === 'CUBICSPLINE' ? 3 : 1)) return [];
    return [{ node: node as number, path, times: data.values(times) as Float32Array, values: data.floats(values), width, interpolation }];
  });
}

/** The value at a time; of a cubic spline, that of the straight lines between its points. */
function valueAt({ times, values, width, interpolation }: Channel, time: number): number[] {
  let next = times.findIndex((key) => key > time);
  if (next < 0) next = times.length;
  const value = (key: number): number[] => {
    const start = interpolation === 'CUBICSPLINE' ? (3 * key + 1) * width : key * width;
    return Array.from(values.subarray(start, start + width));
  };
  if (next === 0 || next === times.length || interpolation === 'STEP') return value(Math.max(0, next - 1));
  const [before, after] = [value(next - 1), value(next)];
  const [from, to] = [times[next - 1] as number, times[next] as number];
  const share = (time - from) / (to - from);
  // A quaternion and its opposite are one rotation; the nearer one is meant.
  const sign = width === 4 && before.reduce((sum, own, at) => sum + own * (after[at] as number), 0) < 0 ? -1 : 1;
  return before.map((own, at) => own * (1 - share) + sign * share * (after[at] as number));
}
