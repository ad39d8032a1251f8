#!/usr/bin/env node
// The command line: reads the arguments, takes each file through, reports.

import { readFile } from 'node:fs/promises';
import { basename, dirname, join, parse } from 'node:path';
import { HELP, readArguments, usage, type Command, type Job } from './cli/arguments.js';
import { readInput, type ReadInput } from './cli/input.js';
import { checkWritable, isProgressivePath, makeDirectory, outputFormat, pathIn, refuseInputs, writeAll } from './cli/output.js';
import { ProgressLine, errorLine, resultLine, warningLine } from './cli/text.js';
import type { Document } from './document.js';
import { openFiles } from './document/open.js';
import type { Written } from './document/write.js';
import { init } from './engine.js';
import { holdsEncodings, usualFormat } from './formats.js';
import { DecimeshError, errorToData, type ErrorData } from './errors.js';
import type { LoadedFile } from './files.js';
import type { Report } from './report.js';
import { screenCoverages } from './screen.js';
import type { OutputFormat, Warning, WriteOptions } from './types.js';

/** In place of a report, for a file among several that failed. */
interface FailedReport {
  readonly input: { readonly path: string };
  readonly error: ErrorData;
}

/** Of a file with thousands of the same fault a few warnings are enough; the report has them all. */
const MOST_WARNINGS = 10;

const EXIT = { done: 0, fault: 1, usage: 2, input: 3, output: 4 } as const;

const progress = new ProgressLine(process.stderr);

async function main(): Promise<number> {
  // Whoever reads our output may have read enough.
  process.stdout.on('error', () => {});
  // A signal is handled between steps and not in the middle of writing a file.
  for (const [signal, code] of [['SIGINT', 130], ['SIGTERM', 143]] as const) {
    process.on(signal, () => {
      progress.clear();
      process.exit(code);
    });
  }
  let command: Command;
  try {
    command = readArguments(process.argv.slice(2));
    if (command.action === 'simplify') checkOutputs(command);
  } catch (error) {
    return fail(error, undefined);
  }
  if (command.action === 'help') {
    process.stdout.write(HELP);
    return EXIT.done;
  }
  if (command.action === 'version') {
    const { version } = JSON.parse(await readFile(new URL('../package.json', import.meta.url), 'utf8')) as { version: string };
    process.stdout.write(`${version}\n`);
    return EXIT.done;
  }
  return simplifyAll(command);
}

/** What can be known to be wrong about the outputs before anything is read. */
function checkOutputs({ inputs, output, directory, lods }: Job): void {
  if (output !== undefined) {
    if (!isProgressivePath(output) && outputFormat(output) !== 'glb' && lods !== undefined) throw usage('--lods', 'only .glb holds several levels; use -d for a file each');
    refuseInputs(output, inputs);
  }
  if (directory === undefined) return;
  const names = new Map<string, string>();
  for (const input of inputs) {
    // Without the extension: which one it will be is known when the file was read.
    const name = basename(pathIn(directory, input, 'glb'));
    const other = names.get(name);
    if (other !== undefined) throw usage('-d', `'${other}' and '${input}' would be written to the same file`);
    names.set(name, input);
  }
}

async function simplifyAll(job: Job): Promise<number> {
  const { inputs, directory, json } = job;
  try {
    await init();
    if (directory !== undefined) makeDirectory(directory);
  } catch (error) {
    return fail(error, undefined);
  }
  const reports: Array<Report | FailedReport> = [];
  let exitCode: number = EXIT.done;
  for (const [index, path] of inputs.entries()) {
    const label = inputs.length > 1 ? `[${index + 1}/${inputs.length}] ${path}` : path;
    try {
      reports.push(await simplifyOne(path, label, job));
    } catch (error) {
      const code = fail(error, path);
      exitCode ||= code;
      reports.push({ input: { path }, error: errorToData(error) });
    }
  }
  const single = inputs.length === 1;
  if (json && !(single && exitCode !== EXIT.done)) {
    process.stdout.write(`${JSON.stringify(single ? reports[0] : reports, undefined, 2)}\n`);
  }
  return exitCode;
}

async function simplifyOne(path: string, label: string, job: Job): Promise<Report> {
  progress.show(`${label}: reading`);
  const start = performance.now();
  const input = await readInput(path);
  const document = await openFiles(input.files);
  const read = performance.now() - start;
  try {
    const { output: named, directory, options, json, measure, size, lods } = job;
    const oneFile = directory === undefined;
    const usual = lods !== undefined && oneFile ? 'glb' : usualFormat(document.summary.format);
    const progressive = isProgressivePath(named);
    const format = named === undefined || progressive ? usual : outputFormat(named);
    const encoding = encodingFor(format, job);
    const levels = lods === undefined || oneFile ? [undefined] : lods.map((_, level) => level);
    const outputs = levels.map((level) => named ?? (directory === undefined ? undefined : pathIn(directory, path, format, level)));
    for (const output of outputs) {
      if (output === undefined) continue;
      refuseInputs(output, job.inputs);
      checkWritable(output);
    }
    await document.simplify({
      ...options,
      onProgress: (fraction) => progress.show(`${label}: ${Math.floor(100 * fraction)} %`),
    });
    if (progressive) return await writeProgressive(document, path, named, { job, input, read });
    const onMeasured = (fraction: number): void => progress.show(`${label}: measuring, ${Math.floor(100 * fraction)} %`);
    // Which level it will be is known when the size is.
    if (measure && size === undefined) await document.measure({ onProgress: onMeasured });
    const start = performance.now();
    const written = lods !== undefined && !oneFile
      ? await writeLevels(document, lods, { format, ...encoding }, outputs)
      : await document.write({ format, ...encoding, size, lods, ...nameOf(outputs[0]) });
    if (lods === undefined || oneFile) {
      const [output] = outputs;
      if (output !== undefined) {
        const beside = filesBeside(output, written);
        for (const file of beside) refuseInputs(file.path, inputFiles(path, input.files));
        writeAll([{ path: output, bytes: written.bytes }, ...beside]);
      }
    }
    const write = performance.now() - start;
    const deviation = measure && size !== undefined ? await document.measure({ onProgress: onMeasured }) : written.report.deviation;
    const warnings = [...input.warnings, ...written.report.warnings];
    const report: Report = {
      ...written.report,
      input: { ...written.report.input, path },
      output: { ...written.report.output, path: outputs[0] ?? null },
      deviation,
      timings: { ...written.report.timings, read, write },
      warnings,
    };
    progress.clear();
    tellWarnings(warnings, path);
    if (!json) process.stdout.write(`${resultLine(report, document.summary.diagonal)}\n`);
    return report;
  } finally {
    document.dispose();
  }
}

