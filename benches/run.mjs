// `npm run bench`: quality, speed, attributes, memory, history, looks, poses, loaders and limits of the deviation,
// side by side with other simplifiers.
//
//     npm run bench                              everything; ten minutes on two cores, more with MeshLab's first run
//     npm run bench -- --quick                   a small share of each, a minute or two
//     npm run bench -- quality speed             only these; known: quality speed attributes memory history
//                                              levels looks poses loaders bounded
//     npm run bench -- --json FILE               also writes all figures there
//
// Deviations come from an independent meter if there is one: MESHDIST names it, or it stands in ../shared/tools.
// MeshLab takes part when PYMESHLAB names a Python virtual environment with pymeshlab. The peers' results are kept in
// the user's cache directory, by the hash of the model, the peer's version and the target.
import { writeFileSync } from 'node:fs';
import { cpus } from 'node:os';
import { attributes } from './attributes.mjs';
import { bounded } from './bounded.mjs';
import { history } from './history.mjs';
import { levels } from './levels.mjs';
import { loaders } from './loaders.mjs';
import { looks } from './looks.mjs';
import { memory } from './memory.mjs';
import { poses } from './poses.mjs';
import { quality } from './quality.mjs';
import { speed } from './speed.mjs';
import { peerVersion, presets, ready } from './support/engines.mjs';
import { available } from './support/models.mjs';
import { printGoals } from './support/report.mjs';

const BENCHES = { quality, speed, attributes, memory, history, levels, looks, poses, loaders, bounded };

function parse(words) {
  const options = { quick: false, json: undefined, names: [] };
  for (let at = 0; at < words.length; at += 1) {
    const word = words[at];
    if (word === '--quick') options.quick = true;
    else if (word === '--json' && words[at + 1] !== undefined) options.json = words[(at += 1)];
    else if (Object.hasOwn(BENCHES, word)) options.names.push(word);
    else {
      console.error(`unknown word "${word}"; known: ${Object.keys(BENCHES).join(', ')}, --quick, --json FILE`);
      process.exit(2);
    }
  }
  if (options.names.length === 0) options.names = Object.keys(BENCHES);
  return options;
}

const { quick, json, names } = parse(process.argv.slice(2));
if (!available) {
  console.log('SKIPPED: the bench models are not in ../shared/assets/bench');
  process.exit(0);
}
await ready();
const machine = `${cpus()[0]?.model ?? 'unknown processor'} × ${cpus().length}, Node ${process.version}`;
console.log(`${machine}, against meshoptimizer ${peerVersion}${quick ? ', quick' : ''}`);
const setting = { presets: presets(), quick };
const results = {};
for (const name of names) results[name] = await BENCHES[name](setting);
const goals = Object.values(results).flatMap((result) => result.goals ?? []);
if (names.length > 1 && goals.length > 0) printGoals('all goals', goals);
if (json !== undefined) {
  const report = { machine, peer: { meshoptimizer: peerVersion }, quick, presets: setting.presets, results };
  writeFileSync(json, `${JSON.stringify(report, undefined, 1)}\n`);
}
