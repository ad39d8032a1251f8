// Simplification of three.js geometries, and levels of detail as a `LOD`.

import { BufferAttribute, BufferGeometry, InstancedBufferAttribute, LOD, Mesh, SkinnedMesh } from 'three';
import type { InterleavedBufferAttribute, TypedArray } from 'three';
import { invalidArgument } from './errors.js';
import { checkNames } from './check.js';
import { SIMPLIFY_NAMES } from './options.js';
import { errorOfPixels } from './screen.js';
import { simplify, simplifySequence } from './simplify.js';
import type { AttributeArray, MeshInput, ScreenView, SimplifiedMesh, SimplifyOptions } from './types.js';

export { init } from './engine.js';
export { DecimeshError } from './errors.js';

/** An attribute of a geometry, in an array of its own or not. */
type Source = BufferAttribute | InterleavedBufferAttribute;

/**
 * A new geometry with fewer triangles and the attributes, morph targets, groups and name of `geometry`, which stays as
 * it was; `init()` must have finished. Attributes keep their types and normalisation; interleaved ones become arrays of
 * their own. The borders of groups move together and do not tear. Without an index every three vertices are a
 * triangle; vertices at one place are then the sides of a seam only where their attributes differ.
 *
 * The draw range is not looked at. Throws `invalid-argument` where there are no positions, and what `simplify` throws.
 */
export function simplifyGeometry(geometry: BufferGeometry, options: SimplifyOptions): BufferGeometry {
  const input = new GeometryInput(geometry);
  return input.output(simplify(input.mesh, options));
}

/** What `levels` say, and what makes no difference where every level counts. */
const NOT_OF_A_SEQUENCE: readonly string[] = ['ratio', 'triangles', 'error', 'preset'];
const SEQUENCE_NAMES = SIMPLIFY_NAMES.filter((name) => !NOT_OF_A_SEQUENCE.includes(name));

/** How to make a `LOD`. */
export interface CreateLODOptions extends Omit<SimplifyOptions, 'ratio' | 'triangles' | 'error' | 'preset'> {
  /** Shares of the triangles, 0 to 1, each its own; or how many levels, each half of the one before. Default 5. */
  readonly levels?: number | readonly number[] | undefined;
  /** Pixels that the estimated error of a level may take where it is shown, > 0. Default 1. */
  readonly pixels?: number | undefined;
  /** Vertical angle of view in degrees, above 0 and below 180. Default 45. */
  readonly fieldOfView?: number | undefined;
  /** Height of the picture in pixels, > 0. Default 1080. */
  readonly viewportHeight?: number | undefined;
  /** Share of a level's distance by which to come nearer before the finer one is shown, 0 to 1. Default 0. */
  readonly hysteresis?: number | undefined;
}

/**
 * Levels of `mesh` as a `LOD`, from one run; `init()` must have finished. The first is the finest, shown from distance 0,
 * with the geometry of `mesh` itself if its share is 1. The others are shown from the distance on at which their
 * estimated error takes so many `pixels`; levels that would never be shown are left out. The meshes share the material
 * and, if skinned, the skeleton. The `LOD` has the mesh's placement, name and layers; `mesh` stays as and where it is.
 *
 * Distances are in the units that the mesh's scale and those above it give; they hold for the scale at this call.
 */
