// The button `Download` and the choice of its format.
import { FORMAT_NAMES, isOutputFormat } from '../../state.ts';
import type { OutputFormat } from '../../state.ts';
import { Icon } from '../icon/icon.tsx';
import './download.css';

interface DownloadProps {
  readonly format: OutputFormat;
  readonly busy: boolean;
  onFormat(format: OutputFormat): void;
  onDownload(): void;
}

export function Download({ format, busy, onFormat, onDownload }: DownloadProps) {
  return (
    <div class="download">
      <button type="button" class="primary" aria-busy={busy} onClick={onDownload}>
        <Icon name="download" />
        <span>Download</span>
      </button>
      <select aria-label="File format" value={format} onChange={(event) => isOutputFormat(event.currentTarget.value) && onFormat(event.currentTarget.value)}>
        {Object.entries(FORMAT_NAMES).map(([value, name]) => <option key={value} value={value}>{name}</option>)}
      </select>
    </div>
  );
}
