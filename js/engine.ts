// The one WebAssembly instance: loading it, guarding every call into it, replacing it after a trap.
//
// A trap leaves the instance's memory in an unknown state, so the instance is thrown away and with it every object in
// it. Objects remember the generation of the instance they live in; one of an earlier generation only says so.

import instantiate, * as glue from './wasm/decimesh.js';
import { DecimeshError, errorFromData, isErrorData } from './errors.js';
import { importNode, isNode } from './platform.js';
import { supportsSimd } from './simd.js';

/** Where the engine's WebAssembly comes from: an address (on Node also a path), its bytes, or the compiled module. */
export type WasmSource = string | URL | ArrayBuffer | Uint8Array<ArrayBuffer> | WebAssembly.Module;

let ready: Promise<void> | undefined;
let initialised = false;
let generation = 0;
// Set when a trapped instance could not be replaced yet, for want of memory.
let restartPending = false;
// What the panic hook said during the call that is running.
let panicMessage: string | undefined;

/**
 * Loads the engine; needed once before the synchronous calls, while the asynchronous ones do it themselves.
 *
 * Without `source` the build for this machine (with or without vector instructions) is taken from beside this module.
 * Calls at the same time share one load, later ones return at once and ignore `source`; after a failure the next call
 * tries again. Rejects with `cannot-read` when the file cannot be loaded or is not the engine, `unsupported` where
 * there is no WebAssembly, `out-of-memory` when there is no room for it.
 */
export function init(source?: WasmSource): Promise<void> {
  ready ??= load(source).catch((error: unknown) => {
    ready = undefined;
    throw error;
  });
  return ready;
}

async function load(source: WasmSource | undefined): Promise<void> {
  if (typeof WebAssembly !== 'object') {
    throw new DecimeshError('unsupported', 'this environment has no WebAssembly');
  }
  // Both addresses are spelt out because bundlers only find literal ones.
  const wanted =
    source ??
    (supportsSimd()
      ? new URL('./wasm/decimesh_simd.wasm', import.meta.url)
      : new URL('./wasm/decimesh_scalar.wasm', import.meta.url));
  const place = typeof wanted === 'string' ? wanted : wanted instanceof URL ? wanted.href : 'wasm';
  try {
    listenForPanics();
    await instantiate({ module_or_path: await loadWasm(wanted) });
    initialised = true;
  } catch (error) {
    if (error instanceof DecimeshError) throw error;
    const reason = error instanceof Error ? error.message : String(error);
    throw error instanceof RangeError
      ? new DecimeshError('out-of-memory', `the engine could not be loaded: ${reason}`, place, { cause: error })
      : new DecimeshError('cannot-read', `the engine could not be loaded: ${reason}`, place, { cause: error });
  }
}

/** The compiled module of `source`, from disk on Node and else fetched. */
export async function loadWasm(source: WasmSource): Promise<WebAssembly.Module> {
  if (source instanceof WebAssembly.Module) return source;
  if (typeof source !== 'string' && !(source instanceof URL)) return WebAssembly.compile(source);
  if (isNode) {
    // A scheme has at least two letters: `C:` is a drive.
    const path = typeof source === 'string' && /^[a-z][a-z0-9+.-]+:/i.test(source) ? new URL(source) : source;
    if (typeof path === 'string' || path.protocol === 'file:') {
      const { readFile } = await importNode('node:fs/promises');
      return WebAssembly.compile(await readFile(path));
    }
  }
  const response = await fetch(source);
  if (!response.ok) throw new DecimeshError('cannot-read', `HTTP status ${response.status}`, response.url);
  // Streaming demands the right type; a server that does not know .wasm only costs the streaming.
  const typed = response.headers.get('Content-Type')?.split(';')[0]?.trim() === 'application/wasm';
  return typed && typeof WebAssembly.compileStreaming === 'function'
    ? WebAssembly.compileStreaming(response)
    : WebAssembly.compile(await response.arrayBuffer());
}

interface PanicListener {
  __decimeshPanic?: (message: string) => void;
}

