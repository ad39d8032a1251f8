// The brush as it is set, and what of the page's state changes while it paints.
import type { View } from '../state.ts';

/** The mode in which a drag over the model paints. */
export interface PaintMode {
  /** The brush takes paint away. */
  readonly erase: boolean;
  /** Of the brush, CSS pixels, {@link LEAST_RADIUS} to {@link MOST_RADIUS}. */
  readonly radius: number;
  /** In tenths, 1 to 10: at 10 what is painted stays as it is. */
  readonly strength: number;
  /** Vertices that have paint on them, by what was painted last. */
  readonly count: number;
}

export const LEAST_RADIUS = 4;
export const MOST_RADIUS = 160;
export const MOST_STRENGTH = 10;

/** The brush when it is taken up first. */
export const FIRST_BRUSH: PaintMode = { erase: false, radius: 32, strength: 5, count: 0 };

const shownWhilePainting = new WeakMap<View, View>();

/** How the model is shown while one paints: the original, alone and at rest. The same object for the same settings. */
export function viewForPainting(view: View): View {
  const known = shownWhilePainting.get(view);
  if (known !== undefined) return known;
  const shown: View = {
    ...view,
    comparing: true,
    layout: 'single',
    playing: false,
    turntable: false,
    // Only a level has been measured.
    surface: view.surface === 'deviation' ? 'textured' : view.surface,
  };
  shownWhilePainting.set(view, shown);
  return shown;
}

/** What the package multiplies costs by beside 1, for each value of paint: ten times nearer for each half of it. */
export const weightOfPaint: Float32Array = Float32Array.from({ length: 256 }, (_, value) => 10 ** ((4 * value) / 255) - 1);

/** Paint that locks a vertex. */
export const LOCKING = 255;
