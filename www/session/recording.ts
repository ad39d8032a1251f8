// The history of collapses behind the slider: recorded once for each choice of settings, and again when it was lost.
import { runKey } from '../choices.ts';
import { describeError } from '../describe_error.ts';
import { t } from '../messages/messages.ts';
import * as transitions from '../state.ts';
import type { State } from '../state.ts';
import { simplifyOptions } from '../wishes.ts';
import { superseded, type Conversation, type OpenDocument } from './conversation.ts';

/** Codes after which the worker has no documents any more; opening the files again brings them back. */
const LOST_CODES: readonly string[] = ['disposed', 'worker-lost', 'internal', 'out-of-memory'];

export class Recording {
  constructor(
    private readonly conversation: Conversation,
    /** Called when a recording has ended, however it did. */
    private readonly onEnded: () => void,
  ) {}

  /** Records the levels, unless that is under way; `again` with other settings than those. */
  async record(open: OpenDocument, again = false): Promise<void> {
    const { conversation } = this;
    if (open.recording !== null && !again) return;
    open.recording?.abort(superseded());
    open.stale ||= again;
    const recording = new AbortController();
    open.recording = recording;
    const { run } = conversation.store.value;
    open.recorded = runKey(run);
    const isCurrent = (): boolean => conversation.current === open && open.recording === recording;
    const update = (transition: (state: State) => State): void => {
      if (isCurrent()) conversation.store.update(transition);
    };
    // A fitted level is not the history's.
    if (open.fitted !== null) update(transitions.levelStale);
    open.fitted = null;
    update((state) => transitions.recordingProgressed(state, 0));
    try {
      await open.document.simplify({
        ...simplifyOptions(run, open.document.summary, conversation.painted(run.paint)),
        signal: recording.signal,
        onProgress: (fraction) => update((state) => transitions.recordingProgressed(state, fraction)),
      });
      const fewest = await open.document.level({ triangles: 1 });
      recording.signal.throwIfAborted();
      if (open.stale) {
        open.stale = false;
        [open.written, open.failedKey, open.fitted] = [null, null, null];
        update(transitions.historyReplaced);
      }
      update((state) => transitions.historyReady(state, fewest.triangles, fewest.blockers));
      open.reopened = false;
    } catch (error) {
      if (recording.signal.aborted) {
        update((state) => transitions.recordingEnded(state, t('status.cancelledRecording')));
      } else if (isCurrent() && (await this.reopen(open, error))) {
        open.recording = null;
        return this.record(open, again);
      } else {
        update((state) => transitions.recordingEnded(transitions.failed(state, describeError(error)), ''));
      }
    } finally {
      if (open.recording === recording) open.recording = null;
    }
    this.onEnded();
  }

  /** Opens and records anew after an `error` that cost the worker its documents; false if it is no such error. */
  async recover(open: OpenDocument, error: unknown): Promise<boolean> {
    if (!(await this.reopen(open, error))) return false;
    void this.record(open);
    return true;
  }

  // A fault elsewhere, in a bad file say, may have cost the worker its documents; the files are still here.
  private async reopen(open: OpenDocument, error: unknown): Promise<boolean> {
    if (!LOST_CODES.includes(describeError(error).code) || open.reopened) return false;
    open.reopened = true;
    try {
      open.document = await this.conversation.client.openDocument(open.files);
      return true;
    } catch {
      return false;
    }
  }
}
