// The accessors of coarser levels: read out of their files, shared with the first where they are the same, or added to it.

import type { Glb } from './codecs/container.js';
import { COMPONENT_ARRAYS, componentTypeOf, componentsOf, sparseRows, type Tree } from './codecs/tree.js';

const ARRAY_BUFFER = 34962;
const ELEMENT_ARRAY_BUFFER = 34963;

/** Vertices of a primitive, all that they have, as whole words side by side. */
export interface Vertices {
  readonly count: number;
  readonly words: Uint32Array;
  /** Words of each vertex. */
  readonly size: number;
  /** What the words are: those of vertices with another layout mean something else. */
  readonly layout: string;
}

/** A file that gets the accessors of coarser levels. */
export class Geometry {
  /** The first level. */
  readonly file: Glb;
  readonly #views: Tree[];
  readonly #accessors: Tree[];
  readonly #parts: Uint8Array[];
  #length: number;
  /** For each level the accessors that were added already. */
  readonly #added = new Map<Glb, Map<number, number>>();

  constructor(file: Glb) {
    this.file = file;
    this.#views = (file.json['bufferViews'] ??= []) as Tree[];
    this.#accessors = (file.json['accessors'] ??= []) as Tree[];
    this.#parts = [file.binary];
    this.#length = file.binary.byteLength;
  }

