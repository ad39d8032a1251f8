// Long work of the engine on a document: begun, done in steps, and dropped when it comes to nothing.

import type { EngineObject } from '../engine.js';
import { DecimeshError } from '../errors.js';
import { runInSteps } from '../run.js';
import type { RunOptions } from '../types.js';
import type { Model } from '../wasm/decimesh.js';

/** Long work that the engine does in steps. */
export interface EngineRun {
  begin(model: Model): void;
  /** Returns the share that is done. */
  step(model: Model, work: number): number;
  /** Drops what is half done. */
  cancel(model: Model): void;
  /** Ends it when so many milliseconds are spent, keeping what is done. */
  readonly limit?: { readonly milliseconds: number | undefined; stop(model: Model): void };
}

/**
 * Begins `run` on a document and takes its steps to the end, or to the limit of time. The last progress it reports is
 * below 1. Rejects with the signal's reason, or what the engine throws, after what is half done was dropped.
 */
export async function runInEngine(document: EngineObject<Model>, { signal, onProgress }: RunOptions, run: EngineRun): Promise<void> {
  document.call(run.begin);
  const { limit } = run;
  try {
    await runInSteps(
      (work) => document.call((model) => run.step(model, work)),
      {
        signal,
        // The last report comes when the result is there to be used.
        onProgress: (fraction) => fraction < 1 && onProgress?.(fraction),
      },
      limit && { milliseconds: limit.milliseconds, stop: () => document.call((model) => limit.stop(model)) },
    );
  } catch (error) {
    forgetRun(document, run);
    throw error;
  }
}

/** Drops what the engine has half done, unless the document itself is gone. */
function forgetRun(document: EngineObject<Model>, { cancel }: EngineRun): void {
  try {
    document.call(cancel);
  } catch (error) {
    if (!(error instanceof DecimeshError && error.code === 'disposed')) throw error;
  }
}
