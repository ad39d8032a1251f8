// Reads a progressive mesh as it arrives, away from the page, and sends each level when the one before is on screen.
import { readProgressive } from 'decimesh/progressive';
import type { Description, ProgressiveMesh } from 'decimesh/progressive';
import type { LevelGeometry } from 'decimesh';
import { Connection } from './connection.ts';
import type { ReaderReply, ReaderRequest } from './protocol.ts';
import { onTheWay } from './transition.ts';

/** Shares of the way between two levels that are shown. */
const STEPS = [0.15, 0.32, 0.5, 0.68, 0.85];

/** Levels of more triangles follow each other at once: every step takes all of their vertices to the graphics card. */
const MOST_SMOOTH = 80_000;

/** So do those whose last picture took longer than this, in milliseconds: nothing on the way would look smooth. */
const LONG_PICTURE = 60;

/** Milliseconds between two messages about what has come. */
const PROGRESS_TIME = 100;

let connection: Connection | null = null;
let drawn: (() => void) | null = null;
/** Pausing may be asked for before there is a connection. */
let paused = false;

addEventListener('message', ({ data }: MessageEvent<ReaderRequest>) => {
  if (data.type === 'start') void start(data);
  else if (data.type === 'drawn') drawn?.();
  else {
    paused = data.type === 'pause';
    if (paused) connection?.pause();
    else connection?.resume();
  }
});

async function start({ bytes, bytesASecond, smooth }: Extract<ReaderRequest, { type: 'start' }>): Promise<void> {
  try {
    // Nothing is on screen until something has come.
    for await (const { description } of readProgressive(bytes)) {
      await show(nothingOf(description));
      break;
    }
    connection = new Connection(bytes, bytesASecond);
    if (paused) connection.pause();
    const timer = setInterval(() => tell('progress'), PROGRESS_TIME);
    const screen = new Screen(smooth);
    for await (const mesh of readProgressive(connection)) screen.offer(mesh);
    await screen.settled();
    clearInterval(timer);
    tell('arrived');
  } catch (error) {
    fail(error);
  }
}

/** The page ends this worker with that. */
function fail(error: unknown): void {
  const { code = 'internal', message = String(error) } = error as { code?: string; message?: string };
  post({ type: 'failed', code, message });
}

/** Shows the finest level there is, as often as pictures can be drawn. */
class Screen {
  private mesh: ProgressiveMesh | null = null;
  private shown = -1;
  /** Milliseconds that the last picture took. */
  private picture = 0;
  private showing: Promise<void> | null = null;

  constructor(private readonly smooth: boolean) {}

  offer(mesh: ProgressiveMesh): void {
    this.mesh = mesh;
    // Nobody may be waiting for it.
    this.showing ??= this.catchUp(mesh).catch(fail).finally(() => (this.showing = null));
  }

  /** Resolves when the finest level is on screen. */
  async settled(): Promise<void> {
    while (this.showing !== null) await this.showing;
    // Complete, and not yet shown as the whole.
    if (this.mesh !== null) await show(this.mesh.geometry());
  }

  private async catchUp(mesh: ProgressiveMesh): Promise<void> {
    while (this.shown < mesh.splits) {
      const { splits } = mesh;
      const level = mesh.geometry(splits);
      if (this.smooth && this.shown >= 0 && this.picture <= LONG_PICTURE && trianglesOf(level) <= MOST_SMOOTH) {
        const morph = mesh.geomorph(this.shown, splits);
        for (const share of STEPS) await show(onTheWay(morph, share));
      }
      const start = performance.now();
      await show(level);
      this.picture = performance.now() - start;
      this.shown = splits;
    }
  }
}

/** The mesh without a triangle; its attributes are there, as materials are compiled for them. */
const nothingOf = ({ groups, wedgeSets }: Description): LevelGeometry => ({
  groups: groups.map(({ mesh, primitive, wedgeSet }) => ({ mesh, primitive, wedgeSet, indices: new Uint32Array() })),
  wedgeSets: wedgeSets.map(({ attributes }) => ({
    positions: new Float32Array(),
    attributes: Object.fromEntries(attributes.map(({ name, components }) => [name, { components, values: new Float32Array() }])),
  })),
});

const trianglesOf = ({ groups }: LevelGeometry): number => groups.reduce((sum, { indices }) => sum + indices.length / 3, 0);

/** Resolves when it is on screen. */
function show(geometry: LevelGeometry): Promise<void> {
  const arrays = [
    ...geometry.groups.map(({ indices }) => indices),
    ...geometry.wedgeSets.flatMap(({ positions, attributes }) => [positions, ...Object.values(attributes).map(({ values }) => values)]),
  ];
  return new Promise((resolve) => {
    drawn = resolve;
    post({ type: 'show', geometry, triangles: trianglesOf(geometry), ...standing() }, [...new Set(arrays.map(({ buffer }) => buffer as ArrayBuffer))]);
  });
}

const standing = (): { elapsed: number; received: number } => ({ elapsed: connection?.elapsed ?? 0, received: connection?.received ?? 0 });

const tell = (type: 'progress' | 'arrived'): void => post({ type, ...standing() });

const post = (reply: ReaderReply, transfer: Transferable[] = []): void => postMessage(reply, { transfer });
