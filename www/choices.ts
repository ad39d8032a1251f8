// What the user chooses about a model: how far to go, how to simplify, what to save. All of it can be undone, kept for
// the next visit, and written into the page's address.
import { MOST_LODS, isPreset } from 'decimesh/worker';
import { isEncoding } from './encoding.ts';
import type { Encoding } from './encoding.ts';
import { isOutputFormat } from './formats.ts';
import { NO_PREPARATION, readPreparation, writePreparation } from './preparation.ts';
import type { Preparation } from './preparation.ts';
import type { OutputFormat, Quality } from './formats.ts';

/** What attributes can be weighed, by the package's names. */
export const WEIGHTS = ['normal', 'uv', 'color', 'morph'] as const;
export type WeightName = (typeof WEIGHTS)[number];

/** The most that an attribute can weigh here; the package takes more, to no use. */
export const MOST_WEIGHT = 10;

/** What the record of levels depends on: another value needs another run. */
export interface RunSettings {
  readonly lockBorder: boolean;
  readonly prune: boolean;
  /** Multiples of the weights that are found for the model, 0 to {@link MOST_WEIGHT}. */
  readonly weights: Readonly<Record<WeightName, number>>;
  /** Numbers of the meshes that stay as they are, ascending. */
  readonly kept: readonly number[];
  /** The number of the state of what is painted on this model (`paint/history.ts`); 0: nothing is. */
  readonly paint: number;
}

/** What decides the number of triangles: the slider, or a limit that it is set by. */
export type Goal =
  | { readonly kind: 'triangles' }
  /** Largest estimated error, in per cent of the diagonal, above 0. */
  | { readonly kind: 'error'; readonly percent: number }
  /** Largest file, bytes above 0. */
  | { readonly kind: 'size'; readonly bytes: number };

/** All choices but the number of triangles. */
export interface Choices {
  readonly goal: Goal;
  readonly run: RunSettings;
  /** Shares of the triangles of the levels in one file, the finest first; fewer than two: there is one level. */
  readonly lods: readonly number[];
  readonly outputFormat: OutputFormat;
  /** How the geometry is stored where the format has a choice. */
  readonly encoding: Encoding;
  readonly quality: Quality;
  readonly preparation: Preparation;
}

export const DEFAULT_RUN: RunSettings = {
  lockBorder: false,
  prune: false,
  weights: { normal: 1, uv: 1, color: 1, morph: 1 },
  kept: [],
  paint: 0,
};

export const DEFAULT_CHOICES: Choices = {
  goal: { kind: 'triangles' },
  run: DEFAULT_RUN,
  lods: [],
  outputFormat: 'glb',
  encoding: 'none',
  quality: 'balanced',
  preparation: NO_PREPARATION,
};

/** The chain that is offered first. */
export const USUAL_LODS: readonly number[] = [1, 0.5, 0.25, 0.1];

/** The same text for the same settings. */
export const runKey = (run: RunSettings): string => JSON.stringify([run.lockBorder, run.prune, WEIGHTS.map((name) => run.weights[name]), run.kept, run.paint]);

/** Whether a chain of levels would be saved. */
export const isChain = ({ lods, outputFormat }: Pick<Choices, 'lods' | 'outputFormat'>): boolean => lods.length > 1 && outputFormat === 'glb';

/** Shares as people type them, in per cent; those that are no shares are left out, the rest sorted, each once. */
export const readShares = (text: string): number[] =>
  [...new Set((text.match(/\d+(?:\.\d+)?/g) ?? []).map((figure) => Number(figure) / 100).filter((share) => share > 0 && share <= 1))]
    .sort((a, b) => b - a)
    .slice(0, MOST_LODS);

// --- the page's address

/** What an address asks for: choices that differ from the usual, and perhaps a number of triangles. */
export type Wish = Partial<Omit<Choices, 'run'>> & { readonly run?: Partial<RunSettings>; readonly triangles?: number };

const numberIn = (text: string | null, low: number, high: number): number | undefined => {
  const value = text === null || text.trim() === '' ? Number.NaN : Number(text);
  return value >= low && value <= high ? value : undefined;
};

