// What attributes weigh beside the shape: a slider each, in multiples of what is found for the model.
import { MOST_WEIGHT, WEIGHTS } from '../../choices.ts';
import type { WeightName } from '../../choices.ts';
import { currentLanguage, t } from '../../messages/messages.ts';

interface WeightsProps {
  readonly weights: Readonly<Record<WeightName, number>>;
  onWeights(weights: Readonly<Record<WeightName, number>>): void;
}

/** Steps of the slider on either side of 1, which is in its middle. */
const STEPS = 10;

/** 0 … 1 in tenths, then 1 … {@link MOST_WEIGHT} in equal ratios. */
const weightAt = (step: number): number =>
  step <= STEPS ? step / STEPS : Number((MOST_WEIGHT ** ((step - STEPS) / STEPS)).toPrecision(2));

const stepOf = (weight: number): number =>
  Math.round(weight <= 1 ? weight * STEPS : STEPS + (Math.log(weight) / Math.log(MOST_WEIGHT)) * STEPS);

export function Weights({ weights, onWeights }: WeightsProps) {
  return (
    <fieldset class="weights">
      <legend>{t('weights.name')}</legend>
      <p class="hint">{t('weights.hint')}</p>
      {WEIGHTS.map((name) => (
        <div key={name} class="weight">
          <label for={`weight-${name}`}>{t(`weights.${name}`)}</label>
          <input
            id={`weight-${name}`}
            type="range"
            min={0}
            max={2 * STEPS}
            step={1}
            value={stepOf(weights[name])}
            aria-valuetext={`× ${weights[name].toLocaleString(currentLanguage())}`}
            // Each value is a run of its own: it counts when the slider is let go.
            onChange={(event) => onWeights({ ...weights, [name]: weightAt(event.currentTarget.valueAsNumber) })}
          />
          <span class="weight-value" aria-hidden="true">× {weights[name].toLocaleString(currentLanguage())}</span>
        </div>
      ))}
    </fieldset>
  );
}
