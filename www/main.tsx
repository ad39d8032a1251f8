// Wiring only: makes the state, the worker client, the view and the session, and joins events to them.
import { effect, signal } from '@preact/signals';
import { render } from 'preact';
import { createWorkerClient } from 'decimesh/worker';
import { App } from './components/app/app.tsx';
import type { Actions } from './components/app/app.tsx';
import { fileNameOf } from './download.ts';
import { filesOfDrop, filesOfInput, modelsOf } from './files.ts';
import { bindKeys } from './keys.ts';
import { preferredLanguage, rememberLanguage, t, useLanguage } from './messages/messages.ts';
import type { Language } from './messages/messages.ts';
import type { Arrival } from './arrival/arrival.tsx';
import { whenIdle } from './idle.ts';
import { keepOffline, onLaunchFiles, takeSharedFiles } from './offline/offline.ts';
import type { Painting } from './paint/painting.tsx';
import { bindPointers } from './preview/pointer.ts';
import { View } from './preview/view.ts';
import { Batch } from './batch/batch.ts';
import { shareChosen } from './batch/batch_state.ts';
import { DEFAULT_CHOICES, readWish, rememberChoices, rememberedChoices, withWishes, writeWish } from './choices.ts';
import { describeError } from './describe_error.ts';
import { samples } from './samples/samples.ts';
import { Session } from './session.ts';
import * as transitions from './state.ts';
import type { Sample } from './samples/samples.ts';
import type { State } from './state.ts';
import { applyTheme, rememberedTheme, watchSystemTheme } from './theme.ts';
import './styles/tokens.css';
import './styles/base.css';

const reducedMotion = matchMedia('(prefers-reduced-motion: reduce)').matches;
const wish = readWish(new URLSearchParams(location.search));
const state = signal<State>({
  ...transitions.initialState,
  ...withWishes(withWishes(DEFAULT_CHOICES, rememberedChoices()), wish),
  wish,
  reducedMotion,
  view: { ...transitions.initialState.view, playing: !reducedMotion, theme: rememberedTheme() },
});
const update = (transition: (state: State) => State): void => {
  state.value = transition(state.peek());
};

const canvas = document.querySelector<HTMLCanvasElement>('#view');
const host = document.querySelector<HTMLElement>('#app');
if (canvas === null || host === null) throw new Error('index.html lacks #view or #app');

const view = new View(
  canvas,
  {
    onUnavailable: (reason) =>
      update((now) =>
        transitions.failed(now, {
          code: 'no-webgl',
          message: t('view.unavailable'),
          where: reason,
        }),
      ),
    onContextLost: () => update((now) => transitions.remarked(now, t('view.contextLost'))),
    onContextRestored: () => update((now) => transitions.remarked(now, '')),
    onContents: (contents) => update((now) => transitions.contentsChanged(now, contents)),
    onEdges: (counts) => update((now) => transitions.edgesCounted(now, counts)),
    onPaint: (reply) => painting?.received(reply),
    onInsets: (insets) => update((now) => transitions.insetsChanged(now, insets)),
  },
  reducedMotion,
);
let painting: Painting | null = null;
const store = { get value() { return state.peek(); }, update };
const client = createWorkerClient();
const session = new Session(store, client, view, layOut);
const batch = new Batch(store, client);

const dockObserver = new ResizeObserver(() => tellInsets(host));
dockObserver.observe(canvas);

