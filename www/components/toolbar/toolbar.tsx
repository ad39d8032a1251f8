// How the model is looked at: fit, wireframe, compare with the original, more options, animation, undo and redo.
import { useRef, useState } from 'preact/hooks';
import { t } from '../../messages/messages.ts';
import type { Insets, ViewContents } from '../../preview/protocol.ts';
import type { View } from '../../state.ts';
import { Icon } from '../icon/icon.tsx';
import type { IconName } from '../icon/icon.tsx';
import { ViewOptions } from '../view-options/view-options.tsx';
import './toolbar.css';

interface ToolbarProps {
  readonly view: View;
  readonly contents: ViewContents;
  readonly insets: Insets;
  readonly animations: readonly string[];
  readonly canUndo: boolean;
  readonly canRedo: boolean;
  readonly reducedMotion: boolean;
  readonly painting: boolean;
  readonly fetchingBrush: boolean;
  onFit(): void;
  onPaint(): void;
  onView(change: Partial<View>): void;
  onMorph(index: number, weight: number | null): void;
  onUndo(): void;
  onRedo(): void;
}

const OPTIONS = 'view-options';

export function Toolbar({ view, contents, insets, animations, canUndo, canRedo, reducedMotion, painting, fetchingBrush, onFit, onPaint, onView, onMorph, onUndo, onRedo }: ToolbarProps) {
  const [open, setOpen] = useState(false);
  const opener = useRef<HTMLButtonElement>(null);
  const compare = (comparing: boolean) => (): void => onView({ comparing });
  const close = (): void => {
    setOpen(false);
    opener.current?.focus();
  };
  return (
    <div style={{ '--inset-right': `${insets.right}px`, '--inset-bottom': `${insets.bottom}px` }}>
      <div class="toolbar" role="toolbar" aria-label={t('view.toolbar')}>
        <Tool icon="undo" label={t('panel.undo')} keys="Ctrl+Z" disabled={!canUndo} onClick={onUndo} />
        <Tool icon="redo" label={t('panel.redo')} keys="Ctrl+Shift+Z" disabled={!canRedo} onClick={onRedo} />
        <Tool icon="brush" label={t('paint.name')} keys="B" pressed={painting} busy={fetchingBrush} onClick={onPaint} />
        <span class="toolbar-gap" />
        <Tool icon="fit" label={t('view.fit')} keys="F" onClick={onFit} />
        <Tool icon="wireframe" label={t('view.wireframe')} keys="W" pressed={view.wireframe} onClick={() => onView({ wireframe: !view.wireframe })} />
        <button
          type="button"
          class="tool"
          aria-label={t('view.compare')}
          aria-pressed={view.comparing}
          title={`${t('view.compare')} (C)`}
          onPointerDown={(event) => {
            event.currentTarget.setPointerCapture(event.pointerId);
            onView({ comparing: true });
          }}
          onPointerUp={compare(false)}
          onPointerCancel={compare(false)}
          onBlur={compare(false)}
          onContextMenu={(event) => event.preventDefault()}
          onKeyDown={(event) => {
            if (event.key === ' ' || event.key === 'Enter') {
              event.preventDefault();
              if (!event.repeat) onView({ comparing: true });
            }
          }}
          onKeyUp={(event) => {
            if (event.key === ' ' || event.key === 'Enter') onView({ comparing: false });
          }}
        >
          <Icon name="compare" />
        </button>
        <Tool
          icon="split"
          label={t('seeing.handle')}
          keys="S"
          pressed={view.layout === 'split'}
          onClick={() => onView({ layout: view.layout === 'split' ? 'single' : 'split' })}
        />
        <button
          ref={opener}
          type="button"
          class="tool"
          aria-label={t('seeing.options')}
          aria-expanded={open}
          aria-controls={open ? OPTIONS : undefined}
          title={t('seeing.options')}
          onClick={() => setOpen(!open)}
        >
          <Icon name="options" />
        </button>
        {animations.length > 0 && (
          <>
            <span class="toolbar-gap" />
            <Tool
              icon={view.playing ? 'pause' : 'play'}
              label={t(view.playing ? 'view.pause' : 'view.play')}
              keys="Space"
              onClick={() => onView({ playing: !view.playing })}
            />
          </>
        )}
        {animations.length > 1 && (
          <select aria-label={t('view.animation')} value={view.animation} onChange={(event) => onView({ animation: Number(event.currentTarget.value) })}>
            {animations.map((name, index) => (
              <option key={index} value={index}>{name}</option>
            ))}
          </select>
        )}
      </div>
      {open && (
        <ViewOptions id={OPTIONS} view={view} contents={contents} reducedMotion={reducedMotion} onView={onView} onMorph={onMorph} onClose={close} />
      )}
    </div>
  );
}

interface ToolProps {
  readonly icon: IconName;
  readonly label: string;
  readonly keys: string;
  readonly pressed?: boolean;
  readonly busy?: boolean;
  readonly disabled?: boolean;
  onClick(): void;
}

function Tool({ icon, label, keys, pressed, busy, disabled = false, onClick }: ToolProps) {
  return (
    <button type="button" class="tool" aria-label={label} aria-pressed={pressed} aria-busy={busy} title={`${label} (${keys})`} disabled={disabled} onClick={onClick}>
      <Icon name={icon} />
    </button>
  );
}
