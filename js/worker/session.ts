// The worker's side of the protocol, apart from the port it speaks through: owns the documents, answers requests.

import type { Document } from '../document.js';
import { externalFiles, openFiles } from '../document/open.js';
import { init } from '../engine.js';
import { DecimeshError, errorToData } from '../errors.js';
import { loadFiles } from '../files.js';
import { simplifyInSteps } from '../simplify.js';
import type { AnsweredRequest, Answer, Reply, Request } from './protocol.js';

/** Sends a reply; `transfer` lists the buffers that move with it. */
export type Post = (reply: Reply, transfer: readonly Transferable[]) => void;

/** The documents of one client, and its requests that are under way. */
export class Session {
  readonly #post: Post;
  readonly #documents = new Map<number, Document>();
  readonly #running = new Map<number, AbortController>();
  #lastDocument = 0;

  constructor(post: Post) {
    this.#post = post;
  }

  /** Takes a request; its replies go out as they come. Throws only if freeing a document fails, which is our fault. */
  receive(request: Request): void {
    if (request.type === 'cancel') {
      this.#running.get(request.id)?.abort();
    } else if (request.type === 'dispose') {
      this.#dispose(request.document);
    } else {
      void this.#answer(request);
    }
  }

  async #answer(request: AnsweredRequest): Promise<void> {
    const { id } = request;
    const controller = new AbortController();
    this.#running.set(id, controller);
    try {
      const answer = await this.#perform(request, controller.signal);
      this.#post(answer, buffersOf(answer));
    } catch (error) {
      const cancelled = controller.signal.aborted && error === controller.signal.reason;
      this.#post(cancelled ? { type: 'cancelled', id } : { type: 'failed', id, error: errorToData(error) }, []);
    } finally {
      this.#running.delete(id);
    }
  }

  async #perform(request: AnsweredRequest, signal: AbortSignal): Promise<Answer> {
    const { id } = request;
    const onProgress = (fraction: number): void => this.#post({ type: 'progress', id, fraction }, []);
    switch (request.type) {
      case 'open':
        return this.#open(request, signal, onProgress);
      case 'simplify': {
        const document = this.#document(request.document);
        return { type: 'level', id, level: await document.simplify({ ...request.options, signal, onProgress }) };
      }
      case 'measure': {
        const document = this.#document(request.document);
        return { type: 'measured', id, deviation: await document.measure({ ...request.options, signal, onProgress }) };
      }
      case 'deviation-map': {
        const document = this.#document(request.document);
        return { type: 'deviation-map', id, map: await document.deviationMap({ ...request.options, signal, onProgress }) };
      }
      case 'level': {
        const document = this.#document(request.document);
        return { type: 'level', id, level: await document.level(request.targets, { signal, onProgress }) };
      }
      case 'geometry':
        return { type: 'geometry', id, geometry: await this.#document(request.document).geometry() };
      case 'write':
        return { type: 'written', id, written: await this.#document(request.document).write(request.options) };
      case 'write-progressive':
        return { type: 'progressive', id, bytes: await this.#document(request.document).writeProgressive(request.options) };
      case 'simplify-arrays':
        await init();
        return {
          type: 'simplified',
          id,
          mesh: await simplifyInSteps(request.mesh, { ...request.options, signal, onProgress }),
        };
      case 'external-files':
        await init();
        return { type: 'external-files', id, uris: externalFiles(request.bytes) };
    }
  }

  // Three steps that can be told apart: reading the files, loading the engine, and parsing, which is one call.
  async #open(
    { id, files }: AnsweredRequest & { type: 'open' },
    signal: AbortSignal,
    onProgress: (fraction: number) => void,
  ): Promise<Answer> {
    const loading = init();
    // Without this a failure to load would be reported as unhandled while the files are still being read.
    loading.catch(() => {});
    const loaded = await loadFiles(files);
    signal.throwIfAborted();
    onProgress(0.3);
    await loading;
    signal.throwIfAborted();
    onProgress(0.4);
    const document = await openFiles(loaded, signal);
    if (signal.aborted) document.dispose();
    signal.throwIfAborted();
    onProgress(1);
    this.#lastDocument += 1;
    this.#documents.set(this.#lastDocument, document);
    return { type: 'opened', id, document: this.#lastDocument, summary: document.summary };
  }

  #document(number: number): Document {
    const document = this.#documents.get(number);
    if (document === undefined) throw new DecimeshError('disposed', 'the document was disposed');
    return document;
  }

  #dispose(number: number): void {
    const document = this.#documents.get(number);
    this.#documents.delete(number);
    document?.dispose();
  }
}

/** The buffers in `answer`, all made for it alone, each once. */
function buffersOf(answer: Answer): Transferable[] {
  const arrays: Array<{ readonly buffer: ArrayBufferLike }> = [];
  switch (answer.type) {
    case 'geometry':
      for (const { indices } of answer.geometry.groups) arrays.push(indices);
      for (const { positions, attributes } of answer.geometry.wedgeSets) {
        arrays.push(positions, ...Object.values(attributes).map(({ values }) => values));
      }
      break;
    case 'deviation-map':
      for (const { distances, surroundings } of answer.map.wedgeSets) arrays.push(distances, surroundings);
      break;
    case 'written':
      arrays.push(answer.written.bytes, ...answer.written.files.map(({ bytes }) => bytes));
      break;
    case 'progressive':
      arrays.push(answer.bytes);
      break;
    case 'simplified': {
      const { positions, indices, vertexMap, attributes } = answer.mesh;
      arrays.push(positions, indices, vertexMap, ...Object.values(attributes));
      break;
    }
    default:
      break;
  }
  return [...new Set(arrays.map(({ buffer }) => buffer as ArrayBuffer))];
}
