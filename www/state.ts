// The page's one state value and the pure transitions between its values; nothing here fetches, draws or waits.
import type { Blockers } from 'decimesh/worker';
import type { ArrivalState } from './arrival/arrival_state.ts';
import type { BatchState } from './batch/batch_state.ts';
import { DEFAULT_CHOICES, DEFAULT_RUN, isChain, runKey, withWishes } from './choices.ts';
import type { Choices, Goal, RunSettings, Wish } from './choices.ts';
import { encodingFor } from './encoding.ts';
import type { Encoding } from './encoding.ts';
import { isOutputFormat } from './formats.ts';
import type { OutputFormat, Quality } from './formats.ts';
import type { Language } from './messages/messages.ts';
import type { Deviation, Level, Model, Notice, Output, Source, Step, Task } from './model.ts';
import { NO_PREPARATION, preparationKey } from './preparation.ts';
import type { Preparation } from './preparation.ts';
import { viewForPainting } from './paint/mode.ts';
import type { PaintMode } from './paint/mode.ts';
import { NO_CONTENTS } from './preview/no-contents.ts';
import type { EdgeCounts, Insets, ViewContents, ViewSettings } from './preview/protocol.ts';
import { STILL_LIFE } from './preview/settings.ts';

export type * from './model.ts';

/** How the model is shown. */
export interface View extends ViewSettings {
  readonly theme: 'system' | 'light' | 'dark';
}

/** What stands beside the model. */
export type Sheet = 'options' | 'details';

/** Everything the page shows. */
export interface State extends Choices {
  readonly model: Model | null;
  readonly task: Task | null;
  readonly notice: Notice | null;
  /** What the page's address asks for of the first model. */
  readonly wish: Wish;
  readonly sheet: Sheet | null;
  readonly help: boolean;
  /** Several files at once, in place of a model. */
  readonly batch: BatchState | null;
  /** The model arriving as a progressive mesh, in place of the panel. */
  readonly arrival: ArrivalState | null;
  readonly language: Language;
  readonly view: View;
  /** The brush in hand; null while a drag turns the model. */
  readonly paint: PaintMode | null;
  /** The brush was asked for, and its code is on the way. */
  readonly fetchingBrush: boolean;
  /** What the model has to be looked at. */
  readonly contents: ViewContents;
  /** Of what is drawn, while the classes of edges are drawn. */
  readonly edgeCounts: EdgeCounts | null;
  /** The system asks for no motion. */
  readonly reducedMotion: boolean;
  /** What panels cover of the view. */
  readonly insets: Insets;
  /** A new version of the page is there and can be loaded. */
  readonly updateOffered: boolean;
  /** A file is being dragged over the window. */
  readonly dragging: boolean;
  /** What the live region says when nothing is under way; set by the last event worth telling. */
  readonly remark: string;
}

/** A triangle count that nobody wishes for. */
const NO_WISH = -1;

/** A gesture that nothing continues. */
const NO_GESTURE = -1;

/** Undo steps kept. */
const UNDO_LIMIT = 200;

export const initialState: State = {
  model: null,
  task: null,
  notice: null,
  ...DEFAULT_CHOICES,
  wish: {},
  sheet: null,
  help: false,
  batch: null,
  arrival: null,
  language: 'en',
  view: { ...STILL_LIFE, playing: true, theme: 'system' },
  paint: null,
  fetchingBrush: false,
  contents: NO_CONTENTS,
  edgeCounts: null,
  reducedMotion: false,
  insets: { top: 0, right: 0, bottom: 0, left: 0 },
  updateOffered: false,
  dragging: false,
  remark: '',
};

const withModel = (state: State, change: (model: Model) => Model): State => {
  if (state.model === null) return state;
  const model = change(state.model);
  return model === state.model ? state : { ...state, model };
};

/** What was measured for another wish is no answer to this one. */
const withWish = (model: Model, wantedTriangles: number): Model =>
  model.wantedTriangles === wantedTriangles ? model : { ...model, wantedTriangles, measurement: { kind: 'none' } };

// --- opening

export const taskStarted = (state: State, task: Task): State => ({ ...state, task, notice: null });

export const taskProgressed = (state: State, fraction: number | null): State =>
  state.task === null || state.task.fraction === fraction ? state : { ...state, task: { ...state.task, fraction } };

export const taskEnded = (state: State, remark = state.remark): State => ({ ...state, task: null, remark });

