// A document: a whole file in the engine, simplified in steps, looked at and written at any level.

import { levelGeometry, originalPositions, progressiveSource } from './document/arrays.js';
import { runInEngine } from './document/engine_run.js';
import { writeLevels, type LevelState, type Written } from './document/write.js';
import type { EngineObject } from './engine.js';
import { DecimeshError, invalidArgument } from './errors.js';
import {
  DOCUMENT_SIMPLIFY_NAMES,
  RUN_NAMES,
  checkMeasureOptions,
  checkNames,
  checkProgressiveOptions,
  checkProtection,
  checkSignal,
  hasTarget,
  resolveRequest,
  resolveTargets,
  type SimplifyRequest,
} from './options.js';
import { partsOf, type Parts, type PartsSource } from './parts.js';
import type { ProgressiveOptions } from './progressive/encode.js';
import type { Deviation, DeviationMap } from './report.js';
import { Turn, runInSteps } from './run.js';
import type {
  DocumentSimplifyOptions,
  DocumentSummary,
  LevelGeometry,
  LevelSummary,
  LevelTargets,
  MeasureOptions,
  RunOptions,
  WriteOptions,
} from './types.js';
import type { Model } from './wasm/decimesh.js';

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
  #measured: LevelState['measured'];

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
    if (options.maximumDeviation !== undefined) {
      const { simplifyWithin } = await import('./document/within.js');
      return (this.#level = await simplifyWithin(this, originalPositions(this.#model, this.summary), options));
    }
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
      await runInEngine(this.#model, options, {
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
      await runInEngine(this.#model, options, {
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
    return levelGeometry(this.#model, this.summary);
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
    return writeLevels(
      {
        summary: this.summary,
        model: this.#model,
        level: (targets) => this.level(targets),
        state: () => ({ level: this.#level, timings: { ...this.#timings }, measured: this.#measured }),
        inputParts: () => {
          if ('files' in this.#source) this.#source = partsOf(this.#source);
          return this.#source;
        },
      },
      options,
    );
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
    const source = progressiveSource(this.#model, this.summary);
    const { encodeProgressive } = await import('./progressive/encode.js');
    return encodeProgressive(source, options);
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

