// A document: a whole file in the engine, simplified in steps, looked at and written at any level.

import { findWithin } from './bounded.js';
import { unpackArchives } from './codecs/archive.js';
import { decodeFiles, type Decoded } from './codecs/decode.js';
import { encodeGlb, type EncodedFiles, type Encoding } from './codecs/encode.js';
import { DecimeshError, invalidArgument } from './errors.js';
import { EngineObject, callEngine, init } from './engine.js';
import { COMPRESSIONS, OUTPUT_FORMATS, holdsEncodings, isCompression, isOutputFormat, usualFormat } from './formats.js';
import { listFiles, loadFiles, type LoadedFile } from './files.js';
import {
  DOCUMENT_SIMPLIFY_NAMES,
  RUN_NAMES,
  checkMeasureOptions,
  checkNames,
  checkProgressiveOptions,
  checkProtection,
  checkSignal,
  hasTarget,
  resolveMaximumDeviation,
  resolveRequest,
  resolveTargets,
  type SimplifyRequest,
} from './options.js';
import { packLods } from './lods.js';
import { checkPrepareOptions } from './prepare/options.js';
import { partsOf, partsSource, type Parts, type PartsSource } from './parts.js';
import { makeReport, type Deviation, type DeviationMap, type Report, type ReportedLod } from './report.js';
import { isProgressive } from './progressive/container.js';
import type { ProgressiveOptions } from './progressive/encode.js';
import type { ProgressiveSource } from './progressive/source.js';
import { Turn, runInSteps } from './run.js';
import { screenCoverages } from './screen.js';
import { findSize } from './size.js';
import type {
  DocumentInput,
  DocumentSimplifyOptions,
  DocumentSummary,
  LevelGeometry,
  LevelSummary,
  LevelTargets,
  LodSwitch,
  MeasureOptions,
  OutputFormat,
  RunOptions,
  Warning,
  WriteOptions,
} from './types.js';
import type { Model } from './wasm/decimesh.js';

/** A level as the bytes of files, and where the document stood when it was taken. */
interface EncodedLevel extends EncodedFiles {
  readonly losses: readonly Warning[];
  readonly state: {
    readonly level: LevelSummary | undefined;
    readonly timings: { readonly read: number; readonly simplify: number };
    readonly measured: { readonly deviation: Deviation; readonly milliseconds: number } | undefined;
  };
}

/** A written file with the report on it. */
export interface Written {
  readonly bytes: Uint8Array<ArrayBuffer>;
  /** What a `.gltf` refers to, under the names by which it does; empty for other formats. */
  readonly files: ReadonlyArray<{ readonly name: string; readonly bytes: Uint8Array<ArrayBuffer> }>;
  /** `path`s are null; the output's size is that of all files. */
  readonly report: Report;
}

/**
 * Opens a model: glTF (.glb, .gltf with its files), OBJ (with its .mtl and textures), PLY, STL, OFF or SMF, told by
 * their content; or a .zip of these. Loads the engine if that is still to be done.
 *
 * Rejects with a {@link DecimeshError} naming the place in the file, or with the signal's reason.
 */
export async function openDocument(input: DocumentInput, options: { signal?: AbortSignal } = {}): Promise<Document> {
  checkNames(options, ['signal']);
  checkSignal(options.signal);
  options.signal?.throwIfAborted();
  const files = await loadFiles(listFiles(input));
  options.signal?.throwIfAborted();
  await init();
  options.signal?.throwIfAborted();
  return openFiles(files, options.signal);
}

/** Opens files that are in memory; needs the engine to be loaded. Rejects as {@link openDocument} does. */
export async function openFiles(files: readonly LoadedFile[], signal?: AbortSignal): Promise<Document> {
  const start = performance.now();
  const unpacked = await unpackProgressive(await unpackArchives(files, signal));
  const decoded = await decodeFiles(unpacked, signal);
  signal?.throwIfAborted();
  const bytes = files.reduce((sum, file) => sum + file.bytes.byteLength, 0);
  return openDecoded(decoded, unpacked, bytes, start);
}

