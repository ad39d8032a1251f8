// Why there are no fewer triangles, in the reader's words and with what to do about it.
import type { Blockers } from 'decimesh/worker';
import { formatShare } from './format.ts';
import { t } from './messages/messages.ts';

/** Reasons as people tell them apart: seams and the corners where they meet are one thing to them. */
const KINDS = {
  seam: ['seam', 'corner'],
  border: ['border'],
  nonManifold: ['nonManifold'],
  locked: ['locked'],
  topology: ['topology'],
  flip: ['flip'],
  error: ['error'],
  other: ['other'],
} as const satisfies Record<string, ReadonlyArray<keyof Blockers>>;

type Kind = keyof typeof KINDS;

/** A reason with its share of the edges that are left. */
export interface Reason {
  readonly kind: Kind;
  /** 0..1 */
  readonly share: number;
}

/** The reasons there are, the most frequent first. */
export function reasonsOf(blockers: Blockers): Reason[] {
  const counts = (Object.keys(KINDS) as Kind[]).map((kind) => ({ kind, count: KINDS[kind].reduce((sum, name) => sum + blockers[name], 0) }));
  const total = counts.reduce((sum, { count }) => sum + count, 0);
  return counts
    .filter(({ count }) => count > 0)
    .sort((a, b) => b.count - a.count)
    .map(({ kind, count }) => ({ kind, share: count / total }));
}

/** `61 % of the remaining edges lie on UV seams…`, without its full stop. */
export const reasonText = ({ kind, share }: Reason): string =>
  // Shares are of the remaining edges, and a tenth of a per cent of them says nothing.
  t(`blocker.${kind}`, { share: formatShare(share < 1 ? Math.max(Math.round(share * 100), 1) / 100 : 1) });

/** The most frequent reason, without its full stop. */
export function mainBlocker(blockers: Blockers): string {
  const [first] = reasonsOf(blockers);
  return first === undefined ? t('blocker.none') : reasonText(first);
}