const actions: Actions = {
  openFiles: (files) => openFiles(filesOfInput(files)),
  openSample,
  cancel: () => (state.peek().batch?.running === true ? batch.cancel() : session.cancel()),
  dismiss: () => update(transitions.noticeDismissed),
  moveTarget: (triangles, gesture) => update((now) => transitions.targetMoved(now, triangles, gesture)),
  undo: () => update(transitions.undone),
  redo: () => update(transitions.redone),
  paint: () => void togglePainting(),
  fit: () => view.move({ kind: 'fit' }),
  changeView: (change) => update((now) => transitions.viewChanged(now, change)),
  loadUpdate: () => loadUpdate(),
  declineUpdate: () => update((now) => transitions.updateOffered(now, false)),
  changeMorph: (index, weight) => update((now) => transitions.morphChanged(now, index, weight)),
  chooseFormat: (format) => update((now) => transitions.outputFormatChosen(now, format)),
  chooseEncoding: (encoding) => update((now) => transitions.encodingChosen(now, encoding)),
  chooseQuality: (quality) => update((now) => transitions.qualityChosen(now, quality)),
  chooseGoal: (goal) => update((now) => transitions.goalChosen(now, goal)),
  changeRun: (change) => update((now) => transitions.runChanged(now, change)),
  chooseMeshes: (kept) => update((now) => transitions.runChanged(now, { kept })),
  changePreparation: (change) => update((now) => transitions.preparationChanged(now, change)),
  chooseLods: (lods) => update((now) => transitions.lodsChosen(now, lods)),
  resetChoices: () => update(transitions.choicesReset),
  remark: (text) => update((now) => transitions.remarked(now, text)),
  toggleSheet: (sheet) => update((now) => transitions.sheetToggled(now, sheet)),
  toggleHelp: (shown) => update((now) => transitions.helpToggled(now, shown)),
  chooseShare: (share) => update((now) => transitions.batchChanged(now, (queue) => shareChosen(queue, share))),
  startBatch: () => void batch.start(),
  cancelBatch: () => batch.cancel(),
  saveBatch: () => void batch.save(),
  closeBatch: () => batch.close(),
  download: () => void session.download(),
  measure: () => void session.measure(),
  watchArrival: () => void watchArrival(),
  toggleArrival: () => arrival?.toggle(),
  closeArrival: () => arrival?.close(),
  chooseLanguage: (language) => {
    rememberLanguage(language);
    void speak(language);
  },
};

let arrival: Arrival | null = null;
let addressTimer: ReturnType<typeof setTimeout> | undefined;
/** Milliseconds that a level has been on screen for before it is measured for the heat map. */
const HEAT_PAUSE = 400;
/** Milliseconds that the hint where to let go stays at most when that has been done. */
const HINT_TIME = 400;
let heatTimer: ReturnType<typeof setTimeout> | undefined;
let loadUpdate = (): void => {};
let drawing = false;
let drawn = Promise.resolve();
let observedDock: Element | null = null;
effect(() => {
  void state.value;
  if (drawing) return;
  drawing = true;
  // Changes that come together are drawn together.
  drawn = drawn.then(() => {
    drawing = false;
    render(<App state={state.peek()} actions={actions} arrival={arrival?.panel(state.peek())} />, host);
    observeDock(host);
  });
});
watch(transitions.everyWish, () => {
  session.wishChanged();
  rememberChoices(transitions.choicesOf(state.peek()));
  keepAddressLater();
});
watch((now) => `${now.sheet} ${now.paint !== null}`, () => requestAnimationFrame(() => tellInsets(host)));
// Another model has taken the place of the one that was arriving.
watch((now) => now.arrival === null, (gone) => gone && arrival?.stop());
watch(transitions.heatMapWish, (wish) => {
  clearTimeout(heatTimer);
  // Levels that a drag passes are not measured.
  if (wish !== null) heatTimer = setTimeout(() => void session.measure(), HEAT_PAUSE);
});
watch(transitions.shownView, (settings) => view.setSettings(settings));
watch((now) => now.paint !== null, nameCanvas);
watch((now) => now.view.theme, (theme) => view.setTheme(applyTheme(theme)));
// Once the picture is there: for the title in its tab the browser draws the whole window anew.
watch((now) => (now.model?.drawn === false ? null : (now.model?.name ?? '')), (name) => {
  if (name !== null) document.title = name === '' ? 'Decimesh' : `${name} – Decimesh`;
});
watchSystemTheme(() => view.setTheme(applyTheme(state.peek().view.theme)));
bindKeys(canvas, actions, (move) => view.move(move), () => state.peek());
bindPointers(canvas, (move) => view.move(move));
bindDrop();
bindPaste();
// The engine is loaded while the user looks.
whenIdle(() => void client.externalFiles(new Uint8Array()).catch(() => {}));
onLaunchFiles(openFiles);
if (import.meta.env.PROD) {
  void keepOffline((load) => {
    loadUpdate = load;
    update((now) => transitions.updateOffered(now, true));
  });
}

void speak(preferredLanguage());

const parameters = new URLSearchParams(location.search);
const address = parameters.get('model');
const sampleName = parameters.get('sample');
const wantedSample = samples.find(({ fileName }) => fileName === `${sampleName}.glb`);
if (address !== null) openAddress(address);
else if (wantedSample !== undefined) openSample(wantedSample);
if (parameters.has('shared')) void openShared();