/** A model replaces the one before it, at full detail, to be saved in its own format and compression; its history is recorded from now on. */
export const modelOpened = (
  state: State,
  opened: Pick<Model, 'name' | 'credit' | 'source' | 'warnings' | 'animations'> & Partial<Pick<Model, 'fileName' | 'origin' | 'parts' | 'scene'>>,
): State => ({
  ...state,
  ...withWishes({ ...choicesOf(state), goal: DEFAULT_CHOICES.goal, run: { ...state.run, kept: [], paint: DEFAULT_RUN.paint }, ...usualFor(opened.source) }, state.wish),
  wish: {},
  paint: null,
  batch: null,
  arrival: null,
  task: null,
  notice: null,
  remark: '',
  view: { ...state.view, animation: 0, comparing: false, morphs: [] },
  model: {
    fileName: `${opened.name}.${opened.source.format}`,
    origin: null,
    parts: null,
    scene: [],
    ...opened,
    meshTriangles: null,
    drawn: false,
    history: { kind: 'recording', fraction: 0 },
    wantedTriangles: clamp(state.wish.triangles ?? Infinity, 1, opened.source.triangles),
    shown: { triangles: opened.source.triangles, vertices: opened.source.vertices, estimatedError: 0 },
    shownFor: opened.source.triangles,
    output: null,
    measurement: { kind: 'none' },
    undo: [],
    redo: [],
    gesture: NO_GESTURE,
  },
});

/** How a model is saved when nobody chooses: as it came. */
export const usualFor = (source: Source): Pick<Choices, 'outputFormat' | 'encoding'> => ({
  outputFormat: isOutputFormat(source.format) ? source.format : 'glb',
  encoding: source.compression,
});

/** The choices in `state` by themselves. */
export const choicesOf = ({ goal, run, lods, outputFormat, encoding, quality, preparation }: State): Choices =>
  ({ goal, run, lods, outputFormat, encoding, quality, preparation });

/** All that is wanted of the model on screen, as values that stay the same until something else is wanted. */
export const everyWish = (state: State): readonly unknown[] =>
  [state.model?.wantedTriangles, state.model?.origin, ...Object.values(choicesOf(state))];

/** Back to the start page, or to `batch`. */
export const modelClosed = (state: State, batch: BatchState | null): State => ({
  ...state,
  model: null,
  paint: null,
  run: { ...state.run, paint: DEFAULT_RUN.paint },
  batch,
  arrival: null,
  task: null,
  notice: null,
  sheet: null,
  remark: '',
});

/** A failure is shown; the model that was there stays. */
export const failed = (state: State, notice: Notice): State => ({ ...state, task: null, notice });

export const noticeDismissed = (state: State): State => ({ ...state, notice: null });

// --- simplifying

export const recordingProgressed = (state: State, fraction: number): State =>
  withModel(state, (model) => ({
    ...model,
    history: { kind: 'recording', fraction: clamp(fraction, 0, 1) },
    measurement: { kind: 'none' },
  }));

export const recordingEnded = (state: State, remark: string): State => ({
  ...withModel(state, (model) => ({ ...model, history: { kind: 'none' } })),
  remark,
});

/** Levels down to `fewestTriangles` can be had, and no fewer because of `blockers`; a wish for fewer becomes that. */
export const historyReady = (state: State, fewestTriangles: number, blockers: Blockers | null = null): State =>
  withModel({ ...state, remark: '' }, (model) => ({
    ...withWish(model, clamp(model.wantedTriangles, fewestTriangles, model.source.triangles)),
    history: { kind: 'ready', fewestTriangles, blockers },
  }));

/** The level that answers the wish for `shownFor` triangles is on screen. */
export const levelShown = (state: State, shown: Level, shownFor: number, meshTriangles: Model['meshTriangles'] = null): State =>
  withModel({ ...state, remark: '' }, (model) => ({ ...model, shown, shownFor, meshTriangles }));

/** The slider goes where the goal wants it; that is no choice of its own. */
export const goalReached = (state: State, triangles: number): State =>
  withModel(state, (model) => withWish(model, clamp(triangles, fewestTriangles(model), model.source.triangles)));

/** Another run has taken the place of the one that everything so far was made from. */
export const historyReplaced = (state: State): State => withModel(levelStale(state), (model) => ({ ...model, output: null }));

/** The level on screen is to be replaced, by one of the same count too; what was measured is of no use then. */
export const levelStale = (state: State): State =>
  withModel(state, (model) => ({ ...model, shownFor: NO_WISH, measurement: { kind: 'none' } }));

/** The download under way has the level fitted to the original first. */
export const fittingStarted = (state: State): State =>
  state.task?.kind === 'writing' ? { ...state, task: { ...state.task, kind: 'fitting', fraction: 0 } } : state;

export const fittingProgressed = (state: State, fraction: number): State =>
  state.task?.kind === 'fitting' ? { ...state, task: { ...state.task, fraction: clamp(fraction, 0, 1) } } : state;

