// A limit of error or size, in place of a count: the slider is set where it is reached.
import type { Goal } from '../choices.ts';
import { encodingFor, writeOptions } from '../encoding.ts';
import { prepareOptions } from '../preparation.ts';
import * as transitions from '../state.ts';
import type { State } from '../state.ts';
import { goalKey } from '../wishes.ts';
import type { Conversation, OpenDocument } from './conversation.ts';

/** Sets the slider where the goal of `now` wants it; true when there was something to do. */
export async function reachGoal(conversation: Conversation, open: OpenDocument, now: State): Promise<boolean> {
  const { store } = conversation;
  const key = goalKey(now);
  if (open.reached === key) return false;
  open.reached = key;
  if (now.goal.kind === 'triangles') return false;
  try {
    const triangles = await trianglesFor(open, now, now.goal);
    if (conversation.current !== open || goalKey(store.value) !== key) return true;
    // Looking for it has selected other levels.
    if (open.fitted !== null) store.update(transitions.levelStale);
    open.fitted = null;
    store.update((state) => transitions.goalReached(state, triangles));
  } catch (error) {
    open.reached = null;
    throw error;
  }
  return true;
}

async function trianglesFor(open: OpenDocument, now: State, goal: Exclude<Goal, { kind: 'triangles' }>): Promise<number> {
  if (goal.kind === 'error') return (await open.document.level({ error: `${goal.percent}%` })).triangles;
  const { outputFormat: format } = now;
  const file = { ...writeOptions(format, encodingFor(format, now.encoding)), ...prepareOptions(format, now.preparation) };
  const { report } = await open.document.write({ ...file, size: goal.bytes });
  return report.output.triangles;
}