async function speak(language: Language): Promise<void> {
  try {
    await useLanguage(language);
  } catch {
    // Without a network it goes on in the language it has.
    return;
  }
  nameCanvas(state.peek().paint !== null);
  update((now) => transitions.languageChanged(now, language));
}

/** What the view is, in words, and what the keys do there. */
function nameCanvas(painting: boolean): void {
  canvas?.setAttribute('aria-roledescription', t('view.role'));
  canvas?.setAttribute('aria-label', t(painting ? 'paint.view' : 'view.name'));
}

/** Takes the brush up, or puts it down. Its code is loaded for who paints. */
async function togglePainting(): Promise<void> {
  const { paint, model } = state.peek();
  if (state.peek().arrival !== null) return;
  if (paint !== null) return update((now) => transitions.paintChanged(now, null));
  if (model === null || canvas === null) return;
  if (view.isUnavailable) return update((now) => transitions.remarked(now, t('view.unavailable')));
  update((now) => transitions.brushAwaited(now, true));
  try {
    const { Painting } = await import('./paint/painting.tsx');
    // The brush was asked for this model, and not for what has come in between.
    if (state.peek().model?.source !== model.source || state.peek().arrival !== null) return;
    painting ??= new Painting(state, store, session, view, canvas);
    painting.start();
  } catch (error) {
    update((now) => transitions.failed(now, describeError(error)));
  } finally {
    update((now) => transitions.brushAwaited(now, false));
  }
}

function openAddress(text: string): void {
  const url = URL.parse(text, location.href);
  if (url === null) {
    update((now) => transitions.failed(now, { code: 'invalid-argument', message: t('notice.notAnAddress'), where: `?model=${text}` }));
    return;
  }
  void session.openAddress(url, fileNameOf(url), { kind: 'model', address: text });
}

function openSample({ address: path, fileName, credit }: Sample): void {
  const origin = { kind: 'sample', address: fileName.replace(/\.glb$/, '') } as const;
  void session.openAddress(new URL(path, location.href), fileName, origin, credit);
}

/** Has the open model arrive over a slow connection, as a progressive mesh. */
async function watchArrival(): Promise<void> {
  const { model } = state.peek();
  if (model === null || session.files === null || state.peek().arrival !== null) return;
  try {
    const loaded = await import('./arrival/arrival.tsx');
    const { files } = session;
    if (state.peek().model?.name !== model.name || files === null || state.peek().arrival !== null) return;
    arrival = new loaded.Arrival({ store, client, view, onClosed: () => session.takeViewBack() }, model.name);
    const opened = arrival.open(files);
    session.lendView();
    await opened;
  } catch (error) {
    update((now) => transitions.failed(now, { ...describeError(error), code: 'cannot-read' }));
  }
}

/** One model goes on screen, several go into a queue. */
function openFiles(files: File[]): void {
  const models = modelsOf(files);
  if (models.length > 1) {
    session.close();
    batch.open(models);
  } else {
    if (state.peek().batch !== null) batch.close();
    void session.open(files);
  }
}

/** Writes what was chosen into the address, once the slider rests: browsers refuse to be told at every move. */
function keepAddressLater(): void {
  clearTimeout(addressTimer);
  addressTimer = setTimeout(keepAddress, 300);
}

function keepAddress(): void {
  const { model, ...now } = state.peek();
  if (model === null) return;
  const query = new URLSearchParams(location.search);
  for (const name of ['model', 'sample']) query.delete(name);
  if (model.origin !== null) query.set(model.origin.kind, model.origin.address);
  const chosen = model.wantedTriangles === model.source.triangles ? null : model.wantedTriangles;
  const choices = transitions.choicesOf({ ...now, model });
  writeWish(query, choices, chosen, { ...choices, ...transitions.usualFor(model.source) });
  const text = query.toString();
  const next = location.pathname + (text === '' ? '' : `?${text}`) + location.hash;
  if (next !== location.pathname + location.search + location.hash) history.replaceState(history.state, '', next);
}

/** Calls `act` with the first value of `select` and then whenever it, or something in a list, changes. */
function watch<T>(select: (state: State) => T, act: (value: T) => void): void {
  let last: { value: T } | null = null;
  effect(() => {
    const value = select(state.value);
    if (last !== null && isSame(last.value, value)) return;
    last = { value };
    act(value);
  });
}

function isSame(before: unknown, now: unknown): boolean {
  if (!Array.isArray(before) || !Array.isArray(now)) return Object.is(before, now);
  return before.length === now.length && before.every((value, index) => Object.is(value, now[index]));
}

