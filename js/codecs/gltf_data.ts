// A GLB taken apart for the encoders: its tree, and the bytes of each buffer view on its own.

import { buildGlb, encodeTree, parseGlb } from './container.js';
import {
  COMPONENT_ARRAYS,
  arrayAt,
  componentTypeOf,
  componentsOf,
  objectOr,
  objects,
  sparseRows,
  uint,
  type ComponentType,
  type Tree,
} from './tree.js';

/** Where an accessor's elements are. */
export interface Layout {
  readonly view: number;
  readonly offset: number;
  /** From one element to the next, bytes. */
  readonly stride: number;
  /** Of one element, bytes. */
  readonly size: number;
  readonly count: number;
  readonly components: number;
  readonly componentType: ComponentType;
  readonly normalized: boolean;
}

/** A primitive that is a list of triangles with indices. */
export interface Triangles {
  readonly mesh: number;
  readonly json: Tree;
  readonly indices: number;
  /** By semantic, in the order of the file. */
  readonly attributes: ReadonlyArray<readonly [semantic: string, accessor: number]>;
  /** The same for each morph target. */
  readonly targets: ReadonlyArray<ReadonlyArray<readonly [semantic: string, accessor: number]>>;
}

/** An array of numbers as glTF stores them. */
export type Values = InstanceType<(typeof COMPONENT_ARRAYS)[ComponentType]>;

/** A buffer may not be empty. */
const ONE_BYTE = 'data:application/octet-stream;base64,AA==';

/** A glTF whose geometry is being encoded. What cannot be understood is left alone, never an error. */
export class GltfData {
  readonly tree: Tree;
  /** The bytes of every buffer view; replaced, not written to. */
  readonly views: Uint8Array[] = [];
  readonly #spare: number[] = [];

  /** Takes apart a GLB of one buffer, as the engine writes it. */
  constructor(glb: Uint8Array) {
    const { json, binary } = parseGlb(glb);
    this.tree = json;
    for (const view of objects(this.tree, 'bufferViews')) {
      const offset = uint(view['byteOffset']) ?? 0;
      this.views.push(binary.subarray(offset, offset + (uint(view['byteLength']) ?? 0)));
    }
  }

  /** The accessor of this number; an empty object if there is none. */
  accessor(index: number): Tree {
    return objectOr(arrayAt(this.tree, 'accessors')[index]);
  }

  /** The view of this number. */
  view(index: number): Tree {
    return objectOr(arrayAt(this.tree, 'bufferViews')[index]);
  }

  /** Where an accessor's elements are; undefined for a sparse one, one without bytes, and one that is not whole. */
  layout(index: number): Layout | undefined {
    const json = this.accessor(index);
    const [view, count] = [uint(json['bufferView']), uint(json['count'])];
    const [componentType, components] = [componentTypeOf(json['componentType']), componentsOf(json)];
    if (view === undefined || count === undefined || componentType === undefined || components === undefined) return undefined;
    // Columns of matrices of small numbers are padded, which nothing here needs to know.
    if (json['sparse'] !== undefined || (String(json['type']).startsWith('MAT') && componentType !== 5126)) return undefined;
    const size = components * COMPONENT_ARRAYS[componentType].BYTES_PER_ELEMENT;
    const stride = uint(this.view(view)['byteStride']) ?? size;
    const offset = uint(json['byteOffset']) ?? 0;
    const bytes = this.views[view];
    if (bytes === undefined || count === 0 || offset + (count - 1) * stride + size > bytes.length) return undefined;
    return { view, offset, stride, size, count, components, componentType, normalized: json['normalized'] === true };
  }

  /** A copy of an accessor's elements without gaps. */
  values(layout: Layout): Values {
    const { view, offset, stride, size, count, componentType } = layout;
    const source = this.views[view] as Uint8Array;
    const bytes = new Uint8Array(count * size);
    if (stride === size) bytes.set(source.subarray(offset, offset + count * size));
    else for (let row = 0; row < count; row += 1) bytes.set(source.subarray(offset + row * stride, offset + row * stride + size), row * size);
    return new COMPONENT_ARRAYS[componentType](bytes.buffer);
  }

  /** Numbers of an accessor as they are meant: normalised integers as fractions. */
  floats(layout: Layout): Float32Array {
    const values = this.values(layout);
    const scale = layout.normalized ? (FULL_SCALE[layout.componentType] ?? 1) : 1;
    return Float32Array.from(values, (value) => Math.max(value / scale, layout.normalized ? -1 : -Infinity));
  }

  /** The lists of triangles whose indices can be read. */
  triangles(): Triangles[] {
    const found: Triangles[] = [];
    for (const [mesh, { primitives }] of objects(this.tree, 'meshes').entries()) {
      for (const json of Array.isArray(primitives) ? primitives.map(objectOr) : []) {
        const indices = uint(json['indices']);
        if ((json['mode'] ?? 4) !== 4 || indices === undefined) continue;
        const layout = this.layout(indices);
        if (layout === undefined || layout.count % 3 !== 0) continue;
        found.push({ mesh, json, indices, attributes: references(json['attributes']), targets: objects(json, 'targets').map(references) });
      }
    }
    return found;
  }

