// Which part of the canvas shows what: the result alone, original and result at a handle, or both side by side.
import type { Insets, Layout } from './protocol.ts';

/** A state of the model that can be on screen. */
export type SideName = 'original' | 'result';

/** A rectangle in CSS pixels from the canvas's left; all are as high as the canvas. */
export interface Span {
  readonly left: number;
  readonly width: number;
}

/** One picture of the model: the camera's picture lies in `viewport`, and of it `visible` is drawn. */
export interface Pane {
  readonly side: SideName;
  readonly viewport: Span;
  readonly visible: Span;
}

interface Arrangement {
  readonly layout: Layout;
  /** The original alone is wanted. */
  readonly comparing: boolean;
  readonly split: number;
  readonly width: number;
  readonly insets: Insets;
}

/** The panes of a canvas, from left to right. They never overlap. */
export function panesOf({ layout, comparing, split, width, insets }: Arrangement): Pane[] {
  const whole = { left: 0, width };
  if (layout === 'single' || (comparing && layout === 'split')) {
    return [{ side: comparing ? 'original' : 'result', viewport: whole, visible: whole }];
  }
  const free = Math.max(width - insets.left - insets.right, 2);
  if (layout === 'split') {
    const edge = Math.round(insets.left + free * split);
    const panes: Pane[] = [
      { side: 'original', viewport: whole, visible: { left: 0, width: edge } },
      { side: 'result', viewport: whole, visible: { left: edge, width: width - edge } },
    ];
    return panes.filter((pane) => pane.visible.width > 0);
  }
  const half = Math.floor(free / 2);
  const left = { left: insets.left, width: half };
  const right = { left: insets.left + half, width: half };
  return [
    { side: 'original', viewport: left, visible: left },
    { side: comparing ? 'original' : 'result', viewport: right, visible: right },
  ];
}
