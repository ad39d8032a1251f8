// The coarsest level whose measured deviation is within a limit: by refusing collapses where it is not, first for few samples,
// then for many, or else found over the recorded history.
//
// The measured maximum does not fall strictly with the number of triangles: a level may be worse than a coarser one. The
// search brackets the place where it first passes the limit and halves that; what it returns was measured itself.

/** A level that was measured. */
export interface MeasuredLevel {
  readonly triangles: number;
  /** Model units. */
  readonly max: number;
}

/** Between the finest level known to fail and the coarsest known to do, this much is not worth another measurement. */
export const CLOSE = 1.02;

/** From a level to the next while no bracket is known. */
const STRIDE = 1.5;

/** More measurements than this find nothing new. */
const MOST_MEASUREMENTS = 24;

/**
 * The number of triangles, from `least` to `most`, of the coarsest level found whose maximum is at most `limit`; `most`, which
 * is full detail, is always within. `measure` selects the level of at most so many triangles and measures it. `start` is a
 * guess.
 */
export async function findWithin(
  limit: number,
  { least, most, start }: { readonly least: number; readonly most: number; readonly start: number },
  measure: (triangles: number) => Promise<MeasuredLevel>,
): Promise<number> {
  let good = most;
  let bad = least - 1;
  let wanted = Math.min(Math.max(start, least), most);
  for (let count = 0; count < MOST_MEASUREMENTS && good > bad + 1 && good > Math.max(bad, 1) * CLOSE; count += 1) {
    const { triangles, max } = await measure(wanted);
    if (max <= limit) good = Math.min(good, triangles);
    // No level lies between what was asked for and what there is.
    else bad = Math.max(bad, wanted, triangles);
    // There is none coarser.
    if (triangles > wanted) bad = Math.max(bad, triangles - 1);
    const unknown = bad < least ? good / STRIDE : good === most ? bad * STRIDE : Math.sqrt(bad * good);
    wanted = Math.min(Math.max(Math.floor(unknown), bad + 1, least), good - 1);
  }
  return good;
}

/** A run to so many triangles that was measured. */
export interface Attempt {
  readonly triangles: number;
  /** Places that are farther away than the limit; they are refused in the next run. */
  readonly far: number;
}

/** Runs beyond these find little. */
const MOST_ATTEMPTS = 20;

/** From a level that is within the limit to the next that is tried. */
const COARSER = 0.9;

/** Triangles that a place that is too far away takes more; and of what there is, the most, and what each failure in a row adds. */
const FOR_A_PLACE = 3;
const MOST_FINER = 1.2;
const FOR_A_FAILURE = 0.012;

/** From an estimated error that is the limit, the level that refusals will lead to. */
const FIRST = 0.92;

/**
 * Looks for the fewest triangles, from `least` to `most`, of which a run is within the limit. `attempt` runs to at most so many
 * triangles, measures, and refuses what is too far away. `start` is a guess. Ends after the coarsest that is found, if one is.
 */
export async function tryRefusing(
  { least, most, start }: { readonly least: number; readonly most: number; readonly start: number },
  attempt: (triangles: number) => Promise<Attempt>,
): Promise<void> {
  let good = most;
  let wanted = Math.min(Math.max(Math.floor(start * FIRST), least), most);
  for (let [count, failures] = [0, 0]; count < MOST_ATTEMPTS && wanted * CLOSE < good; count += 1) {
    const { triangles, far } = await attempt(wanted);
    if (far === 0) {
      good = Math.min(good, triangles);
      // There is none coarser.
      if (wanted <= least || triangles > wanted) return;
      failures = 0;
      wanted = Math.max(Math.floor(triangles * COARSER), least);
    } else {
      failures += 1;
      wanted = finer(wanted, far, FOR_A_FAILURE * (failures - 1));
    }
  }
}

/** What is tried after a failure with so many triangles and so many places too far away; `share` is for the failures before. */
const finer = (triangles: number, far: number, share: number): number =>
  Math.ceil(Math.min(triangles + FOR_A_PLACE * far, triangles * MOST_FINER) + share * triangles) + 1;

/** What many samples find of a run. */
export interface Look<Run> {
  /** Places that are farther away than the limit. */
  readonly far: number;
  /** The run to so many triangles that refuses them too. */
  mend(triangles: number): Run;
}

/** Runs that refuse what only many samples find; more of them find little. */
const MOST_MENDED = 10;

/** As `FOR_A_FAILURE`: these runs are nearly there. */
const FOR_A_MENDED = 0.003;

/**
 * The coarsest of `runs` that is within the limit by many samples too, or one between it and the next that refuses what they
 * found; undefined if there is none with fewer than `most` triangles. `look` makes a run and measures it.
 */
export async function lookClosely<Run extends { readonly triangles: number }>(
  runs: readonly Run[],
  most: number,
  look: (run: Run) => Promise<Look<Run>>,
): Promise<Run | undefined> {
  const waiting = runs.map((run) => ({ run, failures: 0 }));
  for (let mended = 0; waiting.length > 0; ) {
    waiting.sort((a, b) => b.run.triangles - a.run.triangles);
    const { run, failures } = waiting.pop() as (typeof waiting)[number];
    const { far, mend } = await look(run);
    if (far === 0) return run;
    const triangles = finer(run.triangles, far, FOR_A_MENDED * failures);
    if (mended === MOST_MENDED || triangles >= most) continue;
    mended += 1;
    waiting.push({ run: mend(triangles), failures: failures + 1 });
  }
  return undefined;
}
