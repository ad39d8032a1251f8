// Simplifying to a measured deviation: runs that refuse what was too far away are measured until one is within, however closely
// it is looked at, or else levels of a record.

import { CLOSE, findWithin, lookClosely, tryRefusing } from '../bounded.js';
import type { Document } from '../document.js';
import { hasTarget, resolveMaximumDeviation } from '../options.js';
import { Refusal } from '../refusal.js';
import type { DeviationMap } from '../report.js';
import type { DocumentSimplifyOptions, LevelSummary, RunOptions } from '../types.js';

/**
 * Of a limit for the measured deviation, what is kept for what another look may find: samples climb to the maximum, and were
 * never 0.1 % below what twenty times as many find.
 */
const ANOTHER_LOOK = 0.01;

/** Samples on each side while a level within a limit is searched for. */
const SEARCH_SAMPLES = 100_000;

/** Of what is found, and for the report: what users get without asking. */
const FINAL_SAMPLES = 400_000;

/** Of the triangles of a run that refused collapses, those of the first recorded level that is looked at instead. */
const PROBE = 0.95;

/** While collapses are refused, what few samples find has to be below the limit by this factor. */
const FEW_SAMPLES = 0.998;

/** Triangles between which a level is searched for, and a guess. */
interface SearchRange {
  readonly least: number;
  readonly most: number;
  readonly start: number;
}

/** A run that few samples find within a limit: the triangles it is to, and what it refuses. */
interface Candidate {
  readonly triangles: number;
  readonly refusal: Refusal;
}

/** A run that is within a limit; its level is selected and measured. */
interface Refused {
  readonly level: LevelSummary;
  /** Selects and measures it once more, for the report. */
  again(): Promise<LevelSummary>;
}

/**
 * As {@link Document.simplify} with `maximumDeviation`; after an abort or a failure full detail is selected. `original` are
 * the positions of the document's vertices, of each wedge set: full detail may have fewer once vertices became one.
 */
export async function simplifyWithin(
  document: Document,
  original: readonly Float32Array[],
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
  const safe = limit * (1 - ANOTHER_LOOK);
  const measuring = { signal, onProgress: (fraction: number): void => within(1 / 12, fraction) };
  try {
    const { triangles: most } = document.summary;
    const { triangles: start } = await document.level({ error: safe }, { signal });
    const range = { least: Math.min(coarsest.triangles, most), most, start };
    // A refusal takes runs of its own, and weights in place of the attribute's.
    const canRefuse = options.timeBudget === undefined && options.weightAttribute === undefined;
    const refused = canRefuse ? await refuse(document, original, options, safe, range, measuring) : undefined;
    const level = await coarser(document, refused, safe, range, measuring);
    onProgress?.(1);
    if (level.triangles <= coarsest.triangles) return { ...level, stopReason: coarsest.stopReason, blockers: coarsest.blockers };
    return { ...level, stopReason: 'error' };
  } catch (error) {
    // A document that is lost has no level to go back to; what made it so is what counts.
    await document.level({}).catch(() => {});
    throw error;
  }
}

/** The coarser of what refusals led to and what the record has within `limit`, if it has to be searched; selected. */
async function coarser(document: Document, refused: Refused | undefined, limit: number, range: SearchRange, run: RunOptions): Promise<LevelSummary> {
  const fewest = refused?.level.triangles ?? range.most;
  if (refused && fewest <= range.start) return refused.level;
  // Where everything is as far away as it may be, nothing is gained by refusing, and the record may do better.
  const start = refused ? Math.floor(PROBE * fewest) : range.start;
  const triangles = await findRecorded(document, limit, { ...range, most: fewest, start }, run);
  if (triangles < fewest) return document.level({ triangles });
  return refused ? refused.again() : document.level({});
}

/** The triangles of the coarsest recorded level found that is within `limit`, or the most. */
async function findRecorded(document: Document, limit: number, range: SearchRange, run: RunOptions): Promise<number> {
  let triangles = await findWithin(limit, range, async (wanted) => {
    const level = await document.level({ triangles: wanted }, { signal: run.signal });
    const { max } = await document.measure({ ...run, samples: SEARCH_SAMPLES });
    return { triangles: level.triangles, max };
  });
  // A closer look may find a little more.
  while (triangles < range.most) {
    await document.level({ triangles }, { signal: run.signal });
    if (await isWithin(document, limit, run)) break;
    triangles = Math.min(range.most, Math.ceil(triangles * CLOSE) + 1);
  }
  return triangles;
}

/** The coarsest found of the runs that are within `limit`, each refusing what led the former beyond it; undefined if there is none. */
async function refuse(
  document: Document,
  original: readonly Float32Array[],
  options: DocumentSimplifyOptions & RunOptions,
  limit: number,
  range: SearchRange,
  run: RunOptions,
): Promise<Refused | undefined> {
  const refusal = new Refusal(original, options.weights);
  const runTo = (triangles: number, weights: Float32Array): Promise<LevelSummary> =>
    document.simplify({ ...options, weights, ratio: undefined, error: undefined, triangles, everyLevel: false, keepLevels: true, onProgress: undefined });
  const candidates: Candidate[] = [];
  await tryRefusing(range, async (wanted) => {
    const before = new Refusal(refusal);
    const { triangles } = await runTo(wanted, before.weights());
    const far = await refuseFar(document, refusal, FEW_SAMPLES * limit, await document.deviationMap({ ...run, samples: SEARCH_SAMPLES }), run);
    if (far === 0) candidates.push({ triangles, refusal: before });
    return { triangles, far };
  });
  let selected: LevelSummary | undefined;
  const found = await lookClosely(candidates, range.most, async ({ triangles: wanted, refusal: refused }) => {
    selected = await runTo(wanted, refused.weights());
    const mended = new Refusal(refused);
    const far = await refuseClosely(document, mended, limit, run);
    return { far, mend: (triangles: number): Candidate => ({ triangles, refusal: mended }) };
  });
  return found && selected && {
    level: selected,
    again: async () => {
      const level = await runTo(found.triangles, found.refusal.weights());
      await document.measure({ ...run, samples: FINAL_SAMPLES });
      return level;
    },
  };
}

/** Refuses the places of the selected level that are farther away than `limit` on `map`; how many they are. */
async function refuseFar(document: Document, refusal: Refusal, limit: number, map: DeviationMap, { signal }: RunOptions): Promise<number> {
  const { groups, wedgeSets } = await document.geometry();
  const sets = wedgeSets.map(({ positions }, set) => ({ positions, surroundings: map.wedgeSets[set]?.surroundings ?? new Float32Array() }));
  return refusal.refuse(sets, groups, limit, signal);
}

/** As {@link refuseFar}, when the level is looked at closely. */
async function refuseClosely(document: Document, refusal: Refusal, limit: number, run: RunOptions): Promise<number> {
  const map = await document.deviationMap({ ...run, samples: FINAL_SAMPLES });
  // A place that is at the limit but for the map's 32 bits is one, too.
  return map.deviation.max > limit ? Math.max(await refuseFar(document, refusal, limit, map, run), 1) : 0;
}

/** Whether the selected level is within `limit` when it is looked at closely. */
async function isWithin(document: Document, limit: number, run: RunOptions): Promise<boolean> {
  return (await document.measure({ ...run, samples: FINAL_SAMPLES })).max <= limit;
}