/** Writes all levels as one progressive mesh. */
async function writeProgressive(
  document: Document,
  path: string,
  output: string,
  { job, input, read }: { job: Job; input: ReadInput; read: number },
): Promise<Report> {
  const start = performance.now();
  await document.level({});
  const bytes = await document.writeProgressive();
  writeAll([{ path: output, bytes }]);
  const write = performance.now() - start;
  // The same report as of any other file, but for the output.
  const { report } = await document.write({ format: 'glb', compress: 'none' });
  const whole: Report = {
    ...report,
    input: { ...report.input, path },
    output: { ...report.output, path: output, format: 'pmesh', bytes: bytes.byteLength, parts: { ...report.output.parts, geometry: bytes.byteLength, textures: 0, animation: 0, other: 0 } },
    timings: { ...report.timings, read, write },
    warnings: [...input.warnings, ...report.warnings],
  };
  progress.clear();
  tellWarnings(whole.warnings, path);
  if (!job.json) process.stdout.write(`${resultLine(whole, document.summary.diagonal)}\n`);
  return whole;
}

/** Writes each level to a file of its own, when all of them are there; the first one's report has them all. */
async function writeLevels(
  document: Document,
  ratios: readonly number[],
  options: WriteOptions,
  outputs: ReadonlyArray<string | undefined>,
): Promise<Written> {
  const files: Written[] = [];
  for (const ratio of ratios) {
    await document.level({ ratio });
    files.push(await document.write({ ...options, ...nameOf(outputs[files.length]) }));
  }
  writeAll(files.flatMap((written, index) => {
    const output = outputs[index];
    return output === undefined ? [] : [{ path: output, bytes: written.bytes }, ...filesBeside(output, written)];
  }));
  const errors = files.map(({ report }) => report.estimatedError);
  const coverages = screenCoverages(errors, document.summary.diagonal);
  const lods = files.map(({ report: { output, estimatedError } }, index) => ({
    triangles: output.triangles,
    vertices: output.vertices,
    estimatedError,
    screenCoverage: coverages[index] as number,
    path: outputs[index] ?? null,
    bytes: output.bytes,
  }));
  const [first] = files as [Written];
  return { ...first, report: { ...first.report, lods } };
}

/** What was asked for; throws `usage` if the format does not have it, and leaves out what is the default there. */
function encodingFor(format: OutputFormat, { compress, quantize, prepare }: Job): WriteOptions {
  if (holdsEncodings(format)) return { compress, quantize, prepare };
  if (compress !== undefined && compress !== 'none') throw usage('--compress', `.${format} has no compression; write to .glb`);
  if (quantize) throw usage('--quantize', `.${format} has no quantisation; write to .glb`);
  if (prepare !== undefined) throw usage('--prepare', `.${format} has nothing to prepare; write to .glb`);
  return {};
}

/** The files that a model refers to, next to where it goes. */
function filesBeside(output: string, { files }: Written): { path: string; bytes: Uint8Array }[] {
  return files.map(({ name, bytes }) => ({ path: join(dirname(output), name), bytes }));
}

function nameOf(output: string | undefined): WriteOptions {
  return output === undefined ? {} : { name: baseName(output) };
}

/** What the names of files beside `output` begin with. */
function baseName(output: string): string {
  // Characters that are no good in names elsewhere were good enough for this system.
  return parse(output).name.replace(/[\u0000-\u001f/\\:*?"<>|]/g, '_').slice(0, 200) || 'model';
}

/** The paths of a model's files, which are next to it or below. */
function inputFiles(path: string, files: readonly LoadedFile[]): string[] {
  return files.map(({ name }, index) => (index === 0 ? path : join(dirname(path), name)));
}

function tellWarnings(warnings: readonly Warning[], path: string): void {
  for (const warning of warnings.slice(0, MOST_WARNINGS)) process.stderr.write(`${warningLine(warning, path)}\n`);
  if (warnings.length > MOST_WARNINGS) process.stderr.write(`warning: ${warnings.length - MOST_WARNINGS} more\n`);
}

/** Says on one line what failed and returns the exit code for it. */
function fail(error: unknown, path: string | undefined): number {
  progress.clear();
  if (!(error instanceof DecimeshError)) {
    process.stderr.write(`${errorLine(new DecimeshError('internal', errorToData(error).message), path)}\n`);
    return EXIT.fault;
  }
  process.stderr.write(`${errorLine(error, path)}\n`);
  if (error.code === 'usage') return EXIT.usage;
  if (error.code === 'cannot-write') return EXIT.output;
  // The engine's own file is part of this program.
  return error.code === 'internal' || path === undefined ? EXIT.fault : EXIT.input;
}

process.exitCode = await main();
