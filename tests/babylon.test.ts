// Chains of levels in Babylon.js, which loads the coarsest level of MSFT_lod first and puts finer ones in its place.
import { readFileSync } from 'node:fs';
import { NullEngine } from '@babylonjs/core/Engines/nullEngine.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { Logger } from '@babylonjs/core/Misc/logger.js';
import { Scene } from '@babylonjs/core/scene.js';
import '@babylonjs/loaders/glTF/2.0/glTFLoader.js';
import '@babylonjs/loaders/glTF/2.0/Extensions/MSFT_lod.js';
import { afterAll, beforeAll, expect, it } from 'vitest';
import { init, openDocument } from 'decimesh';
import { at } from '../scripts/project.mjs';
import { glb, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';

let engine: NullEngine;

beforeAll(async () => {
  await init();
  Logger.LogLevels = Logger.ErrorLogLevel;
  engine = new NullEngine();
});
afterAll(() => engine.dispose());

/** Loads at most `most` levels of each chain and calls `look` with the number of triangles that are drawn then. */
async function load(bytes: Uint8Array, most: number, look: (triangles: () => number) => Promise<void>): Promise<void> {
  const scene = new Scene(engine);
  const pluginOptions = { gltf: { extensionOptions: { MSFT_lod: { maxLODsToLoad: most } } } };
  const container = await LoadAssetContainerAsync(bytes, scene, { pluginExtension: '.glb', pluginOptions });
  container.addAllToScene();
  await look(() => scene.meshes.filter((mesh) => mesh.isEnabled()).reduce((sum, mesh) => sum + mesh.getTotalIndices() / 3, 0));
  scene.dispose();
}

const models = {
  'a mesh without a material': () => glb(gltfOf(hills(30))),
  'a scan': () => new Uint8Array(readFileSync(at('www', 'samples', 'nefertiti.glb'))),
  'many meshes with textures': () => new Uint8Array(readFileSync(at('www', 'samples', 'desk-fan.glb'))),
};

it.each(Object.entries(models))('has every level of %s, the coarsest first', async (_, model) => {
  using document = await openDocument(model());
  await document.simplify({});
  const { bytes, report } = await document.write({ lods: [1, 0.3, 0.05] });
  const levels = (report.lods ?? []).map(({ triangles }) => triangles);
  expect(levels).toHaveLength(3);
  expect(new Set(levels).size).toBe(3);
  for (const most of [1, 2, 3]) {
    await load(bytes, most, async (triangles) => {
      // What is finer comes after the promise is kept.
      await expect.poll(triangles, { timeout: 20_000 }).toBe(levels[levels.length - most]);
    });
  }
});
