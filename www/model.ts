// What is known of the model on screen, and of what is done to it.
import type { Blockers, Compression, Parts, ReportedLod } from 'decimesh/worker';
import type { Choices } from './choices.ts';
import type { Encoding } from './encoding.ts';
import type { OutputFormat } from './formats.ts';
import type { SceneNode } from './scene.ts';

/** Something that went wrong, or a remark about a file, as the engine reports it. */
export interface Notice {
  /** Stable code, for example `gltf.index-out-of-range`. */
  readonly code: string;
  readonly message: string;
  /** The place in the file or the argument; empty when there is none. */
  readonly where: string;
}

/** What is known about a file when it has been opened. Lengths in model units. */
export interface Source {
  readonly format: string;
  readonly compression: Compression;
  readonly bytes: number;
  readonly triangles: number;
  readonly vertices: number;
  readonly meshes: number;
  /** Diagonal of the bounding box. */
  readonly diagonal: number;
}

/** One level of detail that is on screen. */
export interface Level {
  readonly triangles: number;
  readonly vertices: number;
  /** Estimated deviation from the original in model units. */
  readonly estimatedError: number;
}

/** How far the recording of the collapse history is; levels exist once it is `ready`. */
export type History =
  | { readonly kind: 'none' }
  | { readonly kind: 'recording'; readonly fraction: number }
  | { readonly kind: 'ready'; readonly fewestTriangles: number; /** Why there are no fewer. */ readonly blockers: Blockers | null };

/** Measured distances between the level and the original, in model units, both ways together. */
export interface Deviation {
  readonly max: number;
  readonly mean: number;
  readonly rms: number;
  /** Diagonal of the original's bounding box. */
  readonly relativeTo: number;
}

/** Whether the level that the slider asks for has been measured; another wish makes it `none` again. */
export type Measurement =
  | { readonly kind: 'none' }
  | { readonly kind: 'running'; readonly fraction: number }
  | { readonly kind: 'done'; readonly deviation: Deviation };

/** The size of the file that Download would save, and what it was measured for. */
export interface Output {
  readonly format: OutputFormat;
  readonly encoding: Encoding;
  /** The `preparationKey` of what it was prepared with. */
  readonly preparation: string;
  /** The wish whose level was written. */
  readonly wantedTriangles: number;
  /** The chain that was written; empty: one level. */
  readonly lods: readonly number[];
  readonly bytes: number;
  /** Where the bytes are; null while that is unknown. */
  readonly parts: Parts | null;
  /** What became of each level of the chain. */
  readonly levels: readonly ReportedLod[];
}

/** Where a model came from, if the page's address can say it. */
export interface Origin {
  readonly kind: 'model' | 'sample';
  readonly address: string;
}

/** All that one step of undo goes back to. */
export type Step = Choices & { readonly wantedTriangles: number };

/** The model on screen. */
export interface Model {
  /** Base name without extension; the download gets it. */
  readonly name: string;
  /** With extension, as it was opened. */
  readonly fileName: string;
  readonly origin: Origin | null;
  readonly credit: string;
  readonly source: Source;
  /** Where the bytes of the file are; null while that is unknown. */
  readonly parts: Parts | null;
  readonly scene: readonly SceneNode[];
  /** Triangles of each mesh at the level shown, by its number; null at full detail. */
  readonly meshTriangles: ReadonlyMap<number, number> | null;
  readonly warnings: readonly Notice[];
  /** Names of the animations, in file order. */
  readonly animations: readonly string[];
  /** Whether it has been drawn yet. */
  readonly drawn: boolean;
  readonly history: History;
  /** What the slider asks for. */
  readonly wantedTriangles: number;
  /** What is drawn; catches up with `wantedTriangles` as soon as the history allows. */
  readonly shown: Level;
  /** The wish that `shown` answers; its count may differ from the wish by a triangle or two. */
  readonly shownFor: number;
  readonly output: Output | null;
  readonly measurement: Measurement;
  readonly undo: readonly Step[];
  readonly redo: readonly Step[];
  /** The gesture of the last move: moves of one drag are undone together. */
  readonly gesture: number;
}

/** Something that keeps the user waiting and can be cancelled. */
export interface Task {
  readonly kind: 'opening' | 'fitting' | 'writing';
  readonly name: string;
  /** 0..1, or null when unknown. */
  readonly fraction: number | null;
}
