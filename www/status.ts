// The sentence of the live region: what is under way, else what there is.
import { mainBlocker } from './blockers.ts';
import { formatBytes } from './format.ts';
import { t } from './messages/messages.ts';
import { isOutputCurrent, isSettled } from './state.ts';
import type { State } from './state.ts';

/** What the live region says. Progress is left to the progress bar, or it would be read out at every per cent. */
export const statusText = (state: State): string => {
  const { task, model } = state;
  if (task !== null) return t(`status.${task.kind}`, { name: task.name });
  if (model === null) return state.remark;
  // What is going on behind it is not told meanwhile.
  if (state.arrival !== null) return state.arrival.phase === 'making' ? t('arrival.making', { name: model.name }) : state.remark;
  const { name, history, wantedTriangles, source, shown } = model;
  if (history.kind === 'recording') return t('status.simplifying', { name });
  if (history.kind === 'ready' && !isSettled(model)) return t('status.going', { count: wantedTriangles });
  if (model.measurement.kind === 'running') return t('status.measuring', { name });
  if (state.remark !== '') return state.remark;
  if (!model.drawn) return t('status.drawing', { name });
  if (history.kind === 'none') return t('status.open', { name });
  const limit = history.blockers === null || wantedTriangles !== history.fewestTriangles ? '' : mainBlocker(history.blockers);
  const why = limit === '' ? '' : ` ${t('status.limit', { reason: limit })}`;
  const ready = shown.triangles === source.triangles
    ? t('status.ready', { count: source.triangles })
    : t('status.showing', { shown: shown.triangles, count: source.triangles });
  return [ready + why, missedSize(state)].filter((sentence) => sentence !== '').join(' ');
};

/** What is said when not even the smallest level fits the size that is wanted; empty where one does. */
export const missedSize = (state: State): string => {
  const { goal, model } = state;
  const bytes = model?.output?.bytes ?? 0;
  return goal.kind === 'size' && isOutputCurrent(state) && bytes > goal.bytes ? t('goal.tooSmall', { size: formatBytes(bytes) }) : '';
};
