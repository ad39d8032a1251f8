// How far the work is, and the button that stops it.
import { t } from '../../messages/messages.ts';
import './progress.css';

interface ProgressProps {
  /** 0..1, or null while that is unknown. */
  readonly fraction: number | null;
  readonly label: string;
  onCancel(): void;
}

export function Progress({ fraction, label, onCancel }: ProgressProps) {
  const percent = fraction === null ? null : Math.floor(fraction * 100);
  return (
    <div class="progress">
      <div
        class={percent === null ? 'progress-bar unknown' : 'progress-bar'}
        role="progressbar"
        aria-label={label}
        aria-valuemin={0}
        aria-valuemax={100}
        {...(percent === null ? {} : { 'aria-valuenow': percent })}
      >
        <div style={{ transform: `scaleX(${fraction ?? 0.3})` }} />
      </div>
      <span class="progress-figure" aria-hidden="true">{percent === null ? '' : t('figure.percent', { value: percent })}</span>
      <button type="button" class="quiet" onClick={onCancel}>{t('panel.cancel')}</button>
    </div>
  );
}
