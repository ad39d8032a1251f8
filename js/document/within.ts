// Simplifying to a measured deviation: runs that refuse what was too far away are measured until one is within, or else levels
// of a record.

import { CLOSE, findWithin, tryRefusing } from '../bounded.js';
import type { Document } from '../document.js';
import { hasTarget, resolveMaximumDeviation } from '../options.js';
import { Refusal } from '../refusal.js';
import type { DocumentSimplifyOptions, LevelSummary, RunOptions } from '../types.js';

/** Of a limit for the measured deviation, what is kept for places between the samples. */
const BETWEEN_SAMPLES = 0.04;

/** Samples on each side while a level within a limit is searched for. */
const SEARCH_SAMPLES = 200_000;

/**
 * Of what is found; the last counts for the report. The places of one number are not among those of another: a thin spot that
 * one misses, another finds, and the number that users get without asking is among them.
 */
const FINAL_SAMPLES = [400_000, 1_000_000] as const;

/** Of the triangles of a run that refused collapses, those of the first recorded level that is looked at instead. */
const PROBE = 0.95;

/** While collapses are refused, what few samples find has to be below the limit by this factor. */
const FEW_SAMPLES = 0.985;

/** Triangles between which a level is searched for, and a guess. */
interface SearchRange {
  readonly least: number;
  readonly most: number;
  readonly start: number;
}

/** Runs that seemed to be within a limit. */
interface Refused {
  /** Of the coarsest. */
  readonly triangles: number;
  /** Selects the coarsest that is within the limit when it is looked at closely; undefined if none is. */
  select(): Promise<LevelSummary | undefined>;
}

/** As {@link Document.simplify} with `maximumDeviation`; after an abort or a failure full detail is selected. */
export async function simplifyWithin(
  document: Document,
  { maximumDeviation, ...options }: DocumentSimplifyOptions & RunOptions,
): Promise<LevelSummary> {
  const limit = resolveMaximumDeviation({ maximumDeviation, ...options }, document.summary);
  const { onProgress, signal } = options;
  // Of the measurements it is not known how many there will be: each is a twelfth of what is left.
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
  const measuring = { signal, onProgress: (fraction: number): void => within(1 / 12, fraction) };
  try {
    const { triangles: most } = document.summary;
    const { triangles: start } = await document.level({ error: safe }, { signal });
    const range = { least: Math.min(coarsest.triangles, most), most, start };
    // A refusal takes runs of its own, and weights in place of the attribute's.
    const canRefuse = options.timeBudget === undefined && options.weightAttribute === undefined;
    const refused = canRefuse ? await refuse(document, options, safe, range, measuring) : undefined;
    let level = refused && refused.triangles <= start ? await refused.select() : undefined;
    if (level === undefined && refused && refused.triangles > start) {
      // Where everything is as far away as it may be, nothing is gained by refusing, and the record may do better.
      const known = { ...range, most: refused.triangles, start: Math.floor(PROBE * refused.triangles) };
      const triangles = await findRecorded(document, safe, known, measuring);
      level = triangles < refused.triangles ? await document.level({ triangles }) : await refused.select();
    }
    if (level === undefined) {
      const triangles = await findRecorded(document, safe, range, measuring);
      level = await document.level(triangles >= most ? {} : { triangles });
    }
    onProgress?.(1);
    if (level.triangles <= coarsest.triangles) return { ...level, stopReason: coarsest.stopReason, blockers: coarsest.blockers };
    return { ...level, stopReason: 'error' };
  } catch (error) {
    // A document that is lost has no level to go back to; what made it so is what counts.
    await document.level({}).catch(() => {});
    throw error;
  }
}

/** The triangles of the coarsest recorded level found that is within `limit`, or the most. */
async function findRecorded(document: Document, limit: number, range: SearchRange, run: RunOptions): Promise<number> {
  let triangles = await findWithin(limit, range, async (wanted) => {
    const level = await document.level({ triangles: wanted }, { signal: run.signal });
    const { max } = await document.measure({ ...run, samples: SEARCH_SAMPLES });
    return { triangles: level.triangles, max };
  });
  // With more samples the maximum may be a little more.
  while (triangles < range.most) {
    await document.level({ triangles }, { signal: run.signal });
    if (await isWithin(document, limit, run)) break;
    triangles = Math.min(range.most, Math.ceil(triangles * CLOSE) + 1);
  }
  return triangles;
}

/** Runs that are within `limit`, each refusing what led the former beyond it; undefined if there is none. */
async function refuse(
  document: Document,
  options: DocumentSimplifyOptions & RunOptions,
  limit: number,
  range: SearchRange,
  run: RunOptions,
): Promise<Refused | undefined> {
  await document.level({});
  const original = await document.geometry();
  const refusal = new Refusal(original.wedgeSets.map(({ positions }) => positions), options.weights);
  const runTo = (triangles: number, weights: Float32Array): Promise<LevelSummary> =>
    document.simplify({ ...options, weights, ratio: undefined, error: undefined, triangles, everyLevel: false, keepLevels: true, onProgress: undefined });
  const found: Array<{ readonly triangles: number; readonly weights: Float32Array }> = [];
  await tryRefusing(range, async (wanted) => {
    const weights = refusal.weights();
    const { triangles } = await runTo(wanted, weights);
    const { groups, wedgeSets } = await document.geometry();
    const map = await document.deviationMap({ ...run, samples: SEARCH_SAMPLES });
    const sets = wedgeSets.map(({ positions }, set) => ({ positions, surroundings: map.wedgeSets[set]?.surroundings ?? new Float32Array() }));
    const far = await refusal.refuse(sets, groups, FEW_SAMPLES * limit, run.signal);
    if (far === 0) found.push({ triangles, weights });
    return { triangles, far };
  });
  found.sort((a, b) => a.triangles - b.triangles);
  const [coarsest] = found;
  return coarsest && {
    triangles: coarsest.triangles,
    select: async () => {
      for (const { triangles, weights } of found) {
        const level = await runTo(triangles, weights);
        if (await isWithin(document, limit, run)) return level;
      }
      return undefined;
    },
  };
}

/** Whether the selected level is within `limit` when it is looked at closely. */
async function isWithin(document: Document, limit: number, run: RunOptions): Promise<boolean> {
  for (const samples of FINAL_SAMPLES) if ((await document.measure({ ...run, samples })).max > limit) return false;
  return true;
}
