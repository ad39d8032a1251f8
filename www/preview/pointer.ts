// Turns pointers and the wheel over the view into camera moves: one finger or the main button orbits, two fingers pan
// and zoom, other buttons or Shift pan, the wheel zooms, a double click fits.
import type { CameraMove } from './protocol.ts';

/** Zoom of one pixel of wheel; a notch is about a hundred. */
const WHEEL_RATE = 0.0016;
/** A trackpad's pinch comes as a wheel with Ctrl and in small figures. */
const PINCH_RATE = 0.01;
const LINE_HEIGHT = 16;

interface Finger {
  x: number;
  y: number;
}

/** Joins the canvas's pointers to `move` for as long as the page lives. */
export function bindPointers(canvas: HTMLElement, move: (move: CameraMove) => void): void {
  const fingers = new Map<number, Finger>();
  let panning = false;

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    if (fingers.size === 0) panning = event.button !== 0 || event.shiftKey;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });

  canvas.addEventListener('pointermove', (event) => {
    const finger = fingers.get(event.pointerId);
    if (finger === undefined) return;
    const x = event.clientX - finger.x;
    const y = event.clientY - finger.y;
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    if (other === undefined) move({ kind: panning ? 'pan' : 'orbit', x, y });
    else {
      // Each finger tells half of the movement of their middle.
      move({ kind: 'pan', x: x / 2, y: y / 2 });
      const before = Math.hypot(finger.x - other.x, finger.y - other.y);
      const after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      const at = { x: (event.clientX + other.x) / 2, y: (event.clientY + other.y) / 2 };
      if (before > 0 && after > 0) move({ kind: 'zoom', factor: after / before, at });
    }
    finger.x = event.clientX;
    finger.y = event.clientY;
  });

  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'] as const) {
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('dblclick', () => move({ kind: 'fit' }));
  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE_HEIGHT : 1);
      const factor = Math.exp(-pixels * (event.ctrlKey ? PINCH_RATE : WHEEL_RATE));
      move({ kind: 'zoom', factor, at: { x: event.clientX, y: event.clientY } });
    },
    { passive: false },
  );
}
