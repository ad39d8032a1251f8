// The view in a worker: messages in, messages out.
import type { ViewRequest } from './protocol.ts';
import { createViewHost } from './view-host.ts';

const handle = createViewHost((reply) => postMessage(reply));
addEventListener('message', (event: MessageEvent<ViewRequest>) => handle(event.data));
