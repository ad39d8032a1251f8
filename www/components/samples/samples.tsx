// The sample models as buttons, with their pictures.
import type { Sample } from '../../samples/samples.ts';
import { formatBytes } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import './samples.css';

interface SamplesProps {
  readonly samples: readonly Sample[];
  onChoose(sample: Sample): void;
}

export function Samples({ samples, onChoose }: SamplesProps) {
  return (
    <ul class="samples">
      {samples.map((sample) => (
        <li key={sample.name}>
          <button type="button" onClick={() => onChoose(sample)}>
            <img src={sample.picture} alt="" width={96} height={96} />
            <span class="sample-name">{sample.name}</span>
            <span class="sample-shows">{t(`sample.${sample.shows}`)}</span>
            <span class="sample-count">{t('sample.triangles', { count: sample.triangles })}, {formatBytes(sample.bytes)}</span>
          </button>
        </li>
      ))}
    </ul>
  );
}
