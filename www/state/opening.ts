// From files to a model, and what went wrong.
import type { BatchState } from '../batch/batch_state.ts';
import { DEFAULT_CHOICES, DEFAULT_RUN, withWishes } from '../choices.ts';
import type { Choices } from '../choices.ts';
import { isOutputFormat } from '../formats.ts';
import type { Model, Notice, Source, Task } from '../model.ts';
import { NO_GESTURE, choicesOf, clamp } from './value.ts';
import type { State } from './value.ts';

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
