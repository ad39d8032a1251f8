// What the page does to a model, as a command line and as a program for the package.
import { isChain, weightList } from './choices.ts';
import type { Choices } from './choices.ts';
import { encodingFor, writeOptions } from './encoding.ts';
import { prepareArguments, prepareOptions } from './preparation.ts';

/** What a recipe is about. */
export interface Recipe {
  /** Of the file that was opened, as it is called on the disk. */
  readonly fileName: string;
  /** Without extension. */
  readonly name: string;
  readonly triangles: number;
  readonly choices: Choices;
}

/** The name of the output, which must not be the input's. */
const outputOf = ({ name, choices }: Recipe): string => `${name}-small.${choices.outputFormat}`;

// Single quotes keep everything in POSIX shells but themselves.
const quoted = (text: string): string => (/^[\w./-]+$/.test(text) && !text.startsWith('-') ? text : `'${text.replaceAll("'", `'\\''`)}'`);

const shares = (lods: readonly number[]): number[] => lods.map((share) => Number(share.toPrecision(6)));

/** One line for a shell, the same result as Download's. */
export function commandOf(recipe: Recipe): string {
  const { choices, triangles } = recipe;
  const { goal, run, lods, quality, outputFormat } = choices;
  const encoding = writeOptions(outputFormat, encodingFor(outputFormat, choices.encoding));
  const weights = weightList(run, '=');
  const parts = ['npx decimesh', quoted(recipe.fileName), '-o', quoted(outputOf(recipe))];
  if (isChain(choices)) parts.push('--lods', shares(lods).join(','));
  else if (goal.kind === 'error') parts.push('--error', `${goal.percent}%`);
  else if (goal.kind === 'size') parts.push('--size', String(goal.bytes));
  else parts.push('--triangles', String(triangles));
  if (quality !== 'balanced' && goal.kind !== 'size' && !isChain(choices)) parts.push('--preset', quality);
  if (run.lockBorder) parts.push('--lock-border');
  if (run.prune) parts.push('--prune');
  if (weights !== '') parts.push('--attribute-weights', weights);
  if (encoding.compress !== undefined && (outputFormat === 'glb' || encoding.compress !== 'none')) parts.push('--compress', encoding.compress);
  if (encoding.quantize === true) parts.push('--quantize');
  parts.push(...prepareArguments(outputFormat, choices.preparation));
  return parts.join(' ');
}

/** A module for Node that does what Download does. */
export function codeOf(recipe: Recipe): string {
  const { choices, triangles } = recipe;
  const { goal, run, lods, quality, outputFormat } = choices;
  const several = isChain(choices) || goal.kind === 'size';
  const weights = Object.fromEntries(Object.entries(run.weights).filter(([, weight]) => weight !== 1));
  const simplify = {
    ...(several ? {} : goal.kind === 'error' ? { error: `${goal.percent}%` } : { triangles }),
    ...(several || quality === 'balanced' ? {} : { preset: quality }),
    ...(run.lockBorder ? { lockBorder: true } : {}),
    ...(run.prune ? { prune: true } : {}),
    ...(Object.keys(weights).length > 0 ? { attributeWeights: weights } : {}),
  };
  const write = {
    ...writeOptions(outputFormat, encodingFor(outputFormat, choices.encoding)),
    ...prepareOptions(outputFormat, choices.preparation),
    ...(isChain(choices) ? { lods: shares(lods) } : goal.kind === 'size' ? { size: goal.bytes } : {}),
  };
  const kept = run.kept.length === 0 ? [] : [
    `const { groups, wedgeSets } = document.summary;`,
    `// Meshes that stay as they are: each of their vertices is locked.`,
    `const kept = new Set(groups.filter(({ mesh }) => [${run.kept.join(', ')}].includes(mesh)).map(({ wedgeSet }) => wedgeSet));`,
    `const locked = Uint8Array.from(wedgeSets.flatMap(({ vertices }, set) => Array(vertices).fill(kept.has(set) ? 1 : 0)));`,
  ];
  const options = kept.length === 0 ? literal(simplify) : literal(simplify).replace(/^\{ ?/, '{ locked, ').replace(', }', ' }');
  return [
    `import { readFile, writeFile } from 'node:fs/promises';`,
    `import { openDocument } from 'decimesh';`,
    ``,
    `const document = await openDocument(await readFile(${literal(recipe.fileName)}));`,
    ...kept,
    `await document.simplify(${options === '{}' ? '' : options});`,
    `const { bytes, report } = await document.write(${literal(write)});`,
    `await writeFile(${literal(outputOf(recipe))}, bytes);`,
    `document.dispose();`,
    ``,
  ].join('\n');
}

/** A value as a program writes it. */
function literal(value: unknown): string {
  if (typeof value === 'string') return `'${value.replaceAll('\\', '\\\\').replaceAll("'", "\\'")}'`;
  if (Array.isArray(value)) return `[${value.map(literal).join(', ')}]`;
  if (typeof value !== 'object' || value === null) return String(value);
  const entries = Object.entries(value).map(([name, item]) => `${name}: ${literal(item)}`);
  return entries.length === 0 ? '{}' : `{ ${entries.join(', ')} }`;
}
