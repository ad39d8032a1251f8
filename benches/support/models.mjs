// The bench models: OBJ text in gzip, read to bare arrays.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';
import { subdivide } from './subdivide.mjs';

/** Where the models are; they are too large to live in the repository. */
export const folder = new URL('../../../shared/assets/bench/', import.meta.url);

export const available = existsSync(folder);

/** The models that the figures of quality are asked on. */
export const sixModels = ['stanford-bunny', 'igea', 'nefertiti', 'fandisk', 'rocker-arm', 'beast'];

/** A model by name, or as `NAME*4`, `NAME*16`, `NAME*64` that many times as many triangles, with a little noise. */
export function benchModel(name) {
  const [base, times = '1'] = name.split('*');
  return subdivide(loadModel(base), Math.log2(Number(times)) / 2);
}

/** The same models as others, under another name or format. */
const TWICE = /^(bun_zipper|bunny70k|igea\.ply)/;

/** All bench models and scans but those that are there twice, as `{ name, read() }`: a file name and its bytes. */
export function allModels() {
  const directories = [folder, new URL('../scans/', folder)].filter((directory) => existsSync(directory));
  return directories
    .flatMap((directory) => readdirSync(directory).map((file) => ({ name: file.replace(/\.gz$/, ''), url: new URL(file, directory) })))
    .filter(({ name }) => !TWICE.test(name))
    .map(({ name, url }) => ({ name, read: () => (url.pathname.endsWith('.gz') ? gunzipSync(readFileSync(url)) : readFileSync(url)) }));
}

/** Positions and indices of one model by its base name, e.g. `stanford-bunny`. */
export function loadModel(name) {
  const text = gunzipSync(readFileSync(new URL(`${name}.obj.gz`, folder))).toString('latin1');
  const positions = [];
  const indices = [];
  for (const line of text.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') {
      positions.push(Number(words[1]), Number(words[2]), Number(words[3]));
    } else if (words[0] === 'f') {
      const corners = words.slice(1).map((word) => Number.parseInt(word, 10) - 1);
      for (let k = 1; k + 1 < corners.length; k++) indices.push(corners[0], corners[k], corners[k + 1]);
    }
  }
  return { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
}

/** The mesh as OBJ text, for meters that read files. */
export function toObj({ positions, indices }) {
  const lines = [];
  for (let i = 0; i < positions.length; i += 3) lines.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  for (let i = 0; i < indices.length; i += 3) lines.push(`f ${indices[i] + 1} ${indices[i + 1] + 1} ${indices[i + 2] + 1}`);
  return `${lines.join('\n')}\n`;
}
