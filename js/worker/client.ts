// The client: the calls of the package, done in a worker. The worker owns the documents, the client knows numbers.

import type { Written } from '../document/write.js';
import { DecimeshError, errorFromData, invalidArgument } from '../errors.js';
import { isFile, listFiles, loadFiles } from '../files.js';
import { RUN_NAMES, checkNames, checkSignal } from '../options.js';
import type { NodeWorker } from '../platform.js';
import type { ProgressiveOptions } from '../progressive/encode.js';
import type { Deviation, DeviationMap } from '../report.js';
import type {
  DocumentInput,
  DocumentSimplifyOptions,
  DocumentSummary,
  LevelGeometry,
  LevelSummary,
  LevelTargets,
  MeasureOptions,
  MeshInput,
  MeshSimplifyOptions,
  RunOptions,
  SimplifiedMesh,
  WriteOptions,
} from '../types.js';
import { startPort, type Port } from './port.js';
import type { Answer, AnsweredRequest, AnswerTo, Reply, Request } from './protocol.js';

export { describeBlockers } from '../blockers.js';
export { DecimeshError } from '../errors.js';
export { COMPRESSIONS, OUTPUT_FORMATS, holdsEncodings, usualFormat } from '../formats.js';
export { MOST_LODS, PRESETS, isPreset } from '../options.js';
export type { Parts } from '../parts.js';
export type { AttributeDeviation, Deviation, DeviationMap, Report, ReportedLod, SideDeviation, WedgeSetDeviation } from '../report.js';
export type * from '../types.js';
export type { Written };

/** How to start the worker. */
export interface WorkerClientOptions {
  /** Makes a worker that runs `decimesh/dist/worker/worker.js`. Default: the client finds that file beside itself. */
  readonly worker?: (() => Worker | NodeWorker) | undefined;
}

/** A request without its id, which is given when it is sent. */
type Unsent<Sent extends AnsweredRequest = AnsweredRequest> = Sent extends AnsweredRequest ? Omit<Sent, 'id'> : never;

interface Pending {
  resolve(answer: Answer): void;
  reject(error: unknown): void;
  readonly onProgress: ((fraction: number) => void) | undefined;
}

/** Makes a client. Its worker starts with the first call, and again with the first call after it was lost. */
export function createWorkerClient(options: WorkerClientOptions = {}): WorkerClient {
  return new WorkerClient(options);
}

/**
 * The package's calls in a worker of its own.
 *
 * Besides the errors of the calls themselves everything rejects with `worker-lost` when the worker fails, and with
 * `disposed` after {@link terminate}. An abort rejects at once with the signal's reason.
 */
export class WorkerClient {
  readonly #make: (() => Worker | NodeWorker) | undefined;
  #connection: Promise<Connection> | undefined;
  #terminated = false;

  /** @internal Use {@link createWorkerClient}. */
  constructor({ worker }: WorkerClientOptions) {
    if (worker !== undefined && typeof worker !== 'function') throw invalidArgument('worker', 'must be a function');
    this.#make = worker;
  }

  /**
   * Opens a model in the worker, as `openDocument` does. Files are read there; buffers are copied to it, and are the
   * caller's own as before. Progress is coarse.
   */
  async openDocument(input: DocumentInput, options: RunOptions = {}): Promise<DocumentProxy> {
    checkRunOptions(options);
    let files = listFiles(input);
    const connection = await this.#connect(options.signal);
    if (!connection.takesFiles) {
      files = await loadFiles(files);
      options.signal?.throwIfAborted();
    }
    const opened = await connection.request({ type: 'open', files }, options);
    return new DocumentProxy(connection, opened.document, opened.summary);
  }

  /** Simplifies bare arrays in the worker, as `simplify` does. They are copied to it; the result's are not. */
  async simplify(mesh: MeshInput, options: MeshSimplifyOptions & RunOptions): Promise<SimplifiedMesh> {
    const [simplifyOptions, runOptions] = splitOptions(options);
    const connection = await this.#connect(runOptions.signal);
    const reply = await connection.request({ type: 'simplify-arrays', mesh, options: simplifyOptions }, runOptions);
    return reply.mesh;
  }

