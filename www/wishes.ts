// What is wanted, as text to compare and as the package takes it.
import type { DocumentSimplifyOptions, DocumentSummary, LevelGeometry } from 'decimesh/worker';
import { isChain, runKey } from './choices.ts';
import type { Choices, RunSettings } from './choices.ts';
import { encodingFor } from './encoding.ts';
import { LOCKING, weightOfPaint } from './paint/mode.ts';
import type { Quality } from './formats.ts';
import { preparationKey } from './preparation.ts';
import type { Model, State } from './state.ts';

/** What a file depends on. */
export const wishKey = (state: State, model: Model, fit: Quality): string =>
  [
    model.wantedTriangles,
    state.outputFormat,
    encodingFor(state.outputFormat, state.encoding),
    preparationKey(state.outputFormat, state.preparation),
    fit,
    isChain(state) ? state.lods.join() : '',
    runKey(state.run),
  ].join(' ');

/** What the count that a goal stands for depends on. */
export const goalKey = ({ goal, run, outputFormat, encoding, preparation }: Choices): string => {
  const file = goal.kind === 'size' ? outputFormat + encodingFor(outputFormat, encoding) + preparationKey(outputFormat, preparation) : '';
  return [JSON.stringify(goal), runKey(run), file].join(' ');
};

/** The quality as it counts: of a chain, and within a size, the levels are those of the record. */
export const fitFor = (state: State): Quality => (isChain(state) || state.goal.kind === 'size' ? 'fast' : state.quality);

/** What a file is to be fitted with: at full detail there is nothing to fit, and `fast` takes what is shown. */
export const fitOfFile = (state: State, model: Model, fitted: Quality | null): Quality => {
  if (model.wantedTriangles === model.source.triangles || isChain(state)) return 'fast';
  const quality = fitFor(state);
  return quality === 'fast' ? (fitted ?? 'fast') : quality;
};

/** The settings as the package takes them, with what is painted on each vertex of the document, if anything is. */
export function simplifyOptions(
  { lockBorder, prune, weights, kept }: RunSettings,
  { groups, wedgeSets }: DocumentSummary,
  painted: Uint8Array | null = null,
): DocumentSimplifyOptions {
  const options = { lockBorder, prune, attributeWeights: weights };
  if (kept.length === 0 && painted === null) return options;
  const sets = new Set(groups.filter(({ mesh }) => kept.includes(mesh)).map(({ wedgeSet }) => wedgeSet));
  const locked = new Uint8Array(wedgeSets.reduce((sum, { vertices }) => sum + vertices, 0));
  let start = 0;
  for (const [set, { vertices }] of wedgeSets.entries()) {
    if (sets.has(set)) locked.fill(1, start, start + vertices);
    start += vertices;
  }
  if (painted === null) return { ...options, locked };
  const protection = new Float32Array(locked.length);
  for (let vertex = 0; vertex < locked.length; vertex += 1) {
    const paint = painted[vertex] ?? 0;
    protection[vertex] = weightOfPaint[paint] ?? 0;
    if (paint === LOCKING) locked[vertex] = 1;
  }
  return { ...options, locked, weights: protection };
}

/** How many triangles of each mesh there are. */
export function countMeshes({ groups }: LevelGeometry): Map<number, number> {
  const counts = new Map<number, number>();
  for (const { mesh, indices } of groups) counts.set(mesh, (counts.get(mesh) ?? 0) + indices.length / 3);
  return counts;
}
