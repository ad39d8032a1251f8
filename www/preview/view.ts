// The page's side of the 3D view: starts it, in a worker where the browser can draw there, and passes on what happens.
import type { LevelGeometry } from 'decimesh';
import type { PaintReply, PaintRequest } from '../paint/protocol.ts';
import { NO_CONTENTS } from './no-contents.ts';
import type { CameraMove, EdgeCounts, Insets, PlainFile, ViewContents, ViewReply, ViewRequest, ViewSettings, ViewTheme } from './protocol.ts';

/** What the page is told. */
export interface ViewEvents {
  /** There is no WebGL2, or the view cannot run; everything else goes on. */
  onUnavailable(reason: string): void;
  onContextLost(): void;
  onContextRestored(): void;
  /** Another model is on its way to the screen. */
  onContents(contents: ViewContents): void;
  /** The classes of edges of what is drawn, when they are drawn; else null. */
  onEdges(counts: EdgeCounts | null): void;
  /** A stroke of the brush has ended. */
  onPaint(reply: PaintReply): void;
  /** Pixels of the canvas that panels cover have changed. */
  onInsets(insets: Insets): void;
}

/** The canvas has this attribute while its picture is the one that was asked for last and nothing in it moves. */
const STILL = 'data-still';

type Loaded = Pick<ViewReply & { type: 'loaded' }, 'contents' | 'file'>;

interface Pending {
  resolve(loaded: Loaded): void;
  reject(reason: Error): void;
}

/** The view as calls. All of them return at once; nothing is drawn on this thread if it can be helped. */
export class View {
  private send: (request: ViewRequest, transfer: Transferable[]) => void = () => {};
  private readonly pending = new Map<number, Pending>();
  private readonly drawing = new Map<number, () => void>();
  private unavailable = false;
  private requests = 0;
  private lastId = 0;
  private insets: Insets = { top: 0, right: 0, bottom: 0, left: 0 };
  private margins: Insets = this.insets;
  /** What was set last, as text. */
  private settings = '';
  private moves: CameraMove[] = [];
  private readonly events: ViewEvents;
  private readonly canvas: HTMLCanvasElement;

  constructor(canvas: HTMLCanvasElement, events: ViewEvents, reducedMotion: boolean) {
    this.canvas = canvas;
    this.events = events;
    this.start(reducedMotion);
    this.watchSize();
    this.watchPixelRatio();
  }

  /** Parses `bytes`, a GLB, which are transferred; resolves to a model that can be shown, or rejects with the reason. */
  async load(bytes: Uint8Array): Promise<PreparedModel> {
    return (await this.prepare(bytes, [bytes.buffer as ArrayBuffer])).model;
  }

  /** The same for a file as it is, which is read by the view; null if that is no plain GLB or cannot be shown. */
  async loadPlain(content: Blob): Promise<PlainModel | null> {
    try {
      const { model, file } = await this.prepare(content, []);
      return file && { ...file, model };
    } catch {
      return null;
    }
  }

  private async prepare(content: Uint8Array | Blob, transfer: Transferable[]): Promise<{ model: PreparedModel; file: PlainFile | null }> {
    if (this.unavailable) return { model: { animations: [], show: () => Promise.resolve(), discard: () => {} }, file: null };
    const id = (this.lastId += 1);
    const { contents, file } = await new Promise<Loaded>((resolve, reject) => {
      this.pending.set(id, { resolve, reject });
      this.post({ type: 'load', id, content }, transfer);
    });
    const model = {
      animations: contents.animations,
      show: () => {
        this.events.onContents(contents);
        return this.drawn((drawing) => this.post({ type: 'show', id: drawing, model: id }));
      },
      discard: () => this.post({ type: 'discard', id }),
    };
    return { model, file };
  }

  /**
   * Swaps the geometry of the model shown, whose arrays are transferred; null is the file's own. Resolves when it is
   * drawn: whoever waits for that does not send more than the graphics card can take.
   */
  setLevel(geometry: LevelGeometry | null): Promise<void> {
    const arrays = geometry === null ? [] : [
      ...geometry.groups.map((group) => group.indices),
      ...geometry.wedgeSets.flatMap((set) => [set.positions, ...Object.values(set.attributes).map(({ values }) => values)]),
    ];
    const buffers = [...new Set(arrays.map((array) => array.buffer as ArrayBuffer))];
    return this.drawn((id) => this.post({ type: 'level', id, geometry }, buffers));
  }

  /** Tells how far each vertex of the level shown is from the original; the arrays are transferred. */
  setDeviation(wedgeSets: readonly Float32Array[], limit: number): void {
    const buffers = [...new Set(wedgeSets.map(({ buffer }) => buffer as ArrayBuffer))];
    this.post({ type: 'deviation', wedgeSets, limit }, buffers);
  }

  setSettings(given: ViewSettings): void {
    const { surface, wireframe, edgeClasses, playing, animation, comparing, layout, split, turntable, lamp, morphs } = given;
    const settings = { surface, wireframe, edgeClasses, playing, animation, comparing, layout, split, turntable, lamp, morphs };
    // What changes nothing is not drawn: another model has often just the settings of the one before.
    const key = JSON.stringify(settings);
    if (key === this.settings) return;
    this.settings = key;
    this.post({ type: 'settings', settings });
  }

