// The models of ../shared/assets with the files they refer to.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { basename, dirname, extname, join } from 'node:path';
import { gunzipSync } from 'node:zlib';
import { externalFiles } from 'decimesh';
import { assetPath } from './assets.ts';

const MODELS = new Set(['.glb', '.gltf', '.obj', '.ply', '.stl', '.off', '.smf']);

export interface Named {
  readonly name: string;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** The paths of the models in a folder of the assets; large text files are compressed there. */
export function modelPaths(folder = '.'): string[] {
  const paths = readdirSync(assetPath(folder), { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map(({ parentPath, name }) => join(parentPath, name));
  return paths.filter((path) => MODELS.has(extname(path.replace(/\.gz$/, '')).toLowerCase())).sort();
}

/** A model, and behind it what it refers to as far as that is there. Needs the engine to be loaded. */
export function loadModel(path: string): Named[] {
  const read = (file: string): Uint8Array<ArrayBuffer> => new Uint8Array(file.endsWith('.gz') ? gunzipSync(readFileSync(file)) : readFileSync(file));
  const files = [{ name: basename(path, '.gz'), bytes: read(path) }];
  for (const { bytes } of files) {
    for (const uri of externalFiles(bytes)) {
      let name = uri;
      try {
        name = decodeURIComponent(uri);
      } catch {
        // Not an encoded name, then.
      }
      const found = join(dirname(path), name);
      if (!files.some((file) => file.name === name) && existsSync(found)) files.push({ name, bytes: read(found) });
    }
  }
  return files;
}
