// Set-up: finds or installs what building and testing need, and names in one sentence what it cannot install.
//
// Runs on bare Node. Looks at files rather than asking programs, so that a run with nothing to do costs milliseconds.
//
//     node scripts/setup.mjs [--browser] [--yes]

import { existsSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync } from 'node:fs';
import { homedir } from 'node:os';
import { delimiter, dirname, join } from 'node:path';
import { createInterface } from 'node:readline/promises';
import { Stop, at, findProgram, isMain, isProgram, main, readIfThere, run } from './project.mjs';

// Vite's and oxlint's lowest. The package itself runs on any Node 20.
const LOWEST_NODE = [20, 19];
const WASM_TARGET = 'wasm32-unknown-unknown';

const say = (text) => console.log(`set-up: ${text}`);

/**
 * Makes the machine ready, installing what is missing; throws a Stop that names what cannot be installed.
 *
 * `browser` (default false) also asks for Chromium and its driver, which only the tests need. `yes` (default false)
 * installs system packages without asking. Resolves to the tools: `env`, the environment for cargo and all that it
 * starts; `wasmBindgen` and `wasmTestRunner`, paths; with `browser` also `chromium` and `chromedriver`, paths.
 */
export async function setup({ browser = false, yes = false } = {}) {
  checkNode();
  await needLinker(yes);
  const env = await needRust();
  await needNodeModules();
  const tools = { env, ...(await needWasmBindgen(env)) };
  return browser ? { ...tools, ...(await needBrowser(yes)) } : tools;
}

function checkNode() {
  const [major, minor] = process.versions.node.split('.').map(Number);
  if (major > LOWEST_NODE[0] || (major === LOWEST_NODE[0] && minor >= LOWEST_NODE[1])) return;
  throw new Stop(
    `Node ${process.versions.node} is too old: install Node ${LOWEST_NODE.join('.')} or later from https://nodejs.org/.`,
  );
}

// Rust links every build script and procedural macro with the system's C compiler, also when it builds for wasm.
async function needLinker(yes) {
  if (process.platform === 'win32' || findProgram(['cc', 'gcc', 'clang'])) return;
  await installPackages({
    missing: 'A C compiler (cc), with which Rust links its programs,',
    packages: ['gcc', 'libc6-dev'],
    elsewhere: process.platform === 'darwin' ? 'run `xcode-select --install`' : 'install gcc',
    yes,
  });
}

/** The pinned toolchain with its components and the wasm target; resolves to the environment that uses it. */
async function needRust() {
  const pinned = readFileSync(at('rust-toolchain.toml'), 'utf8');
  const channel = /^channel\s*=\s*"([^"]+)"/m.exec(pinned)?.[1];
  if (channel === undefined) throw new Stop('rust-toolchain.toml names no channel: restore it from the repository.');

  const cargoHome = process.env.CARGO_HOME || join(homedir(), '.cargo');
  // A shell that was open while rustup was installed does not have its directory on the PATH yet.
  const searchPath = `${process.env.PATH ?? ''}${delimiter}${join(cargoHome, 'bin')}`;
  const rustup = findProgram(['rustup'], searchPath);
  if (rustup === undefined) {
    throw new Stop('rustup, the installer of Rust, is missing: get it from https://rustup.rs/ and run this again.');
  }
  // The cargo beside rustup comes first: another one on the PATH would not heed the pinned toolchain.
  const env = { ...process.env, PATH: `${dirname(rustup)}${delimiter}${process.env.PATH ?? ''}`, RUSTUP_TOOLCHAIN: channel };
  if (findProgram(['cargo'], env.PATH) === undefined) {
    throw new Stop(`cargo is missing beside ${rustup}: install Rust again from https://rustup.rs/.`);
  }
  // These would reach every crate and both builds, and undo what the scripts ask for.
  for (const name of ['RUSTFLAGS', 'CARGO_ENCODED_RUSTFLAGS', 'CARGO_BUILD_TARGET', 'CARGO_BUILD_RUSTFLAGS']) delete env[name];

  if (!hasToolchain(channel)) {
    say(`installing Rust ${channel} with clippy and rustfmt`);
    const extras = ['--profile', 'minimal', '--component', 'clippy', '--component', 'rustfmt', '--no-self-update'];
    await must(rustup, ['toolchain', 'install', channel, ...extras], env, `Rust ${channel} could not be installed`);
  }
  if (!hasToolchain(channel, WASM_TARGET)) {
    say(`adding Rust's target ${WASM_TARGET}`);
    await must(rustup, ['target', 'add', WASM_TARGET, '--toolchain', channel], env, `${WASM_TARGET} could not be added`);
  }
  return env;
}

