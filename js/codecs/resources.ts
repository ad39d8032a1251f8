// The bytes behind a glTF's buffers: the binary chunk, `data:` URIs, and the files given with it.

import { DecimeshError } from '../errors.js';
import { pathOfUri, type LoadedFile } from '../files.js';
import type { Container } from './container.js';
import { objects, rangeError, syntaxError, uint, type Tree } from './tree.js';

/** Finds buffers, each once. */
export class Buffers {
  readonly #tree: Tree;
  readonly #container: Container;
  readonly #main: LoadedFile;
  readonly #files: readonly LoadedFile[];
  readonly #found = new Map<number, Uint8Array>();

  /** `main` is the file that holds `container`, one of `files`. */
  constructor(tree: Tree, container: Container, main: LoadedFile, files: readonly LoadedFile[]) {
    [this.#tree, this.#container, this.#main, this.#files] = [tree, container, main, files];
  }

  /** The range of a buffer that `holder` states; throws a typed error that names `where` or the buffer. */
  range(holder: Tree, where: string): Uint8Array {
    const { buffer, byteOffset = 0, byteLength } = holder;
    const [index, offset, length] = [uint(buffer), uint(byteOffset), uint(byteLength)];
    if (index === undefined || offset === undefined || length === undefined) {
      throw syntaxError(where, 'buffer, byteOffset and byteLength must be integers of at least 0');
    }
    const bytes = this.#bytes(index, where);
    if (offset + length > bytes.length) {
      throw rangeError(where, `${length} bytes from byte ${offset} on reach past the ${bytes.length} bytes of buffer ${index}`);
    }
    return bytes.subarray(offset, offset + length);
  }

  /** Whether the bytes of a buffer can be had. */
  has(index: number): boolean {
    try {
      this.#bytes(index, '');
      return true;
    } catch {
      return false;
    }
  }

  #bytes(index: number, where: string): Uint8Array {
    const known = this.#found.get(index);
    if (known !== undefined) return known;
    const buffer = objects(this.#tree, 'buffers')[index];
    if (buffer === undefined) throw rangeError(where, `there is no buffer ${index}`);
    const bytes = this.#load(buffer, index);
    const length = uint(buffer['byteLength']) ?? 0;
    if (length > bytes.length) {
      throw new DecimeshError('truncated', `${length} bytes are stated, ${bytes.length} are there`, `buffers[${index}].byteLength`);
    }
    const cut = bytes.subarray(0, length);
    this.#found.set(index, cut);
    return cut;
  }

  #load({ uri }: Tree, index: number): Uint8Array {
    const where = `buffers[${index}].uri`;
    if (typeof uri !== 'string') {
      if (index === 0 && this.#container.binary !== undefined) return this.#container.binary;
      throw new DecimeshError('missing-resource', 'the buffer has no uri, and there is no binary chunk for it', where);
    }
    if (/^data:/i.test(uri)) return decodeDataUri(uri, where);
    const file = findFile(uri, this.#files, this.#main);
    if (file === undefined) throw new DecimeshError('missing-resource', `the file "${uri.slice(0, 80)}" was not given`, where);
    return file.bytes;
  }
}

function decodeDataUri(uri: string, where: string): Uint8Array {
  const comma = uri.indexOf(',');
  if (comma < 0) throw syntaxError(where, 'a data: URI without a comma');
  try {
    const content = decodeURIComponent(uri.slice(comma + 1));
    const isBase64 = /;base64$/i.test(uri.slice(0, comma));
    const text = isBase64 ? atob(content) : content;
    const bytes = new Uint8Array(text.length);
    for (let at = 0; at < text.length; at += 1) bytes[at] = text.charCodeAt(at);
    return bytes;
  } catch (error) {
    throw syntaxError(where, `not base64: ${error instanceof Error ? error.message : String(error)}`);
  }
}

/**
 * The file that a relative URI names: by its path from the referring file, as written, or by its last part, because a
 * drop on a page gives names without folders.
 */
export function findFile(uri: string, files: readonly LoadedFile[], main: LoadedFile): LoadedFile | undefined {
  const decoded = pathOfUri(uri);
  const folder = main.name.replace(/[^/\\]*$/, '');
  const others = files.filter((file) => file !== main);
  for (const wanted of [normalize(folder + decoded), normalize(decoded), normalize(uri)]) {
    const found = others.find(({ name }) => normalize(name) === wanted);
    if (found !== undefined) return found;
  }
  const last = normalize(decoded).split('/').pop() ?? '';
  const lastOf = ({ name }: LoadedFile): string => normalize(name).split('/').pop() ?? '';
  return (
    others.find((file) => lastOf(file) === last) ??
    others.find((file) => lastOf(file).toLowerCase() === last.toLowerCase())
  );
}

/** `./a/../b\c` as `b/c`. */
function normalize(name: string): string {
  const parts: string[] = [];
  for (const part of name.split(/[/\\]/)) {
    if (part === '' || part === '.') continue;
    if (part === '..' && parts.length > 0 && parts[parts.length - 1] !== '..') parts.pop();
    else parts.push(part);
  }
  return parts.join('/');
}
