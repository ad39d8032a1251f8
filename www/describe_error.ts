// Any failure as the page tells it.
import type { Notice } from './state.ts';

/** Any failure as a notice: ours keep their code and place, others are named as what they are. */
export function describeError(error: unknown): Notice {
  if (typeof error === 'object' && error !== null && 'code' in error && typeof error.code === 'string') {
    return {
      code: error.code,
      message: 'message' in error ? String(error.message) : '',
      where: 'where' in error && typeof error.where === 'string' ? error.where : '',
    };
  }
  return { code: 'internal', message: error instanceof Error ? error.message : String(error), where: '' };
}