export const fittingEnded = (state: State): State =>
  state.task?.kind === 'fitting' ? { ...state, task: { ...state.task, kind: 'writing', fraction: null } } : state;

/** The first picture of the model is on screen. */
export const modelDrawn = (state: State): State => withModel(state, (model) => ({ ...model, drawn: true }));

/** Tells where the bytes of the file are. */
export const inputMeasured = (state: State, parts: Model['parts']): State => withModel(state, (model) => ({ ...model, parts }));

export const outputMeasured = (state: State, output: Output): State => withModel(state, (model) => ({ ...model, output }));

/** Whether the size that is known is that of what Download would save. */
export const isOutputCurrent = (state: State): boolean => {
  const output = state.model?.output ?? null;
  return (
    output !== null &&
    output.wantedTriangles === state.model?.wantedTriangles &&
    output.format === state.outputFormat &&
    output.encoding === encodingFor(state.outputFormat, state.encoding) &&
    output.preparation === preparationKey(state.outputFormat, state.preparation) &&
    output.lods.join() === (isChain(state) ? state.lods.join() : '')
  );
};

// --- measuring

/** Without a measurement there is nothing to colour the surface by. */
export const heatMapLeft = (state: State): State =>
  state.view.surface === 'deviation' ? viewChanged(state, { surface: 'textured' }) : state;

/** What the heat map is waiting for: the level that is to be measured, as a key; null when there is nothing to do. */
export const heatMapWish = (state: State): string | null =>
  state.model !== null && state.view.surface === 'deviation' && state.model.measurement.kind === 'none' && canMeasure(state.model)
    ? `${state.model.name} ${state.model.shownFor}`
    : null;

/** Whether the level on screen can be measured now. */
export const canMeasure = (model: Model): boolean => model.history.kind === 'ready' && isSettled(model);

export const measuringProgressed = (state: State, fraction: number): State =>
  withModel({ ...state, remark: '' }, (model) => ({ ...model, measurement: { kind: 'running', fraction: clamp(fraction, 0, 1) } }));

export const measuringEnded = (state: State, deviation: Deviation | null, remark: string): State =>
  withModel({ ...state, remark }, (model) => ({
    ...model,
    measurement: deviation === null ? { kind: 'none' } : { kind: 'done', deviation },
  }));

// --- the slider

/** The fewest triangles that may be asked for: 1 until the history tells. */
export const fewestTriangles = (model: Model): number =>
  model.history.kind === 'ready' ? model.history.fewestTriangles : Math.min(1, model.source.triangles);

/** One more step that can be undone, before `change`; changes with the same `gesture` are one step. */
const withStep = (state: State, gesture: number, change: (state: State, model: Model) => State): State => {
  const { model } = state;
  if (model === null) return state;
  const undo = gesture !== NO_GESTURE && gesture === model.gesture ? model.undo : [...model.undo, stepOf(state, model)].slice(-UNDO_LIMIT);
  return change(state, { ...model, undo, redo: [], gesture });
};

const stepOf = (state: State, { wantedTriangles }: Model): Step => ({ ...choicesOf(state), wantedTriangles });

/** The slider asks for `triangles`; moves with the same `gesture` are one undo step. */
export const targetMoved = (state: State, triangles: number, gesture: number): State => {
  if (state.model === null) return state;
  const wanted = clamp(Math.round(triangles), fewestTriangles(state.model), state.model.source.triangles);
  if (!Number.isFinite(wanted) || wanted === state.model.wantedTriangles) return state;
  return withStep(state, gesture, (now, model) => ({ ...now, goal: DEFAULT_CHOICES.goal, model: withWish(model, wanted) }));
};

/** Something else than the slider was changed; without a model there is nothing to undo it for. */
export const chosen = (state: State, choice: Partial<Choices>): State => {
  const names = Object.keys(choice) as Array<keyof Choices>;
  if (names.every((name) => JSON.stringify(state[name]) === JSON.stringify(choice[name]))) return state;
  if (state.model === null) return { ...state, ...choice };
  return withStep(state, NO_GESTURE, (now, model) => ({ ...now, ...choice, model: { ...model, gesture: NO_GESTURE } }));
};

/** Goes to `step`, a past or coming one, and leaves `undo` and `redo`. */
const gone = (state: State, model: Model, step: Step, undo: readonly Step[], redo: readonly Step[]): State => {
  const { wantedTriangles, ...choices } = step;
  const same = runKey(choices.run) === runKey(state.run);
  const wanted = same ? Math.max(wantedTriangles, fewestTriangles(model)) : wantedTriangles;
  return { ...state, ...choices, model: { ...withWish(model, wanted), undo, redo, gesture: NO_GESTURE } };
};

