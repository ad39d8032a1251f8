// The report of one file's way through: what went in, what came out, how far they differ, how long it took.

import type { DocumentSummary, Format, LevelSummary, OutputFormat, StopReason, Warning } from './types.js';

/** A file in a report. */
export interface ReportedFile<FileFormat extends Format = Format> {
  /** Null where there is no file, only bytes. */
  readonly path: string | null;
  readonly format: FileFormat;
  readonly bytes: number;
  readonly triangles: number;
  readonly vertices: number;
  readonly meshes: number;
}

/** Measured distances between two surfaces, model units. */
export interface Deviation {
  readonly max: number;
  readonly mean: number;
  readonly rms: number;
  /** Length of the original's bounding box diagonal. */
  readonly relativeTo: number;
}

/** Milliseconds spent on each part. */
export interface Timings {
  readonly read: number;
  readonly simplify: number;
  readonly write: number;
  readonly measure: number;
}

/** What `--json` prints and `Document.write` returns; lengths in model units. */
export interface Report {
  readonly input: ReportedFile;
  readonly output: ReportedFile<OutputFormat>;
  /** Null when nothing was simplified. */
  readonly stopReason: StopReason | null;
  /** Estimated deviation from the original; 0 at full detail. */
  readonly estimatedError: number;
  /** Null unless it was measured. */
  readonly deviation: Deviation | null;
  readonly timings: Timings;
  readonly warnings: readonly Warning[];
}

/** What a report is made from. */
export interface ReportParts {
  readonly summary: DocumentSummary;
  /** Undefined when nothing was simplified. */
  readonly level: LevelSummary | undefined;
  readonly output: { readonly format: OutputFormat; readonly bytes: number };
  readonly timings: Timings;
  /** What the output format cannot hold. */
  readonly losses: readonly Warning[];
}

/** Puts a report together; both paths are null, for the caller to fill in. */
export function makeReport({ summary, level, output, timings, losses }: ReportParts): Report {
  const { format, bytes, triangles, vertices, meshes, warnings } = summary;
  return {
    input: { path: null, format, bytes, triangles, vertices, meshes },
    output: {
      path: null,
      format: output.format,
      bytes: output.bytes,
      triangles: level?.triangles ?? triangles,
      vertices: level?.vertices ?? vertices,
      meshes,
    },
    stopReason: level?.stopReason ?? null,
    estimatedError: level?.estimatedError ?? 0,
    deviation: null,
    timings,
    warnings: [...warnings, ...losses],
  };
}
