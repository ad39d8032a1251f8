// The choice of how good the downloaded level is: three radio buttons that look like one control.
import { t } from '../../messages/messages.ts';
import { QUALITIES } from '../../formats.ts';
import type { Quality as QualityName } from '../../formats.ts';
import './quality.css';

interface QualityProps {
  readonly quality: QualityName;
  onQuality(quality: QualityName): void;
}

export function Quality({ quality, onQuality }: QualityProps) {
  return (
    <fieldset class="quality">
      <legend>{t('quality.name')}</legend>
      <div class="quality-choices choices">
        {QUALITIES.map((value) => (
          <label key={value} title={t(`quality.${value}.meaning`)}>
            <input
              type="radio"
              name="quality"
              value={value}
              checked={value === quality}
              aria-describedby={`quality-${value}`}
              onChange={() => onQuality(value)}
            />
            <span>{t(`quality.${value}`)}</span>
            <span id={`quality-${value}`} class="visually-hidden" aria-hidden="true">{t(`quality.${value}.meaning`)}</span>
          </label>
        ))}
      </div>
    </fieldset>
  );
}