  /** The addresses of files that a .gltf or .glb needs beside itself, as it names them; empty for other content. */
  async externalFiles(bytes: Uint8Array | ArrayBuffer): Promise<readonly string[]> {
    const [file] = listFiles(bytes);
    if (file === undefined || isFile(file)) throw invalidArgument('bytes', 'must be a Uint8Array or an ArrayBuffer');
    const connection = await this.#connect(undefined);
    return (await connection.request({ type: 'external-files', bytes: file.bytes })).uris;
  }

  /** Ends the worker and with it its documents; what is under way rejects with `disposed`. The client is done then. */
  terminate(): void {
    this.#terminated = true;
    const ended = new DecimeshError('disposed', 'the worker client was terminated');
    // A worker that could not be started has nothing to end, and its caller was told.
    this.#connection?.then((connection) => connection.end(ended), () => {});
  }

  async #connect(signal: AbortSignal | undefined): Promise<Connection> {
    signal?.throwIfAborted();
    const terminated = (): DecimeshError => new DecimeshError('disposed', 'the worker client was terminated');
    if (this.#terminated) throw terminated();
    const pending = (this.#connection ??= Connection.start(this.#make, () => {
      if (this.#connection === pending) this.#connection = undefined;
    }));
    try {
      const connection = await pending;
      signal?.throwIfAborted();
      if (this.#terminated) throw terminated();
      return connection;
    } catch (error) {
      if (this.#connection === pending && !this.#terminated && !signal?.aborted) this.#connection = undefined;
      throw error;
    }
  }
}

/** One worker from its start to its end. */
class Connection {
  #port!: Port;
  #lastId = 0;
  #ended: DecimeshError | undefined;
  readonly #pending = new Map<number, Pending>();
  readonly #onLost: () => void;

  private constructor(onLost: () => void) {
    this.#onLost = onLost;
  }

  static async start(make: (() => Worker | NodeWorker) | undefined, onLost: () => void): Promise<Connection> {
    const connection = new Connection(onLost);
    try {
      connection.#port = await startPort(make, {
        message: (data) => connection.#receive(data as Reply),
        lost: (reason) => connection.end(new DecimeshError('worker-lost', `the worker failed: ${reason}`)),
      });
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      throw new DecimeshError('worker-lost', `the worker could not be started: ${reason}`, '', { cause: error });
    }
    connection.#port.keepAlive(false);
    return connection;
  }

  get takesFiles(): boolean {
    return this.#port.takesFiles;
  }

  /** Sends a request and resolves to its answer; an abort rejects at once and the reply is dropped when it comes. */
  request<Sent extends Unsent>(unsent: Sent, { onProgress, signal }: RunOptions = {}): Promise<AnswerTo[Sent['type']]> {
    return new Promise<Answer>((resolve, reject) => {
      if (this.#ended !== undefined) throw this.#ended;
      signal?.throwIfAborted();
      this.#lastId += 1;
      const id = this.#lastId;
      const abort = (): void => this.#abandon(id, signal?.reason);
      this.#post({ ...unsent, id } as AnsweredRequest);
      const forget = (): void => signal?.removeEventListener('abort', abort);
      signal?.addEventListener('abort', abort, { once: true });
      this.#pending.set(id, {
        resolve: (answer) => (forget(), resolve(answer)),
        reject: (error) => (forget(), reject(error)),
        onProgress,
      });
      this.#port.keepAlive(true);
    }) as Promise<AnswerTo[Sent['type']]>;
  }

  /** Frees a document in the worker. */
  dispose(document: number): void {
    if (this.#ended === undefined) this.#post({ type: 'dispose', document });
  }

  /** Ends the worker; all that is under way, and all that follows, rejects with `error`. */
  end(error: DecimeshError): void {
    if (this.#ended !== undefined) return;
    this.#ended = error;
    this.#onLost();
    this.#port?.terminate();
    const pending = [...this.#pending.values()];
    this.#pending.clear();
    for (const { reject } of pending) reject(error);
  }

  #post(request: Request): void {
    this.#port.post(request, []);
  }

  #abandon(id: number, reason: unknown): void {
    const pending = this.#take(id);
    if (pending === undefined) return;
    this.#post({ type: 'cancel', id });
    pending.reject(reason);
  }

  #take(id: number): Pending | undefined {
    const pending = this.#pending.get(id);
    this.#pending.delete(id);
    if (this.#pending.size === 0) this.#port.keepAlive(false);
    return pending;
  }

  #receive(reply: Reply): void {
    if (reply.type === 'progress') {
      const pending = this.#pending.get(reply.id);
      try {
        pending?.onProgress?.(reply.fraction);
      } catch (error) {
        this.#abandon(reply.id, error);
      }
      return;
    }
    const pending = this.#take(reply.id);
    if (reply.type === 'failed') {
      pending?.reject(errorFromData(reply.error));
    } else if (reply.type === 'cancelled') {
      // Only what was abandoned is cancelled, and that was taken out then.
    } else if (pending !== undefined) {
      pending.resolve(reply);
    } else if (reply.type === 'opened') {
      // Its request was aborted too late for the worker to notice: nobody else would free it.
      this.dispose(reply.document);
    }
  }
}

