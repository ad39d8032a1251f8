// Memory: by how much the WebAssembly memory grows for one call, which is its peak, since it never shrinks.
import { execFileSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';
import { atMost, printGoals, printTable, shown } from './support/report.mjs';
import { ratio } from './support/statistics.mjs';

const MODELS = ['stanford-bunny*4', 'stanford-bunny*16'];
const RATIO = 0.1;

/** Bytes per vertex of the input, positions only. */
const LIMIT = 200;

const child = fileURLToPath(new URL('support/memory-child.mjs', import.meta.url));

/** Every measurement has a process of its own: a fresh instance, whose memory only its one call has grown. */
function measure(engine, options, model) {
  const words = [child, engine, JSON.stringify(options), model, String(RATIO)];
  return JSON.parse(execFileSync(process.execPath, words, { encoding: 'utf8' }));
}

/** Runs the bench, prints its table and returns everything for `--json`. */
export function memory({ presets, quick }) {
  const cases = (quick ? MODELS.slice(0, 1) : MODELS).map((model) => {
    const bytes = {
      simplify: measure('simplify', {}, model),
      update: measure('update', {}, model),
      ...Object.fromEntries(presets.map(({ name, options }) => [name, measure('ours', options, model)])),
      ...Object.fromEntries(presets.map(({ name, options }) => [`${name} (record)`, measure('sequence', options, model)])),
    };
    console.error(`memory: ${model} done`);
    return { model, bytes };
  });
  printTable(`memory: peak growth at ${RATIO * 100} %, arrays in and out included; (record) is a full run, kept`,
    ['case', 'engine', 'before MB', 'grown MB', 'bytes/vertex', '/simplify'],
    cases.flatMap(({ model, bytes }) =>
      Object.entries(bytes).map(([name, { before, after, vertices }]) => [
        model, name, shown(before / 2 ** 20, 1), shown((after - before) / 2 ** 20, 1),
        shown((after - before) / vertices, 0),
        shown(ratio(after - before, bytes.simplify.after - bytes.simplify.before), 2),
      ])));
  const perVertex = ({ before, after, vertices }) => (after - before) / vertices;
  const goals = presets.map(({ name }) =>
    atMost(`${name}: bytes per vertex, the largest of ${cases.length}`, Math.max(...cases.map(({ bytes }) => perVertex(bytes[name]))), LIMIT));
  printGoals('memory: what must hold', goals);
  return { cases, goals };
}
