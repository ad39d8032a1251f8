// The ecosystem's decoders and encoders, each loaded the first time a file needs it.

import { loadWasm } from '../engine.js';
import { DecimeshError } from '../errors.js';
import type { DracoDecoderModule, DracoEncoderModule } from './draco_types.js';

/** Loads once, and again after a failure. */
function once<Result>(what: string, load: () => Promise<Result>): () => Promise<Result> {
  let loading: Promise<Result> | undefined;
  return () =>
    (loading ??= load().catch((error: unknown) => {
      loading = undefined;
      if (error instanceof DecimeshError) throw error;
      const reason = error instanceof Error ? error.message : String(error);
      throw new DecimeshError('cannot-read', `${what} could not be loaded: ${reason}`, what, { cause: error });
    }));
}

/** The decoder of meshoptimizer. */
export const meshoptDecoder = once('the meshopt decoder', async () => {
  const { MeshoptDecoder } = await import('./vendor/meshopt_decoder.js');
  await MeshoptDecoder.ready;
  return MeshoptDecoder;
});

/** The encoder of meshoptimizer. */
export const meshoptEncoder = once('the meshopt encoder', async () => {
  const { MeshoptEncoder } = await import('./vendor/meshopt_encoder.js');
  await MeshoptEncoder.ready;
  return MeshoptEncoder;
});

/** fflate, for archives. */
export const fflate = once('the archive reader', () => import('./vendor/fflate.js'));

const dracoDecoderParts = once('the Draco decoder', async () => {
  const [{ default: create }, wasm] = await Promise.all([
    import('./vendor/draco_decoder.js'),
    loadWasm(new URL('./vendor/draco_decoder.wasm', import.meta.url)),
  ]);
  return { create, wasm };
});

const dracoEncoderParts = once('the Draco encoder', async () => {
  const [{ default: create }, wasm] = await Promise.all([
    import('./vendor/draco_encoder.js'),
    loadWasm(new URL('./vendor/draco_encoder.wasm', import.meta.url)),
  ]);
  return { create, wasm };
});

/**
 * A new instance of Draco's decoder, of the module compiled once: its memory only grows, and is given back when the
 * caller forgets it; and one that was aborted by a bad file must not be used again.
 */
export async function newDracoDecoder(): Promise<DracoDecoderModule> {
  const { create, wasm } = await dracoDecoderParts();
  return (await instantiate(create, wasm, 'the Draco decoder')) as DracoDecoderModule;
}

/** As {@link newDracoDecoder}. */
export async function newDracoEncoder(): Promise<DracoEncoderModule> {
  const { create, wasm } = await dracoEncoderParts();
  return (await instantiate(create, wasm, 'the Draco encoder')) as DracoEncoderModule;
}

type Create = (options: object) => Promise<unknown>;

async function instantiate(create: Create, wasm: WebAssembly.Module, what: string): Promise<unknown> {
  return new Promise((resolve, reject) => {
    const fail = (error: unknown): void => {
      const reason = error instanceof Error ? error.message : String(error);
      reject(new DecimeshError('cannot-read', `${what} could not be started: ${reason}`, what, { cause: error }));
    };
    const options = {
      print: () => {},
      printErr: () => {},
      instantiateWasm: (imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void) => {
        // oxlint-disable-next-line promise/no-callback-in-promise -- Emscripten's interface is a callback
        WebAssembly.instantiate(wasm, imports).then(done).catch(fail);
        return {};
      },
    };
    // Its object may be a thenable that resolves to itself: awaiting that as such would never end.
    create(options).then((module) => resolve(module), fail);
  });
}
