// The contestants for whole glTF files: this package, gltfpack and glTF-Transform, each from file to file.
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { simplify, weld } from '@gltf-transform/functions';
import draco from 'draco3dgltf';
import { MeshoptDecoder, MeshoptSimplifier } from 'meshoptimizer';

const DRACO = 'KHR_draco_mesh_compression';

const installed = (path) => new URL(`../../node_modules/${path}`, import.meta.url);
const versionOf = (name) => JSON.parse(readFileSync(installed(`${name}/package.json`), 'utf8')).version;

/** What is compared with; `run(input, output, share)` writes a GLB file. */
export const PEERS = [
  { name: 'gltfpack', version: versionOf('gltfpack'), run: runGltfpack },
  { name: 'gltf-transform', version: `${versionOf('@gltf-transform/functions')}, ${versionOf('meshoptimizer')}`, run: runGltfTransform },
];

/** This package's command line, as a user calls it. */
export function simplifyOurs(input, output, share) {
  const words = [fileURLToPath(new URL('../../dist/cli.js', import.meta.url)), input, '-o', output, '--ratio', String(share), '--json'];
  return JSON.parse(execFileSync(process.execPath, words, { encoding: 'utf8' }));
}

/** The file itself, or if it is compressed by Draco the name `output`, where it is written decoded, for all engines alike. */
export async function decoded(input, output) {
  if (!input.endsWith('.gltf') || !JSON.parse(readFileSync(input, 'utf8')).extensionsRequired?.includes(DRACO)) return input;
  const document = await (await io()).read(input);
  document.getRoot().listExtensionsUsed().find(({ extensionName }) => extensionName === DRACO)?.dispose();
  await (await io()).write(output, document);
  return output;
}

async function io() {
  await MeshoptDecoder.ready;
  return new NodeIO()
    .registerExtensions(ALL_EXTENSIONS)
    .registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'draco3d.decoder': await draco.createDecoderModule() });
}

/** Without quantisation, with names, materials and extras kept; the error never stops it before the count does. */
function runGltfpack(input, output, share) {
  const words = ['-si', String(share), '-se', '1', '-noq', '-kn', '-km', '-ke'];
  execFileSync(process.execPath, [fileURLToPath(installed('gltfpack/cli.js')), '-i', input, '-o', output, ...words]);
}

async function runGltfTransform(input, output, share) {
  await MeshoptSimplifier.ready;
  const document = await (await io()).read(input);
  await document.transform(weld(), simplify({ simplifier: MeshoptSimplifier, ratio: share, error: 1 }));
  writeFileSync(output, await (await io()).writeBinary(document));
}
