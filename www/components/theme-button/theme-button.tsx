// Dark, light or as the system has it, in turn.
import type { View } from '../../state.ts';
import { t } from '../../messages/messages.ts';
import { Icon } from '../icon/icon.tsx';

const NEXT = { system: 'light', light: 'dark', dark: 'system' } as const;
const ICONS = { system: 'system', light: 'sun', dark: 'moon' } as const;

export function ThemeButton({ theme, onTheme }: { readonly theme: View['theme']; onTheme(theme: View['theme']): void }) {
  const label = t(`theme.${theme}`);
  return (
    <button type="button" class="quiet theme-button" aria-label={label} title={label} onClick={() => onTheme(NEXT[theme])}>
      <Icon name={ICONS[theme]} />
    </button>
  );
}
