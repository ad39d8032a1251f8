// Medians and means, and the measuring of several jobs in turn.

/** The middle value; the upper one of two. `undefined` of nothing. */
export function median(values) {
  return values.toSorted((a, b) => a - b)[values.length >> 1];
}

/** The geometric mean of those `values` that were measured; `undefined` if none was. */
export function geometricMean(values) {
  const measured = values.filter((value) => value !== undefined);
  if (measured.length === 0) return undefined;
  return Math.exp(measured.reduce((sum, value) => sum + Math.log(value), 0) / measured.length);
}

/** `a / b`, or `undefined` unless both were measured and `b` is not 0. */
export const ratio = (a, b) => (a === undefined || b === undefined || b === 0 ? undefined : a / b);

/** Keeps results alive so that no call is dead code. */
export let sink = 0;

/**
 * Runs the `jobs` in turn, so that a change of the machine's speed hits all of them: one round to warm up, then
 * `least` to `most` rounds, as many as begin within `seconds`. Each job returns the milliseconds of what it timed
 * itself, or something else and is timed whole. Returns the milliseconds of every round by job.
 */
export function timeTogether(jobs, { least = 3, most = 7, seconds = 10 } = {}) {
  const times = jobs.map(() => []);
  const start = performance.now();
  for (let round = -1; round < most; round += 1) {
    if (round >= least && performance.now() - start > seconds * 1000) break;
    jobs.forEach((job, at) => {
      const began = performance.now();
      const result = job();
      const took = typeof result === 'number' ? result : performance.now() - began;
      sink ^= result?.length ?? 1;
      if (round >= 0) times[at].push(took);
    });
  }
  return times;
}