// rustup keeps a toolchain as a directory named CHANNEL-HOST, a target as a directory of libraries in it. Asking
// rustup instead would cost more than everything else here together.
function hasToolchain(channel, target) {
  const toolchains = join(process.env.RUSTUP_HOME || join(homedir(), '.rustup'), 'toolchains');
  if (!existsSync(toolchains)) return false;
  const suffix = process.platform === 'win32' ? '.exe' : '';
  return readdirSync(toolchains)
    .filter((name) => name === channel || name.startsWith(`${channel}-`))
    .some((name) => {
      const directory = join(toolchains, name);
      if (target !== undefined) return existsSync(join(directory, 'lib', 'rustlib', target, 'lib'));
      return ['cargo', 'cargo-clippy', 'rustfmt'].every((tool) => existsSync(join(directory, 'bin', tool + suffix)));
    });
}

async function needNodeModules() {
  if (nodeModulesMatchLock()) return;
  say('installing the packages of package-lock.json (npm ci)');
  // npm tells its scripts where it is; by hand, the one on the PATH will do. Without --include=dev a machine with
  // NODE_ENV=production would get none of the tools.
  const npmScript = process.env.npm_execpath;
  const [program, first] = npmScript?.endsWith('.js') ? [process.execPath, [npmScript]] : [findProgram(['npm']) ?? 'npm', []];
  await must(program, [...first, 'ci', '--include=dev', '--no-audit', '--no-fund'], process.env, '`npm ci` failed');
}

// npm records what it put into node_modules in a second lock file there, as its last step: an interrupted
// installation has none, a stale one differs.
function nodeModulesMatchLock() {
  const installed = readIfThere(at('node_modules', '.package-lock.json'));
  if (installed === undefined) return false;
  try {
    const present = JSON.parse(installed).packages;
    const wanted = JSON.parse(readFileSync(at('package-lock.json'), 'utf8')).packages;
    return Object.entries(wanted).every(([path, entry]) => {
      if (path === '') return true;
      // Optional packages are built for one platform each; those of the others are left out rightly.
      if (present[path] === undefined) return entry.optional === true;
      return present[path].version === entry.version && present[path].integrity === entry.integrity;
    });
  } catch {
    return false;
  }
}

/** The version of wasm-bindgen that Cargo.lock pins; the command-line tool must be of exactly this version. */
export function wasmBindgenVersion(lock = readFileSync(at('Cargo.lock'), 'utf8')) {
  const version = /^name = "wasm-bindgen"\r?\nversion = "([^"]+)"/m.exec(lock)?.[1];
  if (version === undefined) throw new Stop('Cargo.lock pins no wasm-bindgen: restore it from the repository.');
  return version;
}

/** Where this user's caches live, by the platform's custom. */
export function cacheDirectory(platform = process.platform, env = process.env, home = homedir()) {
  if (platform === 'darwin') return join(home, 'Library', 'Caches', 'decimesh');
  if (platform === 'win32') return join(env.LOCALAPPDATA || join(home, 'AppData', 'Local'), 'decimesh');
  return join(env.XDG_CACHE_HOME || join(home, '.cache'), 'decimesh');
}

async function needWasmBindgen(env) {
  const version = wasmBindgenVersion();
  const cache = cacheDirectory();
  const home = join(cache, `wasm-bindgen-cli-${version}`);
  const suffix = process.platform === 'win32' ? '.exe' : '';
  const tools = {
    wasmBindgen: join(home, 'bin', `wasm-bindgen${suffix}`),
    wasmTestRunner: join(home, 'bin', `wasm-bindgen-test-runner${suffix}`),
  };
  const complete = () => Object.values(tools).every(isProgram);
  if (complete()) return tools;

  mkdirSync(cache, { recursive: true });
  sweepAbandonedBuilds(cache);
  say(`building wasm-bindgen-cli ${version} into ${home}: takes about 4 minutes, once per machine`);
  // Built beside its place and renamed when whole: an interrupted build is never mistaken for a tool.
  const building = join(cache, `building-${process.pid}`);
  mkdirSync(building);
  try {
    const buildEnv = { ...env, CARGO_TARGET_DIR: join(building, 'target') };
    const what = ['install', 'wasm-bindgen-cli', '--version', version, '--root', building, '--no-track'];
    await must(findProgram(['cargo'], env.PATH), what, buildEnv, `wasm-bindgen-cli ${version} could not be built`, building);
    rmSync(join(building, 'target'), { recursive: true, force: true });
    // A clone set up at the same time may have finished first: then its tool is as good as this one.
    if (!complete()) {
      rmSync(home, { recursive: true, force: true });
      renameSync(building, home);
    }
  } finally {
    rmSync(building, { recursive: true, force: true });
  }
  return tools;
}

