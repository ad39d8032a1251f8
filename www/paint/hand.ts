// The hand that holds the brush: pointers and keys over the view while it paints, and the ring that shows where it is.
import { isTyping } from '../keys.ts';
import type { CameraMove } from '../preview/protocol.ts';
import { clamp } from '../state.ts';
import { LEAST_RADIUS, MOST_RADIUS, MOST_STRENGTH } from './mode.ts';
import type { PaintMode } from './mode.ts';

/** What the hand moves. */
export interface HandEvents {
  /** The brush is at this place of the view and paints. */
  paint(x: number, y: number): void;
  /** The stroke is done. */
  lift(): void;
  /** The stroke is taken back: a second finger came down. */
  spoil(): void;
  move(move: CameraMove): void;
  set(change: Partial<PaintMode>): void;
  leave(): void;
}

/** Pixels of dragging that an arrow key with Shift stands for. */
const TURN_STEP = 40;
/** Shares of the radius that an arrow key moves the brush. */
const STEP = 0.5;
/** What a key makes the brush larger or smaller by. */
const GROWTH = 1.25;

interface Finger {
  x: number;
  y: number;
}

/** Takes pointers and keys over `canvas` until {@link put} is called; `mode` is the brush as it is now. */
export class Hand {
  private readonly fingers = new Map<number, Finger>();
  private readonly ring = document.createElement('div');
  private readonly listening = new AbortController();
  private doing: 'nothing' | 'painting' | 'turning' = 'nothing';
  /** Nobody has moved the brush yet. */
  private resting = true;
  /** Space is down. */
  private pressing = false;
  private x = 0;
  private y = 0;

  constructor(
    private readonly canvas: HTMLElement,
    private readonly mode: () => PaintMode,
    private readonly events: HandEvents,
  ) {
    this.ring.className = 'paint-ring';
    canvas.after(this.ring);
    this.showRing();
    const { signal } = this.listening;
    // Before the camera's own: a brush in the hand is not for turning.
    const options = { capture: true, signal };
    const on = <Name extends keyof HTMLElementEventMap>(name: Name, act: (event: HTMLElementEventMap[Name]) => void): void =>
      canvas.addEventListener(
        name,
        (event) => {
          event.stopImmediatePropagation();
          act(event);
        },
        options,
      );
    on('pointerdown', (event) => this.down(event));
    on('pointermove', (event) => this.moved(event));
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'] as const) on(name, (event) => this.up(event));
    on('dblclick', () => {});
    // The page itself may have had the keys.
    for (const target of [canvas, window]) target.addEventListener('blur', () => this.release(), { signal });
    // On the way to the window, where the page's other keys are.
    document.addEventListener('keydown', (event) => this.keyDown(event), { signal });
    document.addEventListener('keyup', (event) => {
      if (event.key === ' ') this.release();
    }, { signal });
  }

  /** To be called when the brush was set. */
  showRing(): void {
    const { radius, erase } = this.mode();
    const { style } = this.ring;
    style.width = style.height = `${2 * radius}px`;
    style.translate = `${this.x - radius}px ${this.y - radius}px`;
    this.ring.classList.toggle('erasing', erase);
  }

  /** Holds the brush over this place until somebody moves it. */
  rest(x: number, y: number): void {
    if (this.resting) [this.x, this.y] = [x, y];
    this.showRing();
  }

  /** Gives pointers and keys back. */
  put(): void {
    if (this.doing === 'painting' || this.pressing) this.events.lift();
    this.listening.abort();
    this.ring.remove();
  }

  private go(x: number, y: number): void {
    this.resting = false;
    [this.x, this.y] = [clamp(x, 0, this.canvas.clientWidth), clamp(y, 0, this.canvas.clientHeight)];
    this.showRing();
    if (this.doing === 'painting' || this.pressing) this.events.paint(this.x, this.y);
  }

  private down(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.focus({ preventScroll: true });
    const first = this.fingers.size === 0;
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (first) {
      this.doing = event.button === 0 && !event.shiftKey ? 'painting' : 'turning';
      this.go(event.clientX, event.clientY);
    } else {
      if (this.doing === 'painting') this.events.spoil();
      this.doing = 'turning';
    }
  }

  private moved(event: PointerEvent): void {
    const finger = this.fingers.get(event.pointerId);
    if (finger === undefined || this.doing === 'painting') {
      this.go(event.clientX, event.clientY);
      if (finger !== undefined) [finger.x, finger.y] = [event.clientX, event.clientY];
      return;
    }
    const x = event.clientX - finger.x;
    const y = event.clientY - finger.y;
    const other = [...this.fingers].find(([id]) => id !== event.pointerId)?.[1];
    if (other === undefined) this.events.move({ kind: 'orbit', x, y });
    else {
      // Each finger tells half of the movement of their middle.
      this.events.move({ kind: 'orbit', x: x / 2, y: y / 2 });
      const before = Math.hypot(finger.x - other.x, finger.y - other.y);
      const after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      if (before > 0 && after > 0) this.events.move({ kind: 'zoom', factor: after / before });
    }
    [finger.x, finger.y] = [event.clientX, event.clientY];
  }

  private up(event: PointerEvent): void {
    if (!this.fingers.delete(event.pointerId)) return;
    if (this.doing === 'painting') this.events.lift();
    // The finger that stays down goes on turning.
    if (this.fingers.size === 0 || this.doing === 'painting') this.doing = 'nothing';
  }

  /** Space is let go of, or another control has the keys now. */
  private release(): void {
    if (!this.pressing) return;
    this.pressing = false;
    this.events.lift();
  }

  private keyDown(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]') !== null) return;
    const onView = event.target === this.canvas || event.target === document.body;
    if (!this.key(event, onView, isTyping(event.target))) return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Whether the key is one of the brush's. */
  private key({ key, shiftKey, repeat }: KeyboardEvent, onView: boolean, typing: boolean): boolean {
    const { mode, events } = this;
    if (key === 'Escape') {
      events.leave();
      return true;
    }
    if (onView && this.arrow(key, shiftKey)) return true;
    if (onView && key === ' ') {
      if (!repeat && !this.pressing) {
        this.pressing = true;
        events.paint(this.x, this.y);
      }
      return true;
    }
    if (typing) return false;
    const { radius, erase } = mode();
    if (key === ',' || key === '.') events.set({ radius: Math.round(clamp(key === '.' ? radius * GROWTH : radius / GROWTH, LEAST_RADIUS, MOST_RADIUS)) });
    else if (key === 'x' || key === 'X') events.set({ erase: !erase });
    else if (/^\d$/.test(key)) events.set({ strength: key === '0' ? MOST_STRENGTH : Number(key) });
    else return false;
    return true;
  }

  private arrow(key: string, turning: boolean): boolean {
    const ways: Readonly<Record<string, readonly [number, number]>> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const way = ways[key];
    if (way === undefined) return false;
    const step = Math.max(this.mode().radius * STEP, 2);
    if (turning) this.events.move({ kind: 'orbit', x: way[0] * TURN_STEP, y: way[1] * TURN_STEP });
    else this.go(this.x + way[0] * step, this.y + way[1] * step);
    return true;
  }
}
