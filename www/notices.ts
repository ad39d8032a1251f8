// Errors and remarks in plain words with a way out; the engine's own words, in English, are beside them.
import { t } from './messages/messages.ts';
import type { Notice } from './state.ts';

const ERRORS = [
  'unknown-format', 'truncated', 'syntax', 'out-of-range', 'not-finite', 'no-triangles', 'missing-resource', 'unsupported',
  'invalid-argument', 'too-large', 'out-of-memory', 'cannot-read', 'worker-lost', 'disposed', 'internal', 'no-webgl',
] as const;

/** What happened and what to do about it, as sentences. */
export function noticeText({ code }: Notice): string {
  const known = ERRORS.find((one) => one === code);
  return t(known === undefined ? 'error.internal' : `error.${known}`);
}

/** Remarks of readers and writers that the page has words for. */
const WARNINGS = {
  'degenerate-face': 'warning.degenerate',
  'degenerate-triangle': 'warning.degenerate',
  'face-too-small': 'warning.degenerate',
  'not-finite': 'warning.notFinite',
  'not-finite-attribute': 'warning.notFinite',
  'polygon-not-simple': 'warning.polygon',
  'face-colors-blended': 'warning.faceColors',
  'face-colors-ignored': 'warning.faceColors',
  'missing-material-library': 'warning.materials',
  'extra-numbers-ignored': 'warning.ignored',
  'unknown-statement': 'warning.ignored',
  'unknown-binding': 'warning.ignored',
  'values-ignored': 'warning.ignored',
  schema: 'warning.ignored',
  'mixed-corners': 'warning.ignored',
  'chunk-padding': 'warning.ignored',
  'extension-dropped': 'warning.extension',
  'implicit-feature-ids': 'warning.extension',
} as const;

/** What a remark on a file means. */
export function warningText({ code, message }: Notice): string {
  const key = Object.hasOwn(WARNINGS, code) ? WARNINGS[code as keyof typeof WARNINGS] : undefined;
  return key === undefined ? `${message.charAt(0).toUpperCase()}${message.slice(1)}.` : t(key);
}
