// A folder that is gone when the work in it is done.
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

/** The result of `work`, which gets the path of an empty folder for itself. */
export async function withTemporaryFolder(work) {
  const folder = mkdtempSync(join(tmpdir(), 'decimesh-bench-'));
  try {
    return await work(folder);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}
