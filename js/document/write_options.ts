// The options of writing: checked, and resolved for the file at hand.

import type { Encoding } from '../codecs/encode.js';
import { invalidArgument } from '../errors.js';
import { COMPRESSIONS, OUTPUT_FORMATS, holdsEncodings, isCompression, isOutputFormat, usualFormat } from '../formats.js';
import { MOST_LODS, checkNames } from '../options.js';
import { checkPrepareOptions } from '../prepare/options.js';
import type { DocumentSummary, OutputFormat, WriteOptions } from '../types.js';

/** How a level is to be encoded. */
export interface ResolvedWriteOptions {
  readonly format: OutputFormat;
  /** Of the files beside a `.gltf`, without an ending. */
  readonly name: string;
  readonly encoding: Encoding;
}

/** Checks the options of `Document.write` and puts in what a file of this kind is written with by default. */
export function resolveWriteOptions(options: WriteOptions, summary: DocumentSummary): ResolvedWriteOptions {
  checkNames(options, ['format', 'name', 'compress', 'quantize', 'prepare', 'size', 'lods', 'lodSwitch']);
  const { size, lods, name = 'model', quantize = false } = options;
  const { format = lods === undefined ? usualFormat(summary.format) : 'glb' } = options;
  if (size !== undefined && (typeof size !== 'number' || !(size > 0))) {
    throw invalidArgument('size', 'must be a number of bytes above 0');
  }
  if (lods !== undefined) {
    if (!Array.isArray(lods) || lods.length < 2 || lods.length > MOST_LODS) {
      throw invalidArgument('lods', `must be a list of 2 to ${MOST_LODS} levels`);
    }
    if (format !== 'glb') throw invalidArgument('lods', "need the format 'glb'");
    if (size !== undefined) throw invalidArgument('size', 'cannot be asked of a chain of levels');
  }
  if (!isOutputFormat(format)) throw invalidArgument('format', `must be one of ${OUTPUT_FORMATS.join(', ')}`);
  const { compress = holdsEncodings(format) ? summary.compression : 'none' } = options;
  if (!isCompression(compress)) throw invalidArgument('compress', `must be one of ${COMPRESSIONS.join(', ')}`);
  if (typeof quantize !== 'boolean') throw invalidArgument('quantize', 'must be true or false');
  if (!holdsEncodings(format) && compress !== 'none') throw invalidArgument('compress', `${format} has no compression`);
  if (!holdsEncodings(format) && quantize) throw invalidArgument('quantize', `${format} has no quantisation`);
  const prepare = checkPrepareOptions(options.prepare);
  if (!holdsEncodings(format) && prepare !== undefined) throw invalidArgument('prepare', `is for glb and gltf, not ${format}`);
  if (typeof name !== 'string' || !isFileName(name)) throw invalidArgument('name', 'must be a name for files, without a folder');
  return { format, name, encoding: { compress, quantize, prepare } };
}

function isFileName(name: string): boolean {
  // eslint-disable-next-line no-control-regex -- they are what is to be found
  return name !== '' && name.length <= 200 && !/[\u0000-\u001f/\\:*?"<>|]/.test(name) && name !== '.' && name !== '..';
}
