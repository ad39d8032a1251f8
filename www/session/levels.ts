// What is shown and written follows what is wanted. Only the latest wish counts: one request is under way, and what was
// asked for meanwhile is read when it ends.
import { isChain, runKey } from '../choices.ts';
import { describeError } from '../describe_error.ts';
import { encodingFor, writeOptions } from '../encoding.ts';
import { preparationKey, prepareOptions } from '../preparation.ts';
import * as transitions from '../state.ts';
import type { Model, State } from '../state.ts';
import { countMeshes, fitFor, fitOfFile, goalKey, wishKey } from '../wishes.ts';
import { selectLevel, superseded, type Conversation, type OpenDocument, type WrittenFile } from './conversation.ts';
import { fit } from './fitting.ts';
import { reachGoal } from './goal.ts';
import type { Recording } from './recording.ts';
import { tellSize } from './sizes.ts';

/** Milliseconds without a new wish before the file for it is written to learn its size. */
const SETTLE_TIME = 250;

export class Levels {
  private following = false;
  /** Ends the pause before writing, when the wish changes. */
  private wake: (() => void) | null = null;
  /** Downloads that wait for the file itself: its size is not enough for them, and pausing would keep them. */
  private filesWanted = 0;
  /** Told after every step. */
  private readonly waiting = new Set<() => void>();

  constructor(
    private readonly conversation: Conversation,
    private readonly recording: Recording,
  ) {}

  /** To be called when the wish, the format or the history changed. */
  wishChanged(): void {
    this.wake?.();
    const { model, run, goal } = this.conversation.store.value;
    const open = this.conversation.current;
    const fitting = open?.fitting ?? null;
    const rerun = open !== null && open.recorded !== null && open.recorded !== runKey(run);
    if (fitting !== null && (rerun || fitting.wanted !== model?.wantedTriangles || fitting.quality !== fitFor(this.conversation.store.value))) {
      fitting.controller.abort(superseded());
    }
    if (rerun || model?.measurement.kind !== 'running') open?.measuring?.abort(superseded());
    const stopped = model?.history.kind === 'none' && (model.wantedTriangles !== model.source.triangles || goal.kind !== 'triangles');
    if (open !== null && (rerun || stopped)) void this.recording.record(open, rerun);
    void this.follow();
  }

  /** To be called when the levels have been recorded, or will not be. */
  recordingEnded(): void {
    this.tellWaiting();
    void this.follow();
  }

  /** Resolves to the file of the wanted level when it is written, to null when that failed and was told. */
  async file(open: OpenDocument, signal: AbortSignal): Promise<WrittenFile | null> {
    this.filesWanted += 1;
    signal.addEventListener('abort', () => open.fitting?.controller.abort(signal.reason), { once: true });
    return this.settled(open, signal).finally(() => {
      this.filesWanted -= 1;
      // A fit that came to nothing has left the level to be shown again.
      void this.follow();
    });
  }

  private async follow(): Promise<void> {
    if (this.following) return;
    this.following = true;
    try {
      while (await this.step()) this.tellWaiting();
    } finally {
      this.following = false;
      this.tellWaiting();
    }
  }

  /** Does the next thing that is missing; false when nothing is. */
  private async step(): Promise<boolean> {
    const { conversation } = this;
    const { store, current: open } = conversation;
    const now = store.value;
    const { model } = now;
    if (open === null || model === null || model.history.kind === 'recording' || now.arrival !== null) return false;
    if (open.recorded !== null && open.recorded !== runKey(now.run)) return false;
    const wanted = model.wantedTriangles;
    if (model.history.kind === 'none' && wanted !== model.source.triangles) return false;
    // The size shown is that of the level shown; only a download is worth another run.
    const quality = this.filesWanted > 0 ? fitOfFile(now, model, open.fitted) : (open.fitted ?? 'fast');
    const key = wishKey(now, model, quality);
    if (open.failedKey === key) return false;
    try {
      if (model.history.kind === 'ready' && (await reachGoal(conversation, open, now))) return true;
      if (model.shownFor !== wanted) {
        await this.show(open, model);
      } else if (isChain(now) && open.fitted !== null) {
        open.fitted = null;
        store.update(transitions.levelStale);
      } else if (quality !== (open.fitted ?? 'fast')) {
        await fit(conversation, open, wanted, quality);
      } else {
        const measured = transitions.isOutputCurrent(now);
        if (open.written?.key === key || (measured && this.filesWanted === 0)) return false;
        if (this.filesWanted === 0 && ((await this.pause()) || conversation.current !== open)) return true;
        await this.write(open, now, model, key);
      }
    } catch (error) {
      if (conversation.current !== open) return true;
      if (await this.recording.recover(open, error)) return false;
      open.failedKey = key;
      store.update((state) => transitions.failed(state, describeError(error)));
    }
    return true;
  }