/** A progressive mesh at full detail is a GLB. */
async function unpackProgressive(files: readonly LoadedFile[]): Promise<readonly LoadedFile[]> {
  if (!files.some(({ bytes }) => isProgressive(bytes))) return files;
  const [{ decodeProgressive }, { progressiveToGlb }] = await Promise.all([import('./progressive.js'), import('./progressive/to_glb.js')]);
  return files.map((file) => {
    if (!isProgressive(file.bytes)) return file;
    const mesh = decodeProgressive(file.bytes);
    return { ...file, bytes: progressiveToGlb(mesh.description, mesh.geometry()) };
  });
}

function openDecoded({ files, compression }: Decoded, given: readonly LoadedFile[], bytes: number, start: number): Document {
  const model = new EngineObject('document', (engine) =>
    engine.Model.open(
      files.map(({ name }) => name),
      files.map(({ bytes }) => bytes),
    ),
  );
  const found = JSON.parse(model.call((object) => object.summary())) as Omit<DocumentSummary, 'compression'>;
  // What was given counts, not what was decoded from it.
  const summary: DocumentSummary = { ...found, bytes, compression };
  return new Document(model, summary, performance.now() - start, partsSource(given, summary.format));
}

/**
 * The addresses of files that a model names beside itself, as it names them: buffers and images of a glTF, material
 * libraries of an OBJ, the texture of a PLY; and the images that such a library (.mtl) names, relative to it. Empty for
 * other content.
 *
 * Needs the engine to be loaded. Never fails on bad content: opening it will say what is wrong.
 */
export function externalFiles(bytes: Uint8Array): string[] {
  return JSON.parse(callEngine((engine) => engine.externalFiles(bytes))) as string[];
}

/** Of a limit for the measured deviation, what is kept for places between the samples. */
const BETWEEN_SAMPLES = 0.04;

/** Samples on each side while a level within a limit is searched for, and for the one that is found. */
const SEARCH_SAMPLES = 200_000;
const FINAL_SAMPLES = 1_000_000;

/** A chain of more levels than there are octaves of triangles is a mistake. */
const MOST_LODS = 32;

/** Long work that the engine does in steps. */
interface EngineRun {
  begin(model: Model): void;
  /** Returns the share that is done. */
  step(model: Model, work: number): number;
  /** Drops what is half done. */
  cancel(model: Model): void;
  /** Ends it when so many milliseconds are spent, keeping what is done. */
  readonly limit?: { readonly milliseconds: number | undefined; stop(model: Model): void };
}

/**
 * An opened file. It holds memory of the engine until {@link Document.dispose}.
 *
 * Calls on a disposed document, or one lost in a restart of the engine, fail with `disposed`.
 */
export class Document {
  /** What the file holds at full detail. */
  readonly summary: DocumentSummary;
  readonly #model: EngineObject<Model>;
  readonly #timings: { read: number; simplify: number };
  /** What the input was made of; sorted when a report wants it. */
  #source: PartsSource | Parts;
  readonly #simplifying = new Turn('simplify');
  readonly #measuring = new Turn('measure');
  #level: LevelSummary | undefined;
  /** Whether the selected level is of the record, and not of a run beside it. */
  #recorded = true;
  /** Whether the engine knows where skins move the vertices. */
  #posed = false;
  /** Grows with every other level that is selected. */
  #levelNumber = 0;
  /** Of the selected level, and nothing once another is selected. */
  #measured: { readonly deviation: Deviation; readonly milliseconds: number } | undefined;

  /** @internal Use {@link openDocument}. */
  constructor(model: EngineObject<Model>, summary: DocumentSummary, readMilliseconds: number, source: PartsSource) {
    this.#model = model;
    this.#source = source;
    this.summary = summary;
    this.#timings = { read: readMilliseconds, simplify: 0 };
  }

