// The worker and its client: for real in a worker thread, and each alone where the order of messages matters.
import { readFileSync } from 'node:fs';
import { Worker as ThreadWorker } from 'node:worker_threads';
import { afterEach, describe, expect, it, onTestFinished } from 'vitest';
import { openDocument } from 'decimesh';
import { createWorkerClient, type WorkerClient } from 'decimesh/worker';
import type { Reply, Request } from '../dist/worker/protocol.js';
import { Session } from '../dist/worker/session.js';
import { glb, gltfOf } from './support/glb.ts';
import { expectWellFormed, hills } from './support/meshes.ts';
import { runModule } from './support/program.ts';

const SIZE = 30;
const file = (size = SIZE): Uint8Array => glb(gltfOf(hills(size)));
const coded = (code: string): unknown => expect.objectContaining({ name: 'DecimeshError', code });
const workerUrl = new URL('../dist/worker/worker.js', import.meta.url);

let clients: WorkerClient[] = [];
function client(options?: Parameters<typeof createWorkerClient>[0]): WorkerClient {
  const made = createWorkerClient(options);
  clients.push(made);
  return made;
}
afterEach(() => {
  for (const made of clients) made.terminate();
  clients = [];
});

describe('in a worker thread', () => {
  it('a document gives what it gives without a worker', async () => {
    const bytes = file();
    const fractions: number[] = [];
    const remote = await client().openDocument(bytes, { onProgress: (fraction) => fractions.push(fraction) });
    using local = await openDocument(bytes);
    expect(bytes.byteLength).toBeGreaterThan(0);
    expect(remote.summary).toEqual(local.summary);
    expect(fractions.at(-1)).toBe(1);
    expect(fractions.length).toBeGreaterThan(1);

    const progress: number[] = [];
    const level = await remote.simplify({ ratio: 0.2, onProgress: (fraction) => progress.push(fraction) });
    expect(level).toEqual(await local.simplify({ ratio: 0.2 }));
    expect(progress.filter((fraction) => fraction === 1)).toEqual([1]);
    expect(progress.at(-1)).toBe(1);
    expect(await remote.level({ triangles: 900 })).toEqual(await local.level({ triangles: 900 }));
    expect(await remote.geometry()).toEqual(await local.geometry());
    expect((await remote.write()).bytes).toEqual((await local.write()).bytes);
    remote.dispose();
    await expect(remote.write()).rejects.toEqual(coded('disposed'));
  });

  it('several documents are open at once, also from Files', async () => {
    const made = client();
    const [a, b] = await Promise.all([
      made.openDocument(new File([file(4) as Uint8Array<ArrayBuffer>], 'a.glb')),
      made.openDocument([new File([file(6) as Uint8Array<ArrayBuffer>], 'b.glb')]),
    ]);
    const levels = await Promise.all([a.simplify({ ratio: 0.5 }), b.simplify({ ratio: 0.5 })]);
    expect(a.summary.triangles).toBe(32);
    expect(b.summary.triangles).toBe(72);
    expect(levels[0].triangles).toBeLessThanOrEqual(16);
    expect(levels[1].triangles).toBeGreaterThan(16);
  });

  it('arrays are simplified and the input is kept', async () => {
    const mesh = hills(SIZE);
    const small = await client().simplify(mesh, { ratio: 0.1 });
    expectWellFormed(small);
    expect(mesh.positions.length).toBe(3 * (SIZE + 1) ** 2);
    expect(small.attributes['uv']).toHaveLength((2 * small.positions.length) / 3);
  });

  it('names the files that a .gltf needs', async () => {
    const { json } = gltfOf(hills(2));
    json.buffers[0]!.uri = 'a%20b.bin';
    expect(await client().externalFiles(new TextEncoder().encode(JSON.stringify(json)))).toEqual(['a%20b.bin']);
  });

  it('errors keep their code and place', async () => {
    const made = client();
    const opening = made.openDocument([{ name: 'a.obj', bytes: new TextEncoder().encode('v 0 0 0\nf 1 2 9\n') }]);
    await expect(opening).rejects.toEqual(coded('out-of-range'));
    await expect(opening).rejects.toMatchObject({ where: 'a.obj:2', message: expect.stringMatching(/./) });
    const document = await made.openDocument(file(4));
    await expect(document.simplify({ ratio: 7 })).rejects.toMatchObject({ code: 'invalid-argument', where: 'ratio' });
    await expect(document.simplify({ signal: {} as AbortSignal })).rejects.toMatchObject({ where: 'signal' });
  });

  it('an abort rejects at once, the worker stops, and the document goes on with its former level', async () => {
    const document = await client().openDocument(file(400));
    const former = await document.simplify({ error: '0.01%' });
    const controller = new AbortController();
    const fractions: number[] = [];
    const run = document.simplify({
      triangles: 10,
      signal: controller.signal,
      onProgress: (fraction) => {
        fractions.push(fraction);
        if (!controller.signal.aborted) controller.abort(new Error('enough'));
      },
    });
    await expect(run).rejects.toThrow('enough');
    const aborted = performance.now();
    expect((await document.write()).report.output.triangles).toBe(former.triangles);
    // The worker answers soon, because it is not still busy with what was cancelled.
    expect(performance.now() - aborted).toBeLessThan(1000);
    const next = await document.simplify({ ratio: 0.5 });
    expect(next.triangles).toBeLessThanOrEqual(160_000);
    expect(fractions).toHaveLength(1);
  });

  it('a level is measured, with progress, and an abort stops it', async () => {
    const bytes = file();
    const remote = await client().openDocument(bytes);
    using local = await openDocument(bytes);
    await remote.simplify({ ratio: 0.2 });
    await local.simplify({ ratio: 0.2 });
    const progress: number[] = [];
    const deviation = await remote.measure({ samples: 200_000, onProgress: (fraction) => progress.push(fraction) });
    expect(deviation).toEqual(await local.measure({ samples: 200_000 }));
    expect((await remote.write()).report.deviation).toEqual(deviation);
    expect(progress.at(-1)).toBe(1);
    expect(progress.length).toBeGreaterThan(2);

    const controller = new AbortController();
    const long = remote.measure({
      samples: 1e8,
      signal: controller.signal,
      onProgress: () => controller.abort(new Error('enough')),
    });
    await expect(long).rejects.toThrow('enough');
    // It neither holds the worker up nor keeps the next one from starting.
    expect(await remote.measure({ samples: 200_000 })).toEqual(deviation);
    await expect(remote.measure({ samples: -1 })).rejects.toMatchObject({ code: 'invalid-argument', where: 'samples' });
    remote.dispose();
    await expect(remote.measure()).rejects.toEqual(coded('disposed'));
  });

  it('a callback that throws ends its run', async () => {
    const document = await client().openDocument(file(100));
    const onProgress = (): void => {
      throw new Error('from the callback');
    };
    await expect(document.simplify({ ratio: 0.1, onProgress })).rejects.toThrow('from the callback');
    expect((await document.simplify({ ratio: 0.1 })).triangles).toBeLessThanOrEqual(2000);
  });

  it('a lost worker rejects what is under way, and the next call starts another', async () => {
    const workers: ThreadWorker[] = [];
    const made = client({ worker: () => (workers.push(new ThreadWorker(workerUrl)), workers.at(-1)!) as never });
    const document = await made.openDocument(file(300));
    const run = document.simplify({ triangles: 10 });
    const lost = expect(run).rejects.toEqual(coded('worker-lost'));
    await workers[0]!.terminate();
    await lost;
    await expect(document.write()).rejects.toEqual(coded('worker-lost'));
    const again = await made.openDocument(file(4));
    expect(again.summary.triangles).toBe(32);
    expect(workers).toHaveLength(2);
  });

  it('a worker that cannot start is worker-lost', async () => {
    const made = client({ worker: () => new ThreadWorker(new URL('nowhere.js', workerUrl)) as never });
    await expect(made.openDocument(file(4))).rejects.toEqual(coded('worker-lost'));
    const throwing = client({
      worker: () => {
        throw new Error('not today');
      },
    });
    await expect(throwing.openDocument(file(4))).rejects.toThrow('not today');
  });

  it('terminate rejects what is under way and all that follows', async () => {
    const made = client();
    const document = await made.openDocument(file(300));
    const run = document.simplify({ triangles: 10 });
    made.terminate();
    await expect(run).rejects.toEqual(coded('disposed'));
    await expect(document.write()).rejects.toEqual(coded('disposed'));
    await expect(made.openDocument(file(4))).rejects.toEqual(coded('disposed'));
  });

  it('an idle worker does not keep the program alive, a busy one does', async () => {
    const { code, stdout, stderr } = await runModule(`
      import { createWorkerClient } from 'decimesh/worker';
      const client = createWorkerClient();
      client.openDocument(Buffer.from('${Buffer.from(file(4)).toString('base64')}', 'base64'))
        .then((document) => document.simplify({ ratio: 0.5 }))
        .then(({ triangles }) => console.log(triangles <= 16));
    `);
    expect({ code, stdout, stderr }).toEqual({ code: 0, stdout: 'true\n', stderr: '' });
  });
});