  /** The primitive of another level with its accessors in this file. */
  importPrimitive(level: Glb, primitive: Tree): Tree {
    const attributes = (set: unknown): Tree =>
      Object.fromEntries(Object.entries(set as Tree).map(([name, index]) => [name, this.#import(level, index as number, ARRAY_BUFFER)]));
    const { indices, targets } = primitive;
    return {
      ...primitive,
      attributes: attributes(primitive['attributes']),
      ...(indices === undefined ? {} : { indices: this.#import(level, indices as number, ELEMENT_ARRAY_BUFFER) }),
      ...(targets === undefined ? {} : { targets: (targets as unknown[]).map(attributes) }),
    };
  }

  /** Adds the indices of another level's primitive, each replaced by what `places` has for it, below `count`. */
  addIndices(level: Glb, accessor: number, places: Uint32Array, count: number): number {
    const json = (level.json['accessors'] as Tree[])[accessor] as Tree;
    const { bytes } = elementsOf(level, json);
    const size = componentSize(json);
    const old = size === 4 ? new Uint32Array(bytes.buffer) : size === 2 ? new Uint16Array(bytes.buffer) : bytes;
    // 65535 itself would mean primitive restart.
    const wide = count > 65535;
    const indices = wide ? new Uint32Array(old.length) : new Uint16Array(old.length);
    for (const [at, index] of old.entries()) indices[at] = places[index] as number;
    const { name } = json;
    const added = { ...(name === undefined ? {} : { name }), componentType: wide ? 5125 : 5123, count: old.length, type: 'SCALAR' };
    return this.#add(added, new Uint8Array(indices.buffer), ELEMENT_ARRAY_BUFFER, 0);
  }

  /** Everything that the vertices of a primitive have; undefined where that cannot be compared. */
  vertices(level: Glb, primitive: Tree): Vertices | undefined {
    const accessors = level.json['accessors'] as Tree[];
    const sets = [primitive['attributes'], ...((primitive['targets'] ?? []) as unknown[])] as Tree[];
    const columns = sets.flatMap((set, index) =>
      Object.entries(set)
        .sort(([a], [b]) => (a < b ? -1 : 1))
        .map(([name, accessor]) => ({ name: `${index}/${name}`, json: accessors[accessor as number] as Tree })),
    );
    const count = columns[0]?.json['count'] as number | undefined;
    if (count === undefined || columns.some(({ json }) => json['count'] !== count)) return undefined;
    const sizes = columns.map(({ json }) => Math.ceil(elementSize(json) / 4));
    const size = sizes.reduce((sum, own) => sum + own, 0);
    const words = new Uint32Array(count * size);
    let offset = 0;
    for (const [column, { json }] of columns.entries()) {
      const { bytes, stride } = elementsOf(level, json, 4);
      const source = new Uint32Array(bytes.buffer);
      const own = sizes[column] as number;
      for (let vertex = 0; vertex < count; vertex += 1) {
        for (let word = 0; word < own; word += 1) {
          words[vertex * size + offset + word] = source[(vertex * stride) / 4 + word] as number;
        }
      }
      offset += own;
    }
    const layout = columns.map(({ name, json }) => `${name} ${String(json['componentType'])} ${String(json['type'])} ${String(json['normalized'] ?? false)}`);
    return { count, words, size, layout: layout.join(',') };
  }

  /** The content of the file's buffer, whose length the tree states now. */
  finish(): Uint8Array[] {
    const buffers = (this.file.json['buffers'] ??= [{}]) as Tree[];
    if (this.#length > 0) (buffers[0] as Tree)['byteLength'] = this.#length;
    return this.#parts;
  }

  #import(level: Glb, accessor: number, target: number): number {
    let added = this.#added.get(level);
    if (added === undefined) this.#added.set(level, (added = new Map()));
    const known = added.get(accessor);
    if (known !== undefined) return known;
    const json = (level.json['accessors'] as Tree[])[accessor] as Tree;
    const index = this.#same(level, accessor) ?? this.#copy(level, json, target);
    added.set(accessor, index);
    return index;
  }

  /** The accessor of this number in the file, if it is the same in both. */
  #same(level: Glb, accessor: number): number | undefined {
    const other = (level.json['accessors'] as Tree[])[accessor] as Tree;
    const own = this.#accessors[accessor];
    const rest = (json: Tree): string => JSON.stringify({ ...json, bufferView: null, byteOffset: null });
    if (own === undefined || rest(own) !== rest(other) || 'sparse' in own || 'sparse' in other) return undefined;
    const [a, b] = [elementsOf(this.file, own).bytes, elementsOf(level, other).bytes];
    return a.every((byte, at) => byte === b[at]) ? accessor : undefined;
  }

  #copy(level: Glb, accessor: Tree, target: number): number {
    const json = { ...accessor };
    delete json['bufferView'];
    delete json['byteOffset'];
    if (accessor['bufferView'] === undefined) {
      // Zeros have no bytes, nor all but a few of them.
      if (accessor['sparse'] !== undefined) json['sparse'] = this.#copySparse(level, accessor);
      this.#accessors.push(json);
      return this.#accessors.length - 1;
    }
    const isVertices = target === ARRAY_BUFFER;
    const { bytes, stride } = elementsOf(level, accessor, isVertices ? 4 : 1);
    return this.#add(json, bytes, target, isVertices ? stride : 0);
  }

  #copySparse(level: Glb, accessor: Tree): Tree {
    const { count, indices, values } = accessor['sparse'] as { count: number; indices: Tree; values: Tree };
    const copy = (part: Tree, size: number): Tree => {
      const start = startOf(level, part);
      return { ...part, bufferView: this.#addView(level.binary.slice(start, start + count * size)), byteOffset: 0 };
    };
    return { count, indices: copy(indices, componentSize(indices)), values: copy(values, elementSize(accessor)) };
  }

  #add(json: Tree, bytes: Uint8Array, target: number, stride: number): number {
    const bufferView = this.#addView(bytes, { ...(stride > 0 ? { byteStride: stride } : {}), target });
    this.#accessors.push({ bufferView, ...json });
    return this.#accessors.length - 1;
  }

  #addView(bytes: Uint8Array, properties: Tree = {}): number {
    const padding = (4 - (this.#length % 4)) % 4;
    if (padding > 0) this.#parts.push(new Uint8Array(padding));
    this.#length += padding;
    this.#views.push({ buffer: 0, byteOffset: this.#length, byteLength: bytes.byteLength, ...properties });
    this.#parts.push(bytes);
    this.#length += bytes.byteLength;
    return this.#views.length - 1;
  }
}

/** Finds vertices of one primitive among those of another, by all that they have. */
export class VertexTable {
  readonly vertices: Vertices;
  /** Numbers of vertices plus one, at their hashes or behind; 0 is free. */
  readonly #slots: Uint32Array;
  /** Where the hash starts: another each time, so that nobody can choose vertices whose hashes are the same. */
  readonly #seed = Math.floor(Math.random() * 2 ** 32);

  constructor(vertices: Vertices) {
    this.vertices = vertices;
    this.#slots = new Uint32Array(2 ** Math.ceil(Math.log2(2 * vertices.count + 2)));
    for (let vertex = 0; vertex < vertices.count; vertex += 1) {
      const slot = this.#slotOf(vertices, vertex);
      if (this.#slots[slot] === 0) this.#slots[slot] = vertex + 1;
    }
  }

  /** For each of `others` the vertex that is the same; undefined unless there is one for each. */
  find(others: Vertices): Uint32Array | undefined {
    if (others.layout !== this.vertices.layout || others.count > this.vertices.count) return undefined;
    const places = new Uint32Array(others.count);
    for (let vertex = 0; vertex < others.count; vertex += 1) {
      const found = this.#slots[this.#slotOf(others, vertex)] as number;
      if (found === 0) return undefined;
      places[vertex] = found - 1;
    }
    return places;
  }

  /** The slot of the same vertex, or the free one where it would be. */
  #slotOf({ words, size }: Vertices, vertex: number): number {
    const start = vertex * size;
    let hash = this.#seed;
    for (let word = start; word < start + size; word += 1) {
      hash = Math.imul(hash ^ (words[word] as number), 0x01000193);
      hash ^= hash >>> 15;
    }
    const own = this.vertices.words;
    for (let slot = hash & (this.#slots.length - 1); ; slot = (slot + 1) & (this.#slots.length - 1)) {
      const there = this.#slots[slot] as number;
      if (there === 0) return slot;
      let same = 0;
      while (same < size && own[(there - 1) * size + same] === words[start + same]) same += 1;
      if (same === size) return slot;
    }
  }
}

function componentSize({ componentType }: Tree): number {
  const known = componentTypeOf(componentType);
  return known === undefined ? 0 : COMPONENT_ARRAYS[known].BYTES_PER_ELEMENT;
}

function elementSize(accessor: Tree): number {
  return componentSize(accessor) * (componentsOf(accessor) ?? 0);
}

/** A copy of the elements of an accessor, each padded to a multiple of `align` bytes. */
function elementsOf(file: Glb, accessor: Tree, align = 1): { bytes: Uint8Array; stride: number } {
  const size = elementSize(accessor);
  const stride = Math.ceil(size / align) * align;
  const count = accessor['count'] as number;
  const bytes = new Uint8Array(count * stride);
  if (accessor['bufferView'] !== undefined) {
    const start = startOf(file, accessor);
    const step = (viewOf(file, accessor)['byteStride'] ?? size) as number;
    if (step === stride) bytes.set(file.binary.subarray(start, start + count * stride - (stride - size)));
    else for (let row = 0; row < count; row += 1) bytes.set(file.binary.subarray(start + row * step, start + row * step + size), row * stride);
  }
  if (accessor['sparse'] !== undefined) {
    const { count: changed, indices, values } = accessor['sparse'] as { count: number; indices: Tree; values: Tree };
    const rows = sparseRows(file.binary, startOf(file, indices), changed, componentSize(indices));
    const start = startOf(file, values);
    for (const [at, row] of rows.entries()) bytes.set(file.binary.subarray(start + at * size, start + (at + 1) * size), row * stride);
  }
  return { bytes, stride };
}

function viewOf({ json }: Glb, { bufferView }: Tree): Tree {
  return (json['bufferViews'] as Tree[])[bufferView as number] as Tree;
}

/** Where what `holder` refers to begins in the binary chunk. */
function startOf(file: Glb, holder: Tree): number {
  return ((viewOf(file, holder)['byteOffset'] ?? 0) as number) + ((holder['byteOffset'] ?? 0) as number);
}
