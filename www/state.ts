// The page's one state value and the pure transitions between its values; nothing here fetches, draws or waits.
import type { Compression, OutputFormat as PackageFormat, Preset } from 'decimesh/worker';
import type { Encoding } from './encoding.ts';
import { t } from './messages/messages.ts';
import type { Language } from './messages/messages.ts';
import { NO_CONTENTS } from './preview/no-contents.ts';
import type { EdgeCounts, Insets, ViewContents, ViewSettings } from './preview/protocol.ts';

/** What the page saves: formats of one file. */
export type OutputFormat = Exclude<PackageFormat, 'gltf'>;

/** The formats that the page can download, and what it calls them. */
export const FORMAT_NAMES: Readonly<Record<OutputFormat, string>> = { glb: 'GLB', obj: 'OBJ', ply: 'PLY', stl: 'STL', off: 'OFF', smf: 'SMF' };

/** Whether `value` names a format that can be downloaded. */
export const isOutputFormat = (value: string): value is OutputFormat => Object.hasOwn(FORMAT_NAMES, value);

/** How good the level is that is downloaded. */
export type Quality = Preset;

/** The qualities as the page offers them. */
export const QUALITIES: readonly Quality[] = ['fast', 'balanced', 'best'];

/** Something that went wrong, or a remark about a file, as the engine reports it. */
export interface Notice {
  /** Stable code, for example `gltf.index-out-of-range`. */
  readonly code: string;
  readonly message: string;
  /** The place in the file or the argument; empty when there is none. */
  readonly where: string;
}

/** What is known about a file when it has been opened. Lengths in model units. */
export interface Source {
  readonly format: string;
  readonly compression: Compression;
  readonly bytes: number;
  readonly triangles: number;
  readonly vertices: number;
  readonly meshes: number;
  /** Diagonal of the bounding box. */
  readonly diagonal: number;
}

/** One level of detail that is on screen. */
export interface Level {
  readonly triangles: number;
  readonly vertices: number;
  /** Estimated deviation from the original in model units. */
  readonly estimatedError: number;
}

/** How far the recording of the collapse history is; levels exist once it is `ready`. */
export type History =
  | { readonly kind: 'none' }
  | { readonly kind: 'recording'; readonly fraction: number }
  | { readonly kind: 'ready'; readonly fewestTriangles: number; /** Why there are no fewer, as part of a sentence; may be empty. */ readonly limit: string };

/** Measured distances between the level and the original, in model units, both ways together. */
export interface Deviation {
  readonly max: number;
  readonly mean: number;
  readonly rms: number;
  /** Diagonal of the original's bounding box. */
  readonly relativeTo: number;
}

/** Whether the level that the slider asks for has been measured; another wish makes it `none` again. */
export type Measurement =
  | { readonly kind: 'none' }
  | { readonly kind: 'running'; readonly fraction: number }
  | { readonly kind: 'done'; readonly deviation: Deviation };

/** The size of the file that Download would save, and what it was measured for. */
export interface Output {
  readonly format: OutputFormat;
  readonly encoding: Encoding;
  /** The wish whose level was written. */
  readonly wantedTriangles: number;
  readonly bytes: number;
}

/** The model on screen. */
export interface Model {
  /** Base name without extension; the download gets it. */
  readonly name: string;
  readonly credit: string;
  readonly source: Source;
  readonly warnings: readonly Notice[];
  /** Names of the animations, in file order. */
  readonly animations: readonly string[];
  /** Whether it has been drawn yet. */
  readonly drawn: boolean;
  readonly history: History;
  /** What the slider asks for. */
  readonly wantedTriangles: number;
  /** What is drawn; catches up with `wantedTriangles` as soon as the history allows. */
  readonly shown: Level;
  /** The wish that `shown` answers; its count may differ from the wish by a triangle or two. */
  readonly shownFor: number;
  readonly output: Output | null;
  readonly measurement: Measurement;
  readonly undo: readonly number[];
  readonly redo: readonly number[];
  /** The gesture of the last move: moves of one drag are undone together. */
  readonly gesture: number;
}

/** Something that keeps the user waiting and can be cancelled. */
export interface Task {
  readonly kind: 'opening' | 'fitting' | 'writing';
  readonly name: string;
  /** 0..1, or null when unknown. */
  readonly fraction: number | null;
}

/** How the model is shown. */
export interface View extends ViewSettings {
  readonly theme: 'system' | 'light' | 'dark';
}

