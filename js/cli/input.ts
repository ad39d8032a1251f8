// A model from disk: its file, and of the files it refers to those in its own folder or below.

import { readFile } from 'node:fs/promises';
import { basename, dirname, isAbsolute, join, normalize, sep } from 'node:path';
import { externalFiles } from '../document/open.js';
import { pathOfUri, type LoadedFile } from '../files.js';
import type { Warning } from '../types.js';
import { fileError, isMissing } from './file_error.js';

/** What was read; the model comes first. */
export interface ReadInput {
  readonly files: readonly LoadedFile[];
  readonly warnings: readonly Warning[];
}

/**
 * Reads `path` and the files it refers to. Rejects with `cannot-read` if one is there but cannot be read.
 *
 * A file may come from anywhere, so it does not get to name others outside of its folder: such ones are left out with
 * a warning. Whether the model can do without a file that is left out or missing is the reader's to say.
 */
export async function readInput(path: string): Promise<ReadInput> {
  const bytes = await read(path);
  const files: LoadedFile[] = [{ name: basename(path), bytes }];
  const warnings: Warning[] = [];
  const seen = new Set<string>();
  const take = async (uri: string, folder: string): Promise<void> => {
    const name = pathInside(uri, folder);
    if (name === undefined) {
      warnings.push({ code: 'outside-folder', message: 'only files in the folder of the model are read', where: uri });
      return;
    }
    if (seen.has(name)) return;
    seen.add(name);
    try {
      const bytes = await readFile(join(dirname(path), name));
      files.push({ name, bytes });
      // A material library names images, relative to itself; these name nothing further.
      if (folder === '' && /\.mtl$/i.test(name)) {
        for (const image of externalFiles(bytes)) await take(image, `${dirname(name)}/`);
      }
    } catch (error) {
      if (!isMissing(error)) throw fileError('cannot-read', error, join(dirname(path), name));
    }
  };
  for (const uri of externalFiles(bytes)) await take(uri, '');
  return { files, warnings };
}

async function read(path: string): Promise<Uint8Array> {
  try {
    return await readFile(path);
  } catch (error) {
    throw fileError('cannot-read', error, path);
  }
}

/**
 * The path from the model that a relative URI in `folder` (empty, or ending with `/`) names, if that stays in the
 * model's folder; undefined for any other URI.
 */
function pathInside(uri: string, folder = ''): string | undefined {
  // A scheme, and also a drive.
  if (/^[a-z][a-z0-9+.-]*:/i.test(uri)) return undefined;
  const relative = pathOfUri(uri).replaceAll('\\', '/');
  if (isAbsolute(relative)) return undefined;
  const path = normalize(folder + relative);
  const leaves = path === '..' || path.startsWith(`..${sep}`) || isAbsolute(path) || /^[a-z]:/i.test(path);
  return leaves || path === '.' || path.includes('\0') ? undefined : path.replaceAll(sep, '/');
}
