// What callers may hand over as a model, brought to one form: names and bytes.

import { DecimeshError, invalidArgument } from './errors.js';
import type { DocumentInput, NamedBytes } from './types.js';

/** A file with its content in memory. */
export interface LoadedFile {
  readonly name: string;
  readonly bytes: Uint8Array;
}

/** The path that a relative URI names, without what follows it (`?…`, `#…`). */
export function pathOfUri(uri: string): string {
  const path = uri.split(/[?#]/)[0] ?? '';
  try {
    return decodeURIComponent(path);
  } catch {
    // A stray % is a %: such names are not rare.
    return path;
  }
}

/** The files of `input`, without reading any; a single buffer has an empty name. */
export function listFiles(input: DocumentInput): Array<File | LoadedFile> {
  const list: readonly unknown[] = Array.isArray(input) ? input : [input];
  if (list.length === 0) throw invalidArgument('input', 'must hold at least one file');
  return list.map((file, index) => {
    const where = Array.isArray(input) ? `input[${index}]` : 'input';
    if (isFile(file)) return file;
    const bytes = asBytes(file);
    // An unnamed buffer is only clear when it is alone.
    if (bytes !== undefined && !Array.isArray(input)) return { name: '', bytes };
    if (typeof file === 'object' && file !== null) {
      const { name, bytes: content } = file as Partial<NamedBytes>;
      const contentBytes = asBytes(content);
      if (typeof name === 'string' && contentBytes !== undefined) return { name, bytes: contentBytes };
    }
    throw invalidArgument(where, 'must be an ArrayBuffer, a Uint8Array, a File or { name, bytes }');
  });
}

/** The content of `files`; rejects with `cannot-read` and the file's name when one cannot be read. */
export function loadFiles(files: ReadonlyArray<File | LoadedFile>): Promise<LoadedFile[]> {
  return Promise.all(
    files.map(async (file) => {
      if (!isFile(file)) return file;
      try {
        return { name: nameOf(file), bytes: new Uint8Array(await file.arrayBuffer()) };
      } catch (error) {
        throw new DecimeshError('cannot-read', error instanceof Error ? error.message : String(error), file.name);
      }
    }),
  );
}

/** Whether `value` is a File, also one of another realm. */
export function isFile(value: unknown): value is File {
  return typeof Blob === 'function' && value instanceof Blob && typeof (value as Partial<File>).name === 'string';
}

// A file from a chosen or dropped folder knows its path in it, which is how other files refer to it.
function nameOf(file: File): string {
  return file.webkitRelativePath || file.name;
}

function asBytes(value: unknown): Uint8Array | undefined {
  if (value instanceof ArrayBuffer) return new Uint8Array(value);
  if (value instanceof Uint8Array) return value;
  return undefined;
}
