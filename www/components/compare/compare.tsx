// The handle between original and result, and what says which of the two is where.
import { t } from '../../messages/messages.ts';
import type { Insets, Layout } from '../../preview/protocol.ts';
import { clamp } from '../../state.ts';
import './compare.css';

interface CompareProps {
  readonly layout: Layout;
  /** Share of the free width left of the handle, 0..1. */
  readonly split: number;
  /** The original alone is shown. */
  readonly comparing: boolean;
  readonly insets: Insets;
  onSplit(split: number): void;
}

const STEP = 0.02;
const PAGE = 0.1;

export function Compare({ layout, split, comparing, insets, onSplit }: CompareProps) {
  if (layout === 'single') return null;
  const share = layout === 'beside' ? 0.5 : split;
  return (
    <div class="compare" style={{ left: `${insets.left}px`, right: `${insets.right}px`, bottom: `${insets.bottom}px` }}>
      {(layout === 'beside' || !comparing) && (
        <>
          <p class="side-name before" style={{ right: `${100 * (1 - share)}%` }} aria-hidden={share < 0.04}>{t('seeing.original')}</p>
          <p class="side-name after" style={{ left: `${100 * share}%` }} aria-hidden={share > 0.96}>
            {t(comparing ? 'seeing.original' : 'seeing.result')}
          </p>
        </>
      )}
      {layout === 'beside' ? <div class="divider" style={{ left: '50%' }} /> : !comparing && <Handle split={split} onSplit={onSplit} />}
    </div>
  );
}

function Handle({ split, onSplit }: Pick<CompareProps, 'split' | 'onSplit'>) {
  const percent = Math.round(100 * split);
  const set = (to: number): void => onSplit(clamp(to, 0, 1));
  const follow = (event: PointerEvent & { readonly currentTarget: HTMLElement }): void => {
    const area = event.currentTarget.parentElement?.getBoundingClientRect();
    if (area !== undefined && area.width > 0) set((event.clientX - area.left) / area.width);
  };
  return (
    <div
      class="divider handle"
      style={{ left: `${100 * split}%` }}
      role="separator"
      tabindex={0}
      aria-orientation="vertical"
      aria-label={t('seeing.handle')}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={percent}
      aria-valuetext={t('seeing.handleValue', { share: percent })}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        event.currentTarget.focus();
        event.preventDefault();
      }}
      onPointerMove={(event) => {
        if (event.currentTarget.hasPointerCapture(event.pointerId)) follow(event);
      }}
      onKeyDown={(event) => {
        const to = keyed(event.key, split);
        if (to === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
        event.preventDefault();
        set(to);
      }}
    >
      <svg class="grip" width="44" height="44" viewBox="0 0 44 44" aria-hidden="true">
        <path d="M18 15l-7 7 7 7M26 15l7 7-7 7" />
      </svg>
    </div>
  );
}

function keyed(key: string, split: number): number | undefined {
  switch (key) {
    case 'ArrowLeft':
    case 'ArrowDown':
      return split - STEP;
    case 'ArrowRight':
    case 'ArrowUp':
      return split + STEP;
    case 'PageDown':
      return split - PAGE;
    case 'PageUp':
      return split + PAGE;
    case 'Home':
      return 0;
    case 'End':
      return 1;
    default:
      return undefined;
  }
}
