// Several models at once: the queue, how each of them fares, and one zip of what came out.
import { BATCH_SHARES, batchProgress, countsOf } from '../../batch/batch_state.ts';
import type { BatchItem, BatchState } from '../../batch/batch_state.ts';
import { formatBytes, formatCount, formatShare } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import { noticeText } from '../../notices.ts';
import type { Quality as QualityName } from '../../formats.ts';
import { Icon } from '../icon/icon.tsx';
import { Progress } from '../progress/progress.tsx';
import { Quality } from '../quality/quality.tsx';
import './batch.css';

export interface BatchActions {
  chooseShare(share: number): void;
  chooseQuality(quality: QualityName): void;
  startBatch(): void;
  cancelBatch(): void;
  saveBatch(): void;
  closeBatch(): void;
}

interface BatchProps {
  readonly batch: BatchState;
  readonly quality: QualityName;
  readonly actions: BatchActions;
}

export function Batch({ batch, quality, actions }: BatchProps) {
  const { done, ended } = countsOf(batch);
  return (
    <main class="batch">
      <section class="panel batch-panel" aria-labelledby="batch-title">
        <header>
          <h1 id="batch-title">{t('batch.title', { count: batch.items.length })}</h1>
          <button type="button" class="quiet" aria-label={t('batch.close')} title={t('batch.close')} onClick={actions.closeBatch}>
            <Icon name="close" size={18} />
          </button>
        </header>
        <div class="batch-settings">
          <fieldset class="batch-shares choices" disabled={batch.running}>
            <legend>{t('batch.share')}</legend>
            {BATCH_SHARES.map((share) => (
              <label key={share}>
                <input type="radio" name="batch-share" checked={share === batch.share} onChange={() => actions.chooseShare(share)} />
                <span>{formatShare(share)}</span>
              </label>
            ))}
          </fieldset>
          <Quality quality={quality} onQuality={actions.chooseQuality} />
        </div>
        <ul class="batch-list" tabindex={0} aria-label={t('batch.name')}>
          {batch.items.map((item, index) => <Item key={index} item={item} />)}
        </ul>
        <footer>
          {batch.running ? (
            <Progress fraction={batchProgress(batch)} label={t('batch.running')} onCancel={actions.cancelBatch} />
          ) : (
            <>
              <button type="button" class={done > 0 ? 'secondary' : 'primary'} onClick={actions.startBatch}>{t(ended > 0 ? 'batch.again' : 'batch.start')}</button>
              {done > 0 && (
                <button type="button" class="primary" onClick={actions.saveBatch}>
                  <Icon name="download" />
                  <span>{t('batch.zip')}</span>
                </button>
              )}
            </>
          )}
        </footer>
      </section>
    </main>
  );
}

function Item({ item: { name, result } }: { readonly item: BatchItem }) {
  return (
    <li class={`batch-item ${result.kind}`}>
      <span class="batch-name" title={name}>{name}</span>
      {result.kind === 'done' ? (
        <span class="batch-result">
          <strong>{formatShare(result.after.bytes / Math.max(result.before.bytes, 1))}</strong>
          <span class="visually-hidden">
            {t('batch.change', { before: formatCount(result.before.triangles), after: formatCount(result.after.triangles) })},{' '}
          </span>
          {t('batch.bytes', { before: formatBytes(result.before.bytes), after: formatBytes(result.after.bytes) })}
        </span>
      ) : result.kind === 'failed' ? (
        <span class="batch-error">
          {noticeText(result.notice)} <code>{result.notice.code}</code>
        </span>
      ) : (
        <span class="batch-result">
          {result.kind === 'running' ? `${t('batch.now')}${result.fraction === null ? '' : ` ${formatShare(Math.floor(result.fraction * 100) / 100)}`}` : t(`batch.${result.kind}`)}
        </span>
      )}
    </li>
  );
}
