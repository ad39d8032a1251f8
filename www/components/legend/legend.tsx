// What the colours over the surface mean.
import { t } from '../../messages/messages.ts';
import type { EdgeCounts, Surface } from '../../preview/protocol.ts';
import { formatShare } from '../../format.ts';
import { HEAT_COLOURS, heatLimit } from '../../preview/heat.ts';
import type { Measurement } from '../../state.ts';
import './legend.css';

interface LegendProps {
  readonly surface: Surface;
  /** Of the edges that are drawn, or null. */
  readonly edgeCounts: EdgeCounts | null;
  readonly measurement: Measurement;
  /** The model's, in its units. */
  readonly diagonal: number;
}

export function Legend({ surface, edgeCounts, measurement, diagonal }: LegendProps) {
  if (edgeCounts === null && surface !== 'normals' && surface !== 'deviation') return null;
  return (
    <section class="legend" aria-label={t('seeing.legend')}>
      {edgeCounts !== null && (
        <ul>
          <li class="edge-border">{t('seeing.edges.border', { count: edgeCounts.border })}</li>
          <li class="edge-seam">{t('seeing.edges.seam', { count: edgeCounts.seam })}</li>
          <li class="edge-non-manifold">{t('seeing.edges.nonManifold', { count: edgeCounts.nonManifold })}</li>
        </ul>
      )}
      {surface === 'deviation' && <HeatScale measurement={measurement} diagonal={diagonal} />}
      {surface === 'normals' && (
        <ul>
          <li class="direction-right">{t('seeing.normals.right')}</li>
          <li class="direction-up">{t('seeing.normals.up')}</li>
          <li class="direction-viewer">{t('seeing.normals.viewer')}</li>
        </ul>
      )}
    </section>
  );
}

function HeatScale({ measurement, diagonal }: Pick<LegendProps, 'measurement' | 'diagonal'>) {
  if (measurement.kind !== 'done') return <p>{t('seeing.deviationWaiting')}</p>;
  const limit = heatLimit(measurement.deviation);
  const share = (length: number): string => formatShare(diagonal > 0 ? length / diagonal : 0);
  const colours = HEAT_COLOURS.map((parts) => `rgb(${parts.join(' ')})`).join(', ');
  return (
    <div class="heat-scale">
      <p>{t('seeing.deviationScale')}</p>
      <div class="heat-bar" style={{ background: `linear-gradient(to right, ${colours})` }} aria-hidden="true" />
      <p class="heat-ends">
        <span>{share(0)}</span>
        <span>{limit < measurement.deviation.max ? '≥ ' : ''}{share(limit)}</span>
      </p>
    </div>
  );
}
