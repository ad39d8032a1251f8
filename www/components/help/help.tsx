// The keys of the page, in a dialog of their own.
import { useEffect, useRef } from 'preact/hooks';
import { t } from '../../messages/messages.ts';
import type { PlainKey } from '../../messages/messages.ts';
import { Icon } from '../icon/icon.tsx';
import './help.css';

/** Keys as they are printed on keyboards, and what they do. */
const KEYS: ReadonlyArray<readonly [keys: readonly string[], meaning: PlainKey]> = [
  [['←', '→', 'PgUp', 'PgDn'], 'help.slider'],
  [['Shift', '←', '→'], 'help.one'],
  [['Home', 'End'], 'help.ends'],
  [['Ctrl+Z'], 'panel.undo'],
  [['Ctrl+Shift+Z'], 'panel.redo'],
  [['O'], 'help.options'],
  [['I'], 'help.details'],
  [['Ctrl+S'], 'help.download'],
  [['←', '→', '↑', '↓'], 'help.turn'],
  [['+', '−'], 'help.zoom'],
  [['F'], 'view.fit'],
  [['W'], 'view.wireframe'],
  [['S'], 'seeing.handle'],
  [['E'], 'seeing.edges'],
  [['C'], 'view.compare'],
  [['B'], 'paint.name'],
  [['Space', '←', '→', '↑', '↓'], 'help.paint'],
  [[',', '.', '1 … 0', 'X'], 'help.brush'],
  [['Esc'], 'help.cancel'],
  [['?'], 'help.open'],
];

export function Help({ onClose }: { onClose(): void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    dialog.current?.showModal();
  }, []);
  return (
    <dialog
      ref={dialog}
      class="help"
      aria-labelledby="help-title"
      onClose={onClose}
      // Outside of its box is the backdrop.
      onClick={(event) => event.target === event.currentTarget && event.currentTarget.close()}
    >
      <div class="help-body">
        <header>
          <h2 id="help-title">{t('help.title')}</h2>
          <button type="button" class="quiet" aria-label={t('sheet.close')} onClick={() => dialog.current?.close()}>
            <Icon name="close" size={18} />
          </button>
        </header>
        <dl>
          {KEYS.map(([keys, meaning]) => (
            <div key={meaning}>
              <dt>{keys.map((key) => <kbd key={key}>{key}</kbd>)}</dt>
              <dd>{t(meaning)}</dd>
            </div>
          ))}
        </dl>
        <p class="hint">{t('help.mouse')}</p>
      </div>
    </dialog>
  );
}
