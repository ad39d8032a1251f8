// The report of one file's way through: what went in, what came out, how far they differ, how long it took.

import type { Parts } from './parts.js';
import type { Blockers, DocumentSummary, Format, LevelSummary, OutputFormat, StopReason, Warning } from './types.js';

/** A file in a report. */
export interface ReportedFile<FileFormat extends Format = Format> {
  /** Null where there is no file, only bytes. */
  readonly path: string | null;
  readonly format: FileFormat;
  readonly bytes: number;
  readonly triangles: number;
  readonly vertices: number;
  readonly meshes: number;
  /** Where the bytes are. */
  readonly parts: Parts;
}

/** Measured distances of one surface's samples from the other surface, model units. */
export interface SideDeviation {
  readonly max: number;
  /** Average over the area. */
  readonly mean: number;
  /** Root mean square over the area. */
  readonly rms: number;
  /** How many places were measured at: on faces, edges and vertices together. */
  readonly samples: number;
}

/** Measured distances between the original and the selected level, model units. */
export interface Deviation {
  /** The larger of the sides'. */
  readonly max: number;
  /** The average of the sides'. */
  readonly mean: number;
  /** The root of the average of the sides' squares. */
  readonly rms: number;
  /** Length of the original's bounding box diagonal. */
  readonly relativeTo: number;
  /** What was lost: how far the original is from the level. */
  readonly originalToSimplified: SideDeviation;
  /** What was made up: how far the level is from the original. */
  readonly simplifiedToOriginal: SideDeviation;
}

/** How far a level is from the original at each of its vertices, model units. The arrays are the caller's own. */
export interface DeviationMap {
  /** The whole level's; what colours can be scaled by. */
  readonly deviation: Deviation;
  /** One for each wedge set of the level, in the order of its vertices; vertices at one place have the same values. */
  readonly wedgeSets: readonly WedgeSetDeviation[];
}

/** Two measures of the same vertices. */
export interface WedgeSetDeviation {
  /** From each vertex to the original surface. All 0 where `placement` is `'subset'`: the vertices are the original's. */
  readonly distances: Float32Array;
  /**
   * The largest distance that was measured, from either surface to the other, at places nearer to the vertex than to the
   * level's other vertices: also what is lost between vertices that are in their places.
   */
  readonly surroundings: Float32Array;
}

/** Milliseconds spent on each part. */
export interface Timings {
  readonly read: number;
  readonly simplify: number;
  readonly write: number;
  readonly measure: number;
}

/** A level of a chain in a report. */
export interface ReportedLod {
  readonly triangles: number;
  readonly vertices: number;
  /** Estimated deviation from the original, model units. */
  readonly estimatedError: number;
  /** The smallest share of the picture's area, 0 to 1, that the model may cover for this level to be shown. */
  readonly screenCoverage: number;
  /** Of a level in a file of its own. */
  readonly path?: string | null;
  /** Of a level in a file of its own. */
  readonly bytes?: number;
}

/** What `--json` prints and `Document.write` returns; lengths in model units. */
export interface Report {
  readonly input: ReportedFile;
  readonly output: ReportedFile<OutputFormat>;
  /** Null when nothing was simplified. */
  readonly stopReason: StopReason | null;
  /** What blocks the edges that are left, if the run ended for `'error'` or `'constraints'`. */
  readonly blockers: Blockers | null;
  /** Estimated deviation from the original; 0 at full detail. */
  readonly estimatedError: number;
  /** Null unless the written level was measured. */
  readonly deviation: Deviation | null;
  readonly timings: Timings;
  readonly warnings: readonly Warning[];
  /** The levels of a chain, the finest first, of which `output` counts the first. Only where a chain was written. */
  readonly lods?: readonly ReportedLod[];
}

/** What a report is made from. */
export interface ReportParts {
  readonly summary: DocumentSummary;
  /** Undefined when nothing was simplified. */
  readonly level: LevelSummary | undefined;
  /** Undefined when it was not measured. */
  readonly deviation: Deviation | undefined;
  readonly output: { readonly format: OutputFormat; readonly bytes: number; readonly triangles: number; readonly parts: Parts };
  /** Of the input. */
  readonly parts: Parts;
  readonly timings: Timings;
  /** What the output's format or encoding cannot hold. */
  readonly losses: readonly Warning[];
  /** Undefined without a chain. */
  readonly lods?: readonly ReportedLod[] | undefined;
}

/** Puts a report together; both paths are null, for the caller to fill in. */
export function makeReport({ summary, level, deviation, output, parts, timings, losses, lods }: ReportParts): Report {
  const { format, bytes, triangles, vertices, meshes, warnings } = summary;
  return {
    input: { path: null, format, bytes, triangles, vertices, meshes, parts },
    output: {
      path: null,
      format: output.format,
      bytes: output.bytes,
      triangles: output.triangles,
      vertices: level?.vertices ?? vertices,
      meshes,
      parts: output.parts,
    },
    stopReason: level?.stopReason ?? null,
    blockers: level?.blockers ?? null,
    estimatedError: level?.estimatedError ?? 0,
    deviation: deviation ?? null,
    timings,
    warnings: [...warnings, ...losses],
    ...(lods === undefined ? {} : { lods }),
  };
}
