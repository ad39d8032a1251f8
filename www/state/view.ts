// How the model is looked at, and what stands around it.
import type { BatchState } from '../batch/batch_state.ts';
import type { Language } from '../messages/messages.ts';
import { viewForPainting } from '../paint/mode.ts';
import type { PaintMode } from '../paint/mode.ts';
import type { EdgeCounts, Insets, ViewContents } from '../preview/protocol.ts';
import type { Sheet, State, View } from './value.ts';

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
