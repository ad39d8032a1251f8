// The package's public surface.

export { init, type WasmSource } from './engine.js';
export { OUTPUT_FORMATS } from './formats.js';
export { PRESETS } from './options.js';
export { openDocument, externalFiles, type Document, type Written } from './document.js';
export { simplify, simplifySequence, type MeshSequence } from './simplify.js';
export { DecimeshError, type EngineErrorCode, type ErrorCode, type HostErrorCode } from './errors.js';
export type { Deviation, Report, ReportedFile, SideDeviation, Timings } from './report.js';
export type {
  AttributeArray,
  AttributeWeights,
  DocumentInput,
  DocumentSimplifyOptions,
  DocumentSummary,
  Format,
  GroupGeometry,
  GroupSummary,
  LevelGeometry,
  LevelSummary,
  MeasureOptions,
  MeshAttributes,
  MeshInput,
  NamedBytes,
  OutputFormat,
  Preset,
  RunOptions,
  SimplifiedMesh,
  SimplifyOptions,
  StopReason,
  Targets,
  Warning,
  WedgeSetGeometry,
  WedgeSetSummary,
  WriteOptions,
} from './types.js';
