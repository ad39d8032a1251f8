// Serves a Viewer to requests, in a worker or on the page itself.
import { contentsOf } from './contents.ts';
import { disposeModel, loadModel } from './load.ts';
import type { LoadedModel } from './load.ts';
import type { Painter } from '../paint/painter.ts';
import type { PaintRequest } from '../paint/protocol.ts';
import { readScene } from '../scene.ts';
import { readPlainGlb } from './plain.ts';
import type { EdgeCounts, PlainFile, ViewReply, ViewRequest } from './protocol.ts';
import { Viewer } from './viewer.ts';

/** Makes a function that takes requests, in order; `reply` gets the answers. */
export function createViewHost(reply: (reply: ViewReply) => void): (request: ViewRequest) => void {
  let viewer: Viewer | null = null;
  const loaded = new Map<number, LoadedModel>();
  const discarded = new Set<number>();

  // Most levels have no edges drawn: that is told once.
  let edgesTold = false;
  const tellEdges = (counts: EdgeCounts | null): void => {
    if (counts !== null || edgesTold) reply({ type: 'edges', counts });
    edgesTold = counts !== null;
  };

  const load = async (id: number, content: Uint8Array | Blob): Promise<void> => {
    try {
      let file: PlainFile | null = null;
      let bytes = content;
      if (bytes instanceof Blob) {
        const plain = await readPlainGlb(bytes);
        bytes = plain.bytes;
        file = { parts: plain.parts, scene: readScene(plain.bytes) };
      }
      const model = await loadModel(bytes);
      if (discarded.delete(id)) return disposeModel(model);
      loaded.set(id, model);
      reply({ type: 'loaded', id, contents: contentsOf(model), file });
    } catch (error) {
      if (!discarded.delete(id)) reply({ type: 'failed', id, message: messageOf(error) });
    }
  };

  const discard = (id: number): void => {
    const model = loaded.get(id);
    if (model === undefined) discarded.add(id);
    else disposeModel(model);
    loaded.delete(id);
  };

  const show = (id: number): void => {
    const model = loaded.get(id);
    loaded.delete(id);
    if (model === undefined) return;
    painter?.dispose();
    painter = null;
    viewer?.show(model);
  };

  const replyDrawn = async (id: number): Promise<void> => {
    await viewer?.drawn();
    reply({ type: 'drawn', id });
  };

  let painter: Painter | null = null;
  let painting: Promise<void> = Promise.resolve();
  // One after the other: the code is there only when the first has been taken.
  const paint = (request: PaintRequest): void => {
    const model = viewer?.easel?.model;
    painting = painting
      .then(async () => {
        if (painter !== null || request.type !== 'start') return painter?.take(request);
        const { Painter } = await import('../paint/painter.ts');
        // Meanwhile another may have come, which is not what was to be painted on.
        if (model !== undefined && model === viewer?.easel?.model) painter = new Painter(() => viewer?.easel ?? null, (told) => reply({ type: 'paint', paint: told }), request, model);
      })
      .catch((error: unknown) => reply({ type: 'paint', paint: { type: 'failed', message: messageOf(error) } }));
  };

  let requests = 0;
  const replyStill = async (): Promise<void> => {
    const after = requests;
    const isLast = (): boolean => requests === after;
    await painting;
    if ((await viewer?.still(isLast)) === true) reply({ type: 'still', requests: after });
  };

  const take = (request: ViewRequest): void => {
    switch (request.type) {
      case 'start':
        try {
          viewer = new Viewer(
            request.canvas,
            {
              onContextLost: () => reply({ type: 'context-lost' }),
              onContextRestored: () => reply({ type: 'context-restored' }),
              onEdges: tellEdges,
            },
            request.reducedMotion,
          );
        } catch (error) {
          reply({ type: 'failed', id: null, message: messageOf(error) });
        }
        break;
      case 'load':
        void load(request.id, request.content);
        break;
      case 'show':
        show(request.model);
        void replyDrawn(request.id);
        break;
      case 'discard':
        discard(request.id);
        break;
      case 'level':
        viewer?.setLevel(request.geometry);
        void replyDrawn(request.id);
        break;
      case 'deviation':
        viewer?.setDeviation(request.wedgeSets, request.limit);
        break;
      case 'paint':
        paint(request.paint);
        break;
      case 'settings':
        viewer?.setSettings(request.settings);
        break;
      case 'theme':
        viewer?.setTheme(request.theme);
        break;
      case 'resize':
        viewer?.resize(request.size, request.insets);
        break;
      case 'camera':
        viewer?.moveCamera(request.moves);
    }
  };

  return (request) => {
    requests += 1;
    take(request);
    void replyStill();
  };
}

const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));
