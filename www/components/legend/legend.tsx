// What the colours over the surface mean.
import { t } from '../../messages/messages.ts';
import type { EdgeCounts, Surface } from '../../preview/protocol.ts';
import './legend.css';

interface LegendProps {
  readonly surface: Surface;
  /** Of the edges that are drawn, or null. */
  readonly edgeCounts: EdgeCounts | null;
}

export function Legend({ surface, edgeCounts }: LegendProps) {
  if (edgeCounts === null && surface !== 'normals') return null;
  return (
    <section class="legend" aria-label={t('seeing.legend')}>
      {edgeCounts !== null && (
        <ul>
          <li class="edge-border">{t('seeing.edges.border', { count: edgeCounts.border })}</li>
          <li class="edge-seam">{t('seeing.edges.seam', { count: edgeCounts.seam })}</li>
          <li class="edge-non-manifold">{t('seeing.edges.nonManifold', { count: edgeCounts.nonManifold })}</li>
        </ul>
      )}
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
