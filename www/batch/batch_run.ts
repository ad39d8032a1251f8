// Works through a queue of models, one document open at a time; the results wait as blobs, which browsers keep on disk.
import type { WorkerClient } from 'decimesh/worker';
import { describeError } from '../describe_error.ts';
import { simplifyOptions } from '../wishes.ts';
import { blobOf, isOutputFormat } from '../formats.ts';
import type { Quality } from '../formats.ts';
import type { RunSettings } from '../choices.ts';
import { prepareOptions } from '../preparation.ts';
import type { Preparation } from '../preparation.ts';
import type { BatchResult } from './batch_state.ts';

/** How each model is simplified, and what else is done to its file. */
export interface BatchSettings {
  readonly share: number;
  readonly quality: Quality;
  readonly run: RunSettings;
  readonly preparation: Preparation;
}

/** A finished file under its path in the zip. */
export interface BatchFile {
  readonly name: string;
  readonly blob: Blob;
}

/**
 * Simplifies each of `models` (a model with its files, as the client takes them) and tells what becomes of it. One that
 * fails does not keep the others from their turn; an abort leaves those that were done. Resolves to their files.
 */
export async function runBatch(
  client: WorkerClient,
  models: ReadonlyArray<{ readonly name: string; readonly files: readonly File[] }>,
  { share, quality, run, preparation }: BatchSettings,
  { signal, onResult }: { readonly signal: AbortSignal; onResult(index: number, result: BatchResult): void },
): Promise<BatchFile[]> {
  const done: BatchFile[] = [];
  const taken = new Set<string>();
  for (const [index, { name, files }] of models.entries()) {
    if (signal.aborted) break;
    onResult(index, { kind: 'running', fraction: null });
    try {
      using document = await client.openDocument(files, { signal });
      const { summary } = document;
      await document.simplify({
        ...simplifyOptions({ ...run, kept: [] }, summary),
        ratio: share,
        preset: quality,
        signal,
        onProgress: (fraction) => onResult(index, { kind: 'running', fraction }),
      });
      const format = isOutputFormat(summary.format) ? summary.format : 'glb';
      const { bytes, report } = await document.write({ format, ...prepareOptions(format, preparation) });
      signal.throwIfAborted();
      const fileName = unusedName(name.replace(/\.[^./]+$/, ''), format, taken);
      done.push({ name: fileName, blob: blobOf(bytes, format) });
      onResult(index, {
        kind: 'done',
        fileName,
        before: { triangles: summary.triangles, bytes: summary.bytes },
        after: { triangles: report.output.triangles, bytes: bytes.byteLength },
      });
    } catch (error) {
      if (signal.aborted) break;
      const notice = describeError(error);
      onResult(index, { kind: 'failed', notice: { ...notice, where: notice.where || name } });
    }
  }
  return done;
}

/** `base.format`, with a number where an earlier file is called that already. */
function unusedName(base: string, format: string, taken: Set<string>): string {
  let name = `${base}.${format}`;
  for (let number = 2; taken.has(name.toLowerCase()); number += 1) name = `${base}-${number}.${format}`;
  taken.add(name.toLowerCase());
  return name;
}

/** Bytes of a file that are taken into the zip at a time; between them the page answers. */
const PIECE = 1 << 20;

/** All files in one zip, stored and not deflated: what models hold is packed already or hardly gets smaller. */
export async function zipOf(files: readonly BatchFile[], signal: AbortSignal): Promise<Blob> {
  const { Zip, ZipPassThrough } = await import('fflate');
  const pieces: BlobPart[] = [];
  let failure: Error | null = null;
  const zip = new Zip((error, piece) => {
    if (error !== null) failure = error;
    else pieces.push(piece as Uint8Array<ArrayBuffer>);
  });
  for (const { name, blob } of files) {
    const entry = new ZipPassThrough(name);
    zip.add(entry);
    for (let start = 0; start < blob.size; start += PIECE) {
      signal.throwIfAborted();
      entry.push(new Uint8Array(await blob.slice(start, start + PIECE).arrayBuffer()), start + PIECE >= blob.size);
    }
    if (blob.size === 0) entry.push(new Uint8Array(), true);
  }
  zip.end();
  if (failure !== null) throw failure;
  // Pieces in memory become one file that the browser may put on disk.
  return new Blob(pieces, { type: 'application/zip' });
}
