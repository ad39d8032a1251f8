// The one error class of the package, with codes that programs may rely on.

/** Codes the engine gives: what is wrong with a file, an argument or a call. */
export type EngineErrorCode =
  /** The bytes are of no format that can be read. */
  | 'unknown-format'
  /** The file ends before its content does. */
  | 'truncated'
  /** The text or JSON does not parse, or a value breaks the format's rules. */
  | 'syntax'
  /** An index, offset or length points outside of what it indexes. */
  | 'out-of-range'
  /** A coordinate or attribute is NaN or infinite. */
  | 'not-finite'
  /** There is no triangle in the file. */
  | 'no-triangles'
  /** A file that this one refers to was not given. */
  | 'missing-resource'
  /** Valid, but it uses something that is not supported. */
  | 'unsupported'
  /** An argument is out of its range or of the wrong shape. */
  | 'invalid-argument'
  /** The call is not possible in this state, e.g. a level before simplification. */
  | 'wrong-state'
  /** More elements than can be handled. */
  | 'too-large';

/** Codes of what happens around the engine. */
export type HostErrorCode =
  /** `init()` has not finished. */
  | 'not-initialised'
  /** The object was disposed, or lost when the engine was restarted. */
  | 'disposed'
  /** Memory ran out. The engine was restarted: documents must be opened again. */
  | 'out-of-memory'
  /** A fault of this package. The engine was restarted: documents must be opened again. */
  | 'internal'
  /** A file could not be read. */
  | 'cannot-read'
  /** A file could not be written. */
  | 'cannot-write'
  /** Wrong command line. */
  | 'usage'
  /** The worker ended; its documents must be opened again. */
  | 'worker-lost';

/** Every code a {@link DecimeshError} can have. Codes are stable; messages are not. */
export type ErrorCode = EngineErrorCode | HostErrorCode;

/** An error as plain data: as the engine throws it and as it crosses from a worker. */
export interface ErrorData {
  readonly code: ErrorCode;
  readonly message: string;
  readonly where: string;
}

// A record and not a list, so that the compiler notices a code that is missing here.
const CODES: Record<ErrorCode, true> = {
  'unknown-format': true,
  truncated: true,
  syntax: true,
  'out-of-range': true,
  'not-finite': true,
  'no-triangles': true,
  'missing-resource': true,
  unsupported: true,
  'invalid-argument': true,
  'wrong-state': true,
  'too-large': true,
  'not-initialised': true,
  disposed: true,
  'out-of-memory': true,
  internal: true,
  'cannot-read': true,
  'cannot-write': true,
  usage: true,
  'worker-lost': true,
};

/** Every failure of this package, except an abort, which rejects with its signal's reason. */
export class DecimeshError extends Error {
  override readonly name = 'DecimeshError';
  /** What went wrong, for programs. */
  readonly code: ErrorCode;
  /** The argument's name or the place in the file (`meshes[0].primitives[1].indices`); may be empty. */
  readonly where: string;

  /** `message` is one line for people and does not repeat `code` or `where`. */
  constructor(code: ErrorCode, message: string, where = '', options?: ErrorOptions) {
    super(message, options);
    this.code = code;
    this.where = where;
  }
}

/** Whether `value` is an error as plain data, with a code of this package. */
export function isErrorData(value: unknown): value is ErrorData {
  if (typeof value !== 'object' || value === null) return false;
  const data = value as Partial<Record<keyof ErrorData, unknown>>;
  return (
    typeof data.code === 'string' &&
    Object.hasOwn(CODES, data.code) &&
    typeof data.message === 'string' &&
    typeof data.where === 'string'
  );
}

/** The error that `data` describes. */
export function errorFromData(data: ErrorData): DecimeshError {
  return new DecimeshError(data.code, data.message, data.where);
}

/** `error` as plain data that can be posted; anything that is not ours becomes `internal`. */
export function errorToData(error: unknown): ErrorData {
  if (error instanceof DecimeshError) return { code: error.code, message: error.message, where: error.where };
  return { code: 'internal', message: error instanceof Error ? error.message : String(error), where: '' };
}

/** The error for an argument that is out of its range or of the wrong shape. */
export function invalidArgument(where: string, message: string): DecimeshError {
  return new DecimeshError('invalid-argument', message, where);
}
