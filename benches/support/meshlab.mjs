// MeshLab's quadric filter as an optional contestant, through a Python that has pymeshlab.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const script = fileURLToPath(new URL('meshlab.py', import.meta.url));
// PYMESHLAB names a virtual environment that has pymeshlab and numpy.
const python = process.env.PYMESHLAB ? path.join(process.env.PYMESHLAB, 'bin', 'python') : 'python3';
const run = (...words) =>
  execFileSync(python, [script, ...words], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], timeout: 30 * 60_000 });

/** Version of pymeshlab, or `undefined` where there is none. */
export const version = (() => {
  try {
    return run('version').trim();
  } catch {
    return undefined;
  }
})();

/** MeshLab's result at `target` triangles, default settings. */
export function meshlabSimplify({ positions, indices }, target) {
  const directory = mkdtempSync(path.join(tmpdir(), 'decimesh-meshlab-'));
  try {
    const file = (name) => path.join(directory, name);
    writeFileSync(file('positions'), positions);
    writeFileSync(file('indices'), indices);
    run(directory, String(target));
    const bytes = (name) => new Uint8Array(readFileSync(file(name))).buffer;
    return { positions: new Float32Array(bytes('positions.out')), indices: new Uint32Array(bytes('indices.out')) };
  } finally {
    rmSync(directory, { recursive: true, force: true });
  }
}
