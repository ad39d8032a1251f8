// What the page does with a model: opens it, follows the slider, measures, saves. Each is a part of the conversation with
// the worker, in `session/`; here they come together.
import type { DocumentSummary, WorkerClient } from 'decimesh/worker';
import { modelFile, relativeToModel } from './files.ts';
import { blobOf, save } from './formats.ts';
import { t } from './messages/messages.ts';
import type { View } from './preview/view.ts';
import { fetchModel } from './remote.ts';
import { letGo, superseded, type Conversation, type Store } from './session/conversation.ts';
import { Levels } from './session/levels.ts';
import { measure } from './session/measuring.ts';
import { Opening } from './session/opening.ts';
import { Recording } from './session/recording.ts';
import { Tasks } from './session/tasks.ts';
import * as transitions from './state.ts';
import type { Origin } from './state.ts';

export type { Store } from './session/conversation.ts';

export class Session {
  private readonly conversation: Conversation;
  private readonly tasks: Tasks;
  private readonly recording: Recording;
  private readonly levels: Levels;
  private readonly opening: Opening;

  /** `layOut` resolves when the page is laid out with what the state says, and the view knows what of it is free. */
  constructor(
    private readonly store: Store,
    client: WorkerClient,
    view: View,
    layOut: () => Promise<void>,
  ) {
    this.conversation = { store, client, view, current: null, painted: () => null };
    this.tasks = new Tasks(store);
    this.recording = new Recording(this.conversation, () => this.levels.recordingEnded());
    this.levels = new Levels(this.conversation, this.recording);
    this.opening = new Opening(this.conversation, this.recording, layOut);
  }

  /** What the document on screen consists of, null without one. */
  get summary(): DocumentSummary | null {
    return this.conversation.current?.document.summary ?? null;
  }

  /** The files of the model on screen. */
  get files(): readonly File[] | null {
    return this.conversation.current?.files ?? null;
  }

  /** What is painted on each vertex of the document on screen, by the number of its state; null: nothing. */
  set painted(painted: Conversation['painted']) {
    this.conversation.painted = painted;
  }

  /** Opens a model from its files, in place of the one before if that works. */
  async open(given: File[]): Promise<void> {
    const files = relativeToModel(given);
    const model = modelFile(files);
    if (model === undefined) return;
    const from = { fileName: model.name, credit: '', origin: null };
    await this.tasks.run('opening', model.name, (signal) => this.opening.replaceDocument(files, from, signal));
  }

  /** Opens a model from the web under the name `fileName`, with the files it refers to. */
  async openAddress(address: URL, fileName: string, origin: Origin, credit = ''): Promise<void> {
    await this.tasks.run('opening', fileName, async (signal) => {
      const onProgress = (fraction: number | null): void => this.store.update((state) => transitions.taskProgressed(state, fraction));
      const files = await fetchModel(this.conversation.client, address, fileName, { signal, onProgress });
      await this.opening.replaceDocument(files, { fileName, credit, origin }, signal);
    });
  }

  /** Frees the model; nothing is on screen afterwards. */
  close(): void {
    this.cancel();
    letGo(this.conversation);
  }

  /** Stops what is under way: first a file being opened or written, else the measuring or the recording. */
  cancel(): void {
    const reason = new DOMException('Cancelled.', 'AbortError');
    const open = this.conversation.current;
    if (!this.tasks.abort(reason)) (open?.measuring ?? open?.recording)?.abort(reason);
  }

  /** To be called when the wish, the format or the history changed. */
  wishChanged(): void {
    this.levels.wishChanged();
  }

  /** Saves the level that is wanted, as soon as it can be had, fitted to the original as the quality says. */
  async download(): Promise<void> {
    const { model, outputFormat } = this.store.value;
    const open = this.conversation.current;
    if (model === null || open === null) return;
    const fileName = `${model.name}.${outputFormat}`;
    await this.tasks.run('writing', fileName, async (signal) => {
      const file = await this.levels.file(open, signal);
      if (file === null) return;
      save(blobOf(file.bytes, outputFormat), fileName);
      this.store.update((state) => transitions.remarked(state, t('status.saved', { name: fileName }) + file.loss));
    });
  }

  /** Measures the level on screen. */
  async measure(): Promise<void> {
    await measure(this.conversation, this.recording);
  }

  // --- the view lent to an arrival

  /** Something else shows its geometries now: a download and a measurement of what was on screen end. */
  lendView(): void {
    this.tasks.abort(superseded());
    this.store.update((state) => transitions.heatMapLeft(transitions.measuringEnded(state, null, '')));
    this.wishChanged();
  }

  /** Shows the level that is wanted again. */
  takeViewBack(): void {
    if (this.conversation.current !== null) this.conversation.current.fitted = null;
    this.store.update(transitions.levelStale);
    this.wishChanged();
  }
}
