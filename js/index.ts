// The package's public surface.

export { init, type WasmSource } from './engine.js';
export { describeBlockers } from './blockers.js';
export { COMPRESSIONS, OUTPUT_FORMATS } from './formats.js';
export { PRESETS } from './options.js';
export type { Document } from './document.js';
export { openDocument, externalFiles } from './document/open.js';
export type { Written } from './document/write.js';
export type { TriangleLifetimes } from './progressive/lifetimes.js';
export type { ProgressiveOptions } from './progressive/encode.js';
export { simplify, simplifySequence, type MeshSequence } from './simplify.js';
export { DecimeshError, type EngineErrorCode, type ErrorCode, type HostErrorCode } from './errors.js';
export type { Parts } from './parts.js';
export type { AttributeDeviation, Deviation, DeviationMap, Report, ReportedFile, ReportedLod, SideDeviation, Timings, WedgeSetDeviation } from './report.js';
export type {
  AttributeArray,
  AttributeWeights,
  Blockers,
  Compression,
  DocumentInput,
  DocumentSimplifyOptions,
  DocumentSummary,
  Format,
  GroupGeometry,
  GroupSummary,
  LevelGeometry,
  LevelSummary,
  LevelTargets,
  LodSwitch,
  MeasureOptions,
  MeshAttributes,
  MeshInput,
  MeshSimplifyOptions,
  NamedBytes,
  OutputFormat,
  PrepareOptions,
  Preset,
  RunOptions,
  ScreenView,
  SimplifiedMesh,
  SimplifyOptions,
  StopReason,
  Targets,
  TextureOptions,
  Warning,
  WedgeSetGeometry,
  WedgeSetSummary,
  WriteOptions,
} from './types.js';
