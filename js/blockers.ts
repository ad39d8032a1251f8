// What blocks a run that could not reach its target, in one plain sentence.

import type { Blockers } from './types.js';

/** What is said of the edges of each kind; seams and the corners where they meet are one thing to people. */
const MEANINGS: ReadonlyArray<readonly [kinds: ReadonlyArray<keyof Blockers>, meaning: string]> = [
  [['seam', 'corner'], 'lie on UV seams or the borders of materials'],
  [['border'], 'join open borders'],
  [['nonManifold'], 'lie where more than two faces meet'],
  [['locked'], 'are locked'],
  [['topology'], 'cannot go without changing how the surface hangs together'],
  [['flip'], 'cannot go without turning a triangle over'],
  [['error'], 'cannot go within the error limit'],
  [['other'], 'were not cheap enough to go'],
];

/** The most frequent reason as a sentence without its full stop: `61 % of the remaining edges lie on UV seams…`. */
export function describeBlockers(blockers: Blockers): string {
  const total = Object.values(blockers).reduce<number>((sum, count) => sum + (count as number), 0);
  if (total === 0) return 'no edge is left';
  let most = { count: -1, meaning: '' };
  for (const [kinds, meaning] of MEANINGS) {
    const count = kinds.reduce((sum, kind) => sum + blockers[kind], 0);
    if (count > most.count) most = { count, meaning };
  }
  return `${most.count === total ? 'all' : `${Math.round((100 * most.count) / total)} %`} of the remaining edges ${most.meaning}`;
}
