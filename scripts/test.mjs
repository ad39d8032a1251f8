// `npm test`: sets up, builds, runs every suite, and ends with one line `N passed, N failed, N skipped`.
//
//     npm test -- [--only lint,rust,web,package,page] [--yes]

import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { build } from './build.mjs';
import { add, compact, countCargo, countVitest, inWords, judge, none, skipNotices } from './counts.mjs';
import { Stop, at, findProgram, main, readIfThere, run, secondsSince } from './project.mjs';
import { setup } from './setup.mjs';

const WASM = ['--target', 'wasm32-unknown-unknown'];
const DENY = ['--', '-D', 'warnings'];
const tool = (...parts) => [process.execPath, at('node_modules', ...parts)];

// A suite is a list of runs: a title, a program with its arguments, and how to count (default: the run is one test).
// `needs` names what has to be there first.
const SUITES = {
  lint: {
    needs: [],
    runs: ({ cargo }) => [
      { title: 'cargo fmt', command: [cargo, 'fmt', '--check', '--', '--color', 'never'] },
      { title: 'clippy', command: [cargo, 'clippy', '--locked', '--all-targets', ...DENY] },
      { title: 'clippy for wasm', command: [cargo, 'clippy', '--locked', ...WASM, '--lib', '--test', 'web', ...DENY] },
      { title: 'oxlint', command: [...tool('oxlint', 'bin', 'oxlint'), '--deny-warnings'] },
    ],
  },
  rust: {
    needs: [],
    runs: ({ cargo }) => [
      {
        title: 'cargo test',
        // Shown output is where a test says that it was skipped.
        command: [cargo, 'test', '--locked', '--no-fail-fast', '--', '--show-output'],
        count: countCargo,
      },
    ],
  },
  web: {
    needs: ['browser'],
    runs: ({ cargo, webEnv }) => ['+simd128', '-simd128'].map((feature) => ({
      title: `in Chromium, ${feature}`,
      command: [cargo, 'test', '--locked', ...WASM, '--test', 'web'],
      env: { ...webEnv, CARGO_ENCODED_RUSTFLAGS: `-Ctarget-feature=${feature}` },
      count: countCargo,
    })),
  },
  package: {
    needs: ['build'],
    runs: () => [
      // The build checks the types of everything else.
      { title: 'types of the tests', command: [...tool('typescript', 'bin', 'tsc'), '-p', at('tsconfig.tests.json')] },
      vitest('the package and the command line', ['--exclude', 'tests/page*.test.ts']),
    ],
  },
  page: {
    needs: ['build', 'browser'],
    runs: () => [vitest('the page', ['tests/page'])],
  },
};

// More than any of them takes on two slow cores with nothing compiled yet; a test that hangs has to end some time.
const SECONDS_PER_RUN = 15 * 60;

function vitest(title, selection) {
  const report = at('.setup', 'vitest.json');
  return {
    title,
    command: [...tool('vitest', 'vitest.mjs'), 'run', '--reporter=default', '--reporter=json', `--outputFile.json=${report}`, ...selection],
    before: () => rmSync(report, { force: true }),
    count: () => countVitest(readIfThere(report)),
  };
}

function chosenSuites(options) {
  const only = options[options.indexOf('--only') + 1];
  if (!options.includes('--only')) return Object.keys(SUITES);
  const chosen = (only ?? '').split(',');
  const unknown = chosen.find((name) => !Object.hasOwn(SUITES, name));
  if (unknown === undefined) return chosen;
  throw new Stop(`There is no suite "${unknown}": choose among ${Object.keys(SUITES).join(', ')}.`);
}

/** What the runs are started with: tools, and environments that make every program print the same everywhere. */
function surroundings(tools) {
  const env = { ...tools.env, CARGO_TERM_COLOR: 'never', NO_COLOR: '1' };
  delete env.FORCE_COLOR;
  if (tools.chromium) Object.assign(env, { CHROMIUM: tools.chromium, CHROMEDRIVER: tools.chromedriver });
  return { cargo: findProgram(['cargo'], env.PATH), env, webEnv: { ...env, ...(tools.chromium && webSettings(tools)) } };
}

function webSettings({ chromium, wasmTestRunner }) {
  // The driver knows one place of the browser; ours may be at another.
  const settings = JSON.parse(readFileSync(at('webdriver.json'), 'utf8'));
  settings['goog:chromeOptions'].binary = chromium;
  const file = at('.setup', 'webdriver.json');
  writeFileSync(file, JSON.stringify(settings));
  return {
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER: wasmTestRunner,
    WASM_BINDGEN_TEST_WEBDRIVER_JSON: file,
    WASM_BINDGEN_TEST_TIMEOUT: '300',
  };
}

/** Runs one suite and prints what it did: a line when all is well, everything when it is not. */
async function runSuite(name, surrounding) {
  let total = none;
  for (const { title, command: [program, ...rest], env = surrounding.env, before, count } of SUITES[name].runs(surrounding)) {
    const start = performance.now();
    before?.();
    const result = await run(program, rest, { env, capture: true, timeout: SECONDS_PER_RUN });
    const counted = count?.(result.output) ?? { passed: result.code === 0 ? 1 : 0, failed: result.code === 0 ? 0 : 1, skipped: 0 };
    const { counts, reason } = judge(result, counted);
    if (counts.failed > 0) console.log(compact(result.output));
    console.log(`${name}: ${title}: ${inWords(counts)} (${secondsSince(start)})${reason ? `. ${reason}` : ''}`);
    if (counts.skipped > 0) for (const notice of skipNotices(result.output)) console.log(`${name}: ${notice}`);
    total = add(total, counts);
  }
  return total;
}

/** Builds for the suites that need it; false, with the reason on standard error, when that fails. */
async function buildSucceeds(tools) {
  try {
    await build(tools);
    return true;
  } catch (error) {
    console.error(error instanceof Stop ? error.message : error);
    return false;
  }
}

await main(async () => {
  const start = performance.now();
  const options = process.argv.slice(2);
  const names = chosenSuites(options);
  const need = (what) => names.some((name) => SUITES[name].needs.includes(what));
  const tools = await setup({ browser: need('browser'), yes: options.includes('--yes') });
  mkdirSync(at('.setup'), { recursive: true });
  const built = !need('build') || (await buildSucceeds(tools));
  let total = built ? none : { ...none, failed: 1 };
  const surrounding = surroundings(tools);
  for (const name of names) {
    // One failure, the build's, is counted; what it keeps from running is named.
    if (!built && SUITES[name].needs.includes('build')) console.log(`${name}: not run, because the build failed`);
    else total = add(total, await runSuite(name, surrounding));
  }
  console.log(`All suites took ${secondsSince(start)}.\n${inWords(total)}`);
  if (total.failed > 0) process.exitCode = 1;
});
