// How far the level is from the original: the estimate that every level has, and the button that has it measured.
import { formatShare } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import { canMeasure } from '../../state.ts';
import type { Model } from '../../state.ts';
import './error-figure.css';

interface ErrorFigureProps {
  readonly model: Model;
  /** Whether the level on screen is still to follow. */
  readonly pending: boolean;
  onMeasure(): void;
  onCancel(): void;
}

export function ErrorFigure({ model, pending, onMeasure, onCancel }: ErrorFigureProps) {
  const { source, shown, measurement } = model;
  const share = (length: number): string => formatShare(source.diagonal > 0 ? length / source.diagonal : 0);
  if (measurement.kind === 'done') {
    const { max, mean, rms } = measurement.deviation;
    return (
      <div class="figure error-figure">
        <dt>
          <abbr title={t('results.measured.meaning')}>{t('results.measured')}</abbr>
        </dt>
        <dd>
          <span class="after">
            {share(max)} <small>{t('results.atMost')}</small>
          </span>
          <span class="before">
            {t('results.mean', { mean: share(mean), rms: share(rms) })}
          </span>
        </dd>
      </div>
    );
  }
  return (
    <div class={pending ? 'figure error-figure pending' : 'figure error-figure'}>
      <dt>
        <abbr title={t('results.estimated.meaning')}>{t('results.estimated')}</abbr>
      </dt>
      <dd>
        <span class="after">{share(shown.estimatedError)}</span>
        <span class="before">
          {measurement.kind === 'running' ? <Bar fraction={measurement.fraction} /> : null}
          <Action running={measurement.kind === 'running'} possible={canMeasure(model)} onMeasure={onMeasure} onCancel={onCancel} />
        </span>
      </dd>
    </div>
  );
}

function Bar({ fraction }: { readonly fraction: number }) {
  return (
    <span
      class="progress-bar"
      role="progressbar"
      aria-label={t('results.measuring')}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Math.floor(fraction * 100)}
    >
      <span style={{ transform: `scaleX(${fraction})` }} />
    </span>
  );
}

interface ActionProps {
  readonly running: boolean;
  readonly possible: boolean;
  onMeasure(): void;
  onCancel(): void;
}

// One button for both, or the keyboard's focus would be lost when its meaning changes.
function Action({ running, possible, onMeasure, onCancel }: ActionProps) {
  return (
    <button
      type="button"
      class="measure"
      disabled={!running && !possible}
      aria-label={running ? t('results.cancelMeasuring') : undefined}
      onClick={running ? onCancel : onMeasure}
    >
      {t(running ? 'panel.cancel' : 'results.measure')}
    </button>
  );
}
