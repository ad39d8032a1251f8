// Checks the options of a simplification, and turns targets into a triangle count and an error in model units.

import { checkNames } from './check.js';
import { invalidArgument } from './errors.js';
import type { ProgressiveOptions } from './progressive/encode.js';
import { errorOfPixels } from './screen.js';
import type {
  AttributeWeights, DocumentSimplifyOptions, LevelTargets, MeasureOptions, MeshSimplifyOptions, Preset, RunOptions, Targets,
} from './types.js';

export { checkNames };

/** What targets refer to. */
export interface Scale {
  readonly triangles: number;
  /** Of the bounding box, model units. */
  readonly diagonal: number;
}

/** Targets as the engine understands them; absent ones do not stop it. */
export interface ResolvedTargets {
  /** Integer ≥ 0. */
  triangles?: number;
  /** Model units, ≥ 0. */
  error?: number;
}

/** The JSON that the engine's `beginSimplify` takes. */
export interface SimplifyRequest extends ResolvedTargets {
  lockBorder?: boolean;
  prune?: boolean;
  attributeWeights?: AttributeWeights;
  placement?: 'optimal' | 'subset';
  preset?: Preset;
  everyLevel?: boolean;
  keepLevels?: boolean;
  indexLevels?: boolean;
  weightAttribute?: string;
  weightScale?: number;
  /** Model units. */
  mergeDistance?: number;
  memoryLimit?: number;
}

/** The presets, from the fastest to the best. */
export const PRESETS: readonly Preset[] = ['fast', 'balanced', 'best'];

const TARGETS = ['ratio', 'triangles', 'error'];

/** Names of {@link SimplifyOptions}. */
export const SIMPLIFY_NAMES: readonly string[] = [
  ...TARGETS, 'lockBorder', 'prune', 'attributeWeights', 'placement', 'preset', 'timeBudget', 'mergeDistance', 'memoryLimit',
];

/** Names of {@link MeshSimplifyOptions}. */
export const MESH_SIMPLIFY_NAMES: readonly string[] = [...SIMPLIFY_NAMES, 'weights', 'locked'];

/** Names of {@link AttributeWeights}. */
export const WEIGHT_NAMES = ['normal', 'uv', 'color', 'morph'] as const;

/** Names of {@link DocumentSimplifyOptions}. */
export const DOCUMENT_SIMPLIFY_NAMES: readonly string[] = [
  ...SIMPLIFY_NAMES, 'everyLevel', 'keepLevels', 'weightAttribute', 'weightScale', 'weights', 'locked', 'maximumDeviation',
];

/** Names of {@link RunOptions}. */
export const RUN_NAMES: readonly string[] = ['onProgress', 'signal'];

/** Checks `options` of a level, against what the targets refer to. */
export function resolveTargets(options: LevelTargets, scale: Scale): ResolvedTargets {
  checkNames(options, [...TARGETS, 'pixels', 'view']);
  const { pixels, view, ...others } = options;
  const targets = targetsOf(others, scale);
  if (pixels !== undefined) {
    const error = errorOfPixels(pixels, view, scale.diagonal);
    targets.error = Math.min(error, targets.error ?? error);
  }
  return targets;
}

/** Whether `value` names a preset. */
export function isPreset(value: unknown): value is Preset {
  return (PRESETS as readonly unknown[]).includes(value);
}

/**
 * Checks the values of `options` of a simplification; its targets refer to `scale`. The time budget is checked too, but
 * is no part of the request: the engine knows no clock.
 */
export function resolveRequest(options: DocumentSimplifyOptions & RunOptions, scale: Scale): SimplifyRequest {
  const { attributeWeights, placement, preset, timeBudget, mergeDistance, memoryLimit, weightAttribute, weightScale, onProgress, signal } = options;
  const request: SimplifyRequest = targetsOf(options, scale);
  for (const name of ['lockBorder', 'prune', 'everyLevel', 'keepLevels'] as const) {
    const value = options[name];
    if (value === undefined) continue;
    if (typeof value !== 'boolean') throw invalidArgument(name, 'must be true or false');
    request[name] = value;
  }
  if (attributeWeights !== undefined) request.attributeWeights = checkedWeights(attributeWeights);
  if (preset !== undefined) {
    if (!isPreset(preset)) throw invalidArgument('preset', `must be one of ${PRESETS.join(', ')}, not ${shown(preset)}`);
    request.preset = preset;
  }
  if (mergeDistance !== undefined) request.mergeDistance = lengthInModelUnits('mergeDistance', mergeDistance, scale.diagonal);
  if (memoryLimit !== undefined) {
    if (!(Number.isFinite(memoryLimit) && memoryLimit >= 0)) {
      throw invalidArgument('memoryLimit', `must be a number of bytes of at least 0, not ${shown(memoryLimit)}`);
    }
    request.memoryLimit = memoryLimit;
  }
  if (weightAttribute !== undefined) {
    if (typeof weightAttribute !== 'string') throw invalidArgument('weightAttribute', 'must be the name of an attribute');
    request.weightAttribute = weightAttribute;
  }
  if (weightScale !== undefined) {
    if (!(Number.isFinite(weightScale) && weightScale >= 0)) {
      throw invalidArgument('weightScale', `must be a number of at least 0, not ${shown(weightScale)}`);
    }
    if (weightAttribute === undefined) throw invalidArgument('weightScale', 'needs weightAttribute beside it');
    request.weightScale = weightScale;
  }
  if (timeBudget !== undefined && !(Number.isFinite(timeBudget) && timeBudget >= 0)) {
    throw invalidArgument('timeBudget', `must be a number of at least 0, in milliseconds, not ${shown(timeBudget)}`);
  }
  if (placement !== undefined) {
    if (placement !== 'optimal' && placement !== 'subset') {
      throw invalidArgument('placement', "must be 'optimal' or 'subset'");
    }
    request.placement = placement;
  }
  if (onProgress !== undefined && typeof onProgress !== 'function') {
    throw invalidArgument('onProgress', 'must be a function');
  }
  checkSignal(signal);
  return request;
}

