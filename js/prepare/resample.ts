// Animations without the keys that interpolation between the others gives too.

import type { GltfData, Layout } from '../codecs/gltf_data.js';
import { arrayAt, objects, uint, type Tree } from '../codecs/tree.js';
import { releaseAccessors } from './release.js';

/**
 * How far a value may be from what it was: this share of the largest change in its track, and for rotations this much of
 * a quaternion, which is 0.01 degrees. A tenth of what would be seen of a figure as high as the picture.
 */
const TOLERANCE = 1e-4;

/** A sampler's keys and values. */
interface Track {
  readonly times: Float32Array;
  readonly values: Float32Array;
  /** Numbers of one key. */
  readonly width: number;
  readonly kind: 'linear' | 'step' | 'rotation';
}

/** Drops the keys that can be missed. Cubic splines, and values stored as integers, stay as they are. */
export function resample(data: GltfData): void {
  const released = new Set<number>();
  const made: Made = { columns: new Map(), inputs: new Map() };
  for (const animation of objects(data.tree, 'animations')) {
    const channels = objects(animation, 'channels');
    for (const [index, sampler] of objects(animation, 'samplers').entries()) {
      const paths = new Set(channels.filter((channel) => channel['sampler'] === index).map(({ target }) => (target as Tree | undefined)?.['path']));
      const [input, output] = [uint(sampler['input']), uint(sampler['output'])];
      if (input === undefined || output === undefined) continue;
      const track = trackOf(data, sampler, input, output, paths);
      if (track === undefined) continue;
      const kept = keysToKeep(track);
      const keys = track.times.length;
      // Its times may have been shared with others, which then still need them.
      if (kept.length * (1 + track.width) >= keys * track.width || kept.length === keys) continue;
      sampler['input'] = inputFor(data, made, input, track, kept);
      sampler['output'] = add(data, made, output, pick(track.values, track.width, kept));
      released.add(input).add(output);
    }
  }
  for (const parts of made.columns.values()) store(data, parts);
  releaseAccessors(data, released);
}

function trackOf(data: GltfData, sampler: Tree, input: number, output: number, paths: ReadonlySet<unknown>): Track | undefined {
  const interpolation = sampler['interpolation'] ?? 'LINEAR';
  const [times, values] = [data.layout(input), data.layout(output)];
  if ((interpolation !== 'LINEAR' && interpolation !== 'STEP') || !isFloats(times) || !isFloats(values)) return undefined;
  const isRotation = paths.has('rotation');
  // One sampler for things that are interpolated in different ways.
  if (paths.size === 0 || (isRotation && paths.size > 1) || paths.has('pointer') || times.components !== 1) return undefined;
  const width = (values.count * values.components) / times.count;
  if (!Number.isInteger(width) || times.count < 3 || (isRotation && width !== 4)) return undefined;
  const track: Track = {
    times: data.values(times) as Float32Array,
    values: data.values(values) as Float32Array,
    width,
    kind: interpolation === 'STEP' ? 'step' : isRotation ? 'rotation' : 'linear',
  };
  const ascends = track.times.every((time, key) => key === 0 || time > (track.times[key - 1] as number));
  return ascends && track.values.every(Number.isFinite) ? track : undefined;
}

const isFloats = (layout: Layout | undefined): layout is Layout => layout?.componentType === 5126;

/** The numbers of the keys to keep, the first and the last among them: the length of the animation stays. */
export function keysToKeep({ times, values, width, kind }: Track): number[] {
  const keys = times.length;
  const tolerance = kind === 'step' ? 0 : kind === 'rotation' ? TOLERANCE : TOLERANCE * spread(values, width);
  const between = new Float64Array(width);
  const fits = (from: number, to: number): boolean => {
    for (let key = from + 1; key < to; key += 1) {
      const [start, end, time] = [times[from] as number, times[to] as number, times[key] as number];
      blend(between, values, width, from, to, kind === 'step' ? 0 : (time - start) / (end - start), kind === 'rotation');
      if (!isNear(between, values, key * width, tolerance, kind === 'rotation')) return false;
    }
    return true;
  };
  const kept = [0];
  let from = 0;
  for (let to = 2; to < keys; to += 1) {
    // Beyond this a check of all keys between would take too long, and one key of so many costs nothing.
    if (to - from <= LONGEST && fits(from, to)) continue;
    from = to - 1;
    kept.push(from);
  }
  kept.push(keys - 1);
  return kept;
}

