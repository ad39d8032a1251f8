// What people read in the terminal: errors, warnings, progress and the line on each finished file.

import { basename } from 'node:path';
import { describeBlockers } from '../blockers.js';
import { DecimeshError } from '../errors.js';
import type { Report } from '../report.js';
import type { StopReason, Warning } from '../types.js';

const LONGEST_LINE = 1000;

/** `code: place: reason` on one line; `path` is the file that was worked on, if any. */
export function errorLine(error: DecimeshError, path: string | undefined): string {
  return line([error.code, placeIn(path, error.where), error.message]);
}

/** `warning: code: place: reason` on one line. */
export function warningLine(warning: Warning, path: string): string {
  return line(['warning', warning.code, placeIn(path, warning.where), warning.message]);
}

/** Why there are not fewer triangles, where that is worth saying. */
const STOPPED: Readonly<Record<StopReason, string>> = {
  target: '',
  error: '',
  constraints: ', no fewer without damage',
  time: ', the time budget was spent',
};

/** What became of a file. */
export function resultLine(
  { input, output, stopReason, blockers, estimatedError, deviation, timings, lods }: Report,
  diagonal: number,
): string {
  const count = (value: number): string => value.toLocaleString('en');
  const seconds = (timings.read + timings.simplify + timings.measure + timings.write) / 1000;
  const percent = (value: number): string => `${((100 * value) / diagonal).toPrecision(2)} %`;
  const shown = (value: number): string => value.toPrecision(2) + (diagonal > 0 ? ` (${percent(value)})` : '');
  const measured =
    deviation === null
      ? ''
      : `, measured deviation max ${shown(deviation.max)}, mean ${shown(deviation.mean)}, rms ${shown(deviation.rms)}`;
  const blocked = stopReason === 'constraints' && blockers !== null ? ` (${describeBlockers(blockers)})` : '';
  const stopped = stopReason === null ? '' : STOPPED[stopReason] + blocked;
  const triangles = lods?.map((level) => count(level.triangles)).join(', ') ?? count(output.triangles);
  const last = lods?.at(-1)?.path;
  return line([
    `${input.path} → ${output.path}${last ? ` … ${last}` : ''}`,
    `${count(input.triangles)} → ${triangles} triangles${stopped}, ${size(input.bytes)} → ` +
      `${size(output.bytes)}, estimated error ${shown(estimatedError)}${measured}, ${seconds.toFixed(1)} s`,
  ]);
}

function size(bytes: number): string {
  if (bytes < 1000) return `${bytes} B`;
  return bytes < 1e6 ? `${(bytes / 1e3).toPrecision(3)} kB` : `${(bytes / 1e6).toPrecision(3)} MB`;
}

/** The file's path with the place in it, which may begin with the file's own name. */
function placeIn(path: string | undefined, where: string): string {
  if (path === undefined || where === path) return where;
  const name = basename(path);
  if (where === '' || where === name) return path;
  // As compilers do it, `dir/model.obj:12` for `model.obj:12`.
  return where.startsWith(`${name}:`) ? path + where.slice(name.length) : `${path}: ${where}`;
}

/** Joins the parts that are not empty. They may quote a file: control characters could drive the terminal. */
function line(parts: readonly string[]): string {
  // eslint-disable-next-line no-control-regex -- they are what is to be found
  const text = parts.filter((part) => part !== '').join(': ').replace(/[\u0000-\u001f\u007f-\u009f\u2028\u2029]+/g, ' ');
  return text.length > LONGEST_LINE ? `${text.slice(0, LONGEST_LINE)}…` : text;
}

/** One line of progress on a terminal, rewritten in place; nothing where there is no terminal. */
export class ProgressLine {
  readonly #stream: NodeJS.WriteStream;
  #shown = false;

  constructor(stream: NodeJS.WriteStream) {
    this.#stream = stream;
  }

  show(text: string): void {
    if (!this.#stream.isTTY) return;
    // A longer line would wrap, and then could not be rewritten.
    this.#stream.write(`\r\u001b[K${line([text]).slice(0, (this.#stream.columns || 80) - 1)}`);
    this.#shown = true;
  }

  clear(): void {
    if (this.#shown) this.#stream.write('\r\u001b[K');
    this.#shown = false;
  }
}