/** The largest measured deviation that `options` allow, model units; throws `invalid-argument`. */
export function resolveMaximumDeviation({ maximumDeviation, keepLevels, everyLevel }: DocumentSimplifyOptions, { diagonal }: Scale): number {
  const limit = lengthInModelUnits('maximumDeviation', maximumDeviation as number | string, diagonal);
  if (limit === 0) throw invalidArgument('maximumDeviation', 'must be above 0: only the original is at no distance from itself');
  if (keepLevels === true) throw invalidArgument('keepLevels', 'is not possible beside maximumDeviation, which records all levels');
  if (everyLevel === false) throw invalidArgument('everyLevel', 'is needed by maximumDeviation');
  return limit;
}

/** A chain of more levels than there are octaves of triangles is a mistake. */
export const MOST_LODS = 32;

/** Checks the types and lengths of weights and locks; the values are the engine's to check. */
export function checkProtection({ weights, locked }: Pick<MeshSimplifyOptions, 'weights' | 'locked'>, vertices: number): void {
  if (weights !== undefined && !(weights instanceof Float32Array && weights.length === vertices)) {
    throw invalidArgument('weights', `must be a Float32Array of one number for each of the ${vertices} vertices`);
  }
  if (locked !== undefined && !(locked instanceof Uint8Array && locked.length === vertices)) {
    throw invalidArgument('locked', `must be a Uint8Array of one number for each of the ${vertices} vertices`);
  }
}

function checkedWeights(weights: AttributeWeights): AttributeWeights {
  checkNames(weights, WEIGHT_NAMES, 'attributeWeights');
  for (const name of WEIGHT_NAMES) {
    const weight = weights[name];
    // What is no finite f32 any more would reach the engine as infinite.
    if (weight !== undefined && !(typeof weight === 'number' && weight >= 0 && weight <= 1e6)) {
      throw invalidArgument(`attributeWeights.${name}`, `must be a number from 0 to 1e6, not ${shown(weight)}`);
    }
  }
  return weights;
}

/** Checks `options` of a measurement. */
export function checkMeasureOptions(options: MeasureOptions & RunOptions): void {
  checkNames(options, ['samples', ...RUN_NAMES]);
  const { samples, onProgress, signal } = options;
  if (samples !== undefined && !(Number.isInteger(samples) && samples >= 1 && samples <= 1e9)) {
    throw invalidArgument('samples', `must be an integer from 1 to 1e9, not ${shown(samples)}`);
  }
  if (onProgress !== undefined && typeof onProgress !== 'function') {
    throw invalidArgument('onProgress', 'must be a function');
  }
  checkSignal(signal);
}

/** Checks `options` of a progressive mesh. */
export function checkProgressiveOptions(options: ProgressiveOptions): void {
  checkNames(options, ['keepOrder']);
  if (options.keepOrder !== undefined && typeof options.keepOrder !== 'boolean') throw invalidArgument('keepOrder', 'must be true or false');
}

/** Throws `invalid-argument` unless `signal` is an AbortSignal or absent. */
export function checkSignal(signal: unknown): void {
  if (signal !== undefined && !(signal instanceof AbortSignal)) {
    throw invalidArgument('signal', 'must be an AbortSignal');
  }
}

/** Whether `targets` names one. */
export function hasTarget({ ratio, triangles, error }: Targets): boolean {
  return ratio !== undefined || triangles !== undefined || error !== undefined;
}

/** Throws `invalid-argument` unless `targets` names one. */
export function checkHasTarget(targets: Targets): void {
  if (!hasTarget(targets)) throw invalidArgument('options', 'name a target: ratio, triangles or error');
}

function targetsOf({ ratio, triangles, error }: Targets, scale: Scale): ResolvedTargets {
  const targets: ResolvedTargets = {};
  if (ratio !== undefined) {
    if (typeof ratio !== 'number' || !(ratio >= 0 && ratio <= 1)) {
      throw invalidArgument('ratio', `must be a number from 0 to 1, not ${shown(ratio)}`);
    }
    // A millionth of a triangle makes up for 0.29 × 100 being a little less than 29.
    targets.triangles = Math.floor(ratio * scale.triangles + 1e-6);
  }
  if (triangles !== undefined) {
    if (!Number.isSafeInteger(triangles) || triangles < 0) {
      throw invalidArgument('triangles', `must be an integer of at least 0, not ${shown(triangles)}`);
    }
    // Of several targets the first that is reached counts: going down, the larger.
    targets.triangles = Math.max(triangles, targets.triangles ?? 0);
  }
  if (error !== undefined) targets.error = lengthInModelUnits('error', error, scale.diagonal);
  return targets;
}

function lengthInModelUnits(name: string, length: number | string, diagonal: number): number {
  const percent = typeof length === 'string' ? /^\s*(\d+(?:\.\d*)?(?:e[+-]?\d+)?|\.\d+)\s*%\s*$/i.exec(length)?.[1] : undefined;
  const value = percent === undefined ? length : (Number(percent) / 100) * diagonal;
  if (typeof value !== 'number' || !(value >= 0) || value === Infinity) {
    throw invalidArgument(name, `must be a number of at least 0 or a percentage such as '0.1%', not ${shown(length)}`);
  }
  return value;
}

/** A value as a message quotes it. */
export function shown(value: unknown): string {
  return typeof value === 'string' ? `'${value}'` : String(value);
}
