// Contrast of the page's colours as WCAG 2.2 computes it (relative luminance): axe cannot see through what lies over a
// canvas, so the colours themselves are checked, each text on each ground that it stands on.
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { at } from '../scripts/project.mjs';

const css = readFileSync(at('www', 'styles', 'tokens.css'), 'utf8');
const themed = (which: 1 | 2): string => css.replace(/light-dark\((#\w+|rgb\([^)]*\)), (#\w+|rgb\([^)]*\))\)/g, `$${which}`);
const THEMES = { light: themed(1), dark: themed(2) };

it('the browser paints its own bars in the colour of the paper', () => {
  const paper = (theme: string): string => /--paper: (#\w+);/.exec(theme)?.[1] ?? 'none';
  const page = readFileSync(at('www', 'index.html'), 'utf8');
  expect(page).toContain(`media="(prefers-color-scheme: light)" content="${paper(THEMES.light)}"`);
  expect(page).toContain(`media="(prefers-color-scheme: dark)" content="${paper(THEMES.dark)}"`);
  const manifest = JSON.parse(readFileSync(at('www', 'public', 'manifest.webmanifest'), 'utf8')) as Record<string, unknown>;
  expect(manifest).toMatchObject({ background_color: paper(THEMES.light), theme_color: paper(THEMES.light) });
});

type Color = readonly [number, number, number];

/** A colour of `theme`, over `ground` where it is translucent. */
function color(theme: string, name: string, ground: Color = [0, 0, 0]): Color {
  const value = new RegExp(`--${name}: ([^;]+);`).exec(theme)?.[1] ?? '';
  const hex = /^#(..)(..)(..)$/.exec(value);
  if (hex !== null) return hex.slice(1).map((part) => Number.parseInt(part, 16)) as unknown as Color;
  const [, red, green, blue, alpha] = /^rgb\((\d+) (\d+) (\d+) \/ (\d+)%\)$/.exec(value) ?? [];
  if (alpha === undefined) throw new Error(`no colour --${name}: ${value}`);
  const share = Number(alpha) / 100;
  return [red, green, blue].map((part, index) => Number(part) * share + (ground[index] as number) * (1 - share)) as unknown as Color;
}

const luminance = (of: Color): number => {
  const [red, green, blue] = of.map((part) => (part / 255 <= 0.04045 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4)) as [number, number, number];
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
};

const contrast = (one: Color, other: Color): number => {
  const [darker, lighter] = [luminance(one), luminance(other)].sort((a, b) => a - b) as [number, number];
  return (lighter + 0.05) / (darker + 0.05);
};

describe.each(Object.entries(THEMES))('the %s theme', (_, theme) => {
  const papers = ['paper', 'paper-edge'].map((name) => color(theme, name));
  const panels = [color(theme, 'panel-solid'), ...papers.map((paper) => color(theme, 'panel', paper))];
  const hovered = panels.map((panel) => color(theme, 'hover', panel));

  it('has text of at least 4.5 to 1 on all it stands on', () => {
    for (const ground of [...papers, ...panels, ...hovered]) {
      for (const name of ['ink', 'accent-text', 'muted']) expect(contrast(color(theme, name), ground), name).toBeGreaterThanOrEqual(4.5);
    }
    for (const ground of panels) expect(contrast(color(theme, 'danger'), ground)).toBeGreaterThanOrEqual(4.5);
    expect(contrast(color(theme, 'danger'), color(theme, 'danger-paper'))).toBeGreaterThanOrEqual(4.5);
    expect(contrast(color(theme, 'muted'), color(theme, 'danger-paper'))).toBeGreaterThanOrEqual(4.5);
    for (const name of ['accent', 'accent-hover']) expect(contrast(color(theme, 'on-accent'), color(theme, name)), name).toBeGreaterThanOrEqual(4.5);
  });

  it('has fields and the focus of at least 3 to 1', () => {
    for (const ground of panels) {
      expect(contrast(color(theme, 'field-line', ground), ground)).toBeGreaterThanOrEqual(3);
      expect(contrast(color(theme, 'focus'), ground)).toBeGreaterThanOrEqual(3);
    }
  });
});
