// The conversation with the worker: opens files, records the history, and keeps what is shown in step with what is
// wanted. Only the latest wish counts: one request is under way, and what was asked for meanwhile is read when it ends.
import { DecimeshError } from 'decimesh/worker';
import type { DocumentProxy, DocumentSummary, Report, WorkerClient } from 'decimesh/worker';
import { isChain, runKey } from './choices.ts';
import type { Goal } from './choices.ts';
import { describeError } from './describe_error.ts';
import { readEarly } from './early.ts';
import type { EarlyModel } from './early.ts';
import { baseName, modelFile, relativeToModel } from './files.ts';
import { formatShare } from './format.ts';
import { encodingFor, writeOptions } from './encoding.ts';
import { blobOf, save } from './formats.ts';
import type { Quality } from './formats.ts';
import { t } from './messages/messages.ts';
import { heatLimit } from './preview/heat.ts';
import type { PreparedModel, View } from './preview/view.ts';
import { NO_PREPARATION, preparationKey, prepareOptions } from './preparation.ts';
import { fetchModel } from './remote.ts';
import { readScene } from './scene.ts';
import type { SceneNode } from './scene.ts';
import * as transitions from './state.ts';
import type { Model, Origin, State } from './state.ts';
import { countMeshes, fitFor, fitOfFile, goalKey, simplifyOptions, wishKey } from './wishes.ts';

/** Where the session reads and changes the page's state. */
export interface Store {
  readonly value: State;
  update(transition: (state: State) => State): void;
}

/** Milliseconds without a new wish before the file for it is written to learn its size. */
const SETTLE_TIME = 250;

/** Milliseconds that the first picture is waited for before the recording starts. */
const PICTURE_TIME = 3000;

/** Codes after which the worker has no documents any more; opening the files again brings them back. */
const LOST_CODES: readonly string[] = ['disposed', 'worker-lost', 'internal', 'out-of-memory'];

/** A file, the wish it answers, and a sentence on what its format cannot hold, or nothing. */
interface WrittenFile {
  readonly key: string;
  readonly bytes: Uint8Array;
  readonly loss: string;
}

/** What the view gets of a model at first, and its size. */
const FULL_DETAIL = { format: 'glb', compress: 'none' } as const;

/** A model that can be shown. */
interface PreparedDocument {
  readonly prepared: PreparedModel;
  readonly scene: readonly SceneNode[];
  /** The size of the file that the engine wrote for it; null: it wrote none. */
  readonly written: { readonly bytes: { readonly byteLength: number }; readonly report: Report } | null;
}

/** The document behind the model on screen. */
interface OpenDocument {
  document: DocumentProxy;
  readonly files: File[];
  recording: AbortController | null;
  /** What the record of levels was or is being made with. */
  recorded: string | null;
  /** Whether what is shown and written is of another run than the one that is or was being recorded. */
  stale: boolean;
  /** The goal that the slider was set for last, with all it depends on. */
  reached: string | null;
  measuring: AbortController | null;
  /** The fit for a download that is under way, and what it is for. */
  fitting: { readonly controller: AbortController; readonly wanted: number; readonly quality: Quality } | null;
  /** What the level on screen, which the document stands at, was fitted with; null: it is the history's. */
  fitted: Quality | null;
  /** The last file written, and what for; Download takes it from here. */
  written: WrittenFile | null;
  /** The wish that failed last: not tried again until it changes. */
  failedKey: string | null;
  /** Whether the documents were lost once without a success since. */
  reopened: boolean;
}

export class Session {
  private current: OpenDocument | null = null;
  private task: AbortController | null = null;
  private reconciling = false;
  /** Ends the pause before writing, when the wish changes. */
  private wake: (() => void) | null = null;
  /** Downloads that wait for the file itself: its size is not enough for them, and pausing would keep them. */
  private filesWanted = 0;
  /** What is painted on each vertex of the document on screen, by the number of its state; null: nothing. */
  painted: (state: number) => Uint8Array | null = () => null;
  /** Told after every step. */
  private readonly waiting = new Set<() => void>();

  constructor(
    private readonly store: Store,
    private readonly client: WorkerClient,
    private readonly view: View,
    /** Resolves when the page is laid out with what the state says, and the view knows what of it is free. */
    private readonly layOut: () => Promise<void>,
  ) {}

  /** Opens a model from its files, in place of the one before if that works. */
  async open(given: File[]): Promise<void> {
    const files = relativeToModel(given);
    const model = modelFile(files);
    if (model === undefined) return;
    await this.runTask('opening', model.name, (signal) => this.replaceDocument(files, { fileName: model.name, credit: '', origin: null }, signal));
  }

