// Simplifying bare arrays: at once, or recorded for any level afterwards.

import { EngineObject } from './engine.js';
import { attributesForEngine, attributesFromEngine, checkMesh, type EngineAttribute } from './mesh.js';
import {
  MESH_SIMPLIFY_NAMES,
  RUN_NAMES,
  checkHasTarget,
  checkNames,
  checkProgressiveOptions,
  checkProtection,
  resolveRequest,
  resolveTargets,
  type Scale,
  type SimplifyRequest,
} from './options.js';
import { lifetimesOf, type TriangleLifetimes } from './progressive/lifetimes.js';
import type { ProgressiveOptions } from './progressive/encode.js';
import type { ProgressiveSource } from './progressive/source.js';
import { runInSteps, runToEnd, type TimeLimit } from './run.js';
import type { LevelSummary, LevelTargets, MeshInput, MeshSimplifyOptions, RunOptions, SimplifiedMesh } from './types.js';
import type { Model } from './wasm/decimesh.js';

/**
 * Simplifies a mesh at once and returns the level that the targets ask for; `init()` must have finished.
 *
 * The input is only read. Throws `invalid-argument` naming the array or option (also when no target is given),
 * `out-of-range` for an index without a vertex, `not-finite` for NaN and infinities.
 */
export function simplify(mesh: MeshInput, options: MeshSimplifyOptions): SimplifiedMesh {
  checkNames(options, MESH_SIMPLIFY_NAMES);
  checkHasTarget(options);
  const run = new MeshRun(mesh, options, false);
  try {
    runToEnd((work) => run.step(work), run.limit);
    return run.level(run.request);
  } finally {
    run.dispose();
  }
}

/** As {@link simplify}, in steps between which events are handled; needs `init()` all the same. */
export async function simplifyInSteps(mesh: MeshInput, options: MeshSimplifyOptions & RunOptions): Promise<SimplifiedMesh> {
  checkNames(options, [...MESH_SIMPLIFY_NAMES, ...RUN_NAMES]);
  checkHasTarget(options);
  const run = new MeshRun(mesh, options, false);
  try {
    await runInSteps((work) => run.step(work), { signal: options.signal, onProgress: options.onProgress }, run.limit);
    return run.level(run.request);
  } finally {
    run.dispose();
  }
}

/**
 * Simplifies a mesh once and keeps the record, from which any level is extracted; `init()` must have finished.
 *
 * Every level is as good as a sweep to it alone; {@link simplify} beside that fits its one level to the original.
 * Targets bound how far the record goes; without any it goes as far as the shape allows. The sequence holds memory of
 * the engine until {@link MeshSequence.dispose}. Throws what {@link simplify} throws.
 */
export function simplifySequence(mesh: MeshInput, options: MeshSimplifyOptions = {}): MeshSequence {
  return new MeshSequence(mesh, options);
}

/** The record of one simplification of arrays. */
export class MeshSequence {
  readonly #run: MeshRun;

