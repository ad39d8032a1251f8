// Compressed glTF in, plain glTF out: decoded data go into one more buffer, and the tree is edited to point there.

import { DecimeshError } from '../errors.js';
import type { LoadedFile } from '../files.js';
import { yieldToEvents } from '../platform.js';
import type { Compression } from '../types.js';
import { buildGlb, encodeTree, splitContainer, textOf, type Container } from './container.js';
import { decodeDraco, listDracoJobs, type DracoJob, type DracoResult } from './draco_decode.js';
import { Budget } from './limits.js';
import { decodeMeshopt, listMeshoptJobs, type MeshoptJob } from './meshopt_decode.js';
import { newDracoDecoder } from './modules.js';
import { Buffers } from './resources.js';
import {
  COMPONENT_ARRAYS,
  DRACO_EXTENSION,
  MESHOPT_EXTENSIONS,
  arrayAt,
  componentTypeOf,
  extensionOf,
  forgetExtension,
  objectOr,
  objects,
  removeExtension,
  uint,
  type Tree,
} from './tree.js';

/** Files that the engine can read. */
export interface Decoded {
  readonly files: readonly LoadedFile[];
  /** How the geometry was stored. */
  readonly compression: Compression;
}

/** Between two decoders' calls events get their turn when this has passed, ms. */
const YIELD_MILLISECONDS = 10;

/**
 * `files` with their compressed geometry decoded; as they are if there is none. Loads a decoder only for what needs it.
 *
 * Rejects with a `DecimeshError` that names the file and the JSON path, or with the signal's reason.
 */
export async function decodeFiles(files: readonly LoadedFile[], signal?: AbortSignal): Promise<Decoded> {
  for (const main of files) {
    const container = splitContainer(main.bytes);
    if (container === undefined) continue;
    const tree = compressedTree(container);
    if (tree === undefined) continue;
    try {
      return await new Decoding(tree, container, main, files, signal).run();
    } catch (error) {
      if (!(error instanceof DecimeshError) || main.name === '') throw error;
      // As the engine names places in files.
      const where = error.where === '' ? main.name : `${main.name}: ${error.where}`;
      throw new DecimeshError(error.code, error.message, where, { cause: error.cause });
    }
  }
  return { files, compression: 'none' };
}

/** The tree of a container that uses compression; undefined for others, and for what the engine has to refuse. */
function compressedTree(container: Container): Tree | undefined {
  const text = textOf(container);
  // The text is looked at first: parsing every large file twice would cost more than all else here.
  if (text === undefined || ![...MESHOPT_EXTENSIONS, DRACO_EXTENSION].some((name) => text.includes(name))) return undefined;
  let tree: Tree;
  try {
    tree = objectOr(JSON.parse(text));
  } catch {
    return undefined;
  }
  const isPacked = objects(tree, 'bufferViews').some((view) => MESHOPT_EXTENSIONS.some((name) => extensionOf(view, name)));
  const hasDraco = objects(tree, 'meshes').some((mesh) => objects(mesh, 'primitives').some((json) => extensionOf(json, DRACO_EXTENSION)));
  return isPacked || hasDraco ? tree : undefined;
}

class Decoding {
  readonly #tree: Tree;
  readonly #container: Container;
  readonly #main: LoadedFile;
  readonly #files: readonly LoadedFile[];
  readonly #signal: AbortSignal | undefined;
  /** The new buffer, in pieces. */
  readonly #pieces: Uint8Array[] = [];
  #length = 0;
  #yielded = performance.now();

