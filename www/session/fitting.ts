// The level that a download saves, simplified again for itself: better than the history's of the same count.
import type { Quality } from '../formats.ts';
import * as transitions from '../state.ts';
import { countMeshes, simplifyOptions } from '../wishes.ts';
import { superseded, type Conversation, type OpenDocument } from './conversation.ts';

/** Shows the level of `wanted` triangles as a run to it alone gives it. An abort leaves the history's to be shown. */
export async function fit(conversation: Conversation, open: OpenDocument, wanted: number, quality: Quality): Promise<void> {
  const { store, view } = conversation;
  const controller = new AbortController();
  const { signal } = controller;
  open.fitting = { controller, wanted, quality };
  open.fitted = null;
  open.measuring?.abort(superseded());
  // Nobody is to measure meanwhile: the selected level changes at the end.
  store.update((state) => transitions.fittingStarted(transitions.levelStale(state)));
  try {
    const onProgress = (fraction: number): void => store.update((state) => transitions.fittingProgressed(state, fraction));
    const { run } = store.value;
    const options = simplifyOptions(run, open.document.summary, conversation.painted(run.paint));
    let level = await open.document.simplify({ ...options, triangles: wanted, preset: quality, keepLevels: true, signal, onProgress });
    // Near the fewest there are, the history may go further than this run.
    if (level.triangles > wanted) level = await open.document.level({ triangles: wanted });
    const geometry = await open.document.geometry();
    if (conversation.current !== open) return;
    const counts = countMeshes(geometry);
    await view.setLevel(geometry);
    signal.throwIfAborted();
    if (conversation.current !== open) return;
    open.fitted = quality;
    store.update((state) => transitions.levelShown(state, level, wanted, counts));
  } catch (error) {
    if (!signal.aborted) throw error;
  } finally {
    open.fitting = null;
    if (conversation.current === open) store.update(transitions.fittingEnded);
  }
}