let listening = false;
function listenForPanics(): void {
  if (listening) return;
  listening = true;
  const globals = globalThis as PanicListener;
  // Another copy of this package may be on the same page: both hear of every panic, only one has a call running.
  const others = globals.__decimeshPanic;
  globals.__decimeshPanic = (message) => {
    panicMessage = message;
    others?.(message);
  };
}

/**
 * Runs `work`, which calls into the engine, and returns its result. Every call into the engine goes through here.
 *
 * Throws the engine's own errors as they are. Anything else that comes out of the engine is a trap: it throws
 * `out-of-memory` or `internal` and replaces the instance, so that the next call works.
 */
export function callEngine<Result>(work: (engine: typeof glue) => Result): Result {
  if (!initialised) throw new DecimeshError('not-initialised', 'call init() and wait for it first');
  if (restartPending) restart();
  panicMessage = undefined;
  try {
    return work(glue);
  } catch (thrown) {
    if (isErrorData(thrown)) throw errorFromData(thrown);
    if (thrown instanceof DecimeshError) throw thrown;
    const error = errorFromTrap(thrown, panicMessage);
    generation += 1;
    restartPending = true;
    try {
      restart();
    } catch {
      // No memory even for an empty instance. It stays pending, and the next call reports it if it fails again.
    }
    throw error;
  }
}

/** The error for what came out of the engine instead of a result; `panic` is what its panic hook said, if it did. */
export function errorFromTrap(thrown: unknown, panic: string | undefined): DecimeshError {
  const text = thrown instanceof Error ? thrown.message : String(thrown);
  const options = { cause: thrown };
  if (panic !== undefined && !panic.includes('capacity overflow')) {
    return new DecimeshError('internal', oneLine(panic), '', options);
  }
  // A failed allocation aborts without a panic: an `unreachable` is executed and nothing was said before. Copying a
  // result out of the engine may fail for the same want of memory, then as an error of the array's constructor.
  const aborted = thrown instanceof WebAssembly.RuntimeError && /unreachable/i.test(text);
  const noRoom = thrown instanceof RangeError && /alloc|array length|memory/i.test(text);
  if (panic !== undefined || aborted || noRoom) {
    return new DecimeshError('out-of-memory', 'not enough memory; the engine was restarted', '', options);
  }
  return new DecimeshError('internal', oneLine(text), '', options);
}

function oneLine(text: string): string {
  return text.trim().replace(/\s*\n\s*/g, ' ');
}

function restart(): void {
  try {
    glue.__wbg_reset_state();
  } catch (error) {
    throw new DecimeshError('out-of-memory', 'not enough memory to restart the engine', '', { cause: error });
  }
  restartPending = false;
}

/**
 * An object inside the engine, with the instance it lives in.
 *
 * The glue's finalizers free an object that was forgotten, and leave those of an earlier instance alone; its `free()`
 * and, before that, its borrow flags do not look, which is why no call may go past this class.
 */
export class EngineObject<Kind extends { free(): void }> {
  #object: Kind | undefined;
  readonly #generation: number;
  readonly #name: string;

  /** `name` is what messages call it. Throws what {@link callEngine} throws. */
  constructor(name: string, create: (engine: typeof glue) => Kind) {
    this.#name = name;
    this.#object = callEngine(create);
    this.#generation = generation;
  }

  /** Throws `disposed` unless {@link call} can reach the object. */
  check(): void {
    if (this.#object === undefined) throw new DecimeshError('disposed', `the ${this.#name} was disposed`);
    if (this.#generation !== generation) {
      throw new DecimeshError('disposed', `the engine was restarted after a failure; open the ${this.#name} again`);
    }
  }

  /** Runs `use` on the object. */
  call<Result>(use: (object: Kind) => Result): Result {
    this.check();
    return callEngine(() => use(this.#object as Kind));
  }

  /** Frees the object's memory. Disposing twice, or after a restart, does nothing. */
  dispose(): void {
    const object = this.#object;
    this.#object = undefined;
    if (object !== undefined && this.#generation === generation) callEngine(() => object.free());
  }
}
