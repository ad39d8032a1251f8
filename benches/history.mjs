// History: how long a level takes against copying its buffers, and what recording costs in time and bytes.
import { simplify, simplifySequence } from '../dist/index.js';
import { benchModel } from './support/models.mjs';
import { atMost, none, printGoals, printTable, shown } from './support/report.mjs';
import { median, timeTogether } from './support/statistics.mjs';

const MODEL = { full: 'stanford-bunny*16', quick: 'stanford-bunny*4' };
const SHARES = [1, 0.75, 0.5, 0.25, 0.1, 0.01];

/** Time of a level as a multiple of copying buffers of its size. */
const LEVEL_LIMIT = 1.5;

/** Runs the bench, prints its tables and returns everything for `--json`. */
export function history({ presets, quick }) {
  const name = quick ? MODEL.quick : MODEL.full;
  const mesh = benchModel(name);
  const triangles = mesh.indices.length / 3;
  const results = presets.map((preset) => {
    const result = measure(mesh, triangles, preset);
    console.error(`history: ${preset.name} done`);
    return { preset: preset.name, ...result };
  });
  for (const { preset, levels, recording } of results) {
    printTable(`history, ${preset}: levels of ${triangles} triangles, milliseconds, medians`,
      ['level', 'triangles', 'extract', 'copy', 'extract/copy', '/full copy', 'error'],
      levels.map((level) => [`${level.share * 100} %`, String(level.triangles), shown(level.extract, 2), shown(level.copy, 2),
        shown(level.times, 1), shown(level.extract / levels[0].copy, 1), level.error.toExponential(3)]));
    printTable(`history, ${preset}: the whole record`, ['', 'ms'], [
      ['simplify to 1 % (the call)', shown(recording.simplify, 0)],
      ['record to 1 %', shown(recording.recordToTarget, 0)],
      ['record to the end', shown(recording.recordToEnd, 0)],
      ['first level, and the index', shown(recording.firstLevel, 0)],
    ]);
  }
  const goals = results.flatMap(({ preset, levels, faults }) => [
    atMost(`${preset}: slowest level / copy`, Math.max(...levels.map(({ times }) => times)), LEVEL_LIMIT),
    none(`${preset}: error falls along the sequence, or the full level is not the input`, faults, levels.length),
  ]);
  printGoals('history: what must hold', goals);
  return { model: name, triangles, results, goals };
}

function measure(mesh, triangles, { options }) {
  const least = Math.max(1, Math.floor(triangles * 0.01));
  const recording = recordingCost(mesh, least, options);
  const sequence = simplifySequence(mesh, options);
  try {
    const faults = [];
    // The first level that is not the last of the record makes the index for all.
    const began = performance.now();
    sequence.level({ triangles: least });
    recording.firstLevel = performance.now() - began;
    let error = -1;
    const levels = SHARES.map((share) => {
      const target = Math.floor(triangles * share);
      const level = sequence.level({ triangles: target });
      if (level.estimatedError < error) faults.push(`error falls at ${share * 100} %`);
      error = level.estimatedError;
      if (share === 1) faults.push(...differences(mesh, level));
      // Copied from buffers of the level's own size: what any extraction at least has to write, three arrays.
      const arrays = [level.positions, level.indices, level.vertexMap];
      const [extract, copy] = timeTogether(
        [() => sequence.level({ triangles: target }).indices, () => arrays.map((array) => array.slice())],
        { least: 3, most: 9, seconds: 5 },
      ).map(median);
      return { share, triangles: level.indices.length / 3, extract, copy, times: extract / copy, error };
    });
    return { levels, recording, faults };
  } finally {
    sequence.dispose();
  }
}

/** What makes the level at full count not the input: the same triangles, by position, in the same order. */
function differences({ positions, indices }, level) {
  if (level.indices.length !== indices.length) return [`${level.indices.length / 3} triangles at full count`];
  for (let corner = 0; corner < indices.length; corner += 1) {
    for (let axis = 0; axis < 3; axis += 1) {
      if (level.positions[3 * level.indices[corner] + axis] !== positions[3 * indices[corner] + axis]) {
        return [`corner ${corner} is elsewhere at full count`];
      }
    }
  }
  return [];
}

/**
 * The same run as a call that is thrown away and as a record that is kept. The public surface always records, so an
 * engine that does it at no cost shows no difference here; the share of recording inside is the native bench's matter.
 */
function recordingCost(mesh, target, options) {
  const keep = (targets) => simplifySequence(mesh, { ...targets, ...options }).dispose();
  const [call, recordToTarget, recordToEnd] = timeTogether(
    [() => simplify(mesh, { triangles: target, ...options }).indices, () => keep({ triangles: target }), () => keep({})],
    { least: 3, most: 3 },
  ).map(median);
  return { simplify: call, recordToTarget, recordToEnd };
}