  /** @internal Use {@link simplifySequence}. */
  constructor(mesh: MeshInput, options: MeshSimplifyOptions) {
    checkNames(options, MESH_SIMPLIFY_NAMES);
    this.#run = new MeshRun(mesh, options, true);
    try {
      runToEnd((work) => this.#run.step(work), this.#run.limit);
    } catch (error) {
      this.#run.dispose();
      throw error;
    }
  }

  /**
   * The level that `targets` ask for, or full detail for `{}`; beyond the last recorded level it is that one.
   *
   * Throws `invalid-argument` naming the target, `disposed` after {@link dispose}.
   */
  level(targets: LevelTargets): SimplifiedMesh {
    return this.#run.level(resolveTargets(targets, this.#run.scale));
  }

  /**
   * All levels as a progressive mesh, for `decimesh/progressive` to read. Numbers are floats in it, whatever arrays they
   * came in. Rejects with `wrong-state` unless the sequence was made with `placement: 'subset'`.
   */
  async writeProgressive(options: ProgressiveOptions = {}): Promise<Uint8Array<ArrayBuffer>> {
    checkProgressiveOptions(options);
    const source = this.#run.progressiveSource();
    const { encodeProgressive } = await import('./progressive/encode.js');
    return encodeProgressive(source, options);
  }

  /**
   * Every triangle of every level, with the errors between which it is there: those with births ≤ ε < deaths are
   * `level({ error: ε })`, found in linear time by whoever has the arrays, on a graphics card too. Throws `wrong-state` unless
   * the sequence was made with `placement: 'subset'`, so that vertices are those of the input.
   */
  lifetimes(): TriangleLifetimes {
    return lifetimesOf(this.#run.progressiveSource());
  }

  /** Frees the memory in the engine. May be called twice. */
  dispose(): void {
    this.#run.dispose();
  }

  /** {@link dispose}, for `using`. */
  [Symbol.dispose](): void {
    this.dispose();
  }
}

/** What targets refer to. The diagonal is asked for when one does: the engine goes through all triangles for it. */
class MeshScale implements Scale {
  readonly triangles: number;
  readonly #summary: () => string;
  #diagonal: number | undefined;

  constructor(triangles: number, summary: () => string) {
    this.triangles = triangles;
    this.#summary = summary;
  }

  get diagonal(): number {
    this.#diagonal ??= (JSON.parse(this.#summary()) as Scale).diagonal;
    return this.#diagonal;
  }
}

/** A mesh in the engine whose simplification has begun. */
class MeshRun {
  readonly scale: Scale;
  readonly request: SimplifyRequest;
  readonly limit: TimeLimit;
  readonly #model: EngineObject<Model>;
  readonly #attributes: readonly EngineAttribute[];

  constructor(mesh: MeshInput, options: MeshSimplifyOptions & RunOptions, everyLevel: boolean) {
    const { positions, indices } = checkMesh(mesh);
    // Everything about the options that needs no diagonal is said before the arrays are copied.
    resolveRequest(options, { triangles: 0, diagonal: 0 });
    checkProtection(options, positions.length / 3);
    this.#attributes = attributesForEngine(mesh);
    const description = this.#attributes.map(({ name, components, blend }) => ({ name, components, blend }));
    this.#model = new EngineObject('mesh', (engine) =>
      engine.Model.fromArrays(
        positions,
        indices,
        JSON.stringify(description),
        this.#attributes.map(({ values }) => values),
      ),
    );
    this.scale = new MeshScale(Math.floor((indices?.length ?? positions.length / 3) / 3), () => this.#model.call((model) => model.summary()));
    try {
      this.request = { ...resolveRequest(options, this.scale), everyLevel };
      this.limit = { milliseconds: options.timeBudget, stop: () => this.#model.call((model) => model.stopSimplify()) };
      const { weights, locked } = options;
      if (weights !== undefined || locked !== undefined) {
        this.#model.call((model) => model.setProtection(weights ?? new Float32Array(), locked ?? new Uint8Array()));
      }
      this.#model.call((model) => model.beginSimplify(JSON.stringify(this.request)));
    } catch (error) {
      this.dispose();
      throw error;
    }
  }

  step(work: number): number {
    return this.#model.call((model) => model.step(work));
  }

  level({ triangles, error }: { triangles?: number; error?: number }): SimplifiedMesh {
    return this.#model.call((model) => {
      const { estimatedError, stopReason, blockers } = JSON.parse(model.selectLevel(triangles, error)) as LevelSummary;
      return {
        positions: model.levelPositions(0),
        indices: model.levelIndices(0),
        attributes: attributesFromEngine(this.#attributes, (index) => model.levelAttribute(0, index)),
        estimatedError,
        stopReason,
        blockers,
        vertexMap: model.levelWedgeMap(),
      };
    });
  }

  progressiveSource(): ProgressiveSource {
    return this.#model.call((model) => {
      const words = model.history();
      model.putAside();
      try {
        const indices = model.levelIndices(0);
        const attributes = this.#attributes.map(({ name, components }, index) => ({ name, components, values: model.levelAttribute(0, index) }));
        return {
          words,
          diagonal: this.scale.diagonal,
          groups: [{ indices, wedgeSet: 0, mesh: 0, primitive: 0, object: null, material: null }],
          wedgeSets: [{ positions: model.levelPositions(0), attributes }],
        };
      } finally {
        model.bringBack();
      }
    });
  }

  dispose(): void {
    this.#model.dispose();
  }
}
