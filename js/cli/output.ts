// Where results go, and writing them whole or not at all.

import { accessSync, constants, mkdirSync, realpathSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { basename, dirname, extname, join, parse, resolve } from 'node:path';
import { isOutputFormat, OUTPUT_FORMATS } from '../formats.js';
import { PROGRESSIVE_EXTENSION } from '../progressive/container.js';
import type { OutputFormat } from '../types.js';
import { usage } from './arguments.js';
import { fileError, isMissing } from './file_error.js';

/** The format that a path's extension names; throws `usage` if none that can be written. */
export function outputFormat(path: string): OutputFormat {
  const extension = extname(path).toLowerCase();
  const format = extension.slice(1);
  if (isOutputFormat(format)) return format;
  const what = extension === '' ? 'has no extension' : `cannot be written as ${extension}`;
  throw usage('-o', `'${path}' ${what}; known are ${OUTPUT_FORMATS.map((known) => `.${known}`).join(', ')}, ${PROGRESSIVE_EXTENSION}`);
}

/** Whether a path is to be a progressive mesh, which is no format of documents. */
export function isProgressivePath(path: string | undefined): path is string {
  return path !== undefined && extname(path).toLowerCase() === PROGRESSIVE_EXTENSION;
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

/** A file to be written. */
export interface OutputFile {
  readonly path: string;
  readonly bytes: Uint8Array;
}

/** A file on its way to its place. */
interface Pending {
  readonly path: string;
  readonly target: string;
  readonly temporary: string;
  /** What was at the target, kept until all is well. */
  backup?: string;
  moved?: boolean;
}

/**
 * Writes all files or none: each first beside its place, which it then takes in one operation; when one cannot, those
 * before it are taken back.
 *
 * Synchronous, so that a signal cannot come between and leave something half done. Throws `cannot-write`, and then what
 * was at the paths is still there.
 */
export function writeAll(files: readonly OutputFile[]): void {
  const pending: Pending[] = [];
  let path = '';
  try {
    for (const file of files) {
      ({ path } = file);
      // Through a link, the file it names is replaced and not the link.
      const target = realPath(path);
      const beside = join(dirname(target), `.${basename(target)}.${process.pid}`);
      const there = statSync(target, { throwIfNoEntry: false });
      if (there?.isDirectory()) throw Object.assign(new Error(), { code: 'EISDIR' });
      const mode = there?.mode;
      writeFileSync(`${beside}.tmp`, '', { flag: 'wx', ...(mode === undefined ? {} : { mode: mode & 0o777 }) });
      pending.push({ path, target, temporary: `${beside}.tmp` });
      writeFileSync(`${beside}.tmp`, file.bytes);
    }
    for (const file of pending) {
      ({ path } = file);
      // One file alone takes its place at once; of several, each has to be able to go back.
      if (pending.length > 1 && statSync(file.target, { throwIfNoEntry: false }) !== undefined) {
        const backup = file.temporary.replace(/tmp$/, 'old');
        renameSync(file.target, backup);
        file.backup = backup;
      }
      renameSync(file.temporary, file.target);
      file.moved = true;
    }
  } catch (error) {
    for (const { target, temporary, backup, moved } of pending.reverse()) {
      rmSync(temporary, { force: true });
      if (moved) rmSync(target, { force: true });
      if (backup !== undefined) renameSync(backup, target);
    }
    throw fileError('cannot-write', error, path);
  }
  for (const { backup } of pending) if (backup !== undefined) rmSync(backup, { force: true });
}

function realPath(path: string): string {
  try {
    return realpathSync(path);
  } catch (error) {
    if (isMissing(error)) return resolve(path);
    throw error;
  }
}