describe('the worker alone', () => {
  function session() {
    const sent: Array<{ reply: Reply; transfer: readonly Transferable[] }> = [];
    const waiting = new Map<number, (reply: Reply) => void>();
    const worker = new Session((reply, transfer) => {
      sent.push({ reply, transfer });
      if (reply.type !== 'progress') waiting.get(reply.id)?.(reply);
    });
    const answer = (id: number): Promise<Reply> => new Promise((resolve) => waiting.set(id, resolve));
    return { worker, sent, answer };
  }

  it('transfers every buffer of an answer once and copies none', async () => {
    const { worker, sent, answer } = session();
    const opened = answer(1);
    worker.receive({ type: 'open', id: 1, files: [{ name: 'a.glb', bytes: file(8) }] });
    expect(await opened).toMatchObject({ type: 'opened', document: 1 });
    const requests: Array<Request & { id: number }> = [
      { type: 'geometry', id: 2, document: 1 },
      { type: 'write', id: 3, document: 1, options: {} },
      { type: 'simplify-arrays', id: 4, mesh: hills(8), options: { ratio: 0.5 } },
    ];
    for (const request of requests) {
      const reply = answer(request.id);
      worker.receive(request);
      await reply;
      const { reply: last, transfer } = sent.at(-1)!;
      const buffers = new Set<unknown>();
      collectBuffers(last, buffers);
      expect(buffers.size, request.type).toBeGreaterThan(0);
      expect(new Set(transfer), request.type).toEqual(buffers);
      expect(transfer.length, request.type).toBe(buffers.size);
    }
  });

  it('answers a cancelled request once, with cancelled, and others with what they are', async () => {
    const { worker, sent, answer } = session();
    const opened = answer(1);
    worker.receive({ type: 'open', id: 1, files: [{ name: 'a.glb', bytes: file(100) }] });
    await opened;
    const [first, second] = [answer(2), answer(3)];
    worker.receive({ type: 'simplify', id: 2, document: 1, options: { triangles: 10 } });
    worker.receive({ type: 'cancel', id: 2 });
    worker.receive({ type: 'simplify', id: 3, document: 1, options: { ratio: 0.5 } });
    expect(await first).toEqual({ type: 'cancelled', id: 2 });
    expect(await second).toMatchObject({ type: 'level', id: 3 });
    worker.receive({ type: 'cancel', id: 3 });
    worker.receive({ type: 'dispose', document: 1 });
    worker.receive({ type: 'dispose', document: 1 });
    const gone = answer(4);
    worker.receive({ type: 'level', id: 4, document: 1, targets: {} });
    expect(await gone).toMatchObject({ type: 'failed', error: { code: 'disposed' } });
    expect(sent.filter(({ reply }) => reply.type !== 'progress').map(({ reply }) => reply.id)).toEqual([1, 2, 3, 4]);
  });
});