/** A document in the worker. The same calls as `Document`. */
export class DocumentProxy {
  /** What the file holds at full detail. */
  readonly summary: DocumentSummary;
  readonly #connection: Connection;
  readonly #document: number;
  #disposed = false;

  /** @internal Use {@link WorkerClient.openDocument}. */
  constructor(connection: Connection, document: number, summary: DocumentSummary) {
    this.#connection = connection;
    this.#document = document;
    this.summary = summary;
  }

  /** As `Document.simplify`; an abort rejects at once. A call after an abort need not wait for anything. */
  async simplify(options: DocumentSimplifyOptions & RunOptions = {}): Promise<LevelSummary> {
    const [simplifyOptions, runOptions] = splitOptions(options);
    const request = { type: 'simplify', document: this.#number(), options: simplifyOptions } as const;
    return (await this.#connection.request(request, runOptions)).level;
  }

  /** As `Document.level`; an abort rejects at once. */
  async level(targets: LevelTargets, options: RunOptions = {}): Promise<LevelSummary> {
    checkRunOptions(options);
    return (await this.#connection.request({ type: 'level', document: this.#number(), targets }, options)).level;
  }

  /** As `Document.measure`; an abort rejects at once. */
  async measure(options: MeasureOptions & RunOptions = {}): Promise<Deviation> {
    const [measureOptions, runOptions] = splitOptions(options);
    const request = { type: 'measure', document: this.#number(), options: measureOptions } as const;
    return (await this.#connection.request(request, runOptions)).deviation;
  }

  /** As `Document.deviationMap`; an abort rejects at once. The arrays are moved, not copied. */
  async deviationMap(options: MeasureOptions & RunOptions = {}): Promise<DeviationMap> {
    const [measureOptions, runOptions] = splitOptions(options);
    const request = { type: 'deviation-map', document: this.#number(), options: measureOptions } as const;
    return (await this.#connection.request(request, runOptions)).map;
  }

  /** As `Document.geometry`; the arrays are moved, not copied. */
  async geometry(): Promise<LevelGeometry> {
    return (await this.#connection.request({ type: 'geometry', document: this.#number() })).geometry;
  }

  /** As `Document.write`; the bytes are moved, not copied. */
  async write(options: WriteOptions = {}): Promise<Written> {
    return (await this.#connection.request({ type: 'write', document: this.#number(), options })).written;
  }

  /** As `Document.writeProgressive`; the bytes are moved, not copied. */
  async writeProgressive(options: ProgressiveOptions = {}): Promise<Uint8Array<ArrayBuffer>> {
    return (await this.#connection.request({ type: 'write-progressive', document: this.#number(), options })).bytes;
  }

  /** Frees the document in the worker. May be called twice. */
  dispose(): void {
    if (this.#disposed) return;
    this.#disposed = true;
    this.#connection.dispose(this.#document);
  }

  /** {@link dispose}, for `using`. */
  [Symbol.dispose](): void {
    this.dispose();
  }

  #number(): number {
    if (this.#disposed) throw new DecimeshError('disposed', 'the document was disposed');
    return this.#document;
  }
}

function checkRunOptions(options: RunOptions): void {
  checkNames(options, RUN_NAMES);
  if (options.onProgress !== undefined && typeof options.onProgress !== 'function') {
    throw invalidArgument('onProgress', 'must be a function');
  }
  checkSignal(options.signal);
}

// Callbacks and signals cannot be posted; the rest is checked in the worker.
function splitOptions<Options extends RunOptions>(options: Options): [Omit<Options, keyof RunOptions>, RunOptions] {
  if (typeof options !== 'object' || options === null) throw invalidArgument('options', 'must be an object');
  const { onProgress, signal, ...rest } = options;
  const run: RunOptions = { onProgress, signal };
  checkRunOptions(run);
  return [rest, run];
}