/** Everything the page shows. */
export interface State {
  readonly model: Model | null;
  readonly task: Task | null;
  readonly notice: Notice | null;
  readonly outputFormat: OutputFormat;
  /** How the geometry is stored where the format has a choice. */
  readonly encoding: Encoding;
  readonly quality: Quality;
  readonly language: Language;
  readonly view: View;
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

/** Undo steps kept. */
const UNDO_LIMIT = 200;

export const initialState: State = {
  model: null,
  task: null,
  notice: null,
  outputFormat: 'glb',
  encoding: 'none',
  quality: 'balanced',
  language: 'en',
  view: {
    surface: 'textured',
    wireframe: false,
    edgeClasses: false,
    playing: true,
    animation: 0,
    comparing: false,
    layout: 'single',
    split: 0.5,
    turntable: false,
    lamp: 'view',
    morphs: [],
    theme: 'system',
  },
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
  opened: Pick<Model, 'name' | 'credit' | 'source' | 'warnings' | 'animations'>,
): State => ({
  ...state,
  task: null,
  notice: null,
  remark: '',
  outputFormat: isOutputFormat(opened.source.format) ? opened.source.format : 'glb',
  encoding: opened.source.compression,
  view: { ...state.view, animation: 0, comparing: false, morphs: [] },
  model: {
    ...opened,
    drawn: false,
    history: { kind: 'recording', fraction: 0 },
    wantedTriangles: opened.source.triangles,
    shown: { triangles: opened.source.triangles, vertices: opened.source.vertices, estimatedError: 0 },
    shownFor: opened.source.triangles,
    output: null,
    measurement: { kind: 'none' },
    undo: [],
    redo: [],
    gesture: -1,
  },
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

/** Levels down to `fewestTriangles` can be had, and no fewer because of `limit`; a wish for fewer becomes that. */
export const historyReady = (state: State, fewestTriangles: number, limit = ''): State =>
  withModel({ ...state, remark: '' }, (model) => ({
    ...withWish(model, clamp(model.wantedTriangles, fewestTriangles, model.source.triangles)),
    history: { kind: 'ready', fewestTriangles, limit },
  }));

/** The level that answers the wish for `shownFor` triangles is on screen. */
export const levelShown = (state: State, shown: Level, shownFor: number): State =>
  withModel({ ...state, remark: '' }, (model) => ({ ...model, shown, shownFor }));

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

export const outputMeasured = (state: State, output: Output): State => withModel(state, (model) => ({ ...model, output }));

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

/** The slider asks for `triangles`; moves with the same `gesture` are one undo step. */
export const targetMoved = (state: State, triangles: number, gesture: number): State =>
  withModel(state, (model) => {
    const wantedTriangles = clamp(Math.round(triangles), fewestTriangles(model), model.source.triangles);
    if (!Number.isFinite(wantedTriangles) || wantedTriangles === model.wantedTriangles) return model;
    const continues = gesture === model.gesture;
    const undo = continues ? model.undo : [...model.undo, model.wantedTriangles].slice(-UNDO_LIMIT);
    return { ...withWish(model, wantedTriangles), undo, redo: [], gesture };
  });

export const undone = (state: State): State =>
  withModel(state, (model) => {
    const wantedTriangles = model.undo.at(-1);
    if (wantedTriangles === undefined) return model;
    return {
      ...withWish(model, Math.max(wantedTriangles, fewestTriangles(model))),
      undo: model.undo.slice(0, -1),
      redo: [...model.redo, model.wantedTriangles],
      gesture: -1,
    };
  });

export const redone = (state: State): State =>
  withModel(state, (model) => {
    const wantedTriangles = model.redo.at(-1);
    if (wantedTriangles === undefined) return model;
    return {
      ...withWish(model, Math.max(wantedTriangles, fewestTriangles(model))),
      undo: [...model.undo, model.wantedTriangles],
      redo: model.redo.slice(0, -1),
      gesture: -1,
    };
  });

// --- the rest

export const outputFormatChosen = (state: State, outputFormat: OutputFormat): State => ({ ...state, outputFormat });

export const encodingChosen = (state: State, encoding: Encoding): State => ({ ...state, encoding });

export const qualityChosen = (state: State, quality: Quality): State => ({ ...state, quality });

/** The page speaks `language` now. */
export const languageChanged = (state: State, language: Language): State => ({ ...state, language });

export const viewChanged = (state: State, change: Partial<View>): State => ({ ...state, view: { ...state.view, ...change } });

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

/** The sentence of the live region. Progress is left to the progress bar, or it would be read out at every per cent. */
export const statusText = (state: State): string => {
  const { task, model } = state;
  if (task !== null) return t(`status.${task.kind}`, { name: task.name });
  if (model === null) return state.remark;
  if (model.history.kind === 'recording') return t('status.simplifying', { name: model.name });
  if (model.history.kind === 'ready' && !isSettled(model)) return t('status.going', { count: model.wantedTriangles });
  if (model.measurement.kind === 'running') return t('status.measuring', { name: model.name });
  if (state.remark !== '') return state.remark;
  if (!model.drawn) return t('status.drawing', { name: model.name });
  if (model.history.kind === 'none') return t('status.open', { name: model.name });
  const { fewestTriangles, limit } = model.history;
  const why = limit !== '' && model.wantedTriangles === fewestTriangles ? ` ${t('status.limit', { reason: limit })}` : '';
  return model.shown.triangles === model.source.triangles
    ? t('status.ready', { count: model.source.triangles }) + why
    : t('status.showing', { shown: model.shown.triangles, count: model.source.triangles }) + why;
};

export const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);
