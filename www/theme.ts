// Dark and light: the choice is kept on this device, the colours live in styles/tokens.css.
import type { ViewTheme } from './preview/protocol.ts';
import type { View } from './state.ts';

type Theme = View['theme'];
const KEY = 'decimesh.theme';
const systemDark = matchMedia('(prefers-color-scheme: dark)');

/** The theme chosen on an earlier visit, or the system's. */
export function rememberedTheme(): Theme {
  try {
    const stored = localStorage.getItem(KEY);
    return stored === 'light' || stored === 'dark' ? stored : 'system';
  } catch {
    // Storage may be forbidden; then every visit starts anew.
    return 'system';
  }
}

/** Shows `theme` on the page and keeps it; returns what the view needs to follow. */
export function applyTheme(theme: Theme): ViewTheme {
  const root = document.documentElement;
  if (theme === 'system') delete root.dataset['theme'];
  else root.dataset['theme'] = theme;
  try {
    if (theme === 'system') localStorage.removeItem(KEY);
    else localStorage.setItem(KEY, theme);
  } catch {
    // As above.
  }
  const dark = theme === 'dark' || (theme === 'system' && systemDark.matches);
  const style = getComputedStyle(root);
  const colour = (name: string): string => style.getPropertyValue(name).trim() || '#000';
  const edges = { border: colour('--edge-border'), seam: colour('--edge-seam'), nonManifold: colour('--edge-non-manifold') };
  return { lines: colour('--wire'), edges, lineOpacity: dark ? 0.15 : 0.26, shadowOpacity: dark ? 0.6 : 0.36 };
}

/** Calls `act` when the system changes between dark and light. */
export function watchSystemTheme(act: () => void): void {
  systemDark.addEventListener('change', act);
}
