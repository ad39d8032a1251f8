// From a user's files to a document: loaded, unpacked, decoded, and read by the engine.

import { unpackArchives } from '../codecs/archive.js';
import { decodeFiles, type Decoded } from '../codecs/decode.js';
import { Document } from '../document.js';
import { EngineObject, callEngine, init } from '../engine.js';
import { listFiles, loadFiles, type LoadedFile } from '../files.js';
import { checkNames, checkSignal } from '../options.js';
import { partsSource } from '../parts.js';
import { isProgressive } from '../progressive/container.js';
import type { DocumentInput, DocumentSummary } from '../types.js';

/**
 * Opens a model: glTF (.glb, .gltf with its files), OBJ (with its .mtl and textures), PLY, STL, OFF or SMF, told by
 * their content; a progressive mesh; or a .zip of these. Loads the engine if that is still to be done.
 *
 * The geometry is checked and decoded here: a fault in it is told now, and not by a later call. Rejects with a
 * {@link DecimeshError} naming the place in the file, or with the signal's reason.
 */
export async function openDocument(input: DocumentInput, options: { signal?: AbortSignal } = {}): Promise<Document> {
  checkNames(options, ['signal']);
  checkSignal(options.signal);
  options.signal?.throwIfAborted();
  const files = await loadFiles(listFiles(input));
  options.signal?.throwIfAborted();
  await init();
  options.signal?.throwIfAborted();
  return openFiles(files, options.signal);
}

/** Opens files that are in memory; needs the engine to be loaded. Rejects as {@link openDocument} does. */
export async function openFiles(files: readonly LoadedFile[], signal?: AbortSignal): Promise<Document> {
  const start = performance.now();
  const unpacked = await unpackProgressive(await unpackArchives(files, signal));
  const decoded = await decodeFiles(unpacked, signal);
  signal?.throwIfAborted();
  const bytes = files.reduce((sum, file) => sum + file.bytes.byteLength, 0);
  return openDecoded(decoded, unpacked, bytes, start);
}

/** A progressive mesh at full detail is a GLB. */
async function unpackProgressive(files: readonly LoadedFile[]): Promise<readonly LoadedFile[]> {
  if (!files.some(({ bytes }) => isProgressive(bytes))) return files;
  const [{ decodeProgressive }, { progressiveToGlb }] = await Promise.all([import('../progressive.js'), import('../progressive/to_glb.js')]);
  return files.map((file) => {
    if (!isProgressive(file.bytes)) return file;
    const mesh = decodeProgressive(file.bytes);
    return { ...file, bytes: progressiveToGlb(mesh.description, mesh.geometry()) };
  });
}

function openDecoded({ files, compression }: Decoded, given: readonly LoadedFile[], bytes: number, start: number): Document {
  const model = new EngineObject('document', (engine) =>
    engine.Model.open(
      files.map(({ name }) => name),
      files.map(({ bytes }) => bytes),
    ),
  );
  const found = JSON.parse(model.call((object) => object.summary())) as Omit<DocumentSummary, 'compression'>;
  // What was given counts, not what was decoded from it.
  const summary: DocumentSummary = { ...found, bytes, compression };
  return new Document(model, summary, performance.now() - start, partsSource(given, summary.format));
}

/**
 * The addresses of files that a model names beside itself, as it names them: buffers and images of a glTF, material
 * libraries of an OBJ, the texture of a PLY; and the images that such a library (.mtl) names, relative to it. Empty for
 * other content.
 *
 * Needs the engine to be loaded. Never fails on bad content: opening it will say what is wrong.
 */
export function externalFiles(bytes: Uint8Array): string[] {
  return JSON.parse(callEngine((engine) => engine.externalFiles(bytes))) as string[];
}
