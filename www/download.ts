// One file from the web, with its progress, under the name that its address gives it.

/** A failed download, with the code and place that a notice shows. */
class FetchError extends Error {
  readonly code = 'cannot-read';
  constructor(
    message: string,
    /** The address. */
    readonly where: string,
  ) {
    super(message);
  }
}

/** The last part of an address's path, readable. */
export function fileNameOf(address: URL): string {
  return decodePath(address.pathname.split('/').pop() ?? '') || 'model';
}

/** A path with its escapes undone; a stray % is no escape and stays as it is. */
export function decodePath(path: string): string {
  try {
    return decodeURIComponent(path);
  } catch {
    return path;
  }
}

/** Downloads `address` as a file called `name`; `onProgress` gets 0..1, or null while the size is unknown. */
export async function fetchFile(
  address: URL,
  name: string,
  { signal, onProgress }: { signal: AbortSignal; onProgress?: (fraction: number | null) => void },
): Promise<File> {
  let response: Response;
  try {
    response = await fetch(address, { signal });
  } catch (error) {
    signal.throwIfAborted();
    // Browsers keep the cause from scripts: it may be the network or a server that does not allow other pages.
    throw new FetchError(`could not be downloaded (${error instanceof Error ? error.message : String(error)})`, address.href);
  }
  if (!response.ok) throw new FetchError(`the server answered ${response.status} ${response.statusText}`.trim(), address.href);
  const total = Number(response.headers.get('content-length') ?? 0);
  // The length counts compressed bytes, the stream gives them unpacked.
  const countable = total > 0 && !response.headers.has('content-encoding');
  const reader = response.body?.getReader();
  if (reader === undefined) return new File([await response.blob()], name);
  const chunks: BlobPart[] = [];
  let received = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return new File(chunks, name);
    chunks.push(value);
    received += value.length;
    onProgress?.(countable ? Math.min(received / total, 1) : null);
  }
}
