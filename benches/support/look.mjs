// The meter of looks: both files drawn from the same views in headless Chromium, compared by SSIM.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { digest } from './cache.mjs';

const tool = new URL('../../../shared/tools/lookdist.mjs', import.meta.url);
const models = new URL('../../../shared/assets/gltf/', import.meta.url);

/** Views around the model, and the side of each picture in pixels. */
const VIEWS = 12;
const SIZE = 384;

export const available = existsSync(tool) && existsSync(models);

/** Changes with everything that the figures depend on. */
export const version = available ? digest(readFileSync(tool), `${VIEWS} views, ${SIZE} px`) : undefined;

/** `{ ssim, worst, psnr, triangles, triangles_in }` of the file `result` against the file `original`. */
export function compare(original, result) {
  const words = [fileURLToPath(tool), original, result, '--views', String(VIEWS), '--size', String(SIZE)];
  const env = { ...process.env, LOOKDIST_MODULES: fileURLToPath(new URL('../../node_modules', import.meta.url)) };
  const { file: _, ...figures } = JSON.parse(execFileSync(process.execPath, words, { env, encoding: 'utf8' }));
  if (figures.ssim === undefined) throw new Error(`the meter cannot draw ${result}: ${figures.error}`);
  return figures;
}
