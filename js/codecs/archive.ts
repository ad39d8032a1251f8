// A .zip among the files stands for the files in it. It may come from anyone: what it says is bounded before it is done.
//
// APPNOTE 6.3.10, PKWARE: end of central directory (4.3.16), central directory (4.3.12), local headers (4.3.7).

import { crc32 } from '../checksum.js';
import { DecimeshError } from '../errors.js';
import type { LoadedFile } from '../files.js';
import { yieldToEvents } from '../platform.js';
import { fflate } from './modules.js';

/** Files in one archive. */
const MOST_FILES = 10_000;

/** What any archive may unpack to, bytes; larger ones by a factor. */
const ALWAYS_ALLOWED = 64 * 1024 * 1024;

/** Text formats come to a tenth; only what repeats itself without end to less than a hundredth. */
const LARGEST_FACTOR = 100;

/** The engine's memory. */
const LARGEST_TOTAL = 2 ** 31;

/** Compressed bytes that are unpacked at a time: at most 16 MiB come of them. */
const PIECE = 16 * 1024;

const END_RECORD = 0x0605_4b50;
const CENTRAL_HEADER = 0x0201_4b50;
const LOCAL_HEADER = 0x0403_4b50;

/** A file in an archive, as its directory has it. */
interface Entry {
  readonly name: string;
  readonly where: string;
  readonly method: number;
  readonly checksum: number;
  readonly packed: number;
  readonly size: number;
  readonly header: number;
}

/** Extensions of models, so that a text beside one is not taken for one. */
const MODELS = /\.(glb|gltf|obj|ply|stl|off|smf)$/i;

/** Whether the bytes begin as those of a zip archive. */
function isArchive(bytes: Uint8Array): boolean {
  const [p, k, a, b] = bytes;
  return p === 0x50 && k === 0x4b && ((a === 3 && b === 4) || (a === 5 && b === 6));
}

/**
 * `files` with every archive replaced by the files in it, models first and those nearest to the root. Archives in
 * archives stay as they are.
 *
 * Rejects with a typed error that names the archive and the file in it: `truncated`, `syntax`, `unsupported` (encrypted,
 * or of another method than Deflate), `too-large`; or with the signal's reason.
 */
export async function unpackArchives(files: readonly LoadedFile[], signal?: AbortSignal): Promise<readonly LoadedFile[]> {
  if (!files.some(({ bytes }) => isArchive(bytes))) return files;
  const unpacked: LoadedFile[] = [];
  for (const file of files) {
    if (isArchive(file.bytes)) unpacked.push(...(await unpack(file, signal)));
    else unpacked.push(file);
  }
  const depth = ({ name }: LoadedFile): number => name.split('/').length;
  const rank = (file: LoadedFile): number => (MODELS.test(file.name) ? depth(file) : Infinity);
  return unpacked.sort((a, b) => (rank(a) === rank(b) ? 0 : rank(a) - rank(b)));
}

async function unpack(archive: LoadedFile, signal: AbortSignal | undefined): Promise<LoadedFile[]> {
  const entries = readDirectory(archive);
  const files: LoadedFile[] = [];
  for (const entry of entries) {
    await yieldToEvents();
    signal?.throwIfAborted();
    files.push({ name: entry.name, bytes: await readEntry(archive.bytes, entry, signal) });
  }
  if (files.length === 0) throw new DecimeshError('unknown-format', 'the archive holds no file', archive.name);
  return files;
}

