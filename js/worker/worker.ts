// The worker's entry: joins a session to the port it was started with, in browsers and on Node.

import { importNode, isNode } from '../platform.js';
import type { Request } from './protocol.js';
import { Session } from './session.js';

if (isNode) {
  // Messages wait in the port until there is a listener.
  const { parentPort } = await importNode('node:worker_threads');
  if (parentPort === null) throw new Error('worker.js is for workers only; import decimesh/worker instead');
  const session = new Session((reply, transfer) => parentPort.postMessage(reply, transfer));
  parentPort.on('message', (request) => session.receive(request as Request));
} else {
  // Before anything asynchronous: a browser delivers messages once the script has run, listener or not.
  const scope = self as unknown as DedicatedWorkerGlobalScope;
  const session = new Session((reply, transfer) => scope.postMessage(reply, [...transfer]));
  scope.addEventListener('message', (event: MessageEvent<Request>) => session.receive(event.data));
}
