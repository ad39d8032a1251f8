// Buffer views compressed by EXT_meshopt_compression, or its successor of KHR, as plain ones.

import { DecimeshError } from '../errors.js';
import type { Budget } from './limits.js';
import { meshoptDecoder } from './modules.js';
import type { Buffers } from './resources.js';
import { MESHOPT_EXTENSIONS, extensionOf, objects, rangeError, syntaxError, uint, type Tree } from './tree.js';

/** A view that is to be decoded; everything that can be checked was. */
export interface MeshoptJob {
  readonly view: number;
  readonly where: string;
  readonly source: Uint8Array;
  readonly count: number;
  readonly stride: number;
  readonly mode: string;
  readonly filter: string;
}

const FILTERS: readonly unknown[] = ['NONE', 'OCTAHEDRAL', 'QUATERNION', 'EXPONENTIAL', 'COLOR'];

/** The views of `tree` that are compressed; throws a typed error with the JSON path. */
export function listMeshoptJobs(tree: Tree, buffers: Buffers, budget: Budget): MeshoptJob[] {
  const jobs: MeshoptJob[] = [];
  for (const [view, json] of objects(tree, 'bufferViews').entries()) {
    const name = MESHOPT_EXTENSIONS.find((extension) => extensionOf(json, extension) !== undefined);
    if (name === undefined) continue;
    const where = `bufferViews[${view}].extensions.${name}`;
    const job = readJob(extensionOf(json, name) ?? {}, view, where, buffers);
    budget.take(job.count * job.stride, job.source.length, where);
    const stated = uint(json['byteLength']);
    if (stated !== undefined && stated > job.count * job.stride) {
      throw rangeError(`bufferViews[${view}].byteLength`, `${stated} bytes, but the data unpack to ${job.count * job.stride}`);
    }
    jobs.push(job);
  }
  return jobs;
}

function readJob(extension: Tree, view: number, where: string, buffers: Buffers): MeshoptJob {
  const { mode, filter = 'NONE' } = extension;
  const [count, stride] = [uint(extension['count']), uint(extension['byteStride'])];
  if (count === undefined || count > 0xffff_ffff) throw syntaxError(`${where}.count`, 'must be an integer from 0 to 2³²-1');
  const strideFits = (fits: (stride: number) => boolean, wanted: string): number => {
    if (stride === undefined || !fits(stride)) throw syntaxError(`${where}.byteStride`, `must be ${wanted}`);
    return stride;
  };
  if (!FILTERS.includes(filter)) throw syntaxError(`${where}.filter`, `${JSON.stringify(filter)} is not known`);
  if (filter !== 'NONE' && mode !== 'ATTRIBUTES') throw syntaxError(`${where}.filter`, 'is for attributes only');
  const source = buffers.range(extension, where);
  // What the codecs cannot do without: a header, and for the indices a byte each or for every triangle.
  const least = mode === 'TRIANGLES' ? 17 + count / 3 : mode === 'INDICES' ? 5 + count : 1;
  if (count > 0 && source.length < least) {
    throw new DecimeshError('truncated', `${source.length} bytes cannot hold ${count} elements`, where);
  }
  const job = { view, where, source, count, filter: filter as string };
  switch (mode) {
    case 'ATTRIBUTES': {
      const wanted = filter === 'NONE' ? 'a multiple of 4 from 4 to 256' : 'what its filter works on';
      const fits = (value: number): boolean => {
        if (filter === 'OCTAHEDRAL' || filter === 'COLOR') return value === 4 || value === 8;
        return filter === 'QUATERNION' ? value === 8 : value >= 4 && value <= 256 && value % 4 === 0;
      };
      return { ...job, mode, stride: strideFits(fits, wanted) };
    }
    case 'TRIANGLES':
      if (count % 3 !== 0) throw syntaxError(`${where}.count`, 'must be a multiple of 3 for triangles');
      return { ...job, mode, stride: strideFits((value) => value === 2 || value === 4, '2 or 4') };
    case 'INDICES':
      return { ...job, mode, stride: strideFits((value) => value === 2 || value === 4, '2 or 4') };
    default:
      throw syntaxError(`${where}.mode`, `${JSON.stringify(mode)} is not known`);
  }
}

/** Decodes one view; throws `syntax` when the stream is corrupt. */
export async function decodeMeshopt({ source, count, stride, mode, filter, where }: MeshoptJob): Promise<Uint8Array> {
  const decoder = await meshoptDecoder();
  const target = new Uint8Array(count * stride);
  if (count === 0) return target;
  try {
    decoder.decodeGltfBuffer(target, count, stride, source, mode, filter);
  } catch (error) {
    throw new DecimeshError('syntax', 'the meshopt data are corrupt', where, { cause: error });
  }
  return target;
}
