// Reading a progressive mesh while it arrives.

import { DecimeshError } from '../errors.js';
import type { LevelGeometry } from '../types.js';
import { codeBase, codeDirections, guessDirections } from './base_coder.js';
import { ChunkReader, VERSION, type Chunk } from './container.js';
import { hasDirections, unpackDescription, type Description } from './description.js';
import { Geomorph } from './geomorph.js';
import { geometryOf, wholeGeometry } from './levels.js';
import { IntegerModel } from './numbers.js';
import { RangeDecoder } from './range_coder.js';
import { codeRest, type Rest } from './rest_coder.js';
import { Dependencies, type Region } from './selective.js';
import { SplitCoder } from './split_coder.js';
import { Cursor, SplitLog } from './split_log.js';
import { SplitMesh } from './state.js';

/** How to read. */
export interface ProgressiveReadOptions {
  /** Keeps what {@link ProgressiveMesh.refined} needs, about 60 bytes a vertex more. Default false. */
  readonly selective?: boolean | undefined;
}

/** A level that a progressive mesh has stopped at. */
export interface ProgressiveLevel {
  /** Splits that were done. */
  readonly splits: number;
  readonly triangles: number;
  /** Estimated deviation from the original, model units. */
  readonly error: number;
}

/**
 * A mesh as far as it has arrived. The same object grows with each chunk; what has arrived can be had at any level.
 */
export class ProgressiveMesh {
  /** What the whole mesh will have. */
  readonly description: Description;
  /** The levels at the end of each chunk, the base mesh first. */
  readonly levels: readonly ProgressiveLevel[];
  readonly #mesh: SplitMesh;
  readonly #log: SplitLog;
  readonly #dependencies: Dependencies | undefined;
  readonly #rest: () => Rest | undefined;
  #cursor: Cursor | undefined;

  /** @internal Made by the reader. */
  constructor(description: Description, mesh: SplitMesh, log: SplitLog, levels: readonly ProgressiveLevel[], dependencies: Dependencies | undefined, rest: () => Rest | undefined) {
    this.description = description;
    this.#mesh = mesh;
    this.#log = log;
    this.levels = levels;
    this.#dependencies = dependencies;
    this.#rest = rest;
  }

  /** Splits that have arrived, from 0 to `description.splits`. */
  get splits(): number {
    return this.#log.count;
  }

  /** Triangles of the finest level that has arrived. */
  get triangles(): number {
    return this.complete ? this.description.triangles : this.#log.trianglesAfter(this.#log.count);
  }

  /** Whether everything has arrived. */
  get complete(): boolean {
    return this.#rest() !== undefined;
  }

  /** Estimated deviation of the finest level that has arrived from the original, model units. */
  get error(): number {
    return this.levels.at(-1)?.error ?? 0;
  }

