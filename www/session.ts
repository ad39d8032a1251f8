// The conversation with the worker: opens files, records the history, and keeps what is shown in step with what is
// wanted. Only the latest wish counts: one request is under way, and what was asked for meanwhile is read when it ends.
import { DecimeshError, describeBlockers } from 'decimesh/worker';
import type { DocumentProxy, WorkerClient } from 'decimesh/worker';
import { baseName, decodePath, fetchFile, modelFile } from './files.ts';
import { formatShare } from './format.ts';
import { encodingFor, writeOptions } from './encoding.ts';
import type { Encoding } from './encoding.ts';
import type { View } from './preview/view.ts';
import * as transitions from './state.ts';
import type { Model, Notice, OutputFormat, Quality, State } from './state.ts';

/** Where the session reads and changes the page's state. */
export interface Store {
  readonly value: State;
  update(transition: (state: State) => State): void;
}

const CANCELLED = 'Cancelled. Move the slider to simplify again.';

/** Milliseconds without a new wish before the file for it is written to learn its size. */
const SETTLE_TIME = 250;

/** Codes after which the worker has no documents any more; opening the files again brings them back. */
const LOST_CODES: readonly string[] = ['disposed', 'worker-lost', 'internal', 'out-of-memory'];

const MIME_TYPES: Readonly<Record<OutputFormat, string>> = {
  glb: 'model/gltf-binary',
  obj: 'model/obj',
  stl: 'model/stl',
  // Without a type of their own; as text they would be saved as .txt.
  ply: 'application/octet-stream',
  off: 'application/octet-stream',
  smf: 'application/octet-stream',
};

/** A file, the wish it answers, and a sentence on what its format cannot hold, or nothing. */
interface WrittenFile {
  readonly key: string;
  readonly bytes: Uint8Array;
  readonly loss: string;
}

/** The document behind the model on screen. */
interface OpenDocument {
  document: DocumentProxy;
  readonly files: File[];
  recording: AbortController | null;
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
  /** Told after every step. */
  private readonly waiting = new Set<() => void>();

  constructor(
    private readonly store: Store,
    private readonly client: WorkerClient,
    private readonly view: View,
  ) {}

  /** Opens a model from its files, in place of the one before if that works. */
  async open(files: File[], credit = ''): Promise<void> {
    const model = modelFile(files);
    if (model === undefined) return;
    await this.runTask('opening', model.name, (signal) => this.replaceDocument(files, model.name, credit, signal));
  }