  /** What the document on screen consists of, null without one. */
  get summary(): DocumentSummary | null {
    return this.current?.document.summary ?? null;
  }

  /** Frees the model; nothing is on screen afterwards. */
  close(): void {
    this.cancel();
    for (const controller of [this.current?.measuring, this.current?.recording]) controller?.abort(superseded());
    this.current?.document.dispose();
    this.current = null;
  }

  /** Opens a model from the web under the name `fileName`, with the files it refers to. */
  async openAddress(address: URL, fileName: string, origin: Origin, credit = ''): Promise<void> {
    await this.runTask('opening', fileName, async (signal) => {
      const onProgress = (fraction: number | null): void => this.store.update((state) => transitions.taskProgressed(state, fraction));
      const files = await fetchModel(this.client, address, fileName, { signal, onProgress });
      await this.replaceDocument(files, { fileName, credit, origin }, signal);
    });
  }

  /** Stops what is under way: first a file being opened or written, else the measuring or the recording. */
  cancel(): void {
    const reason = new DOMException('Cancelled.', 'AbortError');
    if (this.task !== null) this.task.abort(reason);
    else (this.current?.measuring ?? this.current?.recording)?.abort(reason);
  }

  /** To be called when the wish, the format or the history changed. */
  wishChanged(): void {
    this.wake?.();
    const { model, run, goal } = this.store.value;
    const open = this.current;
    const fitting = open?.fitting ?? null;
    const rerun = open !== null && open.recorded !== null && open.recorded !== runKey(run);
    if (fitting !== null && (rerun || fitting.wanted !== model?.wantedTriangles || fitting.quality !== fitFor(this.store.value))) {
      fitting.controller.abort(superseded());
    }
    if (rerun || model?.measurement.kind !== 'running') open?.measuring?.abort(superseded());
    const stopped = model?.history.kind === 'none' && (model.wantedTriangles !== model.source.triangles || goal.kind !== 'triangles');
    if (open !== null && (rerun || stopped)) void this.record(open, rerun);
    void this.reconcile();
  }

  /** Saves the level that is wanted, as soon as it can be had, fitted to the original as the quality says. */
  async download(): Promise<void> {
    const { model, outputFormat } = this.store.value;
    const open = this.current;
    if (model === null || open === null) return;
    const fileName = `${model.name}.${outputFormat}`;
    await this.runTask('writing', fileName, async (signal) => {
      this.filesWanted += 1;
      signal.addEventListener('abort', () => open.fitting?.controller.abort(signal.reason), { once: true });
      const file = await this.settled(open, signal).finally(() => {
        this.filesWanted -= 1;
        // A fit that came to nothing has left the level to be shown again.
        void this.reconcile();
      });
      if (file === null) return;
      save(blobOf(file.bytes, outputFormat), fileName);
      this.store.update((state) => transitions.remarked(state, t('status.saved', { name: fileName }) + file.loss));
    });
  }

  /** Measures the level on screen. */
  async measure(): Promise<void> {
    const { model } = this.store.value;
    const open = this.current;
    if (model === null || open === null || open.measuring !== null || !transitions.canMeasure(model)) return;
    const measuring = new AbortController();
    open.measuring = measuring;
    const update = (transition: (state: State) => State): void => {
      if (this.current === open && !measuring.signal.aborted) this.store.update(transition);
    };
    update((state) => transitions.measuringProgressed(state, 0));
    try {
      await this.selectLevel(open, model);
      const { deviation, wedgeSets } = await open.document.deviationMap({
        signal: measuring.signal,
        onProgress: (fraction) => update((state) => transitions.measuringProgressed(state, fraction)),
      });
      if (this.current === open && !measuring.signal.aborted) {
        this.view.setDeviation(wedgeSets.map(({ surroundings }) => surroundings), heatLimit(deviation));
      }
      update((state) => transitions.measuringEnded(state, deviation, describeDeviation(deviation)));
    } catch (error) {
      const cancelled = measuring.signal.aborted;
      if (this.current !== open) return;
      if (cancelled) {
        // A new wish has ended it already, and goes on to what it asks for.
        if (this.store.value.model?.measurement.kind !== 'running') return;
        this.store.update((state) => transitions.heatMapLeft(transitions.measuringEnded(state, null, t('status.cancelledMeasuring'))));
      } else if (await this.reopen(open, error)) {
        void this.record(open);
      } else {
        update((state) => transitions.heatMapLeft(transitions.measuringEnded(transitions.failed(state, describeError(error)), null, '')));
      }
    } finally {
      if (open.measuring === measuring) open.measuring = null;
    }
  }

