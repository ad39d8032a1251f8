// Protection by painting: from taking up the brush to putting it down. Each stroke is a state of the painted vertices,
// whose number is a choice like the others: it can be undone, and another one is another run.
import { effect } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
import { render } from 'preact';
import type { DocumentSummary } from 'decimesh/worker';
import { describeError } from '../describe_error.ts';
import type { View } from '../preview/view.ts';
import type { Session, Store } from '../session.ts';
import * as transitions from '../state.ts';
import type { Source, State } from '../state.ts';
import { Hand } from './hand.ts';
import { PaintHistory, UNPAINTED } from './history.ts';
import { FIRST_BRUSH } from './mode.ts';
import type { PaintMode } from './mode.ts';
import { PaintBar } from './paint-bar.tsx';
import type { PaintReply, PaintedPart } from './protocol.ts';

/** What is painted on one model. */
interface Canvas {
  /** Tells it from other models. */
  readonly source: Source;
  readonly summary: DocumentSummary;
  readonly history: PaintHistory;
}

/** The brush of the page; made when it is asked for first. */
export class Painting {
  private canvasOf: Canvas | null = null;
  private hand: Hand | null = null;
  private brush = FIRST_BRUSH;
  private readonly host = document.createElement('div');
  /** What the view shows as painted, and the number that its answers to that have. */
  private shown = UNPAINTED;
  private epoch = 0;

  constructor(
    private readonly state: ReadonlySignal<State>,
    private readonly store: Store,
    private readonly session: Session,
    private readonly view: View,
    private readonly canvas: HTMLElement,
  ) {
    // After the view for Tab, before the rest.
    canvas.after(this.host);
    session.painted = (number) => (number === UNPAINTED ? null : (this.canvasOf?.history.at(number) ?? null));
    effect(() => this.follow(state.value));
  }

  /** Takes the brush up. */
  start(): void {
    const { summary } = this.session;
    const { model } = this.store.value;
    if (summary === null || model === null) return;
    if (this.canvasOf?.source !== model.source) {
      this.canvasOf = { source: model.source, summary, history: new PaintHistory(summary.wedgeSets.reduce((sum, { vertices }) => sum + vertices, 0)) };
    }
    this.store.update((now) => transitions.paintChanged(now, this.brush));
    this.canvas.focus({ preventScroll: true });
  }

  /** The view tells what is painted, and what a stroke has changed. */
  received(reply: PaintReply): void {
    if (reply.type === 'failed') {
      this.store.update((now) => transitions.failed(transitions.paintChanged(now, null), describeError(new Error(reply.message))));
      return;
    }
    const { epoch, change, count } = reply;
    const { model, run } = this.store.value;
    // What was undone meanwhile, be it without the brush in hand, is not what was painted on.
    if (model === null || this.canvasOf === null || epoch !== this.epoch || run.paint !== this.shown) return;
    this.set({ count });
    if (change === null) return;
    this.shown = this.canvasOf.history.add(run.paint, change);
    const paint = this.shown;
    this.store.update((now) => transitions.runChanged(now, { paint }));
    const steps = [...(this.store.value.model?.undo ?? []), ...(this.store.value.model?.redo ?? [])];
    this.canvasOf.history.keep([paint, ...steps.map(({ run: { paint: state } }) => state)]);
  }

  private follow(now: State): void {
    const { paint } = now;
    // Another model has another history.
    if (this.canvasOf !== null && now.model?.source !== this.canvasOf.source) this.canvasOf = null;
    if (paint === null) this.put();
    else {
      this.brush = paint;
      if (this.hand === null) this.take();
      else if (now.run.paint !== this.shown) this.show(now.run.paint);
      const { top, right, bottom, left } = now.insets;
      const { clientWidth, clientHeight } = this.canvas;
      this.hand?.rest((left + clientWidth - right) / 2, (top + clientHeight - bottom) / 2);
    }
    const actions = { set: this.set, clear: this.clear, leave: this.leave };
    render(paint === null ? null : <PaintBar mode={paint} insets={now.insets} painted={now.run.paint !== UNPAINTED} actions={actions} />, this.host);
  }

  private take(): void {
    const { canvasOf, view } = this;
    if (canvasOf === null) return;
    this.hand = new Hand(this.canvas, () => this.brush, {
      paint: (x, y) => view.paint({ type: 'dab', brush: { x, y, radius: this.brush.radius, strength: this.brush.strength / 10, erase: this.brush.erase } }),
      lift: () => view.paint({ type: 'end' }),
      spoil: () => view.paint({ type: 'cancel' }),
      move: (move) => view.move(move),
      set: this.set,
      leave: this.leave,
    });
    this.epoch += 1;
    this.shown = this.state.peek().run.paint;
    view.paint({ type: 'start', parts: partsOf(canvasOf.summary), painted: canvasOf.history.at(this.shown).slice(), epoch: this.epoch });
  }

  private put(): void {
    if (this.hand === null) return;
    this.hand.put();
    this.hand = null;
    this.view.paint({ type: 'stop' });
  }

  /** Undo, redo or a reset has gone to another state. */
  private show(number: number): void {
    if (this.canvasOf === null) return;
    this.epoch += 1;
    this.shown = number;
    this.view.paint({ type: 'set', painted: this.canvasOf.history.at(number).slice(), epoch: this.epoch });
  }

  private readonly set = (change: Partial<PaintMode>): void =>
    this.store.update((now) => (now.paint === null ? now : transitions.paintChanged(now, { ...now.paint, ...change })));

  private readonly clear = (): void => this.store.update((now) => transitions.runChanged(now, { paint: UNPAINTED }));

  private readonly leave = (): void => {
    this.store.update((now) => transitions.paintChanged(now, null));
    this.canvas.focus({ preventScroll: true });
  };
}

/** Where the vertices of each primitive are: those of a wedge set follow those of the set before. */
function partsOf({ groups, wedgeSets }: DocumentSummary): PaintedPart[] {
  const starts: number[] = [];
  wedgeSets.reduce((start, { vertices }) => {
    starts.push(start);
    return start + vertices;
  }, 0);
  return groups.map(({ mesh, primitive, wedgeSet }) => ({ mesh, primitive, start: starts[wedgeSet] ?? 0, vertices: wedgeSets[wedgeSet]?.vertices ?? 0 }));
}