  /** Puts the history's level on screen. */
  private async show(open: OpenDocument, model: Model): Promise<void> {
    const { conversation } = this;
    const wanted = model.wantedTriangles;
    open.fitted = null;
    const level = await selectLevel(open, model);
    const geometry = wanted === model.source.triangles ? null : await open.document.geometry();
    if (conversation.current !== open) return;
    const counts = geometry && countMeshes(geometry);
    await conversation.view.setLevel(geometry);
    if (conversation.current !== open) return;
    conversation.store.update((state) => transitions.levelShown(state, level, wanted, counts));
  }

  /** Writes the level on screen as `now` wants it, which is `key`. */
  private async write(open: OpenDocument, now: State, model: Model, key: string): Promise<void> {
    const { conversation } = this;
    const { outputFormat, lods } = now;
    const encoding = encodingFor(outputFormat, now.encoding);
    await selectLevel(open, model);
    const chain = isChain(now) && model.history.kind === 'ready';
    const prepared = prepareOptions(outputFormat, now.preparation);
    const { bytes, report } = await open.document.write({ ...writeOptions(outputFormat, encoding), ...prepared, ...(chain ? { lods } : {}) });
    if (conversation.current !== open) return;
    // A change that came meanwhile asks for something else.
    if (open.recorded !== null && open.recorded !== runKey(conversation.store.value.run)) return;
    const loss = report.warnings.find((warning) => warning.code === 'not-carried');
    open.written = { key, bytes, loss: loss === undefined ? '' : ` ${loss.message}.` };
    tellSize(conversation.store, { bytes, report }, {
      format: outputFormat, encoding, preparation: preparationKey(outputFormat, now.preparation), wantedTriangles: model.wantedTriangles, lods: isChain(now) ? lods : [],
    });
  }

  /** Waits until wishes settle; true when a new one came meanwhile. */
  private pause(): Promise<boolean> {
    return new Promise((resolve) => {
      const finish = (woken: boolean): void => {
        clearTimeout(timer);
        this.wake = null;
        resolve(woken);
      };
      const timer = setTimeout(() => finish(false), SETTLE_TIME);
      this.wake = () => finish(true);
    });
  }

  private async settled(open: OpenDocument, signal: AbortSignal): Promise<WrittenFile | null> {
    this.wishChanged();
    for (;;) {
      signal.throwIfAborted();
      const now = this.conversation.store.value;
      const { model } = now;
      if (this.conversation.current !== open || model === null) return null;
      const key = wishKey(now, model, fitOfFile(now, model, open.fitted));
      const sought = now.goal.kind !== 'triangles' && open.reached !== goalKey(now);
      if (!sought && open.written?.key === key && open.recorded === runKey(now.run)) return open.written;
      const stopped = model.history.kind === 'none' && model.wantedTriangles !== model.source.triangles;
      if (stopped || open.failedKey === key) return null;
      await new Promise<void>((resolve) => {
        this.waiting.add(resolve);
        signal.addEventListener('abort', () => resolve(), { once: true });
      });
    }
  }

  private tellWaiting(): void {
    for (const resolve of this.waiting) resolve();
    this.waiting.clear();
  }
}
