// Keyboard shortcuts of the whole window, and of the view when it has the focus.
import type { Actions } from './components/app/app.tsx';
import type { CameraMove } from './preview/protocol.ts';
import { canCancel } from './state.ts';
import type { State } from './state.ts';

/** Pixels of dragging that an arrow key stands for. */
const ORBIT_STEP = 40;
const ZOOM_STEP = 1.15;

/** Joins keys to actions for as long as the page lives. */
export function bindKeys(canvas: HTMLElement, actions: Actions, move: (move: CameraMove) => void, state: () => State): void {
  addEventListener('keydown', (event) => {
    const { key } = event;
    if (key === 'Escape') {
      if (state().help) return;
      if (state().arrival !== null) actions.closeArrival();
      else if (canCancel(state()) || state().batch?.running === true) actions.cancel();
      else if (state().sheet !== null && state().notice === null) actions.toggleSheet(null);
      else actions.dismiss();
      return;
    }
    if (isTyping(event.target) || event.altKey) return;
    if (event.ctrlKey || event.metaKey) {
      const lower = key.toLowerCase();
      // There is no level to choose or to save while the model arrives.
      if (state().arrival !== null) return;
      if (lower === 'z' || lower === 'y') {
        event.preventDefault();
        if (lower === 'y' || event.shiftKey) actions.redo();
        else actions.undo();
      } else if (lower === 's' && state().model !== null) {
        event.preventDefault();
        actions.download();
      }
      return;
    }
    if (key === '?') actions.toggleHelp(!state().help);
    if (state().model === null || state().help) return;
    const turn = event.target === canvas ? cameraMove(key) : undefined;
    if (turn !== undefined) {
      event.preventDefault();
      move(turn);
    } else if (key === ' ' && state().arrival !== null && (event.target === canvas || isText(event.target))) {
      event.preventDefault();
      actions.toggleArrival();
    } else if (key === 'o' || key === 'O') actions.toggleSheet('options');
    else if (key === 'i' || key === 'I') actions.toggleSheet('details');
    else if (key === 'f' || key === 'F') actions.fit();
    else if (key === 'b' || key === 'B') actions.paint();
    else if (key === 'w' || key === 'W') actions.changeView({ wireframe: !state().view.wireframe });
    else if (key === 's' || key === 'S') actions.changeView({ layout: state().view.layout === 'split' ? 'single' : 'split' });
    else if (key === 'e' || key === 'E') actions.changeView({ edgeClasses: !state().view.edgeClasses });
    else if ((key === 'c' || key === 'C') && !event.repeat) actions.changeView({ comparing: true });
    else if (key === ' ' && (event.target === canvas || event.target === document.body)) {
      event.preventDefault();
      actions.changeView({ playing: !state().view.playing });
    }
  });
  const stopComparing = (): void => {
    if (state().view.comparing) actions.changeView({ comparing: false });
  };
  addEventListener('keyup', (event) => {
    if (event.key === 'c' || event.key === 'C') stopComparing();
  });
  // A key let go in another window is never told here.
  addEventListener('blur', stopComparing);
}

/** What a key does to the camera, if anything. */
function cameraMove(key: string): CameraMove | undefined {
  switch (key) {
    case 'ArrowLeft':
      return { kind: 'orbit', x: -ORBIT_STEP, y: 0 };
    case 'ArrowRight':
      return { kind: 'orbit', x: ORBIT_STEP, y: 0 };
    case 'ArrowUp':
      return { kind: 'orbit', x: 0, y: -ORBIT_STEP };
    case 'ArrowDown':
      return { kind: 'orbit', x: 0, y: ORBIT_STEP };
    case '+':
    case '=':
      return { kind: 'zoom', factor: ZOOM_STEP };
    case '-':
      return { kind: 'zoom', factor: 1 / ZOOM_STEP };
    default:
      return undefined;
  }
}

/** Whether a key on it is not its own: nothing that is pressed or scrolled has the focus. */
const isText = (target: EventTarget | null): boolean => target instanceof HTMLElement && (target === document.body || target instanceof HTMLHeadingElement);

/** Inputs in which a letter means nothing. */
const WITHOUT_LETTERS: readonly string[] = ['range', 'file', 'radio', 'checkbox'];

/** Whether letters and figures are those of the field that has the focus. */
export const isTyping = (target: EventTarget | null): boolean =>
  (target instanceof HTMLInputElement && !WITHOUT_LETTERS.includes(target.type)) || target instanceof HTMLSelectElement;
