// The model's history, the level on screen, its file and its measurement.
import type { Blockers } from 'decimesh/worker';
import type { Deviation, Level, Model, Output } from '../model.ts';
import { canMeasure, clamp, fewestTriangles, withModel, withWish } from './value.ts';
import type { State } from './value.ts';
import { viewChanged } from './view.ts';

/** A triangle count that nobody wishes for. */
const NO_WISH = -1;

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

/** Without a measurement there is nothing to colour the surface by. */
export const heatMapLeft = (state: State): State =>
  state.view.surface === 'deviation' ? viewChanged(state, { surface: 'textured' }) : state;

/** What the heat map is waiting for: the level that is to be measured, as a key; null when there is nothing to do. */
export const heatMapWish = (state: State): string | null =>
  state.model !== null && state.view.surface === 'deviation' && state.model.measurement.kind === 'none' && canMeasure(state.model)
    ? `${state.model.name} ${state.model.shownFor}`
    : null;

export const measuringProgressed = (state: State, fraction: number): State =>
  withModel({ ...state, remark: '' }, (model) => ({ ...model, measurement: { kind: 'running', fraction: clamp(fraction, 0, 1) } }));

export const measuringEnded = (state: State, deviation: Deviation | null, remark: string): State =>
  withModel({ ...state, remark }, (model) => ({
    ...model,
    measurement: deviation === null ? { kind: 'none' } : { kind: 'done', deviation },
  }));
