// Reads how many tests passed, failed and were skipped out of what the test runners print.

/** No tests at all; counts are added up from here. */
export const none = Object.freeze({ passed: 0, failed: 0, skipped: 0 });

/** The sum of two counts. */
export const add = (a, b) => ({
  passed: a.passed + b.passed,
  failed: a.failed + b.failed,
  skipped: a.skipped + b.skipped,
});

/** The counts in the words that `npm test` ends with. */
export const inWords = ({ passed, failed, skipped }) => `${passed} passed, ${failed} failed, ${skipped} skipped`;

/** The lines in which tests say that they were skipped, and why: `skipped: REASON`, in capitals too. */
export const skipNotices = (output) => output.split('\n').map((line) => line.trim()).filter((line) => /^skipped[: ]/i.test(line));

// What a run that failed also prints and nobody reads then: cargo's progress and the tests that passed.
const NOISE = /^\s*(Compiling|Checking|Downloading|Downloaded|Updating|Locking|Blocking|Fresh|Finished)\s|^test .* \.\.\. ok$|^\s*✓ /;

/** The output of a run that failed, without what did not fail. */
export function compact(output) {
  return output
    .replace(/^successes:\n( {4}.*\n)+/gm, '') // their names; what they printed stays
    .split('\n')
    .filter((line) => !NOISE.test(line))
    .join('\n')
    .replace(/\n{3,}/g, '\n\n')
    .trim();
}

/**
 * The counts in the output of cargo test or of wasm-bindgen's test runner, one summary line a test program.
 *
 * Rust's harness cannot skip a test while it runs. A test that lacks its input prints a line `skipped: REASON` and
 * returns; it was counted as passed and is moved to the skipped ones, beside those marked `#[ignore]`.
 */
export function countCargo(output) {
  let counts = none;
  const summary = /^test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored;/gm;
  for (const [, passed, failed, ignored] of output.matchAll(summary)) {
    counts = add(counts, { passed: Number(passed), failed: Number(failed), skipped: Number(ignored) });
  }
  const skipped = Math.min(skipNotices(output).length, counts.passed);
  return add(counts, { passed: -skipped, failed: 0, skipped });
}

/** The counts in Vitest's JSON report (its text, undefined when none was written). */
export function countVitest(json) {
  if (json === undefined) return none;
  const report = JSON.parse(json);
  // A file that fails to load has no tests that could fail: it counts as one.
  const broken = report.testResults.filter(
    (file) => file.status === 'failed' && !file.assertionResults.some((test) => test.status === 'failed'),
  );
  return {
    passed: report.numPassedTests,
    failed: report.numFailedTests + broken.length,
    skipped: report.numPendingTests + report.numTodoTests,
  };
}

/**
 * The verdict over one run of a program that counts its tests: a failure that no test accounts for is one failed test.
 *
 * `result` is what run() resolved to. Resolves to the counts with `reason`, a sentence, when there is such a failure.
 */
export function judge(result, counts) {
  const total = counts.passed + counts.failed + counts.skipped;
  let reason;
  if (result.timedOut) reason = 'It took too long and was ended.';
  else if (result.code !== 0 && counts.failed === 0) reason = `It ended with exit code ${result.code} although no test failed.`;
  else if (result.code === 0 && total === 0) reason = 'It ran no tests.';
  return reason === undefined ? { counts } : { counts: add(counts, { passed: 0, failed: 1, skipped: 0 }), reason };
}
