// What is alive on the JavaScript heaps of a page and its workers, and apart from it what the engine compiles of the code.
// Functions that run often are compiled again and better, round after round: that grows and is not given back soon.

/** Resolves to a function that collects garbage and resolves to the bytes alive on all heaps, arrays' contents included: `code`, what was compiled, and `rest`. */
export async function heapMeter(page) {
  const session = await page.context().newCDPSession(page);
  const heaps = [heapOf((method, params) => session.send(method, params), (event, act) => session.on(event, act))];
  session.on('Target.attachedToTarget', ({ sessionId, targetInfo }) => {
    if (targetInfo.type === 'worker') heaps.push(workerHeap(session, sessionId));
  });
  await session.send('Target.setAutoAttach', { autoAttach: true, waitForDebuggerOnStart: false, flatten: false });
  return async () => {
    const total = { code: 0, rest: 0 };
    for (const measure of heaps) {
      const { code, rest } = await measure();
      total.code += code;
      total.rest += rest;
    }
    return total;
  };
}

/** Speaks to a worker through its page. */
function workerHeap(session, sessionId) {
  const waiting = new Map();
  const listeners = new Map();
  let last = 0;
  session.on('Target.receivedMessageFromTarget', (received) => {
    if (received.sessionId !== sessionId) return;
    const { id, method, params, result } = JSON.parse(received.message);
    if (id === undefined) listeners.get(method)?.(params);
    else waiting.get(id)?.(result);
    waiting.delete(id);
  });
  const send = (method, params = {}) =>
    new Promise((resolve, reject) => {
      last += 1;
      waiting.set(last, resolve);
      session.send('Target.sendMessageToTarget', { sessionId, message: JSON.stringify({ id: last, method, params }) }).catch(reject);
    });
  return heapOf(send, (event, act) => listeners.set(event, act));
}

function heapOf(send, on) {
  let chunks = [];
  on('HeapProfiler.addHeapSnapshotChunk', ({ chunk }) => chunks.push(chunk));
  return async () => {
    chunks = [];
    await send('HeapProfiler.enable');
    await send('HeapProfiler.collectGarbage');
    await send('HeapProfiler.takeHeapSnapshot', { reportProgress: false });
    await send('HeapProfiler.disable');
    const { snapshot: { meta }, nodes } = JSON.parse(chunks.join(''));
    chunks = [];
    const [width, type, size] = [meta.node_fields.length, meta.node_fields.indexOf('type'), meta.node_fields.indexOf('self_size')];
    const code = meta.node_types[type].indexOf('code');
    const bytes = { code: 0, rest: 0 };
    for (let node = 0; node < nodes.length; node += width) bytes[nodes[node + type] === code ? 'code' : 'rest'] += nodes[node + size];
    return bytes;
  };
}