  /**
   * The finest level that has arrived as arrays: once all has, the input's positions, attributes and triangles to the bit,
   * in its order if the file keeps it. With `splits`, the level after so many, without what has no three vertices.
   * Going from one level to another takes time that rises with what is between. Throws `out-of-range`.
   */
  geometry(splits?: number): LevelGeometry {
    const rest = this.#rest();
    if (splits === undefined && rest !== undefined) return wholeGeometry(this.#mesh, this.description, rest);
    const cursor = this.#goTo(splits ?? this.splits);
    return geometryOf(this.#mesh, this.description, { corners: cursor.corners, vertexOf: cursor.vertexOf, triangleCount: this.#log.trianglesAfter(cursor.splits) });
  }

  /** How many splits lead to the level of at most so many triangles, of those that have arrived. */
  splitsFor(triangles: number): number {
    let [low, high] = [0, this.splits];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.#log.trianglesAfter(middle) <= triangles) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /**
   * The way between two levels: the triangles of the finer one, whose vertices come out of those of the coarser. Throws
   * `out-of-range` unless `coarse` ≤ `fine` ≤ {@link splits}.
   */
  geomorph(coarse: number, fine: number): Geomorph {
    this.#check(coarse);
    if (fine < coarse) throw new DecimeshError('out-of-range', 'must not be below coarse', 'fine');
    const { corners, vertexOf } = this.#goTo(fine);
    const log = this.#log;
    const view = { corners, vertexOf, triangleCount: log.trianglesAfter(fine) };
    return new Geomorph(this.#mesh, this.description, view, log.baseVertices + coarse, log.wedgesAfter(coarse));
  }

  /**
   * A mesh that is fine in a region alone: every split whose surroundings are in it, and whose error is above `error`, is
   * done, with those that it depends on. No cracks: it is a level of another order of the same collapses. In time linear
   * in the whole. Throws `wrong-state` unless the mesh was read with `selective`.
   */
  refined(region: Region): LevelGeometry {
    if (this.#dependencies === undefined) throw new DecimeshError('wrong-state', 'read with the option selective', 'refined');
    const view = this.#dependencies.refine(region, this.#mesh, this.#log, this.levels);
    return geometryOf(this.#mesh, this.description, view);
  }

  #goTo(splits: number): Cursor {
    this.#check(splits);
    this.#cursor ??= new Cursor(this.#log);
    this.#cursor.goTo(splits);
    return this.#cursor;
  }

  #check(splits: number): void {
    if (!Number.isInteger(splits) || splits < 0 || splits > this.splits) {
      throw new DecimeshError('out-of-range', `must be from 0 to ${this.splits}, which have arrived`, 'splits');
    }
  }
}

/** Splits between two times that others get their turn. */
const SPLITS_AT_ONCE = 4096;

/** Takes bytes, and says when there is more of the mesh. */
export class ProgressiveDecoder {
  readonly #options: ProgressiveReadOptions;
  readonly #chunks = new ChunkReader();
  readonly #levels: ProgressiveLevel[] = [];
  readonly #integers = new IntegerModel();
  #description: Description | undefined;
  #mesh: SplitMesh | undefined;
  #coder: SplitCoder | undefined;
  #log: SplitLog | undefined;
  #dependencies: Dependencies | undefined;
  #rest: Rest | undefined;
  /** Whether the normals of the base mesh are still to come. */
  #guessed = false;
  #result: ProgressiveMesh | undefined;
  #done = false;

  constructor(options: ProgressiveReadOptions = {}) {
    this.#options = options;
  }

  /** Bytes that were given. */
  get received(): number {
    return this.#chunks.received;
  }

  /** More bytes of the file. */
  push(bytes: Uint8Array): void {
    this.#chunks.push(bytes);
  }

  /**
   * Decodes what has arrived. Each time that the mesh is finer it is given, also within a chunk, so that long ones can be
   * left for a while. Throws a {@link DecimeshError} for damaged content.
   */
  *decode(): Generator<{ readonly mesh: ProgressiveMesh; readonly levelEnds: boolean }, void> {
    for (;;) {
      if (this.#done) {
        if (this.#chunks.hasMore) throw new DecimeshError('syntax', 'there is something behind the end');
        return;
      }
      const chunk = this.#chunks.next();
      if (chunk === undefined) return;
      yield* this.#chunk(chunk);
    }
  }

  /** Throws `truncated` unless the end has arrived. */
  finish(): ProgressiveMesh {
    if (!this.#done || this.#result === undefined) throw new DecimeshError('truncated', 'the file ends before its content does');
    return this.#result;
  }

  *#chunk({ type, payload }: Chunk): Generator<{ readonly mesh: ProgressiveMesh; readonly levelEnds: boolean }, void> {
    if (type === 'HEAD') {
      if (this.#description !== undefined) throw misplaced(type);
      this.#description = readHeader(payload);
      return;
    }
    const description = this.#description;
    if (description === undefined) throw misplaced(type);
    if (type === 'BASE') {
      if (this.#result !== undefined) throw misplaced(type);
      yield { mesh: this.#base(description, payload), levelEnds: true };
      return;
    }
    const [mesh, log, coder, result] = [this.#mesh, this.#log, this.#coder, this.#result];
    if (mesh === undefined || log === undefined || coder === undefined || result === undefined) throw misplaced(type);
    if (type === 'NORM' ? !this.#guessed : this.#guessed) throw misplaced(type);
    if (type === 'NORM') {
      codeDirections(new RangeDecoder(payload), mesh, coder.values);
      this.#guessed = false;
      yield { mesh: result, levelEnds: true };
    } else if (type === 'SPLT') {
      if (this.#rest !== undefined) throw misplaced(type);
      yield* this.#splits(description, payload, mesh, log, coder, result);
      this.#levels.push({ splits: log.count, triangles: mesh.triangleCount, error: errorOf(payload) });
      yield { mesh: result, levelEnds: true };
    } else if (type === 'REST') {
      if (this.#rest !== undefined) throw misplaced(type);
      if (log.count !== description.splits) throw new DecimeshError('syntax', 'the counts are not those of the header', 'splits');
      this.#rest = codeRest(new RangeDecoder(payload), mesh, description, coder.values);
      yield { mesh: result, levelEnds: true };
    } else {
      if (this.#rest === undefined) throw misplaced(type);
      this.#done = true;
    }
  }

  #base(description: Description, payload: Uint8Array): ProgressiveMesh {
    const mesh = (this.#mesh = new SplitMesh(description));
    this.#coder = new SplitCoder(description);
    codeBase(new RangeDecoder(payload.subarray(4)), mesh, description, this.#coder.values);
    this.#guessed = hasDirections(description);
    if (this.#guessed) guessDirections(mesh, description);
    const log = (this.#log = new SplitLog(mesh));
    if (this.#options.selective === true) this.#dependencies = new Dependencies(mesh.vertexCount);
    this.#levels.push({ splits: 0, triangles: mesh.triangleCount, error: errorOf(payload) });
    this.#result = new ProgressiveMesh(description, mesh, log, this.#levels, this.#dependencies, () => this.#rest);
    return this.#result;
  }

  *#splits(
    description: Description,
    payload: Uint8Array,
    mesh: SplitMesh,
    log: SplitLog,
    coder: SplitCoder,
    result: ProgressiveMesh,
  ): Generator<{ readonly mesh: ProgressiveMesh; readonly levelEnds: boolean }, void> {
    const decoder = new RangeDecoder(payload.subarray(4));
    const generations = this.#integers.unsigned(decoder, 0, 0);
    let left = SPLITS_AT_ONCE;
    for (let generation = 0; generation < generations; generation += 1) {
      const count = this.#integers.unsigned(decoder, 1, 0);
      if (count === 0 || log.count + count > description.splits) {
        throw new DecimeshError('syntax', 'the counts are not those of the header', 'splits');
      }
      let last = -1;
      for (let k = 0; k < count; k += 1) {
        last += 1 + this.#integers.unsigned(decoder, 2, 0);
        if (last >= mesh.vertexCount) throw new DecimeshError('out-of-range', `there is no vertex ${last}`, 'splits');
        const effect = coder.code(decoder, mesh, last);
        this.#dependencies?.push(coder.ring, effect, mesh, log.count);
        log.push(mesh, effect);
        left -= 1;
        if (left === 0) {
          left = SPLITS_AT_ONCE;
          yield { mesh: result, levelEnds: false };
        }
      }
    }
  }
}

function misplaced(type: string): DecimeshError {
  return new DecimeshError('syntax', `the chunk ${type} is out of place`);
}

function errorOf(payload: Uint8Array): number {
  if (payload.length < 4) throw new DecimeshError('truncated', 'a chunk ends before its content does');
  const error = new DataView(payload.buffer, payload.byteOffset).getFloat32(0, true);
  if (!(error >= 0 && error < Infinity)) throw new DecimeshError('not-finite', 'an error is infinite or none');
  return error;
}

function readHeader(payload: Uint8Array): Description {
  let header: unknown;
  try {
    header = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(payload));
  } catch (error) {
    throw new DecimeshError('syntax', 'is not JSON', 'header', { cause: error });
  }
  const version = typeof header === 'object' && header !== null ? (header as { version?: unknown }).version : undefined;
  if (typeof version !== 'number') throw new DecimeshError('syntax', 'is missing or of the wrong type', 'version');
  if (version !== VERSION) throw new DecimeshError('unsupported', `this is version ${version} of the format, known is ${VERSION}`, 'version');
  return unpackDescription(header);
}