/** Reads `query`; what it does not understand it leaves alone. */
export function readWish(query: URLSearchParams): Wish {
  const triangles = numberIn(query.get('triangles'), 1, Number.MAX_SAFE_INTEGER);
  const percent = numberIn(query.get('error'), 1e-6, 100);
  const bytes = numberIn(query.get('size'), 1, Number.MAX_SAFE_INTEGER);
  const [quality, format, encoding] = ['quality', 'format', 'compression'].map((name) => query.get(name) ?? '') as [string, string, string];
  const preparation = readPreparation(query);
  const lods = readShares((query.get('lods') ?? '').replaceAll(',', ' '));
  const weights = Object.fromEntries(
    (query.get('weights') ?? '').split(',').flatMap((item) => {
      const [name, text = null] = item.split(':');
      const known = WEIGHTS.find((weight) => weight === name);
      const value = numberIn(text, 0, MOST_WEIGHT);
      return known === undefined || value === undefined ? [] : [[known, value]];
    }),
  ) as Partial<Record<WeightName, number>>;
  const kept = (query.get('keep') ?? '').split(',').filter((item) => /^\d{1,6}$/.test(item)).map(Number).sort((a, b) => a - b);
  return {
    ...(triangles === undefined ? {} : { triangles: Math.round(triangles) }),
    ...(percent !== undefined ? { goal: { kind: 'error', percent } } : bytes !== undefined ? { goal: { kind: 'size', bytes } } : {}),
    ...(isPreset(quality) ? { quality } : {}),
    ...(isOutputFormat(format) ? { outputFormat: format } : {}),
    ...(isEncoding(encoding) ? { encoding } : {}),
    ...(lods.length > 1 ? { lods } : {}),
    ...(preparation === null ? {} : { preparation }),
    run: {
      ...(query.has('lock-border') ? { lockBorder: query.get('lock-border') !== '0' } : {}),
      ...(query.has('prune') ? { prune: query.get('prune') !== '0' } : {}),
      ...(Object.keys(weights).length > 0 ? { weights: { ...DEFAULT_RUN.weights, ...weights } } : {}),
      ...(kept.length > 0 ? { kept } : {}),
    },
  };
}

const NAMES = ['triangles', 'error', 'size', 'quality', 'format', 'compression', 'lods', 'weights', 'keep', 'lock-border', 'prune'];

/**
 * Writes into `query` what differs from `usual`, and takes out what does not; other names in it stay. `triangles` is null
 * where nothing was chosen.
 */
export function writeWish(query: URLSearchParams, choices: Choices, triangles: number | null, usual: Choices = DEFAULT_CHOICES): void {
  for (const name of NAMES) query.delete(name);
  const { goal, run, lods, outputFormat, encoding, quality, preparation } = choices;
  writePreparation(query, preparation);
  if (goal.kind === 'error') query.set('error', String(goal.percent));
  else if (goal.kind === 'size') query.set('size', String(goal.bytes));
  else if (triangles !== null) query.set('triangles', String(triangles));
  if (quality !== DEFAULT_CHOICES.quality) query.set('quality', quality);
  if (outputFormat !== usual.outputFormat) query.set('format', outputFormat);
  if (encoding !== usual.encoding) query.set('compression', encoding);
  if (lods.length > 1) query.set('lods', lods.map((share) => Number((share * 100).toPrecision(6))).join(','));
  const weights = weightList(run, ':');
  if (weights !== '') query.set('weights', weights);
  if (run.kept.length > 0) query.set('keep', run.kept.join(','));
  if (run.lockBorder) query.set('lock-border', '1');
  if (run.prune) query.set('prune', '1');
}

/** The weights that are not 1, as `normal=2,uv=0` with `sign` between. */
export const weightList = ({ weights }: RunSettings, sign: string): string =>
  WEIGHTS.filter((name) => weights[name] !== 1).map((name) => `${name}${sign}${weights[name]}`).join(',');

// --- the next visit

const KEY = 'decimesh.choices';

/** Keeps on this device what is not about one model. */
export function rememberChoices({ quality, run, preparation }: Choices): void {
  try {
    const query = new URLSearchParams();
    writeWish(query, { ...DEFAULT_CHOICES, quality, preparation, run: { ...run, kept: [] } }, null);
    const text = query.toString();
    // It is called at every move of the slider, and writing takes longer than reading.
    if (localStorage.getItem(KEY) !== text) localStorage.setItem(KEY, text);
  } catch {
    // Storage may be forbidden; then every visit starts anew.
  }
}

/** What was kept on an earlier visit. */
export function rememberedChoices(): Wish {
  try {
    return readWish(new URLSearchParams(localStorage.getItem(KEY) ?? ''));
  } catch {
    return {};
  }
}

/** `choices` with what `wish` asks for. */
export function withWishes(choices: Choices, wish: Wish): Choices {
  const { goal, lods, outputFormat, encoding, quality, preparation } = { ...choices, ...wish };
  return { goal, lods, outputFormat, encoding, quality, preparation, run: { ...choices.run, ...wish.run } };
}