export const undone = (state: State): State => {
  const { model } = state;
  const step = model?.undo.at(-1);
  if (model === null || step === undefined) return state;
  return gone(state, model, step, model.undo.slice(0, -1), [...model.redo, stepOf(state, model)]);
};

export const redone = (state: State): State => {
  const { model } = state;
  const step = model?.redo.at(-1);
  if (model === null || step === undefined) return state;
  return gone(state, model, step, [...model.undo, stepOf(state, model)], model.redo.slice(0, -1));
};

// --- the rest

export const outputFormatChosen = (state: State, outputFormat: OutputFormat): State => chosen(state, { outputFormat });

export const encodingChosen = (state: State, encoding: Encoding): State => chosen(state, { encoding });

export const qualityChosen = (state: State, quality: Quality): State => chosen(state, { quality });

export const goalChosen = (state: State, goal: Goal): State => chosen(state, { goal });

export const runChanged = (state: State, change: Partial<RunSettings>): State => chosen(state, { run: { ...state.run, ...change } });

export const preparationChanged = (state: State, change: Partial<Preparation>): State =>
  chosen(state, { preparation: { ...state.preparation, ...change } });

export const lodsChosen = (state: State, lods: readonly number[]): State => chosen(state, { lods });

/** Everything but the slider and the format as it is without touching anything. */
export const choicesReset = (state: State): State =>
  chosen(state, { goal: DEFAULT_CHOICES.goal, run: DEFAULT_RUN, lods: [], quality: DEFAULT_CHOICES.quality, preparation: NO_PREPARATION });

/** Shows `sheet`, or puts the one away that is shown. */
export const sheetToggled = (state: State, sheet: Sheet | null): State => ({ ...state, sheet: state.sheet === sheet ? null : sheet });

export const helpToggled = (state: State, help = !state.help): State => ({ ...state, help });

export const batchChanged = (state: State, change: (batch: BatchState) => BatchState): State =>
  state.batch === null ? state : { ...state, batch: change(state.batch) };

/** The page speaks `language` now. */
export const languageChanged = (state: State, language: Language): State => ({ ...state, language });

export const viewChanged = (state: State, change: Partial<View>): State => ({ ...state, view: { ...state.view, ...change } });

/** Takes up the brush, sets it, or puts it down with null. */
export const paintChanged = (state: State, paint: PaintMode | null): State => (state.model === null ? state : { ...state, paint });

export const brushAwaited = (state: State, fetchingBrush: boolean): State => ({ ...state, fetchingBrush });

/** How the model is drawn. */
export const shownView = ({ view, paint }: State): View => (paint === null ? view : viewForPainting(view));

/** Another model is on its way to the screen: what it lacks is not shown any longer. */
export const contentsChanged = (state: State, contents: ViewContents): State => ({
  ...state,
  contents,
  view: state.view.surface === 'checker' && !contents.textureCoordinates ? { ...state.view, surface: 'textured' } : state.view,
});

export const edgesCounted = (state: State, edgeCounts: EdgeCounts | null): State => ({ ...state, edgeCounts });

export const insetsChanged = (state: State, insets: Insets): State => ({ ...state, insets });

/** Takes hold of morph target `index`, or lets go of it with null. */
export const morphChanged = (state: State, index: number, weight: number | null): State =>
  viewChanged(state, { morphs: state.contents.morphs.map((_, at) => (at === index ? weight : (state.view.morphs[at] ?? null))) });

export const updateOffered = (state: State, offered: boolean): State => ({ ...state, updateOffered: offered });

export const draggingChanged = (state: State, dragging: boolean): State =>
  state.dragging === dragging ? state : { ...state, dragging };

export const remarked = (state: State, remark: string): State => ({ ...state, remark });

// --- derived

/** Whether something is under way that the panel's Cancel would stop. */
export const isBusy = (state: State): boolean => state.task !== null || state.model?.history.kind === 'recording';

/** Whether there is anything that Escape would stop. */
export const canCancel = (state: State): boolean => isBusy(state) || state.model?.measurement.kind === 'running';

/** Whether the level on screen is the one the slider asks for. */
export const isSettled = (model: Model): boolean => model.shownFor === model.wantedTriangles;

/** 0..1, null when unknown or when nothing is under way. */
export const progress = (state: State): number | null => {
  if (state.task?.kind === 'opening' || state.task?.kind === 'fitting') return state.task.fraction;
  const history = state.model?.history;
  return history?.kind === 'recording' ? history.fraction : null;
};

export const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);
