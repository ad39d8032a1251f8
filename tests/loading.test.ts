// Real glTF files, as they were and at half their triangles: others can load what is written.
import { existsSync } from 'node:fs';
import { extname, relative } from 'node:path';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { MeshoptDecoder } from 'meshoptimizer';
import { Mesh, Texture } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import type { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { beforeAll, describe, expect, it } from 'vitest';
import { DecimeshError, init, openDocument, type Document } from 'decimesh';
import { assetPath } from './support/assets.ts';
import { glb, glbTree } from './support/glb.ts';
import { loadModel, modelPaths, type Named } from './support/models.ts';
import { issuesOf } from './support/validate.ts';

// Larger ones take most of the time and have nothing that the others have not.
const LARGEST = 4e6;
const present = existsSync(assetPath('gltf'));
if (!present) console.log('skipped: real glTF files load elsewhere: ../shared/assets is not there');

/** Faults that glTF files of the assets have, which are parts of test suites. */
const FAULTS = new Set<string>(['unsupported', 'missing-resource', 'syntax']);

/**
 * What the validator may notice when a file becomes a GLB whose geometry is written anew, none of it an error or a
 * warning: vertices that are equal in everything are one, by which triangles without an area show; what was not given is
 * still named by its address; accessors that lost their use keep their numbers.
 */
const EXPECTED = new Set(['ACCESSOR_INDEX_TRIANGLE_DEGENERATE', 'URI_GLB', 'UNUSED_OBJECT', 'DATA_URI_GLB']);

beforeAll(async () => {
  await init();
  // Images are decoded by browsers alone.
  const picture = { width: 1, height: 1, close: (): void => {} };
  Object.assign(globalThis, { self: globalThis, createImageBitmap: () => Promise.resolve(picture), ProgressEvent: Event });
});

/** Calls `look` with every model that can be opened; returns how many there were, and what went wrong. */
async function eachModel(look: (document: Document, files: readonly Named[], name: string) => Promise<string[]>): Promise<{ count: number; failures: string[] }> {
  const failures: string[] = [];
  let count = 0;
  for (const path of modelPaths('gltf')) {
    const name = relative(assetPath('gltf'), path);
    const files = loadModel(path);
    if (!['.glb', '.gltf'].includes(extname(path)) || files.reduce((sum, { bytes }) => sum + bytes.length, 0) > LARGEST) continue;
    try {
      using document = await openDocument(files);
      failures.push(...(await look(document, files, name)).map((failure) => `${name}: ${failure}`));
      count += 1;
    } catch (error) {
      if (!(error instanceof DecimeshError && FAULTS.has(error.code))) failures.push(`${name}: ${String(error)}`);
    }
  }
  return { count, failures };
}

describe('real glTF files', () => {
  it.skipIf(!present)('have no new issue when they are written as they are', { timeout: 300_000 }, async () => {
    const { count, failures } = await eachModel(async (document, files) => {
      const [first, ...others] = files as readonly [Named, ...Named[]];
      const known = new Set((await issuesOf(first.bytes, others)).map(({ code }) => code));
      const issues = await issuesOf((await document.write({ compress: 'none' })).bytes, others);
      return issues.filter(({ code }) => !known.has(code) && !EXPECTED.has(code)).map(({ severity, code, pointer, message }) => `${severity} ${code} ${pointer} ${message}`).slice(0, 3);
    });
    expect(failures).toEqual([]);
    console.log(`${count} files`);
    expect(count).toBeGreaterThan(150);
  });

  it.skipIf(!present)('load in three.js and glTF-Transform at half their triangles', { timeout: 300_000 }, async () => {
    const { count, failures } = await eachModel(async (document, files) => {
      const { triangles } = await document.simplify({ ratio: 0.5, preset: 'fast' });
      const { bytes } = await document.write({ format: 'glb', compress: 'none' });
      const complaints: string[] = [];
      // What a loader cannot make of the file it cannot make of half of it either.
      const three = await attempt(() => loadWithThree(bytes));
      if (typeof three === 'string' && typeof (await attempt(() => loadWithThree(embedded(files)))) === 'number') complaints.push(`three.js: ${three}`);
      // An image that was not given or is of no known kind is named by its address still, which this reader cannot follow.
      const isWhole = ((glbTree(bytes)['images'] ?? []) as object[]).every((image) => !('uri' in image));
      const found = await attempt(() => countWithTransform(bytes));
      if (typeof found === 'number' ? found !== triangles : isWhole && typeof (await attempt(() => countWithTransform(embedded(files)))) === 'number') {
        complaints.push(`glTF-Transform: ${found}, not ${triangles} triangles`);
      }
      return complaints;
    });
    expect(failures).toEqual([]);
    console.log(`${count} files`);
    expect(count).toBeGreaterThan(150);
  });
});

async function attempt<Result>(run: () => Promise<Result>): Promise<Result | string> {
  let timer: NodeJS.Timeout | undefined;
  const late = new Promise<never>((_, reject) => (timer = setTimeout(() => reject(new Error('takes more than ten seconds')), 10_000)));
  try {
    return await Promise.race([run(), late]);
  } catch (error) {
    return error instanceof Error ? `${error.message} ${(error.stack ?? '').split('\n')[1] ?? ''}` : String(error);
  } finally {
    clearTimeout(timer);
  }
}

/** A glTF with its files in it, as a GLB. */
function embedded(files: readonly Named[]): Uint8Array<ArrayBuffer> {
  const [{ bytes }, ...others] = files as readonly [Named, ...Named[]];
  if (new TextDecoder().decode(bytes.subarray(0, 4)) === 'glTF') return bytes;
  const tree = JSON.parse(new TextDecoder().decode(bytes)) as Record<'buffers' | 'images', Array<{ uri?: string }> | undefined>;
  for (const holder of [...(tree.buffers ?? []), ...(tree.images ?? [])]) {
    const file = others.find(({ name }) => name === decodeURIComponent(holder.uri ?? ''));
    if (file) holder.uri = `data:application/octet-stream;base64,${Buffer.from(file.bytes).toString('base64')}`;
  }
  return glb({ json: tree }) as Uint8Array<ArrayBuffer>;
}

/** How many meshes three.js makes of a GLB. */
async function loadWithThree(bytes: Uint8Array<ArrayBuffer>): Promise<number> {
  const ktx2 = { load: (_: string, done: (texture: Texture) => void) => done(new Texture()), dispose: () => {} };
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).setKTX2Loader(ktx2 as unknown as KTX2Loader);
  const { scenes } = await loader.parseAsync(bytes.slice().buffer, '');
  let meshes = 0;
  for (const scene of scenes) scene.traverse((object) => void (meshes += object instanceof Mesh ? 1 : 0));
  return meshes;
}

/** How many triangles glTF-Transform finds in the meshes of a GLB. */
async function countWithTransform(bytes: Uint8Array): Promise<number> {
  const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
  const document = await io.readBinary(bytes);
  const lists = document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives()).filter((primitive) => primitive.getMode() === 4);
  return lists.reduce((sum, primitive) => sum + (primitive.getIndices()?.getCount() ?? 0) / 3, 0);
}
