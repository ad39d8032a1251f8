// A glTF as its tree and its binary chunk, and back.
//
// The engine reads containers too, and judges them: what is wrong with one is left to it. This here is only for files
// that need a codec on their way in or out.

import { DecimeshError } from '../errors.js';
import type { Tree } from './tree.js';

const MAGIC = 0x4654_6c67;
const JSON_CHUNK = 0x4e4f_534a;
const BINARY_CHUNK = 0x004e_4942;

/** The text of a glTF's JSON, and the binary chunk of a GLB. */
export interface Container {
  readonly isBinary: boolean;
  readonly json: Uint8Array;
  readonly binary: Uint8Array | undefined;
}

/** The parts of `bytes` if they look like a glTF in either form; undefined for anything else, and for a broken GLB. */
export function splitContainer(bytes: Uint8Array): Container | undefined {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 20 || view.getUint32(0, true) !== MAGIC) {
    return startsLikeObject(bytes) ? { isBinary: false, json: bytes, binary: undefined } : undefined;
  }
  const end = Math.min(view.getUint32(8, true), bytes.length);
  let json: Uint8Array | undefined;
  let binary: Uint8Array | undefined;
  for (let offset = 12; offset + 8 <= end; ) {
    const start = offset + 8;
    const next = start + view.getUint32(offset, true);
    if (next > end) return undefined;
    const type = view.getUint32(offset + 4, true);
    if (json === undefined) {
      if (type !== JSON_CHUNK) return undefined;
      json = bytes.subarray(start, next);
    } else if (type === BINARY_CHUNK) {
      binary ??= bytes.subarray(start, next);
    }
    offset = next;
  }
  return json && { isBinary: true, json, binary };
}

function startsLikeObject(bytes: Uint8Array): boolean {
  const blank = new Set([0x20, 0x09, 0x0a, 0x0d, 0xef, 0xbb, 0xbf]);
  // White space without end is no model either.
  for (let at = 0; at < Math.min(bytes.length, 4096); at += 1) if (!blank.has(bytes[at] as number)) return bytes[at] === 0x7b;
  return false;
}

/** The text of a container's JSON; undefined when it is longer than a string can be. */
export function textOf({ json }: Container): string | undefined {
  try {
    return new TextDecoder().decode(json);
  } catch {
    return undefined;
  }
}

/** A GLB of one buffer as its tree and the buffer's content. */
export interface Glb {
  readonly json: Tree;
  readonly binary: Uint8Array;
}

/** Takes apart a GLB that the engine has written; throws `too-large` when its JSON is longer than a string can be. */
export function parseGlb(bytes: Uint8Array): Glb {
  const container = splitContainer(bytes);
  const text = container && textOf(container);
  if (container === undefined || text === undefined) throw new DecimeshError('too-large', 'the JSON is too large to be encoded', 'output');
  return { json: JSON.parse(text) as Tree, binary: container.binary ?? new Uint8Array() };
}

/** `tree` as text; throws `too-large` when it is nested too deeply or too long to be written. */
export function encodeTree(tree: Tree): Uint8Array<ArrayBuffer> {
  try {
    return new TextEncoder().encode(JSON.stringify(tree));
  } catch (error) {
    throw new DecimeshError('too-large', 'the JSON is too large or nested too deeply to be written', '', { cause: error });
  }
}

const paddedLength = (length: number): number => Math.ceil(length / 4) * 4;

/** A GLB of `json` and the pieces of its binary chunk, which is left out when they are empty. Throws `too-large`. */
export function buildGlb(json: Uint8Array, pieces: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const binaryLength = pieces.reduce((sum, piece) => sum + piece.length, 0);
  const total = 20 + paddedLength(json.length) + (binaryLength === 0 ? 0 : 8 + paddedLength(binaryLength));
  if (total > 0xffff_ffff) throw new DecimeshError('too-large', 'a GLB file cannot exceed 4 GiB', 'output');
  const bytes = new Uint8Array(total);
  const view = new DataView(bytes.buffer);
  const header = [MAGIC, 2, total, paddedLength(json.length), JSON_CHUNK];
  for (const [index, value] of header.entries()) view.setUint32(4 * index, value, true);
  bytes.fill(0x20, 20 + json.length, 20 + paddedLength(json.length));
  bytes.set(json, 20);
  if (binaryLength === 0) return bytes;
  let offset = 20 + paddedLength(json.length);
  view.setUint32(offset, paddedLength(binaryLength), true);
  view.setUint32(offset + 4, BINARY_CHUNK, true);
  offset += 8;
  for (const piece of pieces) {
    bytes.set(piece, offset);
    offset += piece.length;
  }
  return bytes;
}
