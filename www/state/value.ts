// The page's one state value, and what follows from it.
import type { ArrivalState } from '../arrival/arrival_state.ts';
import type { BatchState } from '../batch/batch_state.ts';
import { DEFAULT_CHOICES, isChain } from '../choices.ts';
import type { Choices, Wish } from '../choices.ts';
import { encodingFor } from '../encoding.ts';
import type { Language } from '../messages/messages.ts';
import type { Model, Notice, Task } from '../model.ts';
import type { PaintMode } from '../paint/mode.ts';
import { preparationKey } from '../preparation.ts';
import { NO_CONTENTS } from '../preview/no-contents.ts';
import type { EdgeCounts, Insets, ViewContents, ViewSettings } from '../preview/protocol.ts';
import { STILL_LIFE } from '../preview/settings.ts';

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

/** A gesture that nothing continues. */
export const NO_GESTURE = -1;

/** The choices in `state` by themselves. */
export const choicesOf = ({ goal, run, lods, outputFormat, encoding, quality, preparation }: State): Choices =>
  ({ goal, run, lods, outputFormat, encoding, quality, preparation });

/** All that is wanted of the model on screen, as values that stay the same until something else is wanted. */
export const everyWish = (state: State): readonly unknown[] =>
  [state.model?.wantedTriangles, state.model?.origin, ...Object.values(choicesOf(state))];

export const withModel = (state: State, change: (model: Model) => Model): State => {
  if (state.model === null) return state;
  const model = change(state.model);
  return model === state.model ? state : { ...state, model };
};

/** What was measured for another wish is no answer to this one. */
export const withWish = (model: Model, wantedTriangles: number): Model =>
  model.wantedTriangles === wantedTriangles ? model : { ...model, wantedTriangles, measurement: { kind: 'none' } };

/** The fewest triangles that may be asked for: 1 until the history tells. */
export const fewestTriangles = (model: Model): number =>
  model.history.kind === 'ready' ? model.history.fewestTriangles : Math.min(1, model.source.triangles);

/** Whether the level on screen is the one the slider asks for. */
export const isSettled = (model: Model): boolean => model.shownFor === model.wantedTriangles;

/** Whether the level on screen can be measured now. */
export const canMeasure = (model: Model): boolean => model.history.kind === 'ready' && isSettled(model);

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

/** Whether something is under way that the panel's Cancel would stop. */
export const isBusy = (state: State): boolean => state.task !== null || state.model?.history.kind === 'recording';

/** Whether there is anything that Escape would stop. */
export const canCancel = (state: State): boolean => isBusy(state) || state.model?.measurement.kind === 'running';

/** 0..1, null when unknown or when nothing is under way. */
export const progress = (state: State): number | null => {
  if (state.task?.kind === 'opening' || state.task?.kind === 'fitting') return state.task.fraction;
  const history = state.model?.history;
  return history?.kind === 'recording' ? history.fraction : null;
};

export const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);
