// Results that cost much and never change: kept on disk as JSON under the hash of everything they depend on.
import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { cacheDirectory } from '../../scripts/setup.mjs';

const directory = join(cacheDirectory(), 'bench');

/** Hex digest of strings and typed arrays, in order. */
export function digest(...parts) {
  const hash = createHash('sha256');
  for (const part of parts) {
    // The length keeps ('ab', 'c') apart from ('a', 'bc').
    const bytes = typeof part === 'string' ? Buffer.from(part) : Buffer.from(part.buffer, part.byteOffset, part.byteLength);
    hash.update(`${bytes.length}:`).update(bytes);
  }
  return hash.digest('hex').slice(0, 40);
}

/** The value kept under `key` (a digest), or that of `compute`, which is kept then. It must survive JSON. */
export function cached(key, compute) {
  return lookUp(key) ?? keep(key, compute());
}

/** As `cached`, for a `compute` that takes its time. */
export async function cachedAsync(key, compute) {
  return lookUp(key) ?? keep(key, await compute());
}

function lookUp(key) {
  try {
    return JSON.parse(readFileSync(join(directory, `${key}.json`), 'utf8'));
  } catch {
    // Absent, or cut off by a full disk: computed again either way.
    return undefined;
  }
}

function keep(key, value) {
  const file = join(directory, `${key}.json`);
  mkdirSync(directory, { recursive: true });
  // Written aside and renamed, so that two runs at once never read half a file.
  const aside = `${file}.${process.pid}`;
  writeFileSync(aside, JSON.stringify(value));
  renameSync(aside, file);
  return value;
}
