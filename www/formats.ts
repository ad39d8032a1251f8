// The formats and qualities that the page offers for a download.
import type { OutputFormat as PackageFormat, Preset } from 'decimesh/worker';

/** What the page saves: formats of one file. */
export type OutputFormat = Exclude<PackageFormat, 'gltf'>;

/** The formats that the page can download, and what it calls them. */
export const FORMAT_NAMES: Readonly<Record<OutputFormat, string>> = { glb: 'GLB', obj: 'OBJ', ply: 'PLY', stl: 'STL', off: 'OFF', smf: 'SMF' };

/** Whether `value` names a format that can be downloaded. */
export const isOutputFormat = (value: string): value is OutputFormat => Object.hasOwn(FORMAT_NAMES, value);

const MIME_TYPES: Readonly<Record<OutputFormat, string>> = {
  glb: 'model/gltf-binary',
  obj: 'model/obj',
  stl: 'model/stl',
  // Without a type of their own; as text they would be saved as .txt.
  ply: 'application/octet-stream',
  off: 'application/octet-stream',
  smf: 'application/octet-stream',
};

/** `bytes` as a file of `format` that can be saved. */
export const blobOf = (bytes: Uint8Array, format: OutputFormat): Blob => new Blob([bytes as Uint8Array<ArrayBuffer>], { type: MIME_TYPES[format] });

/** Hands `blob` to the browser as a download called `fileName`. */
export function save(blob: Blob, fileName: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = fileName;
  link.click();
  // Some browsers read the blob only after the click has been handled.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** How good the level is that is downloaded. */
export type Quality = Preset;

/** The qualities as the page offers them. */
export const QUALITIES: readonly Quality[] = ['fast', 'balanced', 'best'];
