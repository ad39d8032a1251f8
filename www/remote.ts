// A model from the web with the files it refers to.
import type { WorkerClient } from 'decimesh/worker';
import { decodePath, fetchFile } from './download.ts';

/** How a download is watched and stopped. */
interface Fetching {
  readonly signal: AbortSignal;
  /** Gets 0..1, or null while the size is unknown. */
  onProgress(fraction: number | null): void;
}

/** Downloads the model at `address`, called `fileName`, and what it names beside itself; the model comes first. */
export async function fetchModel(client: WorkerClient, address: URL, fileName: string, { signal, onProgress }: Fetching): Promise<File[]> {
  const model = await fetchFile(address, fileName, { signal, onProgress });
  const references = await client.externalFiles(new Uint8Array(await model.arrayBuffer()));
  const others = (await Promise.all(references.map((reference) => fetchReference(reference, '', address, signal)))).flat();
  const libraries = others.filter((file) => /\.mtl$/i.test(file.name));
  const images = await Promise.all(libraries.map((library) => fetchImages(client, library, address, signal)));
  return [model, ...others, ...images.flat()];
}

// A material library names images relative to itself.
async function fetchImages(client: WorkerClient, library: File, address: URL, signal: AbortSignal): Promise<File[]> {
  const images = await client.externalFiles(new Uint8Array(await library.arrayBuffer()));
  const folder = library.name.slice(0, library.name.lastIndexOf('/') + 1);
  return (await Promise.all(images.map((image) => fetchReference(image, folder, address, signal)))).flat();
}

// A file that cannot be had is left out: opening the model tells whether it can do without, and names the place.
// `folder` is that of the file it is named in, from the model.
async function fetchReference(reference: string, folder: string, address: URL, signal: AbortSignal): Promise<File[]> {
  const beside = URL.parse(folder + reference.replaceAll('\\', '/'), address);
  if (beside === null) return [];
  try {
    return [await fetchFile(beside, decodePath(folder + reference), { signal })];
  } catch {
    signal.throwIfAborted();
    return [];
  }
}
