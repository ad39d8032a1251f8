// How the model is looked at: fit, wireframe, compare with the original, animation, undo and redo.
import { t } from '../../messages/messages.ts';
import type { View } from '../../state.ts';
import { Icon } from '../icon/icon.tsx';
import type { IconName } from '../icon/icon.tsx';
import './toolbar.css';

interface ToolbarProps {
  readonly view: View;
  readonly animations: readonly string[];
  readonly canUndo: boolean;
  readonly canRedo: boolean;
  onFit(): void;
  onView(change: Partial<View>): void;
  onUndo(): void;
  onRedo(): void;
}

export function Toolbar({ view, animations, canUndo, canRedo, onFit, onView, onUndo, onRedo }: ToolbarProps) {
  const compare = (comparing: boolean) => (): void => onView({ comparing });
  return (
    <div class="toolbar" role="toolbar" aria-label={t('view.toolbar')}>
      <Tool icon="undo" label={t('panel.undo')} keys="Ctrl+Z" disabled={!canUndo} onClick={onUndo} />
      <Tool icon="redo" label={t('panel.redo')} keys="Ctrl+Shift+Z" disabled={!canRedo} onClick={onRedo} />
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
  );
}

interface ToolProps {
  readonly icon: IconName;
  readonly label: string;
  readonly keys: string;
  readonly pressed?: boolean;
  readonly disabled?: boolean;
  onClick(): void;
}

function Tool({ icon, label, keys, pressed, disabled = false, onClick }: ToolProps) {
  return (
    <button type="button" class="tool" aria-label={label} aria-pressed={pressed} title={`${label} (${keys})`} disabled={disabled} onClick={onClick}>
      <Icon name={icon} />
    </button>
  );
}
