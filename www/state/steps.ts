// What the user chooses, with all that can be undone.
import { DEFAULT_CHOICES, DEFAULT_RUN, runKey } from '../choices.ts';
import type { Choices, Goal, RunSettings } from '../choices.ts';
import type { Encoding } from '../encoding.ts';
import type { OutputFormat, Quality } from '../formats.ts';
import type { Model, Step } from '../model.ts';
import { NO_PREPARATION } from '../preparation.ts';
import type { Preparation } from '../preparation.ts';
import { NO_GESTURE, choicesOf, clamp, fewestTriangles, withWish } from './value.ts';
import type { State } from './value.ts';

/** Undo steps kept. */
const UNDO_LIMIT = 200;

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