  /**
   * Puts every element of the morph targets into bytes where the file has only those that are not zero; with `blank` also
   * of those that are zero throughout. What numbers vertices anew, or changes the meaning of values, needs that.
   */
  makeTargetsDense(triangles: readonly Triangles[], blank: boolean): void {
    const freed = new Set<number>();
    for (const { attributes, targets } of triangles) {
      const vertices = attributes[0] && this.layout(attributes[0][1])?.count;
      for (const [, index] of targets.flat()) {
        const json = this.accessor(index);
        const [componentType, components] = [componentTypeOf(json['componentType']), componentsOf(json)];
        const isKept = json['bufferView'] !== undefined || (json['sparse'] === undefined && !blank);
        if (isKept || vertices === undefined || json['count'] !== vertices || componentType === undefined || components === undefined) continue;
        const size = components * COMPONENT_ARRAYS[componentType].BYTES_PER_ELEMENT;
        // Vertex data lie on multiples of four.
        const stride = Math.ceil(size / 4) * 4;
        const bytes = new Uint8Array(vertices * stride);
        if (json['sparse'] !== undefined && !this.#unpackSparse(objectOr(json['sparse']), bytes, size, stride, freed)) continue;
        delete json['sparse'];
        json['bufferView'] = this.addView(bytes, { byteStride: stride, target: 34962 });
      }
    }
    this.freeViews(freed);
  }

  /** Puts sparse elements into rows; false, with nothing done, where they are not whole. */
  #unpackSparse(sparse: Tree, rows: Uint8Array, size: number, stride: number, freed: Set<number>): boolean {
    const holders = [objectOr(sparse['indices']), objectOr(sparse['values'])];
    const [indices, values] = holders.map((json) => this.views[uint(json['bufferView']) ?? -1]?.subarray(uint(json['byteOffset']) ?? 0));
    const [count, componentType] = [uint(sparse['count']), componentTypeOf(holders[0]?.['componentType'])];
    if (indices === undefined || values === undefined || count === undefined || componentType === undefined) return false;
    const indexSize = COMPONENT_ARRAYS[componentType].BYTES_PER_ELEMENT;
    if (indices.length < count * indexSize || values.length < count * size) return false;
    for (const [at, row] of sparseRows(indices, 0, count, indexSize).entries()) {
      if ((row + 1) * stride > rows.length) return false;
      rows.set(values.subarray(at * size, (at + 1) * size), row * stride);
    }
    for (const json of holders) freed.add(json['bufferView'] as number);
    return true;
  }

  /** Accessors that something else than the attributes and indices of `triangles` needs. */
  usedElsewhere(triangles: readonly Triangles[]): Set<number> {
    const used = new Set<number>();
    const mark = (value: unknown): void => void (uint(value) === undefined || used.add(uint(value) as number));
    const ours = new Set(triangles.map(({ json }) => json));
    for (const mesh of objects(this.tree, 'meshes')) {
      for (const json of objects(mesh, 'primitives').filter((json) => !ours.has(json))) {
        mark(json['indices']);
        for (const list of [objectOr(json['attributes']), ...objects(json, 'targets')]) Object.values(list).forEach(mark);
      }
    }
    for (const animation of objects(this.tree, 'animations')) {
      for (const { input, output } of objects(animation, 'samplers')) [input, output].forEach(mark);
    }
    for (const skin of objects(this.tree, 'skins')) mark(skin['inverseBindMatrices']);
    markInExtensions(this.tree, false, mark);
    return used;
  }

  /** Puts bytes into a view of their own, which may be one that was given back; returns its number. */
  addView(bytes: Uint8Array, properties: Tree): number {
    const views = arrayAt(this.tree, 'bufferViews');
    const index = this.#spare.pop() ?? views.push({}) - 1;
    const json = this.view(index);
    for (const key of ['byteStride', 'target', 'name']) delete json[key];
    Object.assign(json, properties);
    this.views[index] = bytes;
    return index;
  }

  /** Keeps the views of these numbers, numbered anew in this order, and removes all others. */
  keepViews(kept: readonly number[]): void {
    const json = arrayAt(this.tree, 'bufferViews');
    const bytes = kept.map((view) => this.views[view] as Uint8Array);
    this.tree['bufferViews'] = kept.map((view) => json[view]);
    this.views.splice(0, this.views.length, ...bytes);
    this.#spare.length = 0;
  }

