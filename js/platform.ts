// What differs between Node and browsers, and nothing else.

interface NodeGlobals {
  readonly process?: { readonly versions?: { readonly node?: string } };
  readonly setImmediate?: (callback: () => void) => unknown;
}

const globals = globalThis as NodeGlobals;

/** Whether this runs on Node. */
export const isNode = typeof globals.process?.versions?.node === 'string';

// The few parts of Node's modules that are used, so that the package needs no types of Node.
interface NodeModules {
  'node:fs/promises': { readFile(path: string | URL): Promise<Uint8Array<ArrayBuffer>> };
  'node:worker_threads': {
    readonly parentPort: NodePort | null;
    readonly Worker: new (script: URL, options: { execArgv: string[] }) => NodeWorker;
  };
}

/** A message port of `node:worker_threads`. */
export interface NodePort {
  postMessage(message: unknown, transfer?: readonly Transferable[]): void;
  on(event: 'message', listener: (message: unknown) => void): unknown;
}

/** A worker of `node:worker_threads`. */
export interface NodeWorker {
  postMessage(message: unknown, transfer?: readonly Transferable[]): void;
  on(event: 'message' | 'messageerror' | 'error' | 'exit', listener: (value: unknown) => void): unknown;
  terminate(): Promise<number>;
  ref(): void;
  unref(): void;
}

/** A module of Node; call it on Node only. */
export async function importNode<Name extends keyof NodeModules>(name: Name): Promise<NodeModules[Name]> {
  // Not a literal, so that bundlers for browsers leave it alone.
  const specifier: string = name;
  return (await import(/* @vite-ignore */ /* webpackIgnore: true */ specifier)) as NodeModules[Name];
}

const waiting: Array<() => void> = [];
let channel: MessageChannel | undefined;

/**
 * Resolves after the events that are due now (messages, input, painting) had their turn.
 *
 * Timers would wait 4 ms in browsers, and `scheduler.yield` goes before posted messages, among them the one that
 * cancels; a posted message of our own queues behind those.
 */
export function yieldToEvents(): Promise<void> {
  const { setImmediate } = globals;
  if (setImmediate !== undefined) return new Promise((resolve) => void setImmediate(resolve));
  if (channel === undefined) {
    channel = new MessageChannel();
    channel.port1.onmessage = () => waiting.shift()?.();
  }
  const { port2 } = channel;
  return new Promise((resolve) => {
    waiting.push(resolve);
    port2.postMessage(null);
  });
}