function collectBuffers(value: unknown, found: Set<unknown>): void {
  if (ArrayBuffer.isView(value)) found.add(value.buffer);
  else if (typeof value === 'object' && value !== null) for (const part of Object.values(value)) collectBuffers(part, found);
}

describe('the client alone', () => {
  /** A worker that only listens; the test speaks for it. */
  class ScriptedWorker extends EventTarget {
    readonly received: Array<{ type: string; id: number; document?: number }> = [];
    terminated = false;
    postMessage(message: { type: string; id: number }): void {
      this.received.push(message);
    }
    say(data: unknown): void {
      this.dispatchEvent(new MessageEvent('message', { data }));
    }
    terminate(): void {
      this.terminated = true;
    }
  }
  function scripted() {
    const worker = new ScriptedWorker();
    onTestFinished(() => worker.terminate());
    return { worker, made: client({ worker: () => worker as unknown as Worker }) };
  }
  const settled = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 0));
  const summary = { triangles: 1 };

  it('rejects on abort before the worker has heard of it, and frees a document that comes too late', async () => {
    const { worker, made } = scripted();
    const controller = new AbortController();
    const opening = made.openDocument(file(2), { signal: controller.signal });
    await settled();
    expect(worker.received).toMatchObject([{ type: 'open', id: 1 }]);
    controller.abort(new Error('changed my mind'));
    await expect(opening).rejects.toThrow('changed my mind');
    expect(worker.received.at(-1)).toEqual({ type: 'cancel', id: 1 });
    worker.say({ type: 'opened', id: 1, document: 5, summary });
    expect(worker.received.at(-1)).toEqual({ type: 'dispose', document: 5 });
  });

  it('drops replies and progress of what was superseded', async () => {
    const { worker, made } = scripted();
    const opening = made.openDocument(file(2));
    await settled();
    worker.say({ type: 'opened', id: 1, document: 1, summary });
    const document = await opening;
    const controller = new AbortController();
    const fractions: number[] = [];
    const first = document.simplify({ signal: controller.signal, onProgress: (fraction) => fractions.push(fraction) });
    worker.say({ type: 'progress', id: 2, fraction: 0.25 });
    controller.abort();
    const second = document.simplify({ ratio: 0.5 });
    worker.say({ type: 'progress', id: 2, fraction: 0.5 });
    worker.say({ type: 'level', id: 2, level: { triangles: 2 } });
    worker.say({ type: 'level', id: 3, level: { triangles: 3 } });
    await expect(first).rejects.toHaveProperty('name', 'AbortError');
    expect(await second).toEqual({ triangles: 3 });
    expect(fractions).toEqual([0.25]);
  });

  it('does not post callbacks or signals', async () => {
    const { worker, made } = scripted();
    void made.simplify(hills(2), { ratio: 0.5, onProgress: () => {}, signal: new AbortController().signal }).catch(() => {});
    await settled();
    expect(worker.received).toEqual([expect.objectContaining({ type: 'simplify-arrays', options: { ratio: 0.5 } })]);
  });

  it('takes an error event for the end of the worker', async () => {
    const { worker, made } = scripted();
    const opening = made.openDocument(file(2));
    await settled();
    worker.dispatchEvent(new Event('error', { cancelable: true }));
    await expect(opening).rejects.toEqual(coded('worker-lost'));
    expect(worker.terminated).toBe(true);
  });
});

it('keeps the protocol free of code', () => {
  const text = readFileSync(new URL('../dist/worker/protocol.js', import.meta.url), 'utf8');
  expect(text.replace(/^\/\/.*$/gm, '').replace('export {};', '').trim()).toBe('');
});
