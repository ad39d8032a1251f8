// The measured deviation of the level on screen: the button that asks for it, how far it is, the figures.
import { formatShare } from '../../format.ts';
import type { Deviation, Measurement as MeasurementState } from '../../state.ts';
import './measurement.css';

interface MeasurementProps {
  readonly measurement: MeasurementState;
  /** Whether there is a level to be measured, and it is on screen. */
  readonly possible: boolean;
  onMeasure(): void;
  onCancel(): void;
}

export function Measurement({ measurement, possible, onMeasure, onCancel }: MeasurementProps) {
  return (
    <div class="figure measurement">
      <dt>
        <abbr title="Distance between this mesh and the original, sampled both ways; relative to the bounding box’s diagonal">Measured error</abbr>
      </dt>
      <dd>
        {measurement.kind === 'done' ? (
          <Figures {...measurement.deviation} />
        ) : (
          <Action fraction={measurement.kind === 'running' ? measurement.fraction : null} possible={possible} onMeasure={onMeasure} onCancel={onCancel} />
        )}
      </dd>
    </div>
  );
}

function Figures({ max, mean, rms, relativeTo }: Deviation) {
  const share = (value: number): string => formatShare(relativeTo > 0 ? value / relativeTo : 0);
  return (
    <>
      <span class="after">
        {share(max)} <small>max</small>
      </span>
      <span class="before">
        mean {share(mean)} · rms {share(rms)}
      </span>
    </>
  );
}

interface ActionProps extends Omit<MeasurementProps, 'measurement'> {
  /** Null when nothing is being measured. */
  readonly fraction: number | null;
}

// One button for both, or the keyboard's focus would be lost when its meaning changes.
function Action({ fraction, possible, onMeasure, onCancel }: ActionProps) {
  const running = fraction !== null;
  const percent = Math.floor((fraction ?? 0) * 100);
  return (
    <div class="measure-action">
      {running && (
        <div class="progress-bar" role="progressbar" aria-label="Measuring" aria-valuemin={0} aria-valuemax={100} aria-valuenow={percent}>
          <div style={{ transform: `scaleX(${fraction})` }} />
        </div>
      )}
      <button
        key="button"
        type="button"
        disabled={!running && !possible}
        aria-label={running ? 'Cancel measuring' : undefined}
        onClick={running ? onCancel : onMeasure}
      >
        {running ? 'Cancel' : 'Measure'}
      </button>
    </div>
  );
}