export function createLOD(mesh: Mesh, options: CreateLODOptions = {}): LOD {
  const { levels = 5, pixels = 1, fieldOfView, viewportHeight, hysteresis = 0, ...simplifyOptions } = options;
  checkNames(simplifyOptions, SEQUENCE_NAMES);
  if (!(mesh instanceof Mesh)) throw invalidArgument('mesh', 'must be a Mesh');
  if (!(pixels > 0)) throw invalidArgument('pixels', 'must be a number above 0');
  if (!(hysteresis >= 0 && hysteresis <= 1)) throw invalidArgument('hysteresis', 'must be a number from 0 to 1');
  const ratios = ratiosOf(levels);
  const input = new GeometryInput(mesh.geometry);
  mesh.updateWorldMatrix(true, false);
  const scale = mesh.matrixWorld.getMaxScaleOnAxis();
  // At distance 1; the picture is in proportion to the distance.
  const view: ScreenView = { distance: 1, fieldOfView, viewportHeight };
  const errorAtOne = errorOfPixels(pixels, view, 1);
  const lod = new LOD();
  const sequence = simplifySequence(input.mesh, { ...simplifyOptions, ratio: Math.min(...ratios) });
  try {
    let [last, triangles] = [-1, Infinity];
    for (const ratio of ratios) {
      const level = sequence.level({ ratio });
      const first = last < 0;
      const distance = first ? 0 : (level.estimatedError * scale) / errorAtOne;
      const count = level.indices.length / 3;
      if (count >= triangles) continue;
      // A coarser level with no more error, or none, takes the place of the one before.
      if (!first && distance <= last) lod.levels.pop()?.object.removeFromParent();
      const from = distance <= last ? Math.max(last, 0) : distance;
      lod.addLevel(copyOf(mesh, ratio === 1 ? mesh.geometry : input.output(level)), from, hysteresis);
      [last, triangles] = [from, count];
    }
  } finally {
    sequence.dispose();
  }
  lod.name = mesh.name;
  lod.layers.mask = mesh.layers.mask;
  lod.position.copy(mesh.position);
  lod.quaternion.copy(mesh.quaternion);
  lod.scale.copy(mesh.scale);
  for (const { object } of lod.levels) {
    object.position.set(0, 0, 0);
    object.quaternion.identity();
    object.scale.set(1, 1, 1);
    object.updateMatrix();
  }
  return lod;
}

function ratiosOf(levels: unknown): number[] {
  if (typeof levels === 'number') {
    if (!Number.isInteger(levels) || levels < 1 || levels > 32) throw invalidArgument('levels', 'must be from 1 to 32');
    return Array.from({ length: levels }, (_, level) => 0.5 ** level);
  }
  const fits = Array.isArray(levels) && levels.length >= 1 && levels.length <= 32;
  if (!fits || !levels.every((ratio) => typeof ratio === 'number' && ratio >= 0 && ratio <= 1)) {
    throw invalidArgument('levels', 'must be a count, or a list of numbers from 0 to 1');
  }
  return [...levels].sort((a, b) => b - a);
}

function copyOf(mesh: Mesh, geometry: BufferGeometry): Mesh {
  // Without what hangs below it: that is not part of the levels.
  const copy = mesh.clone(false);
  copy.geometry = geometry;
  if (copy instanceof SkinnedMesh && mesh instanceof SkinnedMesh) copy.bind(mesh.skeleton, mesh.bindMatrix);
  return copy;
}

/** A column of the engine's mesh and how it goes back. */
interface Column {
  readonly name: string;
  readonly source: Source;
  /** Gives the geometry its attribute. */
  place(geometry: BufferGeometry, attribute: BufferAttribute): void;
  /** Of a morph target that is a place and not an offset: the name of the column that it is an offset from. */
  readonly base: string | undefined;
}

/** A geometry as the arrays that the engine takes, and back. */
class GeometryInput {
  readonly mesh: MeshInput;
  readonly #geometry: BufferGeometry;
  readonly #position: Source;
  readonly #columns: Column[] = [];
  readonly #groups: ReadonlyArray<{ start: number; count: number; materialIndex?: number | undefined }>;