  /**
   * Simplifies and selects the level that the targets ask for. Without a target all levels there are get recorded for
   * {@link level}, and full detail is selected. With one, that level is the best there is, and those before it are at
   * hand but rough, unless `everyLevel` asks for them too.
   *
   * Always starts from the file's own triangles, not from the selected level. While it runs, the former levels can be
   * used. Rejects with `invalid-argument` naming the option; with `wrong-state` while another run is under way that
   * has not been aborted; with the signal's reason within 100 ms of an abort, and then the former level is still
   * selected.
   */
  async simplify(options: DocumentSimplifyOptions & RunOptions = {}): Promise<LevelSummary> {
    checkNames(options, [...DOCUMENT_SIMPLIFY_NAMES, ...RUN_NAMES]);
    if (options.maximumDeviation !== undefined) return this.#simplifyWithin(options);
    const request: SimplifyRequest = { everyLevel: !hasTarget(options), ...resolveRequest(options, this.summary) };
    // Where every level counts, others will be asked for, and are to be there at once.
    request.indexLevels = request.everyLevel === true && request.keepLevels !== true;
    const { weights, locked } = options;
    checkProtection(options, this.summary.wedgeSets.reduce((sum, { vertices }) => sum + vertices, 0));
    if (weights !== undefined && options.weightAttribute !== undefined) throw invalidArgument('weights', 'leave out weightAttribute');
    this.#model.check();
    return this.#simplifying.take(options.signal, async () => {
      const start = performance.now();
      await this.#findPoses(options.signal);
      await this.#runInEngine(options, {
        begin: (model) => {
          model.setProtection(weights ?? new Float32Array(), locked ?? new Uint8Array());
          model.beginSimplify(JSON.stringify(request));
        },
        step: (model, work) => model.step(work),
        cancel: (model) => model.cancelSimplify(),
        limit: { milliseconds: options.timeBudget, stop: (model) => model.stopSimplify() },
      });
      this.#timings.simplify = performance.now() - start;
      // The same count as before may be another level now.
      this.#forgetLevel();
      const { triangles, error } = request;
      this.#recorded = request.keepLevels !== true;
      const level = this.#take((model) => model.selectResult(triangles, error));
      options.onProgress?.(1);
      return level;
    });
  }

  /** As {@link simplify} with `maximumDeviation`; after an abort or a failure full detail is selected. */
  async #simplifyWithin({ maximumDeviation, ...options }: DocumentSimplifyOptions & RunOptions): Promise<LevelSummary> {
    const limit = resolveMaximumDeviation({ maximumDeviation, ...options }, this.summary);
    const { onProgress, signal } = options;
    // Of the measurements it is not known how many there will be: each is an eighth of what is left.
    let done = 0;
    const within = (share: number, fraction: number): void => {
      const now = done + (1 - done) * share * fraction;
      if (fraction === 1) done = now;
      if (now < 1) onProgress?.(now);
    };
    const recorded = await this.simplify({ ...options, everyLevel: true, onProgress: (fraction) => within(0.3, fraction) });
    // Without a target the run selects full detail.
    const coarsest = hasTarget(options) ? recorded : await this.level({ triangles: 0 });
    const safe = limit * (1 - BETWEEN_SAMPLES);
    const measured = async (triangles: number, samples: number): Promise<{ triangles: number; max: number }> => {
      const level = await this.level({ triangles }, { signal });
      const { max } = await this.measure({ samples, signal, onProgress: (fraction) => within(1 / 8, fraction) });
      return { triangles: level.triangles, max };
    };
    try {
      const { triangles: most } = this.summary;
      const guess = await this.level({ error: safe / 2 }, { signal });
      const range = { least: Math.min(coarsest.triangles, most), most, start: guess.triangles };
      let triangles = await findWithin(safe, range, (wanted) => measured(wanted, SEARCH_SAMPLES));
      // With more samples the maximum may be a little more.
      while (triangles < most && (await measured(triangles, FINAL_SAMPLES)).max > safe) triangles = Math.min(most, Math.ceil(triangles * 1.02) + 1);
      const level = await this.level(triangles >= most ? {} : { triangles });
      onProgress?.(1);
      if (level.triangles <= coarsest.triangles) return (this.#level = { ...level, stopReason: coarsest.stopReason, blockers: coarsest.blockers });
      return (this.#level = { ...level, stopReason: 'error' });
    } catch (error) {
      if (!(error instanceof DecimeshError && error.code === 'disposed')) await this.level({});
      throw error;
    }
  }

  /**
   * Measures how far the selected level is from the original, both ways, by sampling; the report of {@link write} has
   * the result as long as that level is selected.
   *
   * The level is the one selected at the call; the document can be used while it runs. Rejects as {@link simplify} does.
   */
  async measure(options: MeasureOptions & RunOptions = {}): Promise<Deviation> {
    return (await this.#measure(options, false)).deviation;
  }

  /**
   * As {@link measure}, and how far each vertex of the selected level is from the original, for a heat map; the order is
   * that of {@link geometry}. It takes as long.
   */
  async deviationMap(options: MeasureOptions & RunOptions = {}): Promise<DeviationMap> {
    const { deviation, map, mapLengths } = await this.#measure(options, true);
    const half = map.length / 2;
    let start = 0;
    const wedgeSets = mapLengths.map((length) => {
      const [from, to] = [start, (start += length)];
      return { distances: map.slice(from, to), surroundings: map.slice(half + from, half + to) };
    });
    return { deviation, wedgeSets };
  }

  async #measure(
    options: MeasureOptions & RunOptions,
    wantsMap: boolean,
  ): Promise<{ deviation: Deviation; map: Float32Array; mapLengths: readonly number[] }> {
    checkMeasureOptions(options);
    this.#model.check();
    return this.#measuring.take(options.signal, async () => {
      const [start, level] = [performance.now(), this.#levelNumber];
      await this.#runInEngine(options, {
        begin: (model) => model.beginMeasure(options.samples, wantsMap),
        step: (model, work) => model.stepMeasure(work),
        cancel: (model) => model.cancelMeasure(),
      });
      type Taken = Deviation & { readonly mapLengths?: readonly number[] };
      const { mapLengths = [], ...deviation } = JSON.parse(this.#model.call((model) => model.takeDeviation())) as Taken;
      const map = this.#model.call((model) => model.takeMap());
      if (this.#levelNumber === level) this.#measured = { deviation, milliseconds: performance.now() - start };
      options.onProgress?.(1);
      return { deviation, map, mapLengths };
    });
  }

  /** Before the first run, and while the document is at full detail. */
  async #findPoses(signal: AbortSignal | undefined): Promise<void> {
    if (this.#posed) return;
    const isGltf = this.summary.format === 'glb' || this.summary.format === 'gltf';
    if (isGltf && this.summary.wedgeSets.some(({ attributes }) => attributes.some(({ name }) => name === 'JOINTS_0'))) {
      try {
        await (await import('./poses/poses.js')).addPoses(this.#model, this.summary, signal);
      } catch (error) {
        if (signal?.aborted || (error instanceof DecimeshError && error.code === 'disposed')) throw error;
        // A file too large to be looked at in this way, say, is simplified all the same.
      }
    }
    this.#posed = true;
  }

  async #runInEngine({ signal, onProgress }: RunOptions, run: EngineRun): Promise<void> {
    this.#model.call(run.begin);
    const { limit } = run;
    try {
      await runInSteps(
        (work) => this.#model.call((model) => run.step(model, work)),
        {
          signal,
          // The last report comes when the result is there to be used.
          onProgress: (fraction) => fraction < 1 && onProgress?.(fraction),
        },
        limit && { milliseconds: limit.milliseconds, stop: () => this.#model.call((model) => limit.stop(model)) },
      );
    } catch (error) {
      this.#forgetRun(run);
      throw error;
    }
  }

  // Drops what the engine has half done, unless the document itself is gone.
  #forgetRun({ cancel }: EngineRun): void {
    try {
      this.#model.call(cancel);
    } catch (error) {
      if (!(error instanceof DecimeshError && error.code === 'disposed')) throw error;
    }
  }

  /**
   * Selects a level of the last simplification, without simplifying again: at most so many triangles, or an error not
   * above the given one, in model units or pixels, or full detail for `{}`. Beyond the last recorded level it gives
   * that one. The first level that is neither full detail nor the last takes longer if the run was to one target.
   *
   * Rejects with `wrong-state` before the first simplification, and with the signal's reason.
   */
  async level(targets: LevelTargets, options: RunOptions = {}): Promise<LevelSummary> {
    checkNames(options, RUN_NAMES);
    checkSignal(options.signal);
    const { triangles, error } = resolveTargets(targets, this.summary);
    if (!this.#model.call((model) => model.levelAtHand(triangles, error))) {
      await runInSteps((work) => this.#model.call((model) => model.prepareLevels(work)), options);
    }
    if (!this.#recorded) this.#forgetLevel();
    this.#recorded = true;
    return this.#take((model) => model.selectLevel(triangles, error));
  }

  #take(select: (model: Model) => string): LevelSummary {
    const level = JSON.parse(this.#model.call(select)) as LevelSummary;
    // Of one record there is one level for each count.
    if (level.triangles !== this.#level?.triangles) this.#forgetLevel();
    this.#level = level;
    return level;
  }

  #forgetLevel(): void {
    this.#level = undefined;
    this.#levelNumber += 1;
    this.#measured = undefined;
  }

  /** The selected level as arrays; full detail before the first simplification. The arrays are the caller's own. */
  async geometry(): Promise<LevelGeometry> {
    const { groups, wedgeSets } = this.summary;
    return {
      groups: groups.map(({ mesh, primitive, wedgeSet }, index) => ({
        mesh,
        primitive,
        wedgeSet,
        indices: this.#model.call((model) => model.levelIndices(index)),
      })),
      wedgeSets: wedgeSets.map(({ attributes }, set) => ({
        positions: this.#model.call((model) => model.levelPositions(set)),
        attributes: Object.fromEntries(
          attributes.map(({ name, components }, index) => [
            name,
            { components, values: this.#model.call((model) => model.levelAttribute(set, index)) },
          ]),
        ),
      })),
    };
  }

  /**
   * Writes the selected level, full detail before the first simplification; with `size` the largest recorded level that
   * fits, with `lods` a chain of them. The level written, of a chain the first, is the selected one afterwards.
   *
   * Rejects with `invalid-argument` for an unknown format, for an encoding that the format does not have, for `lods` in
   * another format than GLB, and for `size` beside `lods`; with `wrong-state` for `size` and `lods` before the first
   * simplification.
   */
  async write(options: WriteOptions = {}): Promise<Written> {
    const { format, name, ...encoding } = checkWriteOptions(options, this.summary);
    const gltfName = format === 'gltf' ? name : undefined;
    const start = performance.now();
    const chain = options.lods && (await this.#writeChain(options.lods, options.lodSwitch, encoding, gltfName));
    const encoded =
      chain?.encoded ??
      (options.size === undefined
        ? await this.#encode(format, encoding, gltfName)
        : await this.#writeWithin(options.size, format, encoding, gltfName));
    const { bytes, files, warnings, dropped, losses, state } = encoded;
    const { deviation, milliseconds: measure = 0 } = state.measured ?? {};
    const timings = { ...state.timings, write: performance.now() - start, measure };
    const size = sizeOf(encoded);
    const told = [...losses, ...warnings];
    if (options.size !== undefined && size > options.size) {
      told.push({ code: 'size-not-reached', message: `the smallest recorded level takes ${size} bytes`, where: '' });
    }
    const made = partsOf(partsSource([{ name: `output.${format}`, bytes }, ...files], format));
    if ('files' in this.#source) this.#source = partsOf(this.#source);
    const { level } = state;
    const output = { format, bytes: size, parts: made, triangles: (level?.triangles ?? this.summary.triangles) - dropped };
    const report = { summary: this.summary, level, deviation, output, parts: this.#source, timings, losses: told, lods: chain?.lods };
    return { bytes, files, report: makeReport(report) };
  }

  /** The selected level as the bytes of a file. Everything that is written comes from here. */
  async #encode(format: OutputFormat, encoding: Encoding, gltfName: string | undefined): Promise<EncodedLevel> {
    // The engine knows glTF in one file, and the text is made of that.
    const engineFormat = format === 'gltf' ? 'glb' : format;
    const written = this.#model.call((model) => model.write(engineFormat)) as Uint8Array<ArrayBuffer>;
    return this.#encodeWritten(written, format, encoding, gltfName);
  }

  async #encodeWritten(
    written: Uint8Array<ArrayBuffer>,
    format: OutputFormat,
    encoding: Encoding,
    gltfName: string | undefined,
  ): Promise<EncodedLevel> {
    const losses = JSON.parse(this.#model.call((model) => model.losses(format === 'gltf' ? 'glb' : format))) as Warning[];
    // Another level may be selected while this one is encoded.
    const state = { level: this.#level, timings: { ...this.#timings }, measured: this.#measured };
    const encoded = holdsEncodings(format)
      ? await encodeGlb(written, encoding, gltfName)
      : { bytes: written, files: [], warnings: [], dropped: 0 };
    return { ...encoded, losses, state };
  }

  async #writeWithin(
    limit: number,
    format: OutputFormat,
    encoding: Encoding,
    gltfName: string | undefined,
  ): Promise<EncodedLevel> {
    const { triangles: most, wedgeSets } = this.summary;
    // Numbers of four bytes for every vertex, and half of the indices in two.
    const vertexBytes = wedgeSets.map(({ vertices, attributes }) =>
      attributes.reduce((sum, { components }) => sum + 4 * components, 12) * vertices);
    const bytesPerTriangle = vertexBytes.reduce((sum, bytes) => sum + bytes, 0) / most + 9;
    const { triangles: least } = await this.level({ triangles: 0 });
    const found = await findSize(limit, { least, most, bytesPerTriangle }, async (wanted) => {
      // As far as it goes, and not to what that came to: the stop reason tells.
      const { triangles } = await this.level(wanted >= most ? {} : { triangles: wanted <= least ? 0 : wanted });
      const output = await this.#encode(format, encoding, gltfName);
      return { triangles, bytes: sizeOf(output), output };
    });
    // The last one that was tried need not be the one that fits.
    await this.level({ triangles: found.bytes > limit ? 0 : found.triangles });
    return found.output;
  }

  async #writeChain(
    wanted: NonNullable<WriteOptions['lods']>,
    lodSwitch: LodSwitch | undefined,
    encoding: Encoding,
    gltfName: string | undefined,
  ): Promise<{ encoded: EncodedLevel; lods: ReportedLod[] }> {
    const targets = wanted.map((target) => (typeof target === 'number' ? { ratio: target } : target));
    const levels = new Map<number, { level: LevelSummary; targets: LevelTargets }>();
    for (const target of targets) {
      const level = await this.level(target);
      // What the constraints do not allow is the same level once more.
      if (!levels.has(level.triangles)) levels.set(level.triangles, { level, targets: target });
    }
    const chain = [...levels.values()].sort((a, b) => b.level.triangles - a.level.triangles);
    const coverages = screenCoverages(chain.map(({ level }) => level.estimatedError), this.summary.diagonal, lodSwitch);
    const files: Uint8Array<ArrayBuffer>[] = [];
    // The first one last: it stays selected.
    for (const { targets: target } of [...chain].reverse()) {
      await this.level(target);
      files.unshift(this.#model.call((model) => model.write('glb')) as Uint8Array<ArrayBuffer>);
    }
    const lods = chain.map(({ level }, index) => ({
      triangles: level.triangles,
      vertices: level.vertices,
      estimatedError: level.estimatedError,
      screenCoverage: coverages[index] as number,
    }));
    return { encoded: await this.#encodeWritten(packLods(files, coverages), 'glb', encoding, gltfName), lods };
  }

  /**
   * The geometry as a progressive mesh, for `decimesh/progressive` to read: the coarsest recorded level and what leads from
   * there to full detail. Materials are named in it and not contained. The selected level stays as it is.
   *
   * Rejects with `wrong-state` unless every level was recorded with `placement: 'subset'`:
   * `simplify({ placement: 'subset' })`.
   */
  async writeProgressive(options: ProgressiveOptions = {}): Promise<Uint8Array<ArrayBuffer>> {
    checkProgressiveOptions(options);
    const source = this.#progressiveSource();
    const { encodeProgressive } = await import('./progressive/encode.js');
    return encodeProgressive(source, options);
  }

  #progressiveSource(): ProgressiveSource {
    const { groups, wedgeSets, diagonal } = this.summary;
    return this.#model.call((model) => {
      const words = model.history();
      model.putAside();
      try {
        return {
          words,
          diagonal,
          groups: groups.map(({ mesh, primitive, object, material, wedgeSet }, index) => ({
            mesh, primitive, object, material, wedgeSet, indices: model.levelIndices(index),
          })),
          wedgeSets: wedgeSets.map(({ attributes }, set) => ({
            positions: model.levelPositions(set),
            attributes: attributes.map((attribute, index) => ({ ...attribute, values: model.levelAttribute(set, index) })),
          })),
        };
      } finally {
        model.bringBack();
      }
    });
  }

  /** Frees the document's memory; what runs rejects with `disposed`. May be called twice. */
  dispose(): void {
    this.#model.dispose();
  }

  /** {@link dispose}, for `using`. */
  [Symbol.dispose](): void {
    this.dispose();
  }
}

function sizeOf({ bytes, files }: EncodedLevel): number {
  return files.reduce((sum, file) => sum + file.bytes.byteLength, bytes.byteLength);
}

function checkWriteOptions(options: WriteOptions, summary: DocumentSummary): Encoding & { format: OutputFormat; name: string } {
  checkNames(options, ['format', 'name', 'compress', 'quantize', 'prepare', 'size', 'lods', 'lodSwitch']);
  const { size, lods, name = 'model', quantize = false } = options;
  const { format = lods === undefined ? usualFormat(summary.format) : 'glb' } = options;
  if (size !== undefined && (typeof size !== 'number' || !(size > 0))) {
    throw invalidArgument('size', 'must be a number of bytes above 0');
  }
  if (lods !== undefined) {
    if (!Array.isArray(lods) || lods.length < 2 || lods.length > MOST_LODS) {
      throw invalidArgument('lods', `must be a list of 2 to ${MOST_LODS} levels`);
    }
    if (format !== 'glb') throw invalidArgument('lods', "need the format 'glb'");
    if (size !== undefined) throw invalidArgument('size', 'cannot be asked of a chain of levels');
  }
  if (!isOutputFormat(format)) throw invalidArgument('format', `must be one of ${OUTPUT_FORMATS.join(', ')}`);
  const { compress = holdsEncodings(format) ? summary.compression : 'none' } = options;
  if (!isCompression(compress)) throw invalidArgument('compress', `must be one of ${COMPRESSIONS.join(', ')}`);
  if (typeof quantize !== 'boolean') throw invalidArgument('quantize', 'must be true or false');
  if (!holdsEncodings(format) && compress !== 'none') throw invalidArgument('compress', `${format} has no compression`);
  if (!holdsEncodings(format) && quantize) throw invalidArgument('quantize', `${format} has no quantisation`);
  const prepare = checkPrepareOptions(options.prepare);
  if (!holdsEncodings(format) && prepare !== undefined) throw invalidArgument('prepare', `is for glb and gltf, not ${format}`);
  if (typeof name !== 'string' || !isFileName(name)) throw invalidArgument('name', 'must be a name for files, without a folder');
  return { format, name, compress, quantize, prepare };
}

function isFileName(name: string): boolean {
  // eslint-disable-next-line no-control-regex -- they are what is to be found
  return name !== '' && name.length <= 200 && !/[\u0000-\u001f/\\:*?"<>|]/.test(name) && name !== '.' && name !== '..';
}
