// Primitives compressed by KHR_draco_mesh_compression as plain arrays.

import { DecimeshError } from '../errors.js';
import { readDracoCounts } from './draco_header.js';
import type { DracoDecoder, DracoDecoderModule, DracoMesh } from './draco_types.js';
import type { Budget } from './limits.js';
import type { Buffers } from './resources.js';
import {
  COMPONENT_ARRAYS,
  DRACO_EXTENSION,
  componentTypeOf,
  componentsOf,
  extensionOf,
  objectOr,
  objects,
  rangeError,
  syntaxError,
  tooLarge,
  uint,
  type ComponentType,
  type Tree,
} from './tree.js';

/** An attribute that is to be decoded into an accessor. */
interface DracoAttributeJob {
  readonly semantic: string;
  readonly id: number;
  readonly accessor: number;
  readonly componentType: ComponentType;
  readonly components: number;
}

/** A primitive that is to be decoded; everything that can be checked before was. */
export interface DracoJob {
  readonly primitive: Tree;
  readonly where: string;
  readonly view: number;
  readonly source: Uint8Array;
  /** The accessor of the indices, if the primitive names one. */
  readonly indices: number | undefined;
  readonly attributes: readonly DracoAttributeJob[];
}

/** What a primitive was decoded to. */
export interface DracoResult {
  readonly points: number;
  readonly indices: Uint32Array;
  /** By job attribute, elements without a gap. */
  readonly attributes: readonly Uint8Array[];
}

/** A triangle has three corners, and a vertex that none uses is no use. */
const MOST_POINTS_PER_FACE = 3;

/** The primitives of `tree` that can only be had through Draco; throws a typed error with the JSON path. */
export function listDracoJobs(tree: Tree, buffers: Buffers, budget: Budget): DracoJob[] {
  const accessors = objects(tree, 'accessors');
  const jobs: DracoJob[] = [];
  for (const [m, mesh] of objects(tree, 'meshes').entries()) {
    for (const [p, primitive] of objects(mesh, 'primitives').entries()) {
      const extension = extensionOf(primitive, DRACO_EXTENSION);
      if (extension === undefined || hasCopy(primitive, accessors, tree, buffers)) continue;
      const place = `meshes[${m}].primitives[${p}]`;
      const job = readJob(tree, primitive, extension, place, accessors, buffers);
      const { faces, points } = readDracoCounts(job.source, job.where);
      const bytesPerPoint = job.attributes.reduce((sum, a) => sum + a.components * COMPONENT_ARRAYS[a.componentType].BYTES_PER_ELEMENT, 0);
      budget.take(12 * faces + points * bytesPerPoint, job.source.length, job.where);
      jobs.push(job);
    }
  }
  return jobs;
}

/** Whether every accessor of the primitive has uncompressed data too, and they are there. */
function hasCopy(primitive: Tree, accessors: readonly Tree[], tree: Tree, buffers: Buffers): boolean {
  const views = objects(tree, 'bufferViews');
  const used = [...Object.values(objectOr(primitive['attributes'])), ...('indices' in primitive ? [primitive['indices']] : [])];
  return used.every((index) => {
    const accessor = accessors[uint(index) ?? -1];
    if (accessor === undefined || accessor['sparse'] !== undefined) return true;
    const view = views[uint(accessor['bufferView']) ?? -1];
    return view !== undefined && buffers.has(uint(view['buffer']) ?? -1);
  });
}

function readJob(
  tree: Tree,
  primitive: Tree,
  extension: Tree,
  place: string,
  accessors: readonly Tree[],
  buffers: Buffers,
): DracoJob {
  const where = `${place}.extensions.${DRACO_EXTENSION}`;
  const { mode = 4 } = primitive;
  if (mode !== 4 && mode !== 5) throw syntaxError(`${place}.mode`, 'only triangles and strips can be Draco-compressed');
  const view = uint(extension['bufferView']);
  const viewJson = view === undefined ? undefined : objects(tree, 'bufferViews')[view];
  if (view === undefined || viewJson === undefined) throw rangeError(`${where}.bufferView`, 'there is no such buffer view');
  const named = objectOr(primitive['attributes']);
  const attributes = Object.entries(objectOr(extension['attributes'])).map(([semantic, value]): DracoAttributeJob => {
    const [id, index] = [uint(value), uint(named[semantic])];
    const accessor = index === undefined ? undefined : accessors[index];
    const at = `${where}.attributes.${semantic}`;
    if (id === undefined || id > 0xffff_ffff) throw syntaxError(at, 'must be the number of a Draco attribute');
    if (index === undefined || accessor === undefined) throw rangeError(at, 'the primitive has no accessor for it');
    const [componentType, components] = [componentTypeOf(accessor['componentType']), componentsOf(accessor)];
    if (componentType === undefined) throw syntaxError(`accessors[${index}].componentType`, 'is not known');
    if (components === undefined || components > 4) throw syntaxError(`accessors[${index}].type`, 'must be a scalar or a vector');
    return { semantic, id, accessor: index, componentType, components };
  });
  const indices = 'indices' in primitive ? uint(primitive['indices']) : undefined;
  if (indices !== undefined && accessors[indices] === undefined) throw rangeError(`${place}.indices`, `there is no accessor ${indices}`);
  const source = buffers.range(viewJson, `bufferViews[${view}]`);
  return { primitive, where, view, source, indices, attributes };
}

