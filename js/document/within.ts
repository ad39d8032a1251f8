// Simplifying to a measured deviation: all levels are recorded once, then levels are measured until one is within.

import { findWithin } from '../bounded.js';
import type { Document } from '../document.js';
import { DecimeshError } from '../errors.js';
import { hasTarget, resolveMaximumDeviation } from '../options.js';
import type { DocumentSimplifyOptions, LevelSummary, RunOptions } from '../types.js';

/** Of a limit for the measured deviation, what is kept for places between the samples. */
const BETWEEN_SAMPLES = 0.04;

/** Samples on each side while a level within a limit is searched for, and for the one that is found. */
const SEARCH_SAMPLES = 200_000;
const FINAL_SAMPLES = 1_000_000;

/** As {@link Document.simplify} with `maximumDeviation`; after an abort or a failure full detail is selected. */
export async function simplifyWithin(
  document: Document,
  { maximumDeviation, ...options }: DocumentSimplifyOptions & RunOptions,
): Promise<LevelSummary> {
  const limit = resolveMaximumDeviation({ maximumDeviation, ...options }, document.summary);
  const { onProgress, signal } = options;
  // Of the measurements it is not known how many there will be: each is an eighth of what is left.
  let done = 0;
  const within = (share: number, fraction: number): void => {
    const now = done + (1 - done) * share * fraction;
    if (fraction === 1) done = now;
    if (now < 1) onProgress?.(now);
  };
  const recorded = await document.simplify({ ...options, everyLevel: true, onProgress: (fraction) => within(0.3, fraction) });
  // Without a target the run selects full detail.
  const coarsest = hasTarget(options) ? recorded : await document.level({ triangles: 0 });
  const safe = limit * (1 - BETWEEN_SAMPLES);
  const measured = async (triangles: number, samples: number): Promise<{ triangles: number; max: number }> => {
    const level = await document.level({ triangles }, { signal });
    const { max } = await document.measure({ samples, signal, onProgress: (fraction) => within(1 / 8, fraction) });
    return { triangles: level.triangles, max };
  };
  try {
    const { triangles: most } = document.summary;
    const guess = await document.level({ error: safe / 2 }, { signal });
    const range = { least: Math.min(coarsest.triangles, most), most, start: guess.triangles };
    let triangles = await findWithin(safe, range, (wanted) => measured(wanted, SEARCH_SAMPLES));
    // With more samples the maximum may be a little more.
    while (triangles < most && (await measured(triangles, FINAL_SAMPLES)).max > safe) triangles = Math.min(most, Math.ceil(triangles * 1.02) + 1);
    const level = await document.level(triangles >= most ? {} : { triangles });
    onProgress?.(1);
    if (level.triangles <= coarsest.triangles) return { ...level, stopReason: coarsest.stopReason, blockers: coarsest.blockers };
    return { ...level, stopReason: 'error' };
  } catch (error) {
    if (!(error instanceof DecimeshError && error.code === 'disposed')) await document.level({});
    throw error;
  }
}
