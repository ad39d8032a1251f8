// Has the open model arrive as a progressive mesh does: makes one, plays it over a connection, and shows what has come.
// Materials, textures and camera are those of the model on screen; only its geometry is lent to this for a while.
import type { WorkerClient } from 'decimesh/worker';
import { describeError } from '../describe_error.ts';
import { save } from '../formats.ts';
import { t } from '../messages/messages.ts';
import type { View } from '../preview/view.ts';
import type { Store } from '../session.ts';
import { failed, remarked } from '../state.ts';
import type { State } from '../state.ts';
import { BYTES_A_SECOND, arrivalChanged, arrivalClosed, arrivalOpened, arrivalStarted } from './arrival_state.ts';
import type { ArrivalState, Speed } from './arrival_state.ts';
import { ArrivalPanel, formatTime } from './panel.tsx';
import type { ReaderReply, ReaderRequest } from './protocol.ts';

/** `model/vnd.decimesh.progressive`, without the module that reads it. */
const MIME_TYPE = 'model/vnd.decimesh.progressive';

/** Of the progress, what making the levels takes; the rest is coding them. */
const SIMPLIFYING = 0.7;

/** What it needs of the page. */
export interface ArrivalHost {
  readonly store: Store;
  readonly client: WorkerClient;
  readonly view: View;
  /** Shows the level that is wanted again. */
  onClosed(): void;
}

/** One model, from the command to Close. */
export class Arrival {
  private readonly making = new AbortController();
  private reader: Worker | null = null;
  private bytes: Uint8Array<ArrayBuffer> | null = null;
  private closed = false;

  constructor(
    private readonly host: ArrivalHost,
    private readonly name: string,
  ) {}

  /** Makes a progressive mesh of the model in `files` and plays it. */
  async open(files: readonly File[]): Promise<void> {
    const { store } = this.host;
    store.update((state) => arrivalOpened(state, !state.reducedMotion));
    try {
      const { bytes, rivals } = await this.make(files);
      if (this.closed) return;
      this.bytes = bytes;
      this.change({ bytes: bytes.length, rivals });
      this.play();
    } catch (error) {
      if (this.closed) return;
      this.close();
      const notice = describeError(error);
      store.update((state) => failed(state, { ...notice, where: notice.where || this.name }));
    }
  }

  /** From the beginning, over another connection if one is named. */
  play(change: { readonly speed?: Speed; readonly smooth?: boolean } = {}): void {
    const { store, view } = this.host;
    this.change(change);
    const { bytes } = this;
    const now = store.value.arrival;
    if (bytes === null || now === null) return;
    this.reader?.terminate();
    store.update((state) => arrivalStarted(state, {}));
    const reader = new Worker(new URL('./arrival-worker.ts', import.meta.url), { type: 'module', name: 'decimesh arrival' });
    this.reader = reader;
    const isCurrent = (): boolean => this.reader === reader;
    reader.addEventListener('error', (event) => isCurrent() && this.fail('worker-lost', event.message));
    reader.addEventListener('message', ({ data }: MessageEvent<ReaderReply>) => {
      if (!isCurrent()) return;
      if (data.type === 'failed') return this.fail(data.code, data.message);
      const { elapsed, received } = data;
      if (data.type === 'progress') return this.change({ elapsed, received });
      if (data.type === 'arrived') {
        this.change({ phase: 'arrived', elapsed, received });
        return this.say(t('arrival.arrived', { name: this.name }));
      }
      const { geometry, triangles } = data;
      const sent = performance.now();
      void view.setLevel(geometry).then(() => {
        if (!isCurrent()) return;
        reader.postMessage({ type: 'drawn' } satisfies ReaderRequest);
        if (triangles === 0) return;
        if (store.value.arrival?.first === null) {
          // The picture takes its time, too.
          const first = { elapsed: elapsed + performance.now() - sent, received };
          this.change({ first });
          this.say(t('arrival.firstShown', { time: formatTime(first.elapsed) }));
        }
        this.change({ triangles });
      });
    });
    const { speed, smooth } = now;
    // The bytes are copied: they are played again, and saved.
    reader.postMessage({ type: 'start', bytes, bytesASecond: BYTES_A_SECOND[speed], smooth } satisfies ReaderRequest);
  }

  /** Stops the connection for a while, or lets it go on; begins again what has arrived. */
  toggle(): void {
    const phase = this.host.store.value.arrival?.phase;
    if (phase === 'arrived') return this.play();
    if (phase !== 'arriving' && phase !== 'paused') return;
    const pause = phase === 'arriving';
    this.reader?.postMessage({ type: pause ? 'pause' : 'resume' } satisfies ReaderRequest);
    this.change({ phase: pause ? 'paused' : 'arriving' });
    this.say(pause ? t('arrival.paused') : '');
  }

  /** Saves the progressive mesh. */
  save(): void {
    if (this.bytes === null) return;
    const fileName = `${this.name}.pmesh`;
    save(new Blob([this.bytes], { type: MIME_TYPE }), fileName);
    this.say(t('status.saved', { name: fileName }));
  }

  /** Back to the panel, and the level it asks for. */
  close(): void {
    if (this.closed) return;
    this.stop();
    this.host.store.update(arrivalClosed);
    // The file's own geometry, whatever had come; the level that is wanted follows.
    void this.host.view.setLevel(null);
    this.host.onClosed();
  }

  /** Ends everything that is under way: another model has taken the place. */
  stop(): void {
    this.closed = true;
    this.making.abort(new DOMException('Cancelled.', 'AbortError'));
    this.reader?.terminate();
    this.reader = null;
    this.bytes = null;
  }

  /** What stands in the place of the page's panel. */
  panel(state: State) {
    return state.arrival && <ArrivalPanel arrival={state.arrival} name={this.name} triangles={state.model?.source.triangles ?? 0} reducedMotion={state.reducedMotion} actions={this} />;
  }

  private async make(files: readonly File[]): Promise<{ bytes: Uint8Array<ArrayBuffer>; rivals: ArrivalState['rivals'] }> {
    const { signal } = this.making;
    // Another document: the one behind the panel keeps its levels, whose vertices may lie anywhere.
    const document = await this.host.client.openDocument([...files], { signal });
    try {
      const plain = await document.write({ format: 'glb', compress: 'none' });
      signal.throwIfAborted();
      const meshopt = await document.write({ format: 'glb', compress: 'meshopt' });
      const onProgress = (fraction: number): void => this.change({ fraction: SIMPLIFYING * fraction });
      await document.simplify({ placement: 'subset', signal, onProgress });
      this.change({ fraction: SIMPLIFYING });
      signal.throwIfAborted();
      const bytes = await document.writeProgressive();
      return { bytes, rivals: { plain: plain.report.output.parts.geometry, meshopt: meshopt.report.output.parts.geometry } };
    } finally {
      document.dispose();
    }
  }

  private change(change: Partial<ArrivalState>): void {
    if (!this.closed) this.host.store.update((state) => arrivalChanged(state, change));
  }

  private say(text: string): void {
    this.host.store.update((state) => remarked(state, text));
  }

  private fail(code: string, message: string): void {
    this.close();
    this.host.store.update((state) => failed(state, { code, message, where: this.name }));
  }
}