/** Decodes one primitive; throws a typed error when the stream is corrupt or is not what the file says. */
export function decodeDraco(draco: DracoDecoderModule, job: DracoJob): DracoResult {
  try {
    return new Decoding(draco, job).run();
  } catch (error) {
    if (error instanceof DecimeshError) throw error;
    // Out of its memory, or a failed assertion.
    throw new DecimeshError('syntax', 'the Draco data are corrupt', job.where, { cause: error });
  }
}

class Decoding {
  readonly #draco: DracoDecoderModule;
  readonly #job: DracoJob;
  readonly #decoder: DracoDecoder;
  readonly #mesh: DracoMesh;

  constructor(draco: DracoDecoderModule, job: DracoJob) {
    [this.#draco, this.#job] = [draco, job];
    this.#decoder = new draco.Decoder();
    this.#mesh = new draco.Mesh();
  }

  // What a failure leaves in Draco's memory goes with the instance, which is not used again then.
  run(): DracoResult {
    const { source, where } = this.#job;
    const bytes = new Int8Array(source.buffer, source.byteOffset, source.byteLength);
    const status = this.#decoder.DecodeArrayToMesh(bytes, bytes.length, this.#mesh);
    if (!status.ok() || this.#mesh.ptr === 0) {
      throw new DecimeshError('syntax', `the Draco data are corrupt: ${status.error_msg()}`, where);
    }
    const faces = this.#mesh.num_faces();
    const points = this.#mesh.num_points();
    if (points > MOST_POINTS_PER_FACE * Math.max(faces, 1)) throw tooLarge(where, `${points} vertices for ${faces} triangles`);
    const indices = this.#triangles(faces);
    for (const index of indices) {
      if (index >= points) throw rangeError(where, `a triangle of the Draco data has vertex ${index} of ${points}`);
    }
    const attributes = this.#job.attributes.map((attribute) => this.#attribute(attribute, points));
    this.#draco.destroy(this.#mesh);
    this.#draco.destroy(this.#decoder);
    return { points, indices, attributes };
  }

  #triangles(faces: number): Uint32Array {
    const length = 12 * faces;
    const bytes = this.#copyOut(length, (pointer) => this.#decoder.GetTrianglesUInt32Array(this.#mesh, length, pointer));
    return new Uint32Array(bytes.buffer);
  }

  #attribute({ semantic, id, componentType, components }: DracoAttributeJob, points: number): Uint8Array {
    const where = `${this.#job.where}.attributes.${semantic}`;
    const attribute = this.#decoder.GetAttributeByUniqueId(this.#mesh, id);
    if (attribute.ptr === 0) throw rangeError(where, `the Draco data have no attribute ${id}`);
    const found = attribute.num_components();
    if (found !== components) throw syntaxError(where, `the Draco data have ${found} components, the accessor ${components}`);
    const { DT_INT8, DT_UINT8, DT_INT16, DT_UINT16, DT_UINT32, DT_FLOAT32 } = this.#draco;
    const types = { 5120: DT_INT8, 5121: DT_UINT8, 5122: DT_INT16, 5123: DT_UINT16, 5125: DT_UINT32, 5126: DT_FLOAT32 };
    const length = points * components * COMPONENT_ARRAYS[componentType].BYTES_PER_ELEMENT;
    return this.#copyOut(length, (pointer) =>
      this.#decoder.GetAttributeDataArrayForAllPoints(this.#mesh, attribute, types[componentType], length, pointer),
    );
  }

  #copyOut(length: number, fill: (pointer: number) => boolean): Uint8Array<ArrayBuffer> {
    const pointer = this.#draco._malloc(length);
    if (!fill(pointer)) throw syntaxError(this.#job.where, 'the Draco data do not fit the accessors');
    // The memory may have moved.
    const bytes = this.#draco.HEAPU8.slice(pointer, pointer + length) as Uint8Array<ArrayBuffer>;
    this.#draco._free(pointer);
    return bytes;
  }
}
