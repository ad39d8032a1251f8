// The button `Download` and the choices of its format, compression and quality.
import { holdsEncodings } from 'decimesh/worker';
import { ENCODINGS, isEncoding } from '../../encoding.ts';
import type { Encoding } from '../../encoding.ts';
import { t } from '../../messages/messages.ts';
import { FORMAT_NAMES, isOutputFormat } from '../../formats.ts';
import type { OutputFormat, Quality as QualityName } from '../../formats.ts';
import { Icon } from '../icon/icon.tsx';
import { Quality } from '../quality/quality.tsx';
import './download.css';

interface DownloadProps {
  readonly format: OutputFormat;
  readonly encoding: Encoding;
  readonly quality: QualityName;
  readonly busy: boolean;
  onFormat(format: OutputFormat): void;
  onEncoding(encoding: Encoding): void;
  onQuality(quality: QualityName): void;
  onDownload(): void;
}

export function Download({ format, encoding, quality, busy, onFormat, onEncoding, onQuality, onDownload }: DownloadProps) {
  return (
    <div class="download">
      <Quality quality={quality} onQuality={onQuality} />
      <div class="download-row">
        <button type="button" class="primary" aria-busy={busy} onClick={onDownload}>
          <Icon name="download" />
          <span>{t('download.button')}</span>
        </button>
        <select aria-label={t('download.format')} value={format} onChange={(event) => isOutputFormat(event.currentTarget.value) && onFormat(event.currentTarget.value)}>
          {Object.entries(FORMAT_NAMES).map(([value, name]) => <option key={value} value={value}>{name}</option>)}
        </select>
        {holdsEncodings(format) && (
          <select class="encoding" aria-label={t('download.compression')} value={encoding} onChange={(event) => isEncoding(event.currentTarget.value) && onEncoding(event.currentTarget.value)}>
            {ENCODINGS.map(({ value }) => <option key={value} value={value}>{t(`encoding.${value}`)}</option>)}
          </select>
        )}
      </div>
    </div>
  );
}
