// What stands beside the model, or over it on a telephone: a titled panel that takes the focus and gives it back.
import type { ComponentChildren } from 'preact';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../../messages/messages.ts';
import { Icon } from '../icon/icon.tsx';
import './sheet.css';

interface SheetProps {
  readonly title: string;
  /** Pixels at the bottom that are taken. */
  readonly bottom: number;
  onClose(): void;
  readonly children: ComponentChildren;
}

export function Sheet({ title, bottom, onClose, children }: SheetProps) {
  const heading = useRef<HTMLHeadingElement>(null);
  // Before anything is painted: a key that follows at once is the sheet's already.
  useLayoutEffect(() => {
    const before = document.activeElement;
    heading.current?.focus({ preventScroll: true });
    return () => {
      if (before instanceof HTMLElement && before.isConnected) before.focus({ preventScroll: true });
    };
  }, []);
  return (
    <section class="panel sheet" role="dialog" aria-labelledby="sheet-title" style={{ '--dock': `${bottom}px` }} data-inset-left>
      <header class="sheet-head">
        <h2 id="sheet-title" tabindex={-1} ref={heading}>{title}</h2>
        <button type="button" class="quiet" aria-label={t('sheet.close')} title={`${t('sheet.close')} (Esc)`} onClick={onClose}>
          <Icon name="close" size={18} />
        </button>
      </header>
      {/* Scrolled by keys too, also where nothing in it takes the focus. */}
      <div class="sheet-body" tabindex={0} role="group" aria-labelledby="sheet-title">{children}</div>
    </section>
  );
}
