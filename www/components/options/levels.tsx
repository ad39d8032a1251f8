// A chain of levels of detail in one file: whether, and which shares of the triangles.
import { useState } from 'preact/hooks';
import { USUAL_LODS, readShares } from '../../choices.ts';
import { formatCount, formatShare } from '../../format.ts';
import { t } from '../../messages/messages.ts';
import type { Output } from '../../state.ts';

interface LevelsProps {
  readonly lods: readonly number[];
  /** Whether the format can hold a chain. */
  readonly possible: boolean;
  readonly output: Output | null;
  onLods(lods: readonly number[]): void;
}

const inPercent = (lods: readonly number[]): string => lods.map((share) => Number((share * 100).toPrecision(4))).join(', ');

export function Levels({ lods, possible, output, onLods }: LevelsProps) {
  const [draft, setDraft] = useState<string | null>(null);
  const on = lods.length > 1;
  const commit = (): void => {
    if (draft === null) return;
    setDraft(null);
    const shares = readShares(draft.replaceAll(',', ' '));
    if (shares.length > 1) onLods(shares);
  };
  return (
    <>
      <label class="check">
        <input type="checkbox" checked={on} disabled={!possible} onChange={(event) => onLods(event.currentTarget.checked ? USUAL_LODS : [])} />
        <span>
          {t('levels.on')}
          <span class="hint"> {t(possible ? 'levels.hint' : 'levels.glbOnly')}</span>
        </span>
      </label>
      {on && possible && (
        <span class="shares-field">
          <label for="lod-shares">{t('levels.shares')}</label>
          <input
            id="lod-shares"
            type="text"
            inputMode="decimal"
            autocomplete="off"
            value={draft ?? inPercent(lods)}
            onInput={(event) => setDraft(event.currentTarget.value)}
            onBlur={commit}
            onKeyDown={(event) => event.key === 'Enter' && commit()}
          />
        </span>
      )}
      {on && possible && output !== null && output.levels.length > 0 && (
        <table class="figures">
          <thead>
            <tr>
              <th scope="col">{t('results.triangles')}</th>
              <th scope="col">{t('levels.coverage')}</th>
            </tr>
          </thead>
          <tbody>
            {output.levels.map(({ triangles, screenCoverage }) => (
              <tr key={triangles}>
                <td>{formatCount(triangles)}</td>
                <td>{formatShare(screenCoverage)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </>
  );
}
