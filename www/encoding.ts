// How the geometry of a download is stored: the choices, and what the package calls them.
import { holdsEncodings } from 'decimesh/worker';
import type { Compression, WriteOptions } from 'decimesh/worker';
import type { OutputFormat } from './formats.ts';

/** A choice under Compression. */
export type Encoding = Compression | 'quantized' | 'meshopt-quantized';

/** The choices as the page offers them. */
export const ENCODINGS: ReadonlyArray<{ readonly value: Encoding; readonly options: WriteOptions }> = [
  { value: 'none', options: { compress: 'none' } },
  { value: 'quantized', options: { compress: 'none', quantize: true } },
  { value: 'meshopt', options: { compress: 'meshopt' } },
  { value: 'meshopt-quantized', options: { compress: 'meshopt', quantize: true } },
  { value: 'draco', options: { compress: 'draco' } },
];

/** Whether `value` is one of the choices. */
export const isEncoding = (value: string): value is Encoding => ENCODINGS.some((encoding) => encoding.value === value);

/** The choice as it counts for `format`: only some can be compressed. */
export const encodingFor = (format: OutputFormat, encoding: Encoding): Encoding => (holdsEncodings(format) ? encoding : 'none');

/** What to write with. */
export const writeOptions = (format: OutputFormat, encoding: Encoding): WriteOptions => ({
  format,
  ...ENCODINGS.find(({ value }) => value === encodingFor(format, encoding))?.options,
});