  // --- the view lent to an arrival

  /** The files of the model on screen. */
  get files(): readonly File[] | null {
    return this.current?.files ?? null;
  }

  /** Something else shows its geometries now: a download and a measurement of what was on screen end. */
  lendView(): void {
    this.task?.abort(superseded());
    this.store.update((state) => transitions.heatMapLeft(transitions.measuringEnded(state, null, '')));
    this.wishChanged();
  }

  /** Shows the level that is wanted again. */
  takeViewBack(): void {
    if (this.current !== null) this.current.fitted = null;
    this.store.update(transitions.levelStale);
    this.wishChanged();
  }

  // --- tasks

  private async runTask(kind: 'opening' | 'writing', name: string, run: (signal: AbortSignal) => Promise<void>): Promise<void> {
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

  private async replaceDocument(files: File[], from: Pick<Model, 'fileName' | 'credit' | 'origin'>, signal: AbortSignal): Promise<void> {
    this.store.update((state) => transitions.taskProgressed(state, null));
    const onProgress = (fraction: number): void => this.store.update((state) => transitions.taskProgressed(state, fraction));
    const early = readEarly(this.view, files);
    const document = await this.client.openDocument(files, { signal, onProgress }).catch((error: unknown) => {
      early.drop();
      throw error;
    });
    try {
      const { prepared, scene, written } = await this.prepare(document, early, signal);
      for (const controller of [this.current?.measuring, this.current?.recording]) controller?.abort(superseded());
      this.current?.document.dispose();
      const { summary } = document;
      const open: OpenDocument = { document, files, recording: null, recorded: null, stale: false, reached: null, measuring: null, fitting: null, fitted: null, written: null, failedKey: null, reopened: false };
      this.current = open;
      this.store.update((state) =>
        transitions.modelOpened(state, {
          ...from,
          name: baseName(from.fileName),
          scene,
          source: summary,
          warnings: summary.warnings,
          animations: prepared.animations,
        }),
      );
      // With the panel in its place the picture need not be drawn twice.
      await this.layOut();
      if (this.current !== open) return prepared.discard();
      const drawn = prepared.show().then(() => {
        if (this.current === open) this.store.update(transitions.modelDrawn);
      });
      // The picture next: side by side with the recording both would take as long as one after the other.
      await Promise.race([drawn, delay(PICTURE_TIME)]);
      if (this.current !== open) return;
      void this.tellFullSize(open, written);
      if (signal.aborted) this.store.update((state) => transitions.recordingEnded(state, t('status.cancelledRecording')));
      else void this.record(open);
    } catch (error) {
      if (this.current?.document !== document) document.dispose();
      throw error;
    }
  }

  /** The model for the view: of the file itself where that is enough, else of what the engine writes. */
  private async prepare(document: DocumentProxy, early: EarlyModel, signal: AbortSignal): Promise<PreparedDocument> {
    const none = document.summary.warnings.find(({ code }) => code === 'no-triangles');
    if (signal.aborted || none !== undefined) early.drop();
    signal.throwIfAborted();
    // The library passes it through; here there would be nothing to see or to choose.
    if (none !== undefined) throw new DecimeshError('no-triangles', none.message, none.where);
    const plain = await early.take(document.summary);
    if (plain !== null) {
      if (signal.aborted) plain.model.discard();
      signal.throwIfAborted();
      return { prepared: plain.model, scene: plain.scene, written: null };
    }
    const { bytes, report } = await document.write(FULL_DETAIL);
    signal.throwIfAborted();
    // The view takes the bytes over.
    const written = { bytes: { byteLength: bytes.byteLength }, report };
    const scene = readScene(bytes);
    const prepared = await this.view.load(bytes);
    if (signal.aborted) prepared.discard();
    signal.throwIfAborted();
    return { prepared, scene, written };
  }

  /** Tells how large the file is at full detail, and where its bytes are; writes it for that unless it is `written`. */
  private async tellFullSize(open: OpenDocument, written: PreparedDocument['written']): Promise<void> {
    try {
      const { bytes, report } = written ?? (await open.document.write(FULL_DETAIL));
      if (this.current !== open) return;
      this.tellSize(bytes.byteLength, report, {
        format: 'glb', encoding: 'none', preparation: preparationKey('glb', NO_PREPARATION), wantedTriangles: open.document.summary.triangles, lods: [],
      });
    } catch {
      // It is written once more when nothing else is to be done, and then what is wrong is told.
    }
  }

  // --- the history

  /** Records the levels, unless that is under way; `again` with other settings than those. */
  private async record(open: OpenDocument, again = false): Promise<void> {
    if (open.recording !== null && !again) return;
    open.recording?.abort(superseded());
    open.stale ||= again;
    const recording = new AbortController();
    open.recording = recording;
    const { run } = this.store.value;
    open.recorded = runKey(run);
    const isCurrent = (): boolean => this.current === open && open.recording === recording;
    const update = (transition: (state: State) => State): void => {
      if (isCurrent()) this.store.update(transition);
    };
    // A fitted level is not the history's.
    if (open.fitted !== null) update(transitions.levelStale);
    open.fitted = null;
    update((state) => transitions.recordingProgressed(state, 0));
    try {
      await open.document.simplify({
        ...simplifyOptions(run, open.document.summary, this.painted(run.paint)),
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
    this.tellWaiting();
    void this.reconcile();
  }

  // A fault elsewhere, in a bad file say, may have cost the worker its documents; the files are still here.
  private async reopen(open: OpenDocument, error: unknown): Promise<boolean> {
    if (!LOST_CODES.includes(describeError(error).code) || open.reopened) return false;
    open.reopened = true;
    try {
      open.document = await this.client.openDocument(open.files);
      return true;
    } catch {
      return false;
    }
  }

  // --- levels

  private async reconcile(): Promise<void> {
    if (this.reconciling) return;
    this.reconciling = true;
    try {
      while (await this.step()) this.tellWaiting();
    } finally {
      this.reconciling = false;
      this.tellWaiting();
    }
  }

  /** Does the next thing that is missing; false when nothing is. */
  private async step(): Promise<boolean> {
    const open = this.current;
    const now = this.store.value;
    const { model, outputFormat, lods } = now;
    const encoding = encodingFor(outputFormat, now.encoding);
    if (open === null || model === null || model.history.kind === 'recording' || now.arrival !== null) return false;
    if (open.recorded !== null && open.recorded !== runKey(now.run)) return false;
    const wanted = model.wantedTriangles;
    const full = wanted === model.source.triangles;
    if (model.history.kind === 'none' && !full) return false;
    // The size shown is that of the level shown; only a download is worth another run.
    const fit = this.filesWanted > 0 ? fitOfFile(now, model, open.fitted) : (open.fitted ?? 'fast');
    const key = wishKey(now, model, fit);
    if (open.failedKey === key) return false;
    try {
      if (model.history.kind === 'ready' && (await this.reachGoal(open, now))) return true;
      if (model.shownFor !== wanted) {
        open.fitted = null;
        const level = await this.selectLevel(open, model);
        const geometry = full ? null : await open.document.geometry();
        if (this.current !== open) return true;
        const counts = geometry && countMeshes(geometry);
        await this.view.setLevel(geometry);
        if (this.current !== open) return true;
        this.store.update((state) => transitions.levelShown(state, level, wanted, counts));
        return true;
      }
      if (isChain(now) && open.fitted !== null) {
        open.fitted = null;
        this.store.update(transitions.levelStale);
        return true;
      }
      if (fit !== (open.fitted ?? 'fast')) {
        await this.fit(open, wanted, fit);
        return true;
      }
      const measured = transitions.isOutputCurrent(now);
      if (open.written?.key === key || (measured && this.filesWanted === 0)) return false;
      if (this.filesWanted === 0 && ((await this.pause()) || this.current !== open)) return true;
      await this.selectLevel(open, model);
      const chain = isChain(now) && model.history.kind === 'ready';
      const prepared = prepareOptions(outputFormat, now.preparation);
      const { bytes, report } = await open.document.write({ ...writeOptions(outputFormat, encoding), ...prepared, ...(chain ? { lods } : {}) });
      if (this.current !== open) return true;
      // A change that came meanwhile asks for something else.
      if (open.recorded !== null && open.recorded !== runKey(this.store.value.run)) return true;
      const loss = report.warnings.find((warning) => warning.code === 'not-carried');
      open.written = { key, bytes, loss: loss === undefined ? '' : ` ${loss.message}.` };
      this.tellSize(bytes.byteLength, report, {
        format: outputFormat, encoding, preparation: preparationKey(outputFormat, now.preparation), wantedTriangles: wanted, lods: isChain(now) ? lods : [],
      });
      return true;
    } catch (error) {
      if (this.current !== open) return true;
      if (await this.reopen(open, error)) {
        void this.record(open);
        return false;
      }
      open.failedKey = key;
      this.store.update((state) => transitions.failed(state, describeError(error)));
      return true;
    }
  }

  /** Sets the slider where the goal wants it; true when there was something to do. */
  private async reachGoal(open: OpenDocument, now: State): Promise<boolean> {
    const key = goalKey(now);
    if (open.reached === key) return false;
    open.reached = key;
    if (now.goal.kind === 'triangles') return false;
    try {
      const triangles = await this.findGoal(open, now, now.goal);
      if (this.current !== open || goalKey(this.store.value) !== key) return true;
      // Looking for it has selected other levels.
      if (open.fitted !== null) this.store.update(transitions.levelStale);
      open.fitted = null;
      this.store.update((state) => transitions.goalReached(state, triangles));
    } catch (error) {
      open.reached = null;
      throw error;
    }
    return true;
  }

  private async findGoal(open: OpenDocument, now: State, goal: Exclude<Goal, { kind: 'triangles' }>): Promise<number> {
    if (goal.kind === 'error') return (await open.document.level({ error: `${goal.percent}%` })).triangles;
    const { outputFormat: format } = now;
    const file = { ...writeOptions(format, encodingFor(format, now.encoding)), ...prepareOptions(format, now.preparation) };
    const { report } = await open.document.write({ ...file, size: goal.bytes });
    return report.output.triangles;
  }

  /** Sees to it that the document stands at the level that is wanted. */
  private async selectLevel(open: OpenDocument, model: Model): Promise<transitions.Level> {
    // Without a history it stands at full detail; with one, recording it may have left another level.
    if (model.history.kind !== 'ready' || open.fitted !== null) return model.shown;
    const wanted = model.wantedTriangles;
    return open.document.level(wanted === model.source.triangles ? {} : { triangles: wanted });
  }

  /** Shows the level of `wanted` triangles as a run to it alone gives it. An abort leaves the history's to be shown. */
  private async fit(open: OpenDocument, wanted: number, quality: Quality): Promise<void> {
    const controller = new AbortController();
    const { signal } = controller;
    open.fitting = { controller, wanted, quality };
    open.fitted = null;
    open.measuring?.abort(superseded());
    // Nobody is to measure meanwhile: the selected level changes at the end.
    this.store.update((state) => transitions.fittingStarted(transitions.levelStale(state)));
    try {
      const onProgress = (fraction: number): void => this.store.update((state) => transitions.fittingProgressed(state, fraction));
      const { run } = this.store.value;
      const options = simplifyOptions(run, open.document.summary, this.painted(run.paint));
      let level = await open.document.simplify({ ...options, triangles: wanted, preset: quality, keepLevels: true, signal, onProgress });
      // Near the fewest there are, the history may go further than this run.
      if (level.triangles > wanted) level = await open.document.level({ triangles: wanted });
      const geometry = await open.document.geometry();
      if (this.current !== open) return;
      const counts = countMeshes(geometry);
      await this.view.setLevel(geometry);
      signal.throwIfAborted();
      if (this.current !== open) return;
      open.fitted = quality;
      this.store.update((state) => transitions.levelShown(state, level, wanted, counts));
    } catch (error) {
      if (!signal.aborted) throw error;
    } finally {
      open.fitting = null;
      if (this.current === open) this.store.update(transitions.fittingEnded);
    }
  }

  private tellSize(bytes: number, report: Report, wish: Pick<transitions.Output, 'format' | 'encoding' | 'preparation' | 'wantedTriangles' | 'lods'>): void {
    this.store.update((state) => transitions.outputMeasured(transitions.inputMeasured(state, report.input.parts), { ...wish, bytes, parts: report.output.parts, levels: report.lods ?? [] }));
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

  /** Resolves to the file of the wanted level when it is written, to null when that failed and was told. */
  private async settled(open: OpenDocument, signal: AbortSignal): Promise<WrittenFile | null> {
    this.wishChanged();
    for (;;) {
      signal.throwIfAborted();
      const now = this.store.value;
      const { model } = now;
      if (this.current !== open || model === null) return null;
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

const superseded = (): DOMException => new DOMException('Superseded.', 'AbortError');

const delay = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));

/** What the live region says of a measurement. */
function describeDeviation({ max, mean, relativeTo }: { max: number; mean: number; relativeTo: number }): string {
  const share = (value: number): string => formatShare(relativeTo > 0 ? value / relativeTo : 0);
  return t('status.measured', { max: share(max), mean: share(mean) });
}