  /** Opens a model from the web under the name `fileName`, with the files it refers to. */
  async openAddress(address: URL, fileName: string, credit = ''): Promise<void> {
    await this.runTask('opening', fileName, async (signal) => {
      const onProgress = (fraction: number | null): void => this.store.update((state) => transitions.taskProgressed(state, fraction));
      const model = await fetchFile(address, fileName, { signal, onProgress });
      const references = await this.client.externalFiles(new Uint8Array(await model.arrayBuffer()));
      const others = (await Promise.all(references.map((reference) => fetchReference(reference, '', address, signal)))).flat();
      const libraries = others.filter((file) => /\.mtl$/i.test(file.name));
      const images = await Promise.all(libraries.map((library) => this.fetchImages(library, address, signal)));
      await this.replaceDocument([model, ...others, ...images.flat()], fileName, credit, signal);
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
    const { model, quality } = this.store.value;
    const fitting = this.current?.fitting ?? null;
    if (fitting !== null && (fitting.wanted !== model?.wantedTriangles || fitting.quality !== quality)) {
      fitting.controller.abort(new DOMException('Superseded.', 'AbortError'));
    }
    if (model?.measurement.kind !== 'running') this.current?.measuring?.abort(new DOMException('Superseded.', 'AbortError'));
    if (this.current !== null && model?.history.kind === 'none' && model.wantedTriangles !== model.source.triangles) {
      void this.record(this.current);
    }
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
      save(new Blob([file.bytes as Uint8Array<ArrayBuffer>], { type: MIME_TYPES[outputFormat] }), fileName);
      this.store.update((state) => transitions.remarked(state, `Saved ${fileName}.${file.loss}`));
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
      const deviation = await open.document.measure({
        signal: measuring.signal,
        onProgress: (fraction) => update((state) => transitions.measuringProgressed(state, fraction)),
      });
      update((state) => transitions.measuringEnded(state, deviation, describeDeviation(deviation)));
    } catch (error) {
      const cancelled = measuring.signal.aborted;
      if (this.current !== open) return;
      if (cancelled) {
        // A new wish has ended it already, and goes on to what it asks for.
        if (this.store.value.model?.measurement.kind !== 'running') return;
        this.store.update((state) => transitions.measuringEnded(state, null, 'Cancelled measuring.'));
      } else if (await this.reopen(open, error)) {
        void this.record(open);
      } else {
        update((state) => transitions.measuringEnded(transitions.failed(state, describeError(error)), null, ''));
      }
    } finally {
      if (open.measuring === measuring) open.measuring = null;
    }
  }

  // --- tasks

  private async runTask(kind: 'opening' | 'writing', name: string, run: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.task?.abort(new DOMException('Superseded.', 'AbortError'));
    const task = new AbortController();
    this.task = task;
    this.store.update((state) => transitions.taskStarted(state, { kind, name, fraction: null }));
    try {
      await run(task.signal);
      if (this.task === task) this.store.update((state) => transitions.taskEnded(state));
    } catch (error) {
      if (this.task !== task) return;
      if (task.signal.aborted) this.store.update((state) => transitions.taskEnded(state, 'Cancelled.'));
      else {
        const notice = describeError(error);
        // What is wrong with a file as a whole has the file for its place.
        this.store.update((state) => transitions.failed(state, { ...notice, where: notice.where || name }));
      }
    } finally {
      if (this.task === task) this.task = null;
    }
  }

  // A material library names images relative to itself.
  private async fetchImages(library: File, address: URL, signal: AbortSignal): Promise<File[]> {
    const images = await this.client.externalFiles(new Uint8Array(await library.arrayBuffer()));
    const folder = library.name.slice(0, library.name.lastIndexOf('/') + 1);
    return (await Promise.all(images.map((image) => fetchReference(image, folder, address, signal)))).flat();
  }

  private async replaceDocument(files: File[], fileName: string, credit: string, signal: AbortSignal): Promise<void> {
    this.store.update((state) => transitions.taskProgressed(state, null));
    const onProgress = (fraction: number): void => this.store.update((state) => transitions.taskProgressed(state, fraction));
    const document = await this.client.openDocument(files, { signal, onProgress });
    try {
      signal.throwIfAborted();
      const none = document.summary.warnings.find(({ code }) => code === 'no-triangles');
      // The library passes it through; here there would be nothing to see or to choose.
      if (none !== undefined) throw new DecimeshError('no-triangles', none.message, none.where);
      const { bytes } = await document.write({ format: 'glb', compress: 'none' });
      signal.throwIfAborted();
      // The view takes the bytes over.
      const { byteLength } = bytes;
      const prepared = await this.view.load(bytes);
      if (signal.aborted) prepared.discard();
      signal.throwIfAborted();

      this.current?.recording?.abort(new DOMException('Superseded.', 'AbortError'));
      this.current?.measuring?.abort(new DOMException('Superseded.', 'AbortError'));
      this.current?.document.dispose();
      const { summary } = document;
      const open: OpenDocument = { document, files, recording: null, measuring: null, fitting: null, fitted: null, written: null, failedKey: null, reopened: false };
      this.current = open;
      this.store.update((state) =>
        transitions.modelOpened(state, {
          name: baseName(fileName),
          credit,
          source: summary,
          warnings: summary.warnings,
          animations: prepared.animations,
        }),
      );
      this.tellSize(byteLength, 'glb', 'none', summary.triangles);
      // The panel first: with few cores, drawing and simplifying would keep the page from laying it out.
      await afterNextPaint();
      if (this.current !== open) return prepared.discard();
      void prepared.show().then(() => {
        if (this.current === open) this.store.update(transitions.modelDrawn);
      });
      if (signal.aborted) this.store.update((state) => transitions.recordingEnded(state, CANCELLED));
      else void this.record(open);
    } catch (error) {
      if (this.current?.document !== document) document.dispose();
      throw error;
    }
  }

  // --- the history

  private async record(open: OpenDocument): Promise<void> {
    if (open.recording !== null) return;
    const recording = new AbortController();
    open.recording = recording;
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
        signal: recording.signal,
        onProgress: (fraction) => update((state) => transitions.recordingProgressed(state, fraction)),
      });
      const fewest = await open.document.level({ triangles: 1 });
      recording.signal.throwIfAborted();
      const limit = fewest.blockers === null ? '' : describeBlockers(fewest.blockers);
      update((state) => transitions.historyReady(state, fewest.triangles, limit));
      open.reopened = false;
    } catch (error) {
      if (recording.signal.aborted) {
        update((state) => transitions.recordingEnded(state, CANCELLED));
      } else if (isCurrent() && (await this.reopen(open, error))) {
        open.recording = null;
        return this.record(open);
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
    const { model, outputFormat, quality } = this.store.value;
    const encoding = encodingFor(outputFormat, this.store.value.encoding);
    if (open === null || model === null || model.history.kind === 'recording') return false;
    const wanted = model.wantedTriangles;
    const full = wanted === model.source.triangles;
    if (model.history.kind === 'none' && !full) return false;
    // The size shown is that of the level shown; only a download is worth another run.
    const fit = this.filesWanted > 0 ? fitOfFile(model, quality, open.fitted) : (open.fitted ?? 'fast');
    const key = wishKey(model, outputFormat, encoding, fit);
    if (open.failedKey === key) return false;
    try {
      if (model.shownFor !== wanted) {
        open.fitted = null;
        const level = await this.selectLevel(open, model);
        const geometry = full ? null : await open.document.geometry();
        if (this.current !== open) return true;
        await this.view.setLevel(geometry);
        if (this.current !== open) return true;
        this.store.update((state) => transitions.levelShown(state, level, wanted));
        return true;
      }
      if (fit !== (open.fitted ?? 'fast')) {
        await this.fit(open, wanted, fit);
        return true;
      }
      const measured = model.output?.wantedTriangles === wanted && model.output.format === outputFormat && model.output.encoding === encoding;
      if (open.written?.key === key || (measured && this.filesWanted === 0)) return false;
      if (this.filesWanted === 0 && ((await this.pause()) || this.current !== open)) return true;
      await this.selectLevel(open, model);
      const { bytes, report } = await open.document.write(writeOptions(outputFormat, encoding));
      if (this.current !== open) return true;
      const loss = report.warnings.find((warning) => warning.code === 'not-carried');
      open.written = { key, bytes, loss: loss === undefined ? '' : ` ${loss.message}.` };
      this.tellSize(bytes.byteLength, outputFormat, encoding, wanted);
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
    open.measuring?.abort(new DOMException('Superseded.', 'AbortError'));
    // Nobody is to measure meanwhile: the selected level changes at the end.
    this.store.update((state) => transitions.fittingStarted(transitions.levelStale(state)));
    try {
      const onProgress = (fraction: number): void => this.store.update((state) => transitions.fittingProgressed(state, fraction));
      let level = await open.document.simplify({ triangles: wanted, preset: quality, keepLevels: true, signal, onProgress });
      // Near the fewest there are, the history may go further than this run.
      if (level.triangles > wanted) level = await open.document.level({ triangles: wanted });
      const geometry = await open.document.geometry();
      if (this.current !== open) return;
      await this.view.setLevel(geometry);
      signal.throwIfAborted();
      if (this.current !== open) return;
      open.fitted = quality;
      this.store.update((state) => transitions.levelShown(state, level, wanted));
    } catch (error) {
      if (!signal.aborted) throw error;
    } finally {
      open.fitting = null;
      if (this.current === open) this.store.update(transitions.fittingEnded);
    }
  }

  private tellSize(bytes: number, format: OutputFormat, encoding: Encoding, wantedTriangles: number): void {
    this.store.update((state) => transitions.outputMeasured(state, { format, encoding, wantedTriangles, bytes }));
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
      const { model, outputFormat, encoding, quality } = this.store.value;
      if (this.current !== open || model === null) return null;
      const key = wishKey(model, outputFormat, encodingFor(outputFormat, encoding), fitOfFile(model, quality, open.fitted));
      if (open.written?.key === key) return open.written;
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

const wishKey = (model: Model, format: OutputFormat, encoding: Encoding, fit: Quality): string =>
  `${model.wantedTriangles}.${format}.${encoding}.${fit}`;

/** What a file is to be fitted with: at full detail there is nothing to fit, and `fast` takes what is shown. */
const fitOfFile = (model: Model, quality: Quality, fitted: Quality | null): Quality => {
  if (model.wantedTriangles === model.source.triangles) return 'fast';
  return quality === 'fast' ? (fitted ?? 'fast') : quality;
};

/** Resolves when the page has been painted with what it knows now, and soon where nothing is painted. */
const afterNextPaint = (): Promise<void> =>
  new Promise((resolve) => {
    requestAnimationFrame(() => setTimeout(resolve));
    // A tab in the background has no frames.
    setTimeout(resolve, 200);
  });

// A file that cannot be had is left out: opening the model tells whether it can do without, and names the place.
// `folder` is that of the file it is named in, from the model.
async function fetchReference(reference: string, folder: string, address: URL, signal: AbortSignal): Promise<File[]> {
  const beside = URL.parse(folder + reference.replaceAll('\\', '/'), address);
  if (beside === null) return [];
  try {
    return [await fetchFile(beside, decodePath(folder + reference), { signal })];
  } catch {
    signal.throwIfAborted();
    return [];
  }
}

/** What the live region says of a measurement. */
function describeDeviation({ max, mean, relativeTo }: { max: number; mean: number; relativeTo: number }): string {
  const share = (value: number): string => formatShare(relativeTo > 0 ? value / relativeTo : 0);
  return `Measured: ${share(max)} of the diagonal at most, ${share(mean)} on average.`;
}

/** Any failure as a notice: ours keep their code and place, others are named as what they are. */
export function describeError(error: unknown): Notice {
  if (typeof error === 'object' && error !== null && 'code' in error && typeof error.code === 'string') {
    return {
      code: error.code,
      message: 'message' in error ? String(error.message) : '',
      where: 'where' in error && typeof error.where === 'string' ? error.where : '',
    };
  }
  return { code: 'internal', message: error instanceof Error ? error.message : String(error), where: '' };
}

function save(blob: Blob, fileName: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = fileName;
  link.click();
  // Some browsers read the blob only after the click has been handled.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