  /** The views that something else than the elements of an accessor needs. */
  viewsBesideAccessors(): Set<number> {
    const found = new Set<number>();
    const mark = (value: unknown): void => void found.add(uint(value) ?? -1);
    for (const accessor of objects(this.tree, 'accessors')) {
      for (const key of ['indices', 'values']) mark(objectOr(objectOr(accessor['sparse'])[key])['bufferView']);
    }
    for (const image of objects(this.tree, 'images')) mark(image['bufferView']);
    markInExtensions(this.tree, false, mark, ['bufferView', 'values', 'arrayOffsets', 'stringOffsets']);
    return found;
  }

  /** Gives back views that no accessor needs any more, and of which only accessors knew. */
  freeViews(candidates: ReadonlySet<number>): void {
    const used = this.viewsBesideAccessors();
    for (const { bufferView } of objects(this.tree, 'accessors')) used.add(uint(bufferView) ?? -1);
    for (const view of [...candidates].filter((view) => !used.has(view)).sort((a, b) => b - a)) {
      if (this.#spare.includes(view)) continue;
      this.views[view] = new Uint8Array();
      this.#spare.push(view);
    }
  }

  /**
   * The GLB. `packed` are encoded views, which then are in the second, virtual buffer; all others are written plainly.
   */
  build(packed: ReadonlyMap<number, PackedView> = new Map(), extension = ''): Uint8Array<ArrayBuffer> {
    const views = arrayAt(this.tree, 'bufferViews');
    // Views that lost their use keep their place for the numbers of those behind them; at the end they can go.
    const spare = new Set(this.#spare);
    while (spare.delete(views.length - 1)) views.pop();
    const pieces: Uint8Array[] = [];
    let length = 0;
    let unpacked = 0;
    for (let index = 0; index < views.length; index += 1) {
      const json = this.view(index);
      // A view may not be empty, nor its stride longer than it is.
      if (spare.has(index)) for (const key of ['byteStride', 'target']) delete json[key];
      const bytes = spare.has(index) ? new Uint8Array(4) : (this.views[index] as Uint8Array);
      const encoded = packed.get(index);
      const stored = encoded?.bytes ?? bytes;
      if (encoded === undefined) {
        Object.assign(json, { buffer: 0, byteOffset: length, byteLength: bytes.length });
      } else {
        const { stride, count, mode } = encoded;
        Object.assign(json, { buffer: 1, byteOffset: unpacked, byteLength: bytes.length });
        const value = { buffer: 0, byteOffset: length, byteLength: stored.length, byteStride: stride, count, mode };
        json['extensions'] = { ...objectOr(json['extensions']), [extension]: value };
        unpacked += Math.ceil(bytes.length / 8) * 8;
      }
      pieces.push(stored, new Uint8Array((8 - (stored.length % 8)) % 8));
      length += Math.ceil(stored.length / 8) * 8;
    }
    // Everything is in the first now. The others stay for what they say of themselves.
    const [first, ...others] = objects(this.tree, 'buffers');
    const { uri: _uri, byteLength: _byteLength, ...said } = first ?? {};
    const buffers: Tree[] = length > 0 ? [{ ...said, byteLength: length }] : [];
    if (length === 0 && Object.keys(said).length + others.length > 0) buffers.push({ ...said, uri: ONE_BYTE, byteLength: 1 });
    if (packed.size > 0) buffers.push({ byteLength: unpacked, extensions: { [extension]: { fallback: true } } });
    buffers.push(...others);
    if (buffers.length > 0) this.tree['buffers'] = buffers;
    else delete this.tree['buffers'];
    if (views.length === 0) delete this.tree['bufferViews'];
    return buildGlb(encodeTree(this.tree), pieces);
  }
}

/** A view as it is stored. */
export interface PackedView {
  readonly bytes: Uint8Array;
  readonly stride: number;
  readonly count: number;
  readonly mode: 'ATTRIBUTES' | 'TRIANGLES' | 'INDICES';
}

/** What stands for 1 in normalised integers. */
const FULL_SCALE: Readonly<Partial<Record<ComponentType, number>>> = { 5120: 127, 5121: 255, 5122: 32767, 5123: 65535 };

function references(list: unknown): Array<readonly [string, number]> {
  return Object.entries(objectOr(list)).flatMap(([semantic, value]) => (uint(value) === undefined ? [] : [[semantic, value as number] as const]));
}

/** Calls `mark` with what stands under one of `keys`, or among `attributes`, anywhere inside of an extension. */
function markInExtensions(
  value: unknown,
  inside: boolean,
  mark: (value: unknown) => void,
  keys: readonly string[] = ['accessor', 'indices', 'input', 'output'],
): void {
  if (Array.isArray(value)) {
    for (const item of value) markInExtensions(item, inside, mark, keys);
  } else if (typeof value === 'object' && value !== null) {
    for (const [key, item] of Object.entries(value)) {
      if (inside && keys.includes(key) && typeof item === 'number') mark(item);
      else if (inside && key === 'attributes' && !keys.includes('bufferView')) Object.values(objectOr(item)).forEach(mark);
      else if (key !== 'extras') markInExtensions(item, inside || key === 'extensions', mark, keys);
    }
  }
}