  constructor(geometry: BufferGeometry) {
    const position = (geometry as Partial<BufferGeometry> | undefined)?.getAttribute?.('position') as Source | undefined;
    if (position === undefined || position.itemSize !== 3) throw invalidArgument('geometry', 'must have positions');
    this.#geometry = geometry;
    this.#position = position;
    this.#groups = geometry.groups.filter(({ count }) => count > 0);
    this.#listColumns();
    const corners = this.#corners();
    const { vertices, indices, groupOf } = splitGroups(corners, position.count, this.#groups);
    const attributes: Record<string, AttributeArray> = {};
    for (const { name, source, base } of this.#columns) {
      const values = numbersOf(source, vertices);
      if (base !== undefined) {
        const from = base === 'position' ? numbersOf(position, vertices) : (attributes[base] as Float32Array);
        for (let at = 0; at < values.length; at += 1) values[at] = (values[at] as number) - (from[at] as number);
      }
      // Whole numbers that are not fractions in disguise are names of something: never between two of them.
      const whole = !(source.array instanceof Float32Array) && !source.normalized && isOwnKind(name);
      attributes[name] = whole ? Int32Array.from(values) : values;
    }
    if (this.#groups.length > 1) attributes['group'] = groupOf;
    this.mesh = { positions: numbersOf(position, vertices), indices, attributes };
  }

  /** The geometry at a level. */
  output({ positions, indices, attributes }: SimplifiedMesh): BufferGeometry {
    const geometry = new BufferGeometry();
    geometry.name = this.#geometry.name;
    geometry.userData = { ...this.#geometry.userData };
    geometry.morphTargetsRelative = this.#geometry.morphTargetsRelative;
    geometry.setAttribute('position', likeSource(this.#position, positions));
    for (const { name, source, place, base } of this.#columns) {
      const values = attributes[name] as AttributeArray;
      if (base !== undefined) {
        const from = base === 'position' ? positions : (attributes[base] as AttributeArray);
        for (let at = 0; at < values.length; at += 1) values[at] = (values[at] as number) + (from[at] as number);
      }
      place(geometry, likeSource(source, values));
    }
    for (const [name, attribute] of Object.entries(this.#geometry.attributes)) {
      // What there is once for each instance has nothing to do with vertices.
      if (attribute instanceof InstancedBufferAttribute) geometry.setAttribute(name, attribute.clone());
    }
    const order = this.#groups.length > 1 ? this.#group(geometry, indices, attributes['group'] as AttributeArray) : indices;
    const [only] = this.#groups;
    if (this.#groups.length === 1 && only !== undefined) geometry.addGroup(0, indices.length, only.materialIndex);
    const short = positions.length / 3 <= 65535;
    geometry.setIndex(new BufferAttribute(short ? Uint16Array.from(order) : order, 1));
    return geometry;
  }

  #listColumns(): void {
    const { attributes, morphAttributes, morphTargetsRelative } = this.#geometry;
    const skinned = ['skinIndex', 'skinWeight'].every((name) => attributes[name]?.itemSize === 4);
    for (const [name, source] of Object.entries(attributes)) {
      if (name === 'position' || source instanceof InstancedBufferAttribute) continue;
      this.#addColumn(engineName(name, source.itemSize, skinned), source as Source, undefined, (geometry, attribute) => {
        geometry.setAttribute(name, attribute);
      });
    }
    for (const [name, targets] of Object.entries(morphAttributes)) {
      const based = attributes[name];
      for (const [target, source] of (targets ?? []).entries()) {
        const offset = morphTargetsRelative || based === undefined;
        const base = offset ? undefined : name === 'position' ? name : engineName(name, based.itemSize, skinned);
        this.#addColumn(`morph ${target} ${name}`, source as Source, base, (geometry, attribute) => {
          (geometry.morphAttributes[name as 'position'] ??= [])[target] = attribute;
        });
      }
    }
  }

  #addColumn(name: string, source: Source, base: string | undefined, place: Column['place']): void {
    if (source.count < this.#position.count) throw invalidArgument(name, 'has fewer vertices than the positions');
    this.#columns.push({ name, source, base, place });
  }

  /** Three vertices for each triangle; of a geometry with groups those that one draws. */
  #corners(): Uint32Array {
    const { index } = this.#geometry;
    const count = index?.count ?? this.#position.count;
    const all = Uint32Array.from({ length: count - (count % 3) }, (_, at) => index?.getX(at) ?? at);
    if (this.#groups.length === 0) return all;
    return Uint32Array.from(this.#groups.flatMap(({ start, count }) => {
      const end = Math.min(start + count, all.length);
      return [...all.subarray(start, Math.max(start, end - ((end - start) % 3)))];
    }));
  }

