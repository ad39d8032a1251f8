// Advances long work in short steps, so that events, progress and an abort get their turn between them.

import { DecimeshError } from './errors.js';
import { yieldToEvents } from './platform.js';
import type { RunOptions } from './types.js';

/** How long a step may take, ms: short enough to keep 60 frames a second, long enough that yielding costs little. */
const STEP_MILLISECONDS = 10;

/** Between two reports of progress, ms. */
const PROGRESS_MILLISECONDS = 50;

/** The first step's work, about 5 ms on the machine the unit was chosen on; the following ones adapt. */
const FIRST_WORK = 10_000;

/** An end before the work is done. */
export interface TimeLimit {
  /** From the first step on; absent: no limit. */
  readonly milliseconds: number | undefined;
  /** Ends the work where it stands. */
  stop(): void;
}

/** Calls `step` with amounts of work that take about a step's time each. */
class Pace {
  readonly #step: (work: number) => number;
  readonly #limit: TimeLimit | undefined;
  readonly #start = performance.now();
  #work = FIRST_WORK;

  constructor(step: (work: number) => number, limit: TimeLimit | undefined) {
    this.#step = step;
    this.#limit = limit;
  }

  /** Does one step and returns the share that is done: 1 also when the time is spent and the work was stopped. */
  next(): number {
    const start = performance.now();
    const fraction = this.#step(this.#work);
    if (fraction >= 1) return 1;
    const now = performance.now();
    if (this.#limit?.milliseconds !== undefined && now - this.#start >= this.#limit.milliseconds) {
      this.#limit.stop();
      return 1;
    }
    // Never more than double: the cost of a unit changes from one stage of the work to the next.
    const factor = STEP_MILLISECONDS / Math.max(now - start, 0.01);
    this.#work = Math.max(100, this.#work * Math.min(2, Math.max(0.1, factor)));
    return fraction;
  }
}

/**
 * Calls `step` with an amount of work until it returns 1, the share that is done, or the time of `limit` is spent.
 *
 * Rejects with the signal's reason on an abort, at the latest after the step that is running, and with whatever `step`
 * or `onProgress` throws. What `step` works on is the caller's to clean up then.
 */
export async function runInSteps(
  step: (work: number) => number,
  { onProgress, signal }: RunOptions,
  limit?: TimeLimit,
): Promise<void> {
  let reported = 0;
  let reportedAt = -Infinity;
  signal?.throwIfAborted();
  const pace = new Pace(step, limit);
  for (;;) {
    const fraction = pace.next();
    if (fraction >= 1) break;
    const now = performance.now();
    if (fraction > reported && now - reportedAt >= PROGRESS_MILLISECONDS) {
      reported = fraction;
      reportedAt = now;
      onProgress?.(fraction);
    }
    await yieldToEvents();
    signal?.throwIfAborted();
  }
  onProgress?.(1);
}

/** Lets one run at a time at something. */
export class Turn {
  readonly #name: string;
  #running: { readonly signal: AbortSignal | undefined; readonly over: Promise<void> } | undefined;

  /** `name` is the call's, for the message. */
  constructor(name: string) {
    this.#name = name;
  }

  /**
   * Calls `run` and returns its result. A former run that was aborted is waited for: it ends after its present step.
   *
   * Rejects with `wrong-state` while a run is under way that was not aborted, and with the signal's reason.
   */
  async take<Result>(signal: AbortSignal | undefined, run: () => Promise<Result>): Promise<Result> {
    signal?.throwIfAborted();
    while (this.#running !== undefined) {
      if (this.#running.signal?.aborted !== true) {
        throw new DecimeshError('wrong-state', `${this.#name} is already running on this document`, this.#name);
      }
      await this.#running.over;
      signal?.throwIfAborted();
    }
    let end = (): void => {};
    this.#running = { signal, over: new Promise<void>((resolve) => (end = resolve)) };
    try {
      return await run();
    } finally {
      this.#running = undefined;
      end();
    }
  }
}

/** Calls `step` until it returns 1 or the time of `limit` is spent, without a pause. */
export function runToEnd(step: (work: number) => number, limit: TimeLimit): void {
  if (limit.milliseconds === undefined) {
    while (step(1e9) < 1);
    return;
  }
  const pace = new Pace(step, limit);
  while (pace.next() < 1);
}
