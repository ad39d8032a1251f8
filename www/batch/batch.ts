// The queue's part of the conversation: what was dropped, the run that is under way, and the files it has made.
import type { WorkerClient } from 'decimesh/worker';
import { describeError } from '../describe_error.ts';
import { save } from '../formats.ts';
import { t } from '../messages/messages.ts';
import * as transitions from '../state.ts';
import type { Store } from '../session.ts';
import { batchEnded, batchStarted, countsOf, newBatch, resultChanged } from './batch_state.ts';
import { runBatch, zipOf } from './batch_run.ts';
import type { BatchFile } from './batch_run.ts';

/** Several models at once, in place of one. */
export class Batch {
  private models: Array<{ readonly name: string; readonly files: readonly File[] }> = [];
  private made: BatchFile[] = [];
  private running: AbortController | null = null;

  constructor(
    private readonly store: Store,
    private readonly client: WorkerClient,
  ) {}

  /** Takes the place of the model on screen; nothing runs yet. */
  open(models: readonly File[][]): void {
    this.cancel();
    this.made = [];
    this.models = models.flatMap((files) => (files[0] === undefined ? [] : [{ name: files[0].webkitRelativePath || files[0].name, files }]));
    const batch = newBatch(this.models.map(({ name }) => name));
    this.store.update((state) => transitions.remarked(transitions.modelClosed(state, batch), t('batch.opened', { count: batch.items.length })));
  }

  /** Simplifies all of them. */
  async start(): Promise<void> {
    const { batch, quality, run, preparation } = this.store.value;
    if (batch === null || this.running !== null) return;
    const running = new AbortController();
    this.running = running;
    this.made = [];
    this.store.update((state) => transitions.remarked(transitions.batchChanged(state, batchStarted), t('batch.running')));
    const { models } = this;
    const made = await runBatch(this.client, models, { share: batch.share, quality, run, preparation }, {
      signal: running.signal,
      onResult: (index, result) => {
        if (this.running === running) this.store.update((state) => transitions.batchChanged(state, (now) => resultChanged(now, index, result)));
      },
    });
    // Another queue may have taken its place.
    if (this.running !== running) return;
    this.running = null;
    this.made = made;
    this.store.update((state) => {
      const ended = transitions.batchChanged(state, batchEnded);
      const { done, failed } = ended.batch === null ? { done: 0, failed: 0 } : countsOf(ended.batch);
      const remark = running.signal.aborted ? t('status.cancelled') : t('batch.ended', { done, failed });
      return transitions.remarked(ended, remark);
    });
  }

  /** Stops the run; what was done by then can be saved. */
  cancel(): void {
    this.running?.abort(new DOMException('Cancelled.', 'AbortError'));
  }

  /** Saves all that was made in one zip. */
  async save(): Promise<void> {
    if (this.made.length === 0) return;
    try {
      const zip = await zipOf(this.made, new AbortController().signal);
      save(zip, 'decimesh.zip');
      this.store.update((state) => transitions.remarked(state, t('status.saved', { name: 'decimesh.zip' })));
    } catch (error) {
      this.store.update((state) => transitions.failed(state, describeError(error)));
    }
  }

  /** Back to the start page. */
  close(): void {
    this.cancel();
    this.running = null;
    [this.models, this.made] = [[], []];
    this.store.update((state) => transitions.modelClosed(state, null));
  }
}
