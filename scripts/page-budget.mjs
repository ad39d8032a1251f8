// What a visitor downloads: the built page's files by the part they belong to, gzipped, against their budgets.
//
//     node scripts/page-budget.mjs [DIRECTORY]

import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { Stop, at, isMain, main } from './project.mjs';

/**
 * The parts. A file is of the first whose pattern fits its name; what fits none is of the app and counts.
 *
 * `shell`: what the first screen needs. `app`: what opening and simplifying a GLB needs besides, with the codecs that
 * are small. `on demand`: Draco, progressive meshes and watching one arrive, preparation, painting, limits of the measured deviation and languages other than English, each loaded for who needs it. `instead`: loaded in
 * place of a part of the app by browsers without SIMD or without canvases in workers. `samples`: models and pictures.
 */
const PATTERNS = [
  ['shell', /^(index\.html|assets\/index-[^/]*\.(js|css)|assets\/favicon-[^/]*|manifest\.webmanifest)$/],
  ['samples', /\.(glb|webp)$/],
  ['on demand', /^assets\/(draco_[^/]*|(de|es|it|ja|zh|painter|painting|prepare|progressive|split_coder|to_glb|within)-[^/]*\.(js|css)|arrival[^/]*)$/],
  ['instead', /^assets\/(decimesh_scalar-[^/]*|view-host-[^/]*)$/],
  ['installed', /^(icons\/|service-worker\.js$)/],
];

/** The part that the file called `name`, relative to the built page, belongs to. */
export const partOf = (name) => PATTERNS.find(([, pattern]) => pattern.test(name))?.[0] ?? 'app';

/** Bytes gzipped of each part of the page built in `directory`. */
export function partSizes(directory) {
  const sizes = { shell: 0, app: 0, 'on demand': 0, instead: 0, installed: 0, samples: 0 };
  for (const entry of readdirSync(directory, { recursive: true, withFileTypes: true })) {
    if (!entry.isFile()) continue;
    const path = join(entry.parentPath ?? entry.path, entry.name);
    const name = path.slice(directory.length + 1).replaceAll('\\', '/');
    sizes[partOf(name)] += gzipSync(readFileSync(path), { level: 9 }).length;
  }
  return sizes;
}

/** What is above `budget`, as sentences; empty when all is well. The app's budget has the shell in it. */
export function overBudget(sizes, budget) {
  const counted = { shell: sizes.shell, app: sizes.shell + sizes.app };
  return Object.entries(budget)
    .filter(([part, limit]) => !(counted[part] <= limit))
    .map(([part, limit]) => `The page's ${part} is ${counted[part]} bytes gzipped, above its budget of ${limit} in scripts/page-budget.json: make it smaller.`);
}

/** Says the sizes of the page built in `directory`; a Stop when a budget is exceeded. */
export function checkPage(directory, say) {
  const budget = JSON.parse(readFileSync(at('scripts', 'page-budget.json'), 'utf8'));
  const sizes = partSizes(directory);
  say(`page, bytes gzipped: shell ${sizes.shell} of ${budget.shell}, with the app ${sizes.shell + sizes.app} of ${budget.app}; on demand ${sizes['on demand']}, samples ${sizes.samples}`);
  const [problem] = overBudget(sizes, budget);
  if (problem !== undefined) throw new Stop(problem);
}

if (isMain(import.meta.url)) await main(async () => checkPage(process.argv[2] ?? at('site'), console.log));