const LONGEST = 256;

function blend(out: Float64Array, values: Float32Array, width: number, from: number, to: number, share: number, isRotation: boolean): void {
  const at = (key: number, component: number): number => values[key * width + component] as number;
  let [a, b] = [1 - share, share];
  if (isRotation) {
    let cosine = 0;
    for (let c = 0; c < width; c += 1) cosine += at(from, c) * at(to, c);
    // The shorter way round, as glTF has it.
    const sign = cosine < 0 ? -1 : 1;
    const angle = Math.acos(Math.min(1, Math.abs(cosine)));
    if (angle > 1e-4) [a, b] = [Math.sin((1 - share) * angle) / Math.sin(angle), Math.sin(share * angle) / Math.sin(angle)];
    b *= sign;
  }
  for (let c = 0; c < width; c += 1) out[c] = a * at(from, c) + b * at(to, c);
}

function isNear(found: Float64Array, values: Float32Array, start: number, tolerance: number, isRotation: boolean): boolean {
  let [same, opposite] = [0, 0];
  for (const [c, value] of found.entries()) {
    same = Math.max(same, Math.abs(value - (values[start + c] as number)));
    opposite = Math.max(opposite, Math.abs(value + (values[start + c] as number)));
  }
  // A quaternion and its opposite are one rotation.
  return (isRotation ? Math.min(same, opposite) : same) <= tolerance;
}

/** The largest change of a component. */
function spread(values: Float32Array, width: number): number {
  let most = 0;
  for (let c = 0; c < width; c += 1) {
    let [low, high] = [Infinity, -Infinity];
    for (let at = c; at < values.length; at += width) {
      low = Math.min(low, values[at] as number);
      high = Math.max(high, values[at] as number);
    }
    most = Math.max(most, high - low);
  }
  return most;
}

function pick(values: Float32Array, width: number, keys: readonly number[]): Float32Array {
  const picked = new Float32Array(keys.length * width);
  for (const [row, key] of keys.entries()) picked.set(values.subarray(key * width, (key + 1) * width), row * width);
  return picked;
}

/** Accessors that are made, by the bytes of an element: those of one size share a view, which codecs can pack. */
interface Made {
  readonly columns: Map<number, Array<{ readonly accessor: number; readonly values: Float32Array }>>;
  /** By what they were made from. */
  readonly inputs: Map<string, number>;
}

function inputFor(data: GltfData, made: Made, input: number, { times }: Track, kept: readonly number[]): number {
  const key = `${input}/${kept.join()}`;
  const known = made.inputs.get(key);
  if (known !== undefined) return known;
  const values = pick(times, 1, kept);
  const index = add(data, made, input, values);
  Object.assign(data.accessor(index), { min: [values[0]], max: [values.at(-1)] });
  made.inputs.set(key, index);
  return index;
}

/** A new accessor like `like` with other values; they get a place when all of them are there. */
function add(data: GltfData, made: Made, like: number, values: Float32Array): number {
  const layout = data.layout(like) as Layout;
  const json = structuredClone(data.accessor(like));
  for (const key of ['bufferView', 'byteOffset', 'min', 'max']) delete json[key];
  json['count'] = values.length / layout.components;
  const index = arrayAt(data.tree, 'accessors').push(json) - 1;
  const column = made.columns.get(layout.size);
  if (column === undefined) made.columns.set(layout.size, [{ accessor: index, values }]);
  else column.push({ accessor: index, values });
  return index;
}

function store(data: GltfData, parts: ReadonlyArray<{ accessor: number; values: Float32Array }>): void {
  const bytes = new Uint8Array(parts.reduce((sum, { values }) => sum + values.byteLength, 0));
  const view = data.addView(bytes, {});
  let offset = 0;
  for (const { accessor, values } of parts) {
    bytes.set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength), offset);
    Object.assign(data.accessor(accessor), { bufferView: view }, offset > 0 ? { byteOffset: offset } : {});
    offset += values.byteLength;
  }
}