function sweepAbandonedBuilds(cache) {
  for (const name of readdirSync(cache)) {
    const id = /^building-(\d+)$/.exec(name)?.[1];
    if (id === undefined) continue;
    try {
      process.kill(Number(id), 0); // only asks whether it lives
    } catch (error) {
      if (error.code === 'ESRCH') rmSync(join(cache, name), { recursive: true, force: true });
    }
  }
}

const CHROMIUM_NAMES = ['chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable', 'chrome'];
const CHROMIUM_PLACES = [
  '/Applications/Google Chrome.app/Contents/MacOS/Google Chrome',
  '/Applications/Chromium.app/Contents/MacOS/Chromium',
  'C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe',
];
const CHROMEDRIVER_PLACES = ['/usr/lib/chromium/chromedriver', '/usr/lib/chromium-browser/chromedriver'];

/** Chromium or Chrome and its driver: the environment's CHROMIUM and CHROMEDRIVER, else the usual names and places. */
function findBrowser(env = process.env) {
  for (const name of ['CHROMIUM', 'CHROMEDRIVER']) {
    if (env[name] && !isProgram(env[name])) {
      throw new Stop(`${name} is set to ${env[name]}, which is not a program: correct it or unset it.`);
    }
  }
  return {
    chromium: env.CHROMIUM || findProgram(CHROMIUM_NAMES) || CHROMIUM_PLACES.find(isProgram),
    chromedriver: env.CHROMEDRIVER || findProgram(['chromedriver']) || CHROMEDRIVER_PLACES.find(isProgram),
  };
}

async function needBrowser(yes) {
  const found = findBrowser();
  if (found.chromium && found.chromedriver) return found;
  const missing = found.chromium ? 'chromedriver' : found.chromedriver ? 'Chromium' : 'Chromium with chromedriver';
  await installPackages({
    missing: `${missing}, which the tests run in,`,
    packages: ['chromium', 'chromium-driver'],
    elsewhere: 'install Chrome and its chromedriver from https://googlechromelabs.github.io/chrome-for-testing/, '
      + 'or set CHROMIUM and CHROMEDRIVER to their paths',
    yes,
  });
  const installed = findBrowser();
  if (installed.chromium && installed.chromedriver) return installed;
  throw new Stop(`${missing} is still missing after the installation: set CHROMIUM and CHROMEDRIVER to their paths.`);
}

/** Installs Debian packages where that is possible and wanted; otherwise a Stop says how to get them. */
async function installPackages({ missing, packages, elsewhere, yes }) {
  const release = readIfThere('/etc/os-release') ?? '';
  const debian = /^ID(_LIKE)?=.*\b(debian|ubuntu)\b/m.test(release) && findProgram(['apt-get']) !== undefined;
  if (!debian) throw new Stop(`${missing} is missing: ${elsewhere}.`);
  const byHand = `sudo apt-get install ${packages.join(' ')}`;
  if (process.getuid?.() !== 0) throw new Stop(`${missing} is missing: install it with \`${byHand}\`.`);

  const interactive = process.stdin.isTTY && process.stdout.isTTY && !process.env.CI;
  if (interactive && !yes) {
    const terminal = createInterface({ input: process.stdin, output: process.stdout });
    const answer = await terminal.question(`${missing} is missing. Install the packages ${packages.join(' and ')}? [Y/n] `);
    terminal.close();
    if (!/^(y|yes|)$/i.test(answer.trim())) throw new Stop(`${missing} is missing: install it with \`${byHand}\`.`);
  }
  say(`installing the packages ${packages.join(' and ')} (apt-get)`);
  const env = { ...process.env, DEBIAN_FRONTEND: 'noninteractive' };
  const failed = `${missing} is missing and \`${byHand}\` failed`;
  await must('apt-get', ['update', '-qq'], env, failed);
  await must('apt-get', ['install', '-y', '-qq', '--no-install-recommends', ...packages], env, failed);
}

async function must(program, programArguments, env, failure, cwd = at()) {
  const { code } = await run(program, programArguments, { env, cwd });
  if (code !== 0) throw new Stop(`${failure}: see the lines above.`);
}

if (isMain(import.meta.url)) {
  await main(async () => {
    const options = process.argv.slice(2);
    await setup({ browser: options.includes('--browser'), yes: options.includes('--yes') });
    say('everything is there');
  });
}