  /** Sorts the triangles by the group that their vertices are in, and tells the geometry. */
  #group(geometry: BufferGeometry, indices: Uint32Array, groupOf: AttributeArray): Uint32Array {
    const counts = this.#groups.map(() => 0);
    for (let at = 0; at < indices.length; at += 3) counts[groupOf[indices[at] as number] as number]! += 3;
    const next: number[] = [];
    let start = 0;
    for (const [group, count] of counts.entries()) {
      next.push(start);
      geometry.addGroup(start, count, this.#groups[group]?.materialIndex);
      start += count;
    }
    const order = new Uint32Array(indices.length);
    for (let at = 0; at < indices.length; at += 3) {
      const group = groupOf[indices[at] as number] as number;
      order.set(indices.subarray(at, at + 3), next[group] as number);
      next[group]! += 3;
    }
    return order;
  }
}

/** Gives every group vertices of its own, so that a vertex tells its group. `vertices` are the ones they come from. */
function splitGroups(
  corners: Uint32Array,
  count: number,
  groups: ReadonlyArray<{ count: number }>,
): { vertices: Uint32Array; indices: Uint32Array; groupOf: Int32Array } {
  if (groups.length < 2) {
    return { vertices: Uint32Array.from({ length: count }, (_, at) => at), indices: corners, groupOf: new Int32Array() };
  }
  const [vertices, groupOf]: [number[], number[]] = [[], []];
  const indices = new Uint32Array(corners.length);
  // For each vertex its number in the group that is being gone through.
  const number = new Uint32Array(count);
  const seenIn = new Int32Array(count).fill(-1);
  let at = 0;
  for (const [group, { count: length }] of groups.entries()) {
    const end = Math.min(at + length - (length % 3), corners.length);
    for (; at < end; at += 1) {
      const vertex = corners[at] as number;
      if (vertex >= count) throw invalidArgument('geometry.index', 'names a vertex that is not there');
      if (seenIn[vertex] !== group) {
        seenIn[vertex] = group;
        number[vertex] = vertices.length;
        vertices.push(vertex);
        groupOf.push(group);
      }
      indices[at] = number[vertex] as number;
    }
  }
  return { vertices: Uint32Array.from(vertices), indices: indices.subarray(0, at), groupOf: Int32Array.from(groupOf) };
}

/** The engine's name for an attribute that it knows, or one that it does not. */
function engineName(name: string, itemSize: number, skinned: boolean): string {
  if (name === 'normal' && itemSize === 3) return 'normal';
  if (name === 'tangent' && itemSize === 4) return 'tangent';
  if (name === 'color' && (itemSize === 3 || itemSize === 4)) return 'color';
  if (/^uv\d*$/.test(name) && itemSize === 2) return name;
  if (skinned && name === 'skinIndex') return 'joints';
  if (skinned && name === 'skinWeight') return 'weights';
  return `own ${name}`;
}

function isOwnKind(name: string): boolean {
  return name.startsWith('own ');
}

function numbersOf(source: Source, vertices: Uint32Array): Float32Array {
  const size = source.itemSize;
  const values = new Float32Array(vertices.length * size);
  for (let at = 0; at < vertices.length; at += 1) {
    for (let component = 0; component < size; component += 1) {
      values[at * size + component] = source.getComponent(vertices[at] as number, component);
    }
  }
  return values;
}

function likeSource(source: Source, values: AttributeArray): BufferAttribute {
  const type = source.array.constructor as { new (length: number): TypedArray };
  const attribute = new BufferAttribute(new type(values.length), source.itemSize, source.normalized);
  attribute.name = source.name;
  // It knows how fractions are stored; whole numbers must be whole before.
  const whole = !(source.array instanceof Float32Array) && !source.normalized;
  for (let at = 0; at < values.length; at += 1) {
    const value = values[at] as number;
    attribute.setComponent(Math.floor(at / source.itemSize), at % source.itemSize, whole ? Math.round(value) : value);
  }
  return attribute;
}
