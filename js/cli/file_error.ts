// What the system says about a file, as an error of ours.

import { DecimeshError, type ErrorCode } from '../errors.js';

const REASONS: Readonly<Record<string, string>> = {
  ENOENT: 'there is no such file or directory',
  EACCES: 'permission denied',
  EPERM: 'permission denied',
  EROFS: 'the file system is read-only',
  EISDIR: 'it is a directory',
  ENOTDIR: 'a part of the path is not a directory',
  EEXIST: 'it is there already and not a directory',
  ENOSPC: 'no space is left on the device',
  EMFILE: 'too many files are open',
  ENAMETOOLONG: 'the name is too long',
  ERR_FS_FILE_TOO_LARGE: 'the file is larger than 2 GiB',
};

/** The error for a failed operation on `path`. */
export function fileError(code: ErrorCode & ('cannot-read' | 'cannot-write'), error: unknown, path: string): DecimeshError {
  const reason = error instanceof Error ? error.message : String(error);
  return new DecimeshError(code, REASONS[codeOf(error)] ?? reason, path, { cause: error });
}

/** Whether `error` says that there is no such file. */
export function isMissing(error: unknown): boolean {
  return codeOf(error) === 'ENOENT' || codeOf(error) === 'ENOTDIR';
}

function codeOf(error: unknown): string {
  return String((error as { code?: unknown } | null)?.code);
}
