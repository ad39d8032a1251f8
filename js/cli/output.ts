// Where results go, and writing them whole or not at all.

import { accessSync, constants, mkdirSync, realpathSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { basename, dirname, extname, join, parse, resolve } from 'node:path';
import { isOutputFormat, OUTPUT_FORMATS } from '../formats.js';
import type { OutputFormat } from '../types.js';
import { usage } from './arguments.js';
import { fileError, isMissing } from './file_error.js';

/** The format that a path's extension names; throws `usage` if none that can be written. */
export function outputFormat(path: string): OutputFormat {
  const extension = extname(path).toLowerCase();
  const format = extension.slice(1);
  if (isOutputFormat(format)) return format;
  const what = extension === '' ? 'has no extension' : `cannot be written as ${extension}`;
  throw usage('-o', `'${path}' ${what}; known are ${OUTPUT_FORMATS.map((known) => `.${known}`).join(', ')}`);
}

/** The path in `directory` for a result of `input` in `format`; of several, for the level number `level`. */
export function pathIn(directory: string, input: string, format: OutputFormat, level?: number): string {
  return join(directory, `${parse(input).name}${level === undefined ? '' : `_LOD${level}`}.${format}`);
}

/** Throws `usage` if `output` is the same file as one of `inputs`, by whatever name. */
export function refuseInputs(output: string, inputs: readonly string[]): void {
  const identity = identityOf(output);
  for (const input of inputs) {
    if (resolve(input) === resolve(output) || (identity !== undefined && identityOf(input) === identity)) {
      throw usage('-o', `'${output}' is an input; write to another file`);
    }
  }
}

function identityOf(path: string): string | undefined {
  try {
    const { dev, ino } = statSync(path, { bigint: true });
    return `${dev}:${ino}`;
  } catch {
    // What cannot be looked at is no input either; reading or writing it will say why.
    return undefined;
  }
}

/** Makes `directory` with those it lies in; throws `cannot-write`. */
export function makeDirectory(directory: string): void {
  try {
    mkdirSync(directory, { recursive: true });
  } catch (error) {
    throw fileError('cannot-write', error, directory);
  }
}

/** Throws `cannot-write` if `path` certainly cannot be written, so that nothing is computed in vain. */
export function checkWritable(path: string): void {
  try {
    const found = statSync(path, { throwIfNoEntry: false });
    if (found?.isDirectory()) throw Object.assign(new Error(), { code: 'EISDIR' });
    accessSync(found === undefined ? dirname(path) : path, constants.W_OK);
  } catch (error) {
    throw fileError('cannot-write', error, path);
  }
}

/**
 * Writes `bytes` to `path`: first to a file beside it, which then takes its place in one operation.
 *
 * Synchronous, so that a signal cannot come between and leave that file behind. Throws `cannot-write`, and then what
 * was at `path` is still there.
 */
export function writeWhole(path: string, bytes: Uint8Array): void {
  let temporary: string | undefined;
  try {
    // Through a link, the file it names is replaced and not the link.
    const target = realPath(path);
    const mode = statSync(target, { throwIfNoEntry: false })?.mode;
    temporary = join(dirname(target), `.${basename(target)}.${process.pid}.tmp`);
    writeFileSync(temporary, bytes, { flag: 'wx', ...(mode === undefined ? {} : { mode: mode & 0o777 }) });
    renameSync(temporary, target);
  } catch (error) {
    const ours = temporary !== undefined && (error as { code?: unknown }).code !== 'EEXIST';
    if (ours) rmSync(temporary as string, { force: true });
    throw fileError('cannot-write', error, path);
  }
}

function realPath(path: string): string {
  try {
    return realpathSync(path);
  } catch (error) {
    if (isMissing(error)) return resolve(path);
    throw error;
  }
}
