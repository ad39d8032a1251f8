// What the user waits for, one at a time: a file being opened, or a file being written. It can be cancelled.
import { describeError } from '../describe_error.ts';
import { t } from '../messages/messages.ts';
import * as transitions from '../state.ts';
import { superseded, type Store } from './conversation.ts';

export class Tasks {
  private task: AbortController | null = null;

  constructor(private readonly store: Store) {}

  /** Does `run` in place of the task before it, and tells how it went. `name` is the file's. */
  async run(kind: 'opening' | 'writing', name: string, run: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.task?.abort(superseded());
    const task = new AbortController();
    this.task = task;
    this.store.update((state) => transitions.taskStarted(state, { kind, name, fraction: null }));
    try {
      await run(task.signal);
      if (this.task === task) this.store.update((state) => transitions.taskEnded(state));
    } catch (error) {
      if (this.task !== task) return;
      if (task.signal.aborted) this.store.update((state) => transitions.taskEnded(state, t('status.cancelled')));
      else {
        const notice = describeError(error);
        // What is wrong with a file as a whole has the file for its place.
        this.store.update((state) => transitions.failed(state, { ...notice, where: notice.where || name }));
      }
    } finally {
      if (this.task === task) this.task = null;
    }
  }

  /** Ends the task under way; false when there is none. */
  abort(reason: DOMException): boolean {
    this.task?.abort(reason);
    return this.task !== null;
  }
}
