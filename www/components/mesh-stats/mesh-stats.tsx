// What the file was and what it has become: counts, size and error, side by side.
import type { ComponentChildren } from 'preact';
import { formatBytes, formatCount, formatShare } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import type { Model } from '../../state.ts';
import { ErrorFigure } from '../error-figure/error-figure.tsx';
import './mesh-stats.css';

interface MeshStatsProps {
  readonly model: Model;
  /** Whether the level on screen is still to follow. */
  readonly pending: boolean;
  /** Whether the size belongs to what is wanted now. */
  readonly outputCurrent: boolean;
  onMeasure(): void;
  onCancel(): void;
}

export function MeshStats({ model, pending, outputCurrent, onMeasure, onCancel }: MeshStatsProps) {
  const { source, shown, output } = model;
  return (
    <dl class="mesh-stats">
      <Figure name={t('results.triangles')} before={formatCount(source.triangles)} after={formatCount(shown.triangles)} change={shown.triangles / source.triangles} pending={pending} />
      <Figure name={t('results.vertices')} before={formatCount(source.vertices)} after={formatCount(shown.vertices)} change={shown.vertices / source.vertices} pending={pending} />
      <Figure
        name={t('results.size')}
        before={formatBytes(source.bytes)}
        after={output === null ? '…' : formatBytes(output.bytes)}
        change={output === null ? null : output.bytes / source.bytes}
        pending={!outputCurrent}
      />
      <ErrorFigure model={model} pending={pending} onMeasure={onMeasure} onCancel={onCancel} />
    </dl>
  );
}

interface FigureProps {
  readonly name: ComponentChildren;
  readonly before: string;
  readonly after: string;
  /** After as a share of before. */
  readonly change: number | null;
  readonly pending: boolean;
}

function Figure({ name, before, after, change, pending }: FigureProps) {
  return (
    <div class={pending ? 'figure pending' : 'figure'}>
      <dt>{name}</dt>
      <dd>
        <span class="after">{after}</span>
        <span class="before">
          {t('results.of', { before })}
          {change !== null && <span class="change"> · {formatShare(change)}</span>}
        </span>
      </dd>
    </div>
  );
}
