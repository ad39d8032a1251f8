// What a call throws, as a value to compare.

/** What `run` throws; undefined if nothing. */
export function thrown(run: () => unknown): unknown {
  try {
    run();
  } catch (error) {
    return error;
  }
  return undefined;
}
