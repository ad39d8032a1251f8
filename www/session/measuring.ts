// The measured deviation of the level on screen, and the heat map of it.
import { describeError } from '../describe_error.ts';
import { formatShare } from '../format.ts';
import { t } from '../messages/messages.ts';
import { heatLimit } from '../preview/heat.ts';
import * as transitions from '../state.ts';
import type { Deviation, State } from '../state.ts';
import { selectLevel, type Conversation } from './conversation.ts';
import type { Recording } from './recording.ts';

/** Measures the level on screen, unless that is under way or cannot be done now. */
export async function measure(conversation: Conversation, recording: Recording): Promise<void> {
  const { store, view } = conversation;
  const { model } = store.value;
  const open = conversation.current;
  if (model === null || open === null || open.measuring !== null || !transitions.canMeasure(model)) return;
  const measuring = new AbortController();
  open.measuring = measuring;
  const update = (transition: (state: State) => State): void => {
    if (conversation.current === open && !measuring.signal.aborted) store.update(transition);
  };
  update((state) => transitions.measuringProgressed(state, 0));
  try {
    await selectLevel(open, model);
    const { deviation, wedgeSets } = await open.document.deviationMap({
      signal: measuring.signal,
      onProgress: (fraction) => update((state) => transitions.measuringProgressed(state, fraction)),
    });
    if (conversation.current === open && !measuring.signal.aborted) {
      view.setDeviation(wedgeSets.map(({ surroundings }) => surroundings), heatLimit(deviation));
    }
    update((state) => transitions.measuringEnded(state, deviation, describeDeviation(deviation)));
  } catch (error) {
    const cancelled = measuring.signal.aborted;
    if (conversation.current !== open) return;
    if (cancelled) {
      // A new wish has ended it already, and goes on to what it asks for.
      if (store.value.model?.measurement.kind !== 'running') return;
      store.update((state) => transitions.heatMapLeft(transitions.measuringEnded(state, null, t('status.cancelledMeasuring'))));
    } else if (!(await recording.recover(open, error))) {
      update((state) => transitions.heatMapLeft(transitions.measuringEnded(transitions.failed(state, describeError(error)), null, '')));
    }
  } finally {
    if (open.measuring === measuring) open.measuring = null;
  }
}

/** What the live region says of a measurement. */
function describeDeviation({ max, mean, relativeTo }: Deviation): string {
  const share = (value: number): string => formatShare(relativeTo > 0 ? value / relativeTo : 0);
  return t('status.measured', { max: share(max), mean: share(mean) });
}
