// Distances by a meter that is none of ours, where it and the model are at hand; else a test says that it is skipped.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gunzipSync } from 'node:zlib';
import { test } from 'vitest';
import { assetPath } from './assets.ts';
import { temporaryDirectory } from './program.ts';

const METER = process.env['MESHDIST'] ?? fileURLToPath(new URL('../../../shared/tools/meshdist', import.meta.url));

/** Whether {@link meter} can be asked. */
export const hasMeter = existsSync(METER);

/** Symmetric distances in per cent of the original's diagonal. */
export interface Metered {
  readonly mean: number;
  readonly rms: number;
  /** The largest. */
  readonly haus: number;
}

/** The meter's figures for `result` against `original`, both OBJ texts. */
export function meter(original: Uint8Array, result: Uint8Array): Metered {
  const directory = temporaryDirectory();
  const files = [original, result].map((bytes, index) => {
    const file = join(directory, `${index}.obj`);
    writeFileSync(file, bytes);
    return file;
  });
  return JSON.parse(execFileSync(METER, files, { encoding: 'utf8' })) as Metered;
}

/** A test with the OBJ model `name` of the benchmarks that asks the {@link meter}. */
export function testWithMeter(name: string, title: string, run: (original: Uint8Array<ArrayBuffer>) => Promise<void>): void {
  const path = assetPath(`bench/${name}.obj.gz`);
  const missing = [path, METER].find((file) => !existsSync(file));
  if (missing !== undefined) console.log(`skipped: ${title}: ${name}: ${missing} is not there`);
  test.skipIf(missing !== undefined)(`${title} ${name}`, () => run(new Uint8Array(gunzipSync(readFileSync(path)))));
}
