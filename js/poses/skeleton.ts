// The skins of a glTF at moments of its animations: where every joint takes what hangs on it.

import type { GltfData } from '../codecs/gltf_data.js';
import { objectOr, objects, uint, type Tree } from '../codecs/tree.js';
import { compose, multiply, type Matrix, type Placement } from './matrices.js';

/** Matrices of every joint of a skin: world from the mesh in its bind pose. */
export type Joints = readonly Matrix[];

/** Moments that are looked at, over all animations. */
const MOMENTS = 16;

interface Channel {
  readonly node: number;
  readonly path: 'translation' | 'rotation' | 'scale';
  readonly times: Float32Array;
  readonly values: Float32Array;
  readonly width: number;
  readonly interpolation: string;
}

/** The joints of `skin` as the file's nodes stand, and then at each moment; undefined without an animation of them. */
export function jointsOf(data: GltfData, skin: number): { rest: Joints; moments: Joints[] } | undefined {
  const { tree } = data;
  const { joints: list, inverseBindMatrices } = objects(tree, 'skins')[skin] ?? {};
  const nodes = objects(tree, 'nodes');
  const joints = (Array.isArray(list) ? list : []).map((joint) => uint(joint) ?? -1);
  if (joints.length === 0 || joints.some((joint) => nodes[joint] === undefined)) return undefined;
  const layout = uint(inverseBindMatrices) === undefined ? undefined : data.layout(inverseBindMatrices as number);
  if (layout !== undefined && (layout.componentType !== 5126 || layout.count < joints.length || layout.components !== 16)) return undefined;
  const inverse = layout && (data.values(layout) as Float32Array);
  const parents = parentsOf(nodes);
  const places = nodes.map(placementOf);
  const bones = (own: ReadonlyArray<Placement | Matrix>): Joints => {
    const world = new Map<number, Matrix>();
    const worldOf = (node: number, depth: number): Matrix => {
      const known = world.get(node);
      if (known !== undefined) return known;
      const place = own[node] as Placement | Matrix;
      const local = place instanceof Float64Array ? place : compose(place);
      const parent = parents[node];
      // A ring of nodes has no place in the world.
      const matrix = parent === undefined || depth > nodes.length ? local : multiply(worldOf(parent, depth + 1), local);
      world.set(node, matrix);
      return matrix;
    };
    return joints.map((joint, at) => (inverse === undefined ? worldOf(joint, 0) : multiply(worldOf(joint, 0), inverse.subarray(16 * at, 16 * at + 16))));
  };
  const clips = objects(tree, 'animations').map((animation) => channelsOf(data, animation)).filter((channels) => channels.length > 0);
  if (clips.length === 0) return undefined;
  const moments: Joints[] = [];
  for (let moment = 0; moment < MOMENTS; moment += 1) {
    const channels = clips[moment % clips.length] as Channel[];
    const share = (Math.floor(moment / clips.length) + 0.25) / Math.ceil(MOMENTS / clips.length);
    const end = Math.max(...channels.map(({ times }) => times.at(-1) as number));
    const moved = [...places];
    for (const channel of channels) {
      const place = moved[channel.node];
      if (place === undefined || place instanceof Float64Array) continue;
      moved[channel.node] = { ...place, [channel.path]: valueAt(channel, share * end) };
    }
    moments.push(bones(moved));
  }
  return { rest: bones(places), moments };
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
