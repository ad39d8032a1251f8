// The controls of the brush: paint or erase, how large, how strong, clear, done; and what the hand does with it.
import { formatShare } from '../format.ts';
import { t } from '../messages/messages.ts';
import type { Insets } from '../preview/protocol.ts';
import { LEAST_RADIUS, MOST_RADIUS, MOST_STRENGTH } from './mode.ts';
import type { PaintMode } from './mode.ts';
import './paint.css';

interface PaintBarProps {
  readonly mode: PaintMode;
  readonly insets: Insets;
  /** Whether there is any paint to clear. */
  readonly painted: boolean;
  readonly actions: {
    set(change: Partial<PaintMode>): void;
    clear(): void;
    leave(): void;
  };
}

export function PaintBar({ mode, insets, painted, actions }: PaintBarProps) {
  const { erase, radius, strength, count } = mode;
  const strengthText = strength === MOST_STRENGTH ? t('paint.keep') : formatShare(strength / MOST_STRENGTH);
  return (
    <section class="panel paint-bar" aria-label={t('paint.name')} style={{ '--left': `${insets.left}px`, '--right': `${insets.right}px` }}>
      <div class="paint-controls">
        <fieldset class="paint-choices choices">
          <legend class="visually-hidden">{t('paint.way')}</legend>
          {([[false, 'paint.paint'], [true, 'paint.erase']] as const).map(([value, name]) => (
            <label key={name} title={`${t(name)} (X)`}>
              <input type="radio" name="paint-way" checked={erase === value} onChange={() => actions.set({ erase: value })} />
              <span>{t(name)}</span>
            </label>
          ))}
        </fieldset>
        <label class="paint-slider" title={`${t('paint.size')} (, .)`}>
          <span>{t('paint.size')}</span>
          <input
            type="range"
            min={LEAST_RADIUS}
            max={MOST_RADIUS}
            step={1}
            value={radius}
            aria-valuetext={t('paint.pixels', { count: 2 * radius })}
            onInput={(event) => actions.set({ radius: event.currentTarget.valueAsNumber })}
          />
          <span class="paint-value" aria-hidden="true">{2 * radius} px</span>
        </label>
        <label class="paint-slider" title={`${t('paint.strength')} (1 … 9, 0)`}>
          <span>{t('paint.strength')}</span>
          <input
            type="range"
            min={1}
            max={MOST_STRENGTH}
            step={1}
            value={strength}
            aria-valuetext={strengthText}
            onInput={(event) => actions.set({ strength: event.currentTarget.valueAsNumber })}
          />
          <span class="paint-value" aria-hidden="true">{formatShare(strength / MOST_STRENGTH)}</span>
        </label>
        <div class="paint-buttons">
          <button type="button" class="secondary" disabled={!painted} onClick={actions.clear}>{t('paint.clear')}</button>
          <button type="button" class="secondary paint-done" title={`${t('paint.done')} (Esc)`} onClick={actions.leave}>{t('paint.done')}</button>
        </div>
      </div>
      <div class="paint-words">
        <p class="hint">{t(strength === MOST_STRENGTH ? 'paint.hintKeep' : 'paint.hint')} {t('paint.turn')}</p>
        <p class="hint paint-count" aria-live="polite">{count === 0 ? t('paint.none') : t('paint.count', { count })}</p>
      </div>
    </section>
  );
}
