// A worker as the client sees it, the same for a browser's Worker and one of node:worker_threads.

import { importNode, isNode, type NodeWorker } from '../platform.js';

/** What a worker tells. */
export interface PortEvents {
  /** A message came. */
  message(data: unknown): void;
  /** The worker failed or ended; nothing more will come. */
  lost(reason: string): void;
}

/** A started worker. */
export interface Port {
  post(message: unknown, transfer: readonly Transferable[]): void;
  /** Whether the program should stay alive for its sake. Browsers do not ask. */
  keepAlive(wanted: boolean): void;
  /** Whether a File can be posted. */
  readonly takesFiles: boolean;
  terminate(): void;
}

/** Starts the worker that `make` returns, or else the package's own, and reports to `events`. */
export async function startPort(make: (() => Worker | NodeWorker) | undefined, events: PortEvents): Promise<Port> {
  const worker = make === undefined ? await startOwn() : make();
  return 'addEventListener' in worker ? browserPort(worker, events) : nodePort(worker, events);
}

async function startOwn(): Promise<Worker | NodeWorker> {
  if (isNode) {
    const threads = await importNode('node:worker_threads');
    // The program's own flags are not for the worker: `--input-type` alone would keep it from starting.
    return new threads.Worker(new URL('./worker.js', import.meta.url), { execArgv: [] });
  }
  // In this form bundlers recognise the worker and bundle it.
  return new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
}

function browserPort(worker: Worker, { message, lost }: PortEvents): Port {
  worker.addEventListener('message', (event) => message(event.data));
  worker.addEventListener('messageerror', () => lost('a message could not be read'));
  worker.addEventListener('error', (event) => {
    event.preventDefault();
    // A script that could not be loaded has no message.
    lost(event.message || 'the worker script could not be loaded');
  });
  return {
    post: (data, transfer) => worker.postMessage(data, [...transfer]),
    keepAlive: () => {},
    takesFiles: true,
    terminate: () => worker.terminate(),
  };
}

function nodePort(worker: NodeWorker, { message, lost }: PortEvents): Port {
  worker.on('message', message);
  worker.on('messageerror', () => lost('a message could not be read'));
  worker.on('error', (error) => lost(error instanceof Error ? error.message : String(error)));
  worker.on('exit', (code) => lost(`the worker ended with code ${String(code)}`));
  return {
    post: (data, transfer) => worker.postMessage(data, transfer),
    keepAlive: (wanted) => (wanted ? worker.ref() : worker.unref()),
    // Node clones a Blob but forgets that it was a File.
    takesFiles: false,
    terminate: () => void worker.terminate(),
  };
}
