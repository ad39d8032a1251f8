// Levels: whether a level out of one recorded run is as good as a run of its own to that count.
import * as deviation from './support/deviation.mjs';
import { simplifySequence } from '../dist/index.js';
import { simplifyOurs } from './support/engines.mjs';
import { loadModel } from './support/models.mjs';
import { printTable, shown } from './support/report.mjs';
import { geometricMean } from './support/statistics.mjs';

const MODELS = ['stanford-bunny', 'fandisk', 'beast'];
const SHARES = [0.5, 0.25, 0.1, 0.03, 0.01, 0.005];

/** Runs the bench, prints its table and returns everything for `--json`. */
export function levels({ presets, quick }) {
  if (!deviation.available) {
    console.log('levels: SKIPPED: no meter; MESHDIST may name one');
    return { skipped: 'no meter' };
  }
  const cases = (quick ? MODELS.slice(0, 1) : MODELS).flatMap((model) => {
    const mesh = loadModel(model);
    const ofModel = presets.flatMap(({ name, options }) => {
      const sequence = simplifySequence(mesh, options);
      try {
        return SHARES.map((share) => {
          const target = Math.floor((mesh.indices.length / 3) * share);
          const own = deviation.measure(mesh, simplifyOurs(mesh, target, options));
          const level = sequence.level({ triangles: target });
          return { model, preset: name, share, target, own, level: deviation.measure(mesh, level),
            estimatedError: (level.estimatedError / diagonal(mesh)) * 100 };
        });
      } finally {
        sequence.dispose();
      }
    });
    console.error(`levels: ${model} done`);
    return ofModel;
  });
  printTable('levels: rms and maximum in % of the diagonal, out of one run to the end against runs of their own',
    ['case', 'preset', 'own rms', 'level rms', 'share', 'own max', 'level max', 'share', 'estimated'],
    cases.map(({ model, preset, target, own, level, estimatedError }) => [
      `${model} ${target}`, preset, shown(own.rms, 5), shown(level.rms, 5), shown(level.rms / own.rms),
      shown(own.haus, 4), shown(level.haus, 4), shown(level.haus / own.haus), shown(estimatedError, 4),
    ]));
  const means = presets.map(({ name }) => {
    const mine = cases.filter(({ preset }) => preset === name);
    return {
      preset: name,
      rms: geometricMean(mine.map(({ own, level }) => level.rms / own.rms)),
      max: geometricMean(mine.map(({ own, level }) => level.haus / own.haus)),
    };
  });
  printTable('levels: geometric means', ['preset', 'rms', 'max'],
    means.map(({ preset, rms, max }) => [preset, shown(rms), shown(max)]));
  return { cases, means };
}

function diagonal({ positions }) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  positions.forEach((value, at) => {
    low[at % 3] = Math.min(low[at % 3], value);
    high[at % 3] = Math.max(high[at % 3], value);
  });
  return Math.hypot(...low.map((value, axis) => high[axis] - value));
}