/** Tells the view at once what of it is free, with the state as it is now drawn: an observer tells with the next frame. */
async function layOut(): Promise<void> {
  await drawn;
  if (host !== null) tellInsets(host);
}

/** Sees to it that a dock that has come or gone is known; a ResizeObserver tells when its size has settled. */
function observeDock(page: HTMLElement): void {
  const dock = page.querySelector('[data-inset]');
  if (dock === observedDock) return;
  if (observedDock !== null) dockObserver.unobserve(observedDock);
  if (dock !== null) dockObserver.observe(dock);
  observedDock = dock;
}

function tellInsets(page: HTMLElement): void {
  const insets = insetsOf(page);
  // The model does not move, and is not drawn again, for the line that says how far the work is.
  const line = page.querySelector('.model-panel > .progress')?.getBoundingClientRect().height ?? 0;
  view.setInsets(insets, { ...insets, bottom: Math.max(insets.bottom - line, 0) });
}

/** What panels cover of the view, as they mark it themselves. */
function insetsOf(page: HTMLElement): { top: number; right: number; bottom: number; left: number } {
  // The brush's controls are below the bar.
  const top = (document.querySelector('.paint-bar') ?? page.querySelector('.top-bar'))?.getBoundingClientRect().bottom ?? 0;
  const dock = page.querySelector('[data-inset]')?.getBoundingClientRect();
  const sheet = page.querySelector('[data-inset-left]')?.getBoundingClientRect();
  // A sheet over most of the view leaves nothing to make room in.
  const left = sheet === undefined || sheet.width > innerWidth * 0.5 ? 0 : sheet.right;
  if (dock === undefined) return { top, right: 0, bottom: 0, left };
  // A narrow dock stands at the side, a wide one lies at the bottom.
  const beside = dock.width < innerWidth * 0.6 && dock.height > innerHeight * 0.5;
  return beside
    ? { top, right: Math.max(innerWidth - dock.left, 0), bottom: 0, left }
    : { top, right: 0, bottom: Math.max(innerHeight - dock.top, 0), left };
}

/** Files that another program has shared; a reload does not open them again. */
async function openShared(): Promise<void> {
  history.replaceState(null, '', location.pathname);
  const files = await takeSharedFiles();
  if (files.length > 0) openFiles(files);
}

/** Files from the clipboard; or the address of a model, unless it is pasted into a field. */
function bindPaste(): void {
  addEventListener('paste', (event) => {
    const files = event.clipboardData?.files;
    if (files !== undefined && files.length > 0) {
      event.preventDefault();
      openFiles(filesOfInput(files));
      return;
    }
    const text = event.clipboardData?.getData('text/plain').trim() ?? '';
    const inField = event.target instanceof HTMLInputElement || event.target instanceof HTMLTextAreaElement;
    if (!inField && /^https?:\/\/\S+$/.test(text)) openAddress(text);
  });
}

function bindDrop(): void {
  // Entering a child fires before leaving its parent.
  let depth = 0;
  let dropped = false;
  const carriesFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') ?? false;
  const set = (to: number): void => {
    depth = Math.max(to, 0);
    update((now) => transitions.draggingChanged(now, depth > 0));
  };
  // Where to let go is said until there is something else to see, or nothing for long: between the two the page would be
  // painted once more, which without a graphics card is the processor's work and delays the picture.
  const shown = (): void => {
    if (dropped) set(0);
    dropped = false;
  };
  watch((now) => [now.model?.drawn === false, now.notice !== null, now.batch !== null].join(), shown);
  addEventListener('dragenter', (event) => {
    if (!carriesFiles(event)) return;
    shown();
    set(depth + 1);
  });
  addEventListener('dragleave', (event) => {
    if (carriesFiles(event)) set(depth - 1);
  });
  addEventListener('dragover', (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    if (event.dataTransfer !== null) event.dataTransfer.dropEffect = 'copy';
  });
  addEventListener('drop', (event) => {
    if (!carriesFiles(event) || event.dataTransfer === null) return;
    event.preventDefault();
    dropped = true;
    setTimeout(shown, HINT_TIME);
    void filesOfDrop(event.dataTransfer).then(
      openFiles,
      (error: unknown) => update((now) => transitions.failed(now, { ...describeError(error), code: 'cannot-read' })),
    );
  });
}