  /** Paints on the original; arrays in it are transferred. */
  paint(request: PaintRequest): void {
    this.post({ type: 'paint', paint: request }, 'painted' in request ? [request.painted.buffer] : []);
  }

  /** Whether nothing can be seen. */
  get isUnavailable(): boolean {
    return this.unavailable;
  }

  setTheme(theme: ViewTheme): void {
    this.post({ type: 'theme', theme });
  }

  /** Pixels of the canvas that panels cover, and within which margins the model is centred. */
  setInsets(insets: Insets, margins: Insets): void {
    if (!sameInsets(insets, this.insets)) {
      this.insets = insets;
      this.events.onInsets(insets);
    }
    if (sameInsets(margins, this.margins)) return;
    this.margins = margins;
    this.resize();
  }

  /** Moves the camera with the next frame, together with what else comes until then. */
  move(move: CameraMove): void {
    if (this.moves.length === 0) {
      requestAnimationFrame(() => {
        this.post({ type: 'camera', moves: this.moves });
        this.moves = [];
      });
    }
    this.moves.push(move);
  }

  private drawn(ask: (id: number) => void): Promise<void> {
    if (this.unavailable) return Promise.resolve();
    const id = (this.lastId += 1);
    return new Promise((resolve) => {
      this.drawing.set(id, resolve);
      ask(id);
    });
  }

  private start(reducedMotion: boolean): void {
    if (typeof this.canvas.transferControlToOffscreen === 'function') {
      const worker = new Worker(new URL('./view-worker.ts', import.meta.url), { type: 'module', name: 'decimesh view' });
      worker.addEventListener('message', (event: MessageEvent<ViewReply>) => this.receive(event.data));
      worker.addEventListener('error', (event) => this.receive({ type: 'failed', id: null, message: event.message || 'its worker failed' }));
      this.send = (request, transfer) => worker.postMessage(request, transfer);
      const canvas = this.canvas.transferControlToOffscreen();
      this.post({ type: 'start', canvas, reducedMotion }, [canvas]);
      return;
    }
    // Without a canvas for workers the same code runs here; requests wait until it is there.
    const host = import('./view-host.ts').then(({ createViewHost }) => createViewHost((reply) => this.receive(reply)));
    this.send = (request) => {
      host.then((handle) => handle(request), (error: unknown) => this.receive({ type: 'failed', id: null, message: String(error) }));
    };
    this.post({ type: 'start', canvas: this.canvas, reducedMotion });
  }

  private post(request: ViewRequest, transfer: Transferable[] = []): void {
    if (this.unavailable) return;
    this.requests += 1;
    this.canvas.removeAttribute(STILL);
    this.send(request, transfer);
  }

  private receive(reply: ViewReply): void {
    switch (reply.type) {
      case 'loaded':
        this.pending.get(reply.id)?.resolve(reply);
        this.pending.delete(reply.id);
        break;
      case 'drawn':
        this.drawing.get(reply.id)?.();
        this.drawing.delete(reply.id);
        break;
      case 'still':
        if (reply.requests === this.requests) this.canvas.setAttribute(STILL, '');
        break;
      case 'failed':
        if (reply.id === null) this.giveUp(reply.message);
        else {
          this.pending.get(reply.id)?.reject(new Error(reply.message));
          this.pending.delete(reply.id);
        }
        break;
      case 'edges':
        this.events.onEdges(reply.counts);
        break;
      case 'paint':
        this.events.onPaint(reply.paint);
        break;
      case 'context-lost':
        this.events.onContextLost();
        break;
      case 'context-restored':
        this.events.onContextRestored();
    }
  }

  private giveUp(reason: string): void {
    if (this.unavailable) return;
    this.unavailable = true;
    for (const { resolve } of this.pending.values()) resolve({ contents: NO_CONTENTS, file: null });
    for (const resolve of this.drawing.values()) resolve();
    this.pending.clear();
    this.drawing.clear();
    this.events.onUnavailable(reason);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.post({ type: 'resize', size: { width, height, pixelRatio: devicePixelRatio }, insets: this.margins });
  }

  private watchSize(): void {
    const observer = new ResizeObserver(() => this.resize());
    try {
      // In pixels of the screen: another scale is another size, too.
      observer.observe(this.canvas, { box: 'device-pixel-content-box' });
    } catch {
      // Safari knows CSS pixels only.
      observer.observe(this.canvas);
    }
  }

  private watchPixelRatio(): void {
    const changed = (): void => {
      this.resize();
      this.watchPixelRatio();
    };
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener('change', changed, { once: true });
  }
}

const sameInsets = (one: Insets, other: Insets): boolean =>
  one.top === other.top && one.right === other.right && one.bottom === other.bottom && one.left === other.left;

/** A plain GLB that the view has parsed, and what it says of itself. */
export interface PlainModel extends PlainFile {
  readonly model: PreparedModel;
}

/** A model that the view has parsed. Either `show` or `discard` is to be called, once. */
export interface PreparedModel {
  /** Names, in file order. */
  readonly animations: readonly string[];
  /** Resolves when it is drawn. */
  show(): Promise<void>;
  discard(): void;
}
