// The build: Rust → dist/wasm, js/ → dist, www/ → site, each stage only when something it reads has changed.
//
//     node scripts/build.mjs [--wasm-only | --no-page]

import { chmodSync, existsSync, mkdirSync, readFileSync, readdirSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { homedir } from 'node:os';
import { join, resolve } from 'node:path';
import { gzipSync } from 'node:zlib';
import { checkPage } from './page-budget.mjs';
import { Stop, at, findProgram, hashFiles, isMain, main, readIfThere, root, run, secondsSince } from './project.mjs';
import { setup } from './setup.mjs';
import { vendor } from './vendor.mjs';

const say = (text) => console.log(`build: ${text}`);

const OWN_FILES = ['scripts/build.mjs', 'scripts/project.mjs'];
// What the stages read that no stage makes. A missing package-lock entry would go unnoticed otherwise: a new
// TypeScript, Binaryen or Vite builds differently.
const TOOLS = ['package.json', 'package-lock.json', 'rust-toolchain.toml'];

// dist/ without dist/wasm is the JavaScript stage's; files beside it would be published.
const jsOutputs = () => (existsSync(at('dist')) ? readdirSync(at('dist')) : []).filter((name) => name !== 'wasm').map((name) => `dist/${name}`);

const STAGES = {
  wasm: {
    inputs: ['src', 'Cargo.toml', 'Cargo.lock', 'scripts/size-budget.json'],
    outputs: () => ['dist/wasm'],
    make: buildWasm,
  },
  js: {
    inputs: ['js', 'scripts/vendor.mjs', 'tsconfig.base.json', 'tsconfig.json', 'tsconfig.worker.json', 'tsconfig.node.json', 'dist/wasm/decimesh.d.ts'],
    outputs: jsOutputs,
    make: buildJs,
  },
  page: {
    inputs: [
      'www', 'dist', 'vite.config.ts', 'tsconfig.www.json', 'tsconfig.service-worker.json', 'tsconfig.base.json',
      'scripts/page-budget.json', 'scripts/page-budget.mjs', 'scripts/precache.mjs',
    ],
    outputs: () => ['site'],
    make: buildPage,
  },
};

/**
 * Builds the stages named (default: all, in this order); `tools` are what setup() resolved to.
 *
 * A stage is skipped when the hash of its inputs and the hash of its outputs are those of its last success.
 */
export async function build(tools, stages = Object.keys(STAGES)) {
  for (const name of stages) {
    const stage = STAGES[name];
    const stamp = at('.setup', `${name}.json`);
    const inputs = hashFiles([...stage.inputs, ...TOOLS, ...OWN_FILES]);
    const now = () => JSON.stringify({ inputs, outputs: hashFiles(stage.outputs()) });
    if (readIfThere(stamp) === now()) continue;
    rmSync(stamp, { force: true });
    const start = performance.now();
    await stage.make(tools);
    mkdirSync(at('.setup'), { recursive: true });
    writeFileSync(stamp, now());
    say(`${name} built in ${secondsSince(start)}`);
  }
}

// One target directory for both variants: cargo keeps dependencies apart by their flags and shares the procedural
// macros, which are most of the time. Only this crate is compiled again when the flags change, and it would be anyway.
const VARIANTS = [
  { name: 'simd', rustFlags: ['-Ctarget-feature=+simd128'], optimizerFlags: ['--enable-simd'] },
  { name: 'scalar', rustFlags: [], optimizerFlags: [] },
];

// What Rust's wasm32 target has on by default, and nothing newer: the optimizer may use what it is told of.
const DEFAULT_FEATURES = [
  '--enable-bulk-memory',
  '--enable-multivalue',
  '--enable-mutable-globals',
  '--enable-nontrapping-float-to-int',
  '--enable-reference-types',
  '--enable-sign-ext',
];

async function buildWasm({ env, wasmBindgen }) {
  const work = at('.setup', 'wasm');
  rmSync(work, { recursive: true, force: true });
  mkdirSync(work, { recursive: true });
  for (const variant of VARIANTS) {
    say(`compiling the engine, ${variant.name}`);
    await must(findProgram(['cargo'], env.PATH), ['build', '--release', '--lib', '--target', 'wasm32-unknown-unknown', '--locked'], {
      env: { ...env, CARGO_ENCODED_RUSTFLAGS: [...variant.rustFlags, ...pathFlags(env)].join('\x1f') },
    });
    const target = resolve(root, env.CARGO_TARGET_DIR || 'target');
    // The same name for both, so that the glue is the same byte for byte if their exports are.
    const bound = [
      '--target', 'web', '--out-name', 'decimesh', '--out-dir', join(work, variant.name),
      // The package chooses the file by what the engine can do; a default would make bundlers look for a third.
      '--omit-default-module-path',
      // After a trap the instance is replaced, not the page.
      '--experimental-reset-state-function',
      '--ts-typed-array-buffers',
      '--remove-name-section', '--remove-producers-section',
    ];
    await must(wasmBindgen, [...bound, join(target, 'wasm32-unknown-unknown', 'release', 'decimesh.wasm')], { env });
  }

  const [simd, scalar] = VARIANTS.map(({ name }) => join(work, name));
  for (const file of ['decimesh.js', 'decimesh.d.ts']) {
    if (readFileSync(join(simd, file)).equals(readFileSync(join(scalar, file)))) continue;
    throw new Stop(
      `The simd and scalar builds need different glue, but the package ships one: compare ${join(simd, file)} with ${join(scalar, file)}.`,
    );
  }
  if (!readFileSync(join(simd, 'decimesh.js'), 'utf8').includes('export function __wbg_reset_state')) {
    throw new Stop('The glue exports no __wbg_reset_state: this wasm-bindgen has no --experimental-reset-state-function.');
  }

  const made = join(work, 'dist');
  mkdirSync(made);
  await Promise.all(VARIANTS.map(({ name, optimizerFlags }) => must(process.execPath, [
    at('node_modules', 'binaryen', 'bin', 'wasm-opt'), join(work, name, 'decimesh_bg.wasm'), '-o', join(made, `decimesh_${name}.wasm`),
    '-Os', '--strip-debug', '--strip-producers', ...DEFAULT_FEATURES, ...optimizerFlags,
  ])));
  for (const file of ['decimesh.js', 'decimesh.d.ts']) renameSync(join(simd, file), join(made, file));
  checkSizes(made);
  mkdirSync(at('dist'), { recursive: true });
  rmSync(at('dist', 'wasm'), { recursive: true, force: true });
  renameSync(made, at('dist', 'wasm'));
  rmSync(work, { recursive: true, force: true });
}

// Panic messages name source files. With the builder's own directories in them the bytes would differ from machine to
// machine, and the published package would tell where it was built.
function pathFlags(env) {
  const cargoHome = env.CARGO_HOME || join(homedir(), '.cargo');
  return [`--remap-path-prefix=${join(cargoHome, 'registry', 'src')}=crates`, `--remap-path-prefix=${root}=decimesh`];
}

function checkSizes(directory) {
  const budget = JSON.parse(readFileSync(at('scripts', 'size-budget.json'), 'utf8'));
  for (const [file, limit] of Object.entries(budget)) {
    const content = readFileSync(join(directory, file));
    const size = gzipSync(content, { level: 9 }).length;
    const share = ((100 * size) / limit).toFixed(0);
    say(`${file}: ${content.length} bytes, ${size} gzipped, ${share} % of its budget of ${limit}`);
    if (size > limit) {
      throw new Stop(`${file} is ${size} bytes gzipped, above its budget of ${limit} in scripts/size-budget.json: make it smaller.`);
    }
  }
}

async function buildJs() {
  for (const path of jsOutputs()) rmSync(at(path), { recursive: true, force: true });
  // First, because js/ takes their types from there.
  vendor();
  // The library last: where the three overlap its declarations are the ones to ship.
  for (const project of ['tsconfig.worker.json', 'tsconfig.node.json', 'tsconfig.json']) {
    await must(process.execPath, [at('node_modules', 'typescript', 'bin', 'tsc'), '-p', at(project)]);
  }
  const { bin, exports } = JSON.parse(readFileSync(at('package.json'), 'utf8'));
  for (const entry of Object.values(exports).flatMap((target) => Object.values(Object(target)))) {
    if (typeof entry === 'string' && entry.startsWith('./dist/') && !existsSync(at(entry))) {
      throw new Stop(`package.json exports ${entry}, which js/ does not make: correct one of them.`);
    }
  }
  for (const program of Object.values(bin)) {
    if (!readIfThere(at(program))?.startsWith('#!/usr/bin/env node\n')) {
      throw new Stop(`${program} has to begin with the line #!/usr/bin/env node, or npm cannot link it as a program.`);
    }
    chmodSync(at(program), 0o755);
  }
}

async function buildPage() {
  for (const project of ['tsconfig.www.json', 'tsconfig.service-worker.json']) {
    await must(process.execPath, [at('node_modules', 'typescript', 'bin', 'tsc'), '-p', at(project)]);
  }
  const vite = at('node_modules', 'vite', 'bin', 'vite.js');
  await must(process.execPath, [vite, 'build', '--config', at('vite.config.ts'), '--logLevel', 'warn']);
  checkPage(at('site'), say);
}

async function must(program, programArguments, options) {
  const { code } = await run(program, programArguments, options);
  if (code !== 0) throw new Stop('The build failed: see the lines above.');
}

/** The stages that the command line asks for. */
export function stagesFrom(options) {
  if (options.includes('--wasm-only')) return ['wasm'];
  return options.includes('--no-page') ? ['wasm', 'js'] : Object.keys(STAGES);
}

if (isMain(import.meta.url)) {
  await main(async () => {
    const start = performance.now();
    await build(await setup(), stagesFrom(process.argv.slice(2)));
    say(`up to date (${secondsSince(start)})`);
  });
}
