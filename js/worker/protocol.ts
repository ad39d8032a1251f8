// What the client and the worker say to each other. Types only.
//
// Every request but `cancel` and `dispose` carries an `id` that its replies repeat. It is answered by any number of
// `progress` messages and then by exactly one other: the one named below, or `failed`, or `cancelled`. Documents live
// in the worker and are named by numbers that are not used again. After `failed` with `internal` or `out-of-memory`
// the worker's documents are gone, later requests for them fail with `disposed`, and it can open others.

import type { ErrorData } from '../errors.js';
import type { LoadedFile } from '../files.js';
import type { Written } from '../document/write.js';
import type { ProgressiveOptions } from '../progressive/encode.js';
import type { Deviation, DeviationMap } from '../report.js';
import type {
  DocumentSimplifyOptions,
  DocumentSummary,
  LevelGeometry,
  LevelSummary,
  LevelTargets,
  MeasureOptions,
  MeshInput,
  MeshSimplifyOptions,
  SimplifiedMesh,
  WriteOptions,
} from '../types.js';

/** Opens a document. Answered by {@link Opened}; progress in coarse steps. */
export interface OpenRequest {
  readonly type: 'open';
  readonly id: number;
  readonly files: ReadonlyArray<File | LoadedFile>;
}

/** Simplifies a document and selects a level. Answered by {@link LevelReply}; cancelled, the former level stays. */
export interface SimplifyRequest {
  readonly type: 'simplify';
  readonly id: number;
  readonly document: number;
  readonly options: DocumentSimplifyOptions;
}

/** Selects a level. Answered by {@link LevelReply}; cancelled, the former level stays. */
export interface LevelRequest {
  readonly type: 'level';
  readonly id: number;
  readonly document: number;
  readonly targets: LevelTargets;
}

/** Measures the selected level against the original. Answered by {@link MeasuredReply}. */
export interface MeasureRequest {
  readonly type: 'measure';
  readonly id: number;
  readonly document: number;
  readonly options: MeasureOptions;
}

/** Measures it with a map. Answered by {@link DeviationMapReply}. */
export interface DeviationMapRequest {
  readonly type: 'deviation-map';
  readonly id: number;
  readonly document: number;
  readonly options: MeasureOptions;
}

/** Asks for the selected level's arrays. Answered by {@link GeometryReply}. */
export interface GeometryRequest {
  readonly type: 'geometry';
  readonly id: number;
  readonly document: number;
}

/** Writes the selected level. Answered by {@link WrittenReply}. */
export interface WriteRequest {
  readonly type: 'write';
  readonly id: number;
  readonly document: number;
  readonly options: WriteOptions;
}

/** Writes a progressive mesh. Answered by {@link ProgressiveReply}. */
export interface WriteProgressiveRequest {
  readonly type: 'write-progressive';
  readonly id: number;
  readonly document: number;
  readonly options: ProgressiveOptions;
}

/** Simplifies bare arrays; nothing stays in the worker. Answered by {@link SimplifiedReply}. */
export interface SimplifyArraysRequest {
  readonly type: 'simplify-arrays';
  readonly id: number;
  readonly mesh: MeshInput;
  readonly options: MeshSimplifyOptions;
}

/** Asks which files a .gltf or .glb needs beside itself. Answered by {@link ExternalFilesReply}. */
export interface ExternalFilesRequest {
  readonly type: 'external-files';
  readonly id: number;
  readonly bytes: Uint8Array;
}

/** Stops the request of this id if it is still under way; that request is then answered by {@link CancelledReply}. */
export interface CancelRequest {
  readonly type: 'cancel';
  readonly id: number;
}

/** Frees a document; one that is gone already is no error. Not answered. */
export interface DisposeRequest {
  readonly type: 'dispose';
  readonly document: number;
}

/** Requests that are answered. */
export type AnsweredRequest =
  | OpenRequest
  | SimplifyRequest
  | MeasureRequest
  | DeviationMapRequest
  | LevelRequest
  | GeometryRequest
  | WriteRequest
  | WriteProgressiveRequest
  | SimplifyArraysRequest
  | ExternalFilesRequest;

/** From the client to the worker. */
export type Request = AnsweredRequest | CancelRequest | DisposeRequest;

/** A document is open under this number. */
export interface Opened {
  readonly type: 'opened';
  readonly id: number;
  readonly document: number;
  readonly summary: DocumentSummary;
}

/** A level is selected. */
export interface LevelReply {
  readonly type: 'level';
  readonly id: number;
  readonly level: LevelSummary;
}

/** The level was measured. */
export interface MeasuredReply {
  readonly type: 'measured';
  readonly id: number;
  readonly deviation: Deviation;
}

/** Its arrays are transferred. */
export interface DeviationMapReply {
  readonly type: 'deviation-map';
  readonly id: number;
  readonly map: DeviationMap;
}

/** Its arrays are transferred. */
export interface GeometryReply {
  readonly type: 'geometry';
  readonly id: number;
  readonly geometry: LevelGeometry;
}

/** Its bytes are transferred. */
export interface WrittenReply {
  readonly type: 'written';
  readonly id: number;
  readonly written: Written;
}

/** Its bytes are transferred. */
export interface ProgressiveReply {
  readonly type: 'progressive';
  readonly id: number;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** Its arrays are transferred. */
export interface SimplifiedReply {
  readonly type: 'simplified';
  readonly id: number;
  readonly mesh: SimplifiedMesh;
}

/** Addresses as the file names them. */
export interface ExternalFilesReply {
  readonly type: 'external-files';
  readonly id: number;
  readonly uris: readonly string[];
}

/** The request came to nothing because of this. */
export interface FailedReply {
  readonly type: 'failed';
  readonly id: number;
  readonly error: ErrorData;
}

/** The request was cancelled before it was done. */
export interface CancelledReply {
  readonly type: 'cancelled';
  readonly id: number;
}

/** The share that is done, above 0 and at most 1. */
export interface ProgressReply {
  readonly type: 'progress';
  readonly id: number;
  readonly fraction: number;
}

/** Replies that a request is answered by when it succeeds. */
export type Answer =
  | Opened
  | LevelReply
  | MeasuredReply
  | DeviationMapReply
  | GeometryReply
  | WrittenReply
  | ProgressiveReply
  | SimplifiedReply
  | ExternalFilesReply;

/** From the worker to the client. */
export type Reply = Answer | FailedReply | CancelledReply | ProgressReply;

/** The type of the answer to each type of request. */
export interface AnswerTo {
  open: Opened;
  simplify: LevelReply;
  measure: MeasuredReply;
  'deviation-map': DeviationMapReply;
  level: LevelReply;
  geometry: GeometryReply;
  write: WrittenReply;
  'write-progressive': ProgressiveReply;
  'simplify-arrays': SimplifiedReply;
  'external-files': ExternalFilesReply;
}