  constructor(tree: Tree, container: Container, main: LoadedFile, files: readonly LoadedFile[], signal: AbortSignal | undefined) {
    [this.#tree, this.#container, this.#main, this.#files, this.#signal] = [tree, container, main, files, signal];
  }

  async run(): Promise<Decoded> {
    const tree = this.#tree;
    const buffers = new Buffers(tree, this.#container, this.#main, this.#files);
    const budget = new Budget();
    const meshoptJobs = listMeshoptJobs(tree, buffers, budget);
    const dracoJobs = listDracoJobs(tree, buffers, budget);
    const buffer = arrayAt(tree, 'buffers').length;
    for (const job of meshoptJobs) await this.#decodeView(job, buffer);
    // After the views, one of which may hold Draco data, unlikely as that is: their source was taken before.
    if (dracoJobs.length > 0) await this.#decodePrimitives(dracoJobs, buffer);
    const compression: Compression = meshoptJobs.length > 0 ? 'meshopt' : 'draco';
    forgetCompression(tree);
    if (this.#length === 0) return { files: this.#files, compression };
    const name = this.#freeName();
    arrayAt(tree, 'buffers').push({ uri: name, byteLength: this.#length });
    dropUnusedBuffers(tree, buffers);
    const { isBinary, binary } = this.#container;
    const json = encodeTree(tree);
    const bytes = isBinary ? buildGlb(json, binary === undefined ? [] : [binary]) : json;
    const decoded = this.#files.map((file) => (file === this.#main ? { name: file.name, bytes } : file));
    return { files: [...decoded, { name, bytes: this.#gather() }], compression };
  }

  async #decodeView(job: MeshoptJob, buffer: number): Promise<void> {
    await this.#breathe();
    const bytes = await decodeMeshopt(job);
    const view = objectOr(arrayAt(this.#tree, 'bufferViews')[job.view]);
    view['buffer'] = buffer;
    view['byteOffset'] = this.#append(bytes);
    // The view's own stride counts and not the stream's, but they are the same in a valid file.
    for (const name of MESHOPT_EXTENSIONS) removeExtension(view, name);
  }

  async #decodePrimitives(jobs: readonly DracoJob[], buffer: number): Promise<void> {
    const draco = await newDracoDecoder();
    const edit = new DracoEdit(this.#tree, buffer, (bytes) => this.#append(bytes));
    for (const job of jobs) {
      await this.#breathe();
      if (!edit.isDone(job)) edit.apply(job, decodeDraco(draco, job));
    }
  }

  #append(bytes: Uint8Array): number {
    const offset = this.#length;
    // Aligned for every component type.
    const padding = (8 - (bytes.length % 8)) % 8;
    this.#pieces.push(bytes, new Uint8Array(padding));
    this.#length += bytes.length + padding;
    return offset;
  }

  #gather(): Uint8Array {
    const bytes = new Uint8Array(this.#length);
    let offset = 0;
    for (const piece of this.#pieces.splice(0)) {
      bytes.set(piece, offset);
      offset += piece.length;
    }
    return bytes;
  }

  #freeName(): string {
    const taken = new Set(this.#files.map(({ name }) => name.split(/[/\\]/).pop()?.toLowerCase()));
    let name = 'decoded.bin';
    for (let number = 1; taken.has(name); number += 1) name = `decoded-${number}.bin`;
    return name;
  }

  async #breathe(): Promise<void> {
    if (performance.now() - this.#yielded > YIELD_MILLISECONDS) {
      await yieldToEvents();
      this.#yielded = performance.now();
    }
    this.#signal?.throwIfAborted();
  }
}

/** Points primitives, accessors and views to decoded data. */
class DracoEdit {
  readonly #tree: Tree;
  readonly #buffer: number;
  readonly #append: (bytes: Uint8Array) => number;
  /** What an accessor was filled from: a stream's view and an attribute of it. */
  readonly #filled = new Map<number, string>();
  readonly #freeViews = new Set<number>();
  readonly #usedViews = new Set<number>();

  constructor(tree: Tree, buffer: number, append: (bytes: Uint8Array) => number) {
    [this.#tree, this.#buffer, this.#append] = [tree, buffer, append];
  }

  /** Whether an earlier job has filled all of this one's accessors from the same stream, and left nothing to do. */
  isDone({ view, indices, attributes, primitive }: DracoJob): boolean {
    const done = (accessor: number | undefined, source: string): boolean => accessor !== undefined && this.#filled.get(accessor) === source;
    if (!done(indices, `${view}/indices`)) return false;
    if (!attributes.every(({ accessor, id }) => done(accessor, `${view}/${id}`))) return false;
    finish(primitive);
    return true;
  }

  apply(job: DracoJob, { points, indices, attributes }: DracoResult): void {
    const { view, primitive } = job;
    // The stream's own view has no other use now, and taking it keeps its bytes out of the output.
    if (!this.#usedViews.has(view)) this.#freeViews.add(view);
    this.#usedViews.add(view);
    const named = objectOr(primitive['attributes']);
    for (const [index, { semantic, accessor, id, componentType, components }] of job.attributes.entries()) {
      const size = components * COMPONENT_ARRAYS[componentType].BYTES_PER_ELEMENT;
      const rows = padRows(attributes[index] ?? new Uint8Array(), points, size);
      const stride = Math.ceil(size / 4) * 4;
      const target = this.#accessor(accessor, `${view}/${id}`, (json) => {
        json['count'] = points;
        this.#place(json, rows, view, stride === size ? undefined : stride);
      });
      named[semantic] = target;
    }
    // Three bytes of an index do not exist: more than 65535 vertices need four.
    const old = componentTypeOf(objectOr(arrayAt(this.#tree, 'accessors')[job.indices ?? -1])['componentType']);
    const narrow = points <= 0xffff && old !== 5125;
    primitive['indices'] = this.#accessor(job.indices, `${view}/indices`, (json) => {
      const values = narrow ? Uint16Array.from(indices) : indices;
      json['count'] = indices.length;
      json['componentType'] = narrow ? 5123 : 5125;
      json['type'] = 'SCALAR';
      for (const key of ['min', 'max', 'normalized']) delete json[key];
      this.#place(json, new Uint8Array(values.buffer, values.byteOffset, values.byteLength), view, undefined);
    });
    finish(primitive);
  }

  /** Fills the accessor, or a copy of it if another stream has filled it already; returns the number. */
  #accessor(index: number | undefined, source: string, fill: (json: Tree) => void): number {
    const accessors = arrayAt(this.#tree, 'accessors');
    if (index !== undefined && this.#filled.get(index) === source) return index;
    let number = index;
    if (number === undefined || this.#filled.has(number)) {
      const copy = index === undefined ? {} : structuredClone(objectOr(accessors[index]));
      number = accessors.push(copy) - 1;
    }
    this.#filled.set(number, source);
    const json = objectOr(accessors[number]);
    for (const key of ['byteOffset', 'sparse']) delete json[key];
    fill(json);
    return number;
  }

  #place(accessor: Tree, bytes: Uint8Array, preferred: number, stride: number | undefined): void {
    const views = arrayAt(this.#tree, 'bufferViews');
    const number = this.#freeViews.delete(preferred) ? preferred : views.push({}) - 1;
    const view = objectOr(views[number]);
    for (const key of ['byteStride', 'target']) delete view[key];
    view['buffer'] = this.#buffer;
    view['byteOffset'] = this.#append(bytes);
    view['byteLength'] = bytes.length;
    if (stride !== undefined) view['byteStride'] = stride;
    accessor['bufferView'] = number;
  }
}

// What was a strip comes out of Draco as a list.
function finish(primitive: Tree): void {
  removeExtension(primitive, DRACO_EXTENSION);
  if (primitive['mode'] !== undefined) primitive['mode'] = 4;
}

/** Rows of `size` bytes, each padded to a multiple of four, as glTF wants them. */
function padRows(bytes: Uint8Array, count: number, size: number): Uint8Array {
  const stride = Math.ceil(size / 4) * 4;
  if (stride === size) return bytes;
  const rows = new Uint8Array(count * stride);
  for (let row = 0; row < count; row += 1) rows.set(bytes.subarray(row * size, (row + 1) * size), row * stride);
  return rows;
}

/** Takes compression off the lists of extensions where nothing is compressed any more. */
function forgetCompression(tree: Tree): void {
  for (const name of MESHOPT_EXTENSIONS) {
    for (const buffer of objects(tree, 'buffers')) removeExtension(buffer, name);
    forgetExtension(tree, name);
  }
  const left = objects(tree, 'meshes').some((mesh) => objects(mesh, 'primitives').some((json) => extensionOf(json, DRACO_EXTENSION)));
  if (!left) forgetExtension(tree, DRACO_EXTENSION);
}

/**
 * A buffer that only stood in for what is decoded now needs no bytes. Its place in the array stays, for the numbers of
 * those behind it.
 */
function dropUnusedBuffers(tree: Tree, buffers: Buffers): void {
  const used = new Set(objects(tree, 'bufferViews').map(({ buffer }) => uint(buffer)));
  const list = arrayAt(tree, 'buffers');
  for (const [index, value] of list.entries()) {
    const json = objectOr(value);
    if (index === list.length - 1 || used.has(index) || buffers.has(index)) continue;
    delete json['uri'];
    json['byteLength'] = 1;
  }
}