function readDirectory({ name: archive, bytes }: LoadedFile): Entry[] {
  const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const end = findEnd(data, archive);
  const count = data.getUint16(end + 10, true);
  const start = data.getUint32(end + 16, true);
  if (count === 0xffff || start === 0xffff_ffff) throw new DecimeshError('unsupported', 'archives of more than 4 GiB (Zip64) are not read', archive);
  if (count > MOST_FILES) throw new DecimeshError('too-large', `${count} files; an archive may have ${MOST_FILES}`, archive);
  const entries: Entry[] = [];
  let [offset, total, packedTotal] = [start, 0, 0];
  for (let index = 0; index < count; index += 1) {
    if (offset + 46 > end || data.getUint32(offset, true) !== CENTRAL_HEADER) {
      throw new DecimeshError('syntax', `the directory of the archive is broken at file ${index} of ${count}`, archive);
    }
    const [nameLength, extraLength, commentLength] = [28, 30, 32].map((at) => data.getUint16(offset + at, true)) as [number, number, number];
    const next = offset + 46 + nameLength + extraLength + commentLength;
    if (next > end) throw new DecimeshError('truncated', `the directory of the archive ends inside file ${index} of ${count}`, archive);
    const name = decodeName(bytes.subarray(offset + 46, offset + 46 + nameLength));
    const where = archive === '' ? name : `${archive}: ${name}`;
    const entry: Entry = {
      name,
      where,
      method: data.getUint16(offset + 10, true),
      checksum: data.getUint32(offset + 16, true),
      packed: data.getUint32(offset + 20, true),
      size: data.getUint32(offset + 24, true),
      header: data.getUint32(offset + 42, true),
    };
    const encrypted = (data.getUint16(offset + 8, true) & 1) !== 0;
    offset = next;
    // Folders, and what a Mac adds for itself.
    if (name.endsWith('/') || /(^|\/)(__MACOSX\/|\._|\.DS_Store$)/.test(name)) continue;
    if (encrypted) throw new DecimeshError('unsupported', 'the file is encrypted', where);
    if (entry.method !== 0 && entry.method !== 8) throw new DecimeshError('unsupported', `compression method ${entry.method}; only Deflate is read`, where);
    total += entry.size;
    packedTotal += entry.packed;
    if (total > Math.min(LARGEST_TOTAL, Math.max(ALWAYS_ALLOWED, LARGEST_FACTOR * bytes.length))) {
      throw new DecimeshError('too-large', `the ${bytes.length} bytes of the archive unpack to more than ${total - 1}`, where);
    }
    // Files that share their bytes are how a small archive unpacks to very much.
    if (packedTotal > bytes.length) throw new DecimeshError('syntax', 'files of the archive overlap', where);
    entries.push(entry);
  }
  return entries;
}

/** Where the end record is: before a comment of any length. */
function findEnd(data: DataView, archive: string): number {
  for (let at = data.byteLength - 22; at >= Math.max(0, data.byteLength - 22 - 0xffff); at -= 1) {
    if (data.getUint32(at, true) === END_RECORD) return at;
  }
  throw new DecimeshError('truncated', 'the archive has no directory: its end is missing', archive);
}

function decodeName(bytes: Uint8Array): string {
  let name: string;
  try {
    name = new TextDecoder('utf-8', { fatal: true }).decode(bytes);
  } catch {
    name = new TextDecoder('windows-1252').decode(bytes);
  }
  return name.replaceAll('\\', '/');
}

async function readEntry(archive: Uint8Array, entry: Entry, signal: AbortSignal | undefined): Promise<Uint8Array> {
  const { header, packed, size, where, method, checksum } = entry;
  const data = new DataView(archive.buffer, archive.byteOffset, archive.byteLength);
  if (header + 30 > archive.length || data.getUint32(header, true) !== LOCAL_HEADER) {
    throw new DecimeshError('syntax', 'the file is not where the directory says', where);
  }
  const start = header + 30 + data.getUint16(header + 26, true) + data.getUint16(header + 28, true);
  if (start + packed > archive.length) throw new DecimeshError('truncated', `${packed} bytes reach past the end of the archive`, where);
  const source = archive.subarray(start, start + packed);
  const bytes = method === 0 ? source.slice() : await inflate(source, size, where, signal);
  if (bytes.length !== size || crc32(bytes) !== checksum) throw new DecimeshError('syntax', 'the file is damaged: its checksum differs', where);
  return bytes;
}

/** At most `size` bytes: a stream that goes on after them is not followed. */
async function inflate(source: Uint8Array, size: number, where: string, signal: AbortSignal | undefined): Promise<Uint8Array> {
  const { Inflate } = await fflate();
  const bytes = new Uint8Array(size);
  let length = 0;
  let overflow = false;
  const stream = new Inflate((chunk) => {
    overflow ||= length + chunk.length > size;
    if (!overflow) bytes.set(chunk, length);
    length += chunk.length;
  });
  let yielded = performance.now();
  try {
    for (let at = 0; at < source.length && !overflow; at += PIECE) {
      stream.push(source.subarray(at, at + PIECE), at + PIECE >= source.length);
      if (performance.now() - yielded < 10) continue;
      await yieldToEvents();
      signal?.throwIfAborted();
      yielded = performance.now();
    }
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new DecimeshError('syntax', 'the compressed data are damaged', where, { cause: error });
  }
  if (overflow || length !== size) throw new DecimeshError('syntax', 'the file has another size than the archive says', where);
  return bytes;
}
