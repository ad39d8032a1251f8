// Traps: what goes wrong inside the engine becomes a typed error, and the next call works.
import { afterEach, beforeAll, describe, expect, it, vi } from 'vitest';
import { init, openDocument, type DecimeshError } from 'decimesh';
import { callEngine, errorFromTrap } from '../dist/engine.js';
import instantiate, { Model } from '../dist/wasm/decimesh.js';
import { glb, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { thrown } from './support/thrown.ts';

const file = (size: number): Uint8Array => glb(gltfOf(hills(size)));
const coded = (code: string): unknown => expect.objectContaining({ name: 'DecimeshError', code });

beforeAll(() => init());

describe('a trap', () => {
  afterEach(() => {
    vi.restoreAllMocks();
  });

  // The functions of the instance as it is now, past the glue's classes.
  const raw = async (): Promise<Record<string, (...args: number[]) => unknown>> =>
    (await instantiate(undefined as never)) as unknown as Record<string, (...args: number[]) => unknown>;
  const BOGUS_POINTER = 0xffff_fff0;

  async function expectWorking(): Promise<void> {
    using document = await openDocument(file(10));
    expect((await document.simplify({ ratio: 0.5 })).triangles).toBeLessThanOrEqual(100);
  }

  it('in a call is an internal error; the next call has a new instance, and older documents say that they are gone', async () => {
    const lost = await openDocument(file(10));
    const bystander = await openDocument(file(10));
    const memoryBefore = ((await raw()) as unknown as { memory: WebAssembly.Memory }).memory;
    const exports = await raw();
    vi.spyOn(Model.prototype, 'step').mockImplementation((work) => exports['model_step']!(BOGUS_POINTER, work) as number);
    await expect(lost.simplify({ ratio: 0.5 })).rejects.toEqual(coded('internal'));
    vi.restoreAllMocks();
    expect(((await raw()) as unknown as { memory: WebAssembly.Memory }).memory).not.toBe(memoryBefore);
    await expectWorking();
    for (const document of [lost, bystander]) {
      const error = await document.level({}).catch((reason: unknown) => reason);
      expect(error).toEqual(coded('disposed'));
      expect((error as DecimeshError).message).toContain('restarted');
    }
  });

  it('does not let a document of the old instance free memory of the new one', async () => {
    const old = await openDocument(file(10));
    const exports = await raw();
    expect(thrown(() => callEngine(() => exports['model_step']!(BOGUS_POINTER, 1)))).toEqual(coded('internal'));
    // The same size from the same start: very likely at the same address.
    using young = await openDocument(file(10));
    const free = vi.spyOn(Model.prototype, 'free');
    old.dispose();
    expect(free).not.toHaveBeenCalled();
    expect((await young.simplify({ ratio: 0.5 })).triangles).toBeLessThanOrEqual(100);
  });

  it('for want of memory is out-of-memory', async () => {
    const exports = await raw();
    const exhaust = (): void => {
      for (let block = 0; block < 8; block += 1) exports['__wbindgen_malloc']!(2 ** 30, 1);
    };
    expect(thrown(() => callEngine(exhaust))).toEqual(coded('out-of-memory'));
    await expectWorking();
  });

  it('of an endless recursion is an internal error', async () => {
    const recurse = (): number => 1 + recurse();
    expect(thrown(() => callEngine(recurse))).toEqual(coded('internal'));
    await expectWorking();
  });

  it('after a panic has the panic message, on one line', async () => {
    const panic = (globalThis as { __decimeshPanic?: (message: string) => void }).__decimeshPanic;
    const error = thrown(() =>
      callEngine(() => {
        panic?.('panicked at src/lib.rs:1:2:\nindex out of bounds');
        throw new WebAssembly.RuntimeError('unreachable');
      }),
    );
    expect(error).toEqual(coded('internal'));
    expect((error as DecimeshError).message).toBe('panicked at src/lib.rs:1:2: index out of bounds');
    // The message belongs to that call alone.
    const next = thrown(() =>
      callEngine(() => {
        throw new WebAssembly.RuntimeError('unreachable');
      }),
    );
    expect(next).toEqual(coded('out-of-memory'));
    await expectWorking();
  });

  it('is told apart by what the engines of all browsers say', () => {
    const { RuntimeError } = WebAssembly;
    const codeOf = (error: unknown, panic?: string): string => errorFromTrap(error, panic).code;
    expect(codeOf(new RuntimeError('unreachable'))).toBe('out-of-memory');
    expect(codeOf(new RuntimeError('unreachable executed'))).toBe('out-of-memory');
    expect(codeOf(new RuntimeError('Unreachable code should not be executed (evaluating ...)'))).toBe('out-of-memory');
    expect(codeOf(new RuntimeError('unreachable'), 'panicked at a.rs: capacity overflow')).toBe('out-of-memory');
    expect(codeOf(new RangeError('Array buffer allocation failed'))).toBe('out-of-memory');
    expect(codeOf(new RangeError('Maximum call stack size exceeded'))).toBe('internal');
    expect(codeOf(new RuntimeError('memory access out of bounds'))).toBe('internal');
    expect(codeOf('a string')).toBe('internal');
  });
});
