// The quality of downloads is kept on this device.
import { PRESETS } from 'decimesh/worker';
import type { Quality } from './state.ts';

const KEY = 'decimesh.quality';

/** The quality chosen on an earlier visit, or balanced. */
export function rememberedQuality(): Quality {
  try {
    const stored = localStorage.getItem(KEY);
    return PRESETS.find((preset) => preset === stored) ?? 'balanced';
  } catch {
    // Storage may be forbidden; then every visit starts anew.
    return 'balanced';
  }
}

/** Keeps `quality` for the next visit. */
export function rememberQuality(quality: Quality): void {
  try {
    localStorage.setItem(KEY, quality);
  } catch {
    // As above.
  }
}
