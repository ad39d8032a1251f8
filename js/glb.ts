// The container of binary glTF, for files that the engine itself has written.

/** A part of a glTF tree. */
export interface Json {
  [key: string]: unknown;
}

/** A GLB taken apart. */
export interface Glb {
  readonly json: Json;
  readonly binary: Uint8Array;
}

const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;

/** Takes a GLB apart. The engine wrote it: anything wrong with it is our fault, and throws a `RangeError`. */
export function parseGlb(bytes: Uint8Array): Glb {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const length = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length))) as Json;
  const at = 20 + length;
  if (at + 8 > bytes.byteLength) return { json, binary: new Uint8Array() };
  const size = view.getUint32(at, true);
  return { json, binary: bytes.subarray(at + 8, at + 8 + size) };
}

/** Puts a GLB together from a tree and the content of its one buffer, in parts. */
export function buildGlb(json: Json, parts: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const textLength = Math.ceil(text.byteLength / 4) * 4;
  const size = parts.reduce((sum, part) => sum + part.byteLength, 0);
  const binaryLength = Math.ceil(size / 4) * 4;
  const total = 20 + textLength + (size > 0 ? 8 + binaryLength : 0);
  const bytes = new Uint8Array(total);
  const view = new DataView(bytes.buffer);
  for (const [index, value] of [MAGIC, 2, total, textLength, JSON_CHUNK].entries()) view.setUint32(4 * index, value, true);
  bytes.fill(0x20, 20, 20 + textLength);
  bytes.set(text, 20);
  if (size === 0) return bytes;
  let at = 20 + textLength;
  view.setUint32(at, binaryLength, true);
  view.setUint32(at + 4, BINARY_CHUNK, true);
  at += 8;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.byteLength;
  }
  return bytes;
}
