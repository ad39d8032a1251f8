// The command line's arguments: what is allowed, and what it means.

import { parseArgs, type ParseArgsConfig } from 'node:util';
import { DecimeshError } from '../errors.js';
import { MOST_LODS, PRESETS, WEIGHT_NAMES, isPreset } from '../options.js';
import { COMPRESSIONS, isCompression } from '../formats.js';
import { isProgressivePath } from './output.js';
import { IMAGE_FORMATS, isImageFormat } from '../prepare/options.js';
import type { AttributeWeights, Compression, DocumentSimplifyOptions, PrepareOptions } from '../types.js';

/** Files to simplify, and how. */
export interface Job {
  readonly action: 'simplify';
  /** At least one. */
  readonly inputs: readonly string[];
  /** At most one of `output` and `directory` is set, and one is unless `json` is. */
  readonly output: string | undefined;
  readonly directory: string | undefined;
  readonly options: DocumentSimplifyOptions;
  /** The most bytes that the output may have. */
  readonly size: number | undefined;
  /** Shares of the triangles of the levels of a chain. */
  readonly lods: readonly number[] | undefined;
  /** Undefined: as the input has it. */
  readonly compress: Compression | undefined;
  readonly quantize: boolean;
  readonly prepare: PrepareOptions | undefined;
  readonly json: boolean;
  /** Whether the deviation is to be measured. */
  readonly measure: boolean;
}

/** What the user asked for. */
export type Command = Job | { readonly action: 'help' } | { readonly action: 'version' };

export const HELP = `decimesh: fewer triangles for 3D models, with the same look

  decimesh INPUT -o OUTPUT [options]     one file; its format by the extension: .glb, .gltf (with
                                         its files beside it), .obj, .ply, .stl, .off, .smf
  decimesh INPUT -o OUTPUT.pmesh         a progressive mesh, which refines while it is downloaded;
                                         no target needed
  decimesh INPUTS… -d DIR [options]      many files, into a directory that is made if need be
  decimesh INPUT --json [options]        only a report

Input is .glb, .gltf, .obj (their files are looked for in the same folder and below), .ply, .stl, .off, .smf or .pmesh,
or a .zip of these, told by the content, whatever the extension says.

How far (name one; of several, the first that is reached stops):
  -r, --ratio R        keep this share of the triangles, 0 to 1
  -t, --triangles N    at most N triangles in the whole file
  -e, --error E        estimated deviation, 0.1% of the bounding box's diagonal or a number in model units
  --max-deviation E    largest measured distance of either surface from the other, as --error; slower
  -s, --size BYTES     output at most this large: 500k, 2MB (k is 1000; KiB, MiB: 1024)
  --lods R,R,…         instead of these, several levels by their share of the triangles: with -o one GLB
                       that has them all (MSFT_lod), with -d one file each, NAME_LOD0 and so on

How:
  --placement RULE     optimal (default): new vertex positions; subset: only original ones
  --attribute-weights NAME=W,…  what normal, uv, color, morph weigh, as multiples of the found weights; 0: nothing
  --lock-border        open borders do not move
  --prune              parts that are down to a triangle may vanish
  --merge-distance D   separate parts of a mesh nearer than this may merge; as --error, default 0
  --weight-attribute A where the vertex attribute A is large fewer triangles go: _WEIGHT, COLOR_0.g
  --weight-scale S     times this; a weight of 10 makes a collapse 11 times as dear
  --preset NAME        time against quality: fast, balanced (default) or best
  --time-budget MS     simplify for at most so many milliseconds; the result is what was done by then
  --memory-limit BYTES simplify in at most so much memory beside the model, or end with too-large: 500M

Output:
  -o, --output FILE    replaced only when all went well; never the input itself
  -d, --directory DIR  INPUT in its own format, .gltf as .glb
  --compress NAME      none, meshopt or draco, for .glb and .gltf; default: as the input has it
  --quantize           attributes as integers, for .glb and .gltf (Draco does that by itself)
  --prepare LIST       dedup, prune (what nothing in the file needs), resample (animations), for .glb and .gltf
  --texture-size N     textures of at most N pixels; on Node this and the next two need the package sharp
  --texture-format F   webp, jpeg or png; default: as they are
  --texture-quality Q  of webp and jpeg, 0 to 1, default 0.8
  --measure            measure how far the result is from the original, both ways, and report it
  --json               a report on standard output: an object, or an array of them for several inputs
  -h, --help           this text
  --version            the version

Exit codes: 0 done, also when a target could not be reached (the report's stopReason says so); 1 a fault of this
program; 2 wrong usage; 3 unreadable or invalid input; 4 could not write. With many inputs the others go on when one
fails, and the code is that of the first failure.
`;

const OPTIONS = {
  ratio: { type: 'string', short: 'r' },
  triangles: { type: 'string', short: 't' },
  error: { type: 'string', short: 'e' },
  'max-deviation': { type: 'string' },
  size: { type: 'string', short: 's' },
  lods: { type: 'string' },
  'attribute-weights': { type: 'string' },
  placement: { type: 'string' },
  preset: { type: 'string' },
  'time-budget': { type: 'string' },
  'memory-limit': { type: 'string' },
  'lock-border': { type: 'boolean' },
  prune: { type: 'boolean' },
  'merge-distance': { type: 'string' },
  'weight-attribute': { type: 'string' },
  'weight-scale': { type: 'string' },
  compress: { type: 'string' },
  quantize: { type: 'boolean' },
  prepare: { type: 'string' },
  'texture-size': { type: 'string' },
  'texture-format': { type: 'string' },
  'texture-quality': { type: 'string' },
  measure: { type: 'boolean' },
  output: { type: 'string', short: 'o' },
  directory: { type: 'string', short: 'd' },
  json: { type: 'boolean' },
  help: { type: 'boolean', short: 'h' },
  version: { type: 'boolean' },
} as const satisfies NonNullable<ParseArgsConfig['options']>;

type Values = ReturnType<typeof parse>['values'];

function parse(args: readonly string[]) {
  return parseArgs({ args: [...args], options: OPTIONS, allowPositionals: true, strict: true });
}

/** What `args` (without the program's name) ask for; throws `usage` naming the argument that is wrong. */
export function readArguments(args: readonly string[]): Command {
  let parsed: ReturnType<typeof parse>;
  try {
    parsed = parse(args);
  } catch (error) {
    // The first sentence names the argument; what follows advises on the use of `--`.
    const reason = error instanceof Error ? error.message : String(error);
    throw usage('arguments', (reason.split(/\. |\n/)[0] ?? reason).replace(/\.$/, ''));
  }
  const { values, positionals: inputs } = parsed;
  if (values.help) return { action: 'help' };
  if (values.version) return { action: 'version' };
  if (inputs.length === 0) throw usage('INPUT', 'name a file; see decimesh --help');
  const { output, directory, json = false, measure = false } = values;
  if (output !== undefined && directory !== undefined) throw usage('-o, -d', 'name one of the two');
  if (output !== undefined && inputs.length > 1) throw usage('-o', 'takes one input; use -d DIR for several');
  if (output === undefined && directory === undefined && !json) {
    throw usage('-o', 'name an output with -o FILE or -d DIR, or ask for a report alone with --json');
  }
  for (const [name, value] of Object.entries({ '-o': output, '-d': directory })) {
    if (value === '') throw usage(name, 'must not be empty');
  }
  const { compress, quantize = false } = values;
  if (compress !== undefined && !isCompression(compress)) {
    throw usage('--compress', `must be ${COMPRESSIONS.join(', ')}, not '${compress}'`);
  }
  const lods = levelList(values.lods);
  if (lods !== undefined && measure) throw usage('--measure', 'is of one level; leave out --lods');
  if (lods?.length === 1 && directory === undefined) throw usage('--lods', 'name at least two levels for one file');
  const size = byteCount('--size', values.size);
  const prepare = prepareOptions(values);
  const options = simplifyOptions(values, lods, isProgressivePath(output));
  return { action: 'simplify', inputs, output, directory, json, measure, options, size, lods, compress, quantize, prepare };
}

function simplifyOptions(values: Values, lods: readonly number[] | undefined, progressive: boolean): DocumentSimplifyOptions {
  const { ratio, triangles, error, size, placement, preset } = values;
  const targets = Object.entries({ ratio, triangles, error, size, 'max-deviation': values['max-deviation'] }).filter(([, value]) => value !== undefined);
  if (progressive) {
    const others = ['prepare', 'texture-size', 'texture-format', 'texture-quality'];
    const wrong = ['size', 'max-deviation', 'lods', 'compress', 'quantize', 'measure', ...others].find((name) => values[name as keyof Values] !== undefined);
    if (wrong !== undefined) throw usage(`--${wrong}`, 'is not possible with a .pmesh, which has all levels');
    if (placement === 'optimal') throw usage('--placement', 'must be subset for a .pmesh');
  } else if (targets.length === 0 && lods === undefined) {
    throw usage('options', 'name a target: --ratio R, --triangles N, --error E, --max-deviation E, --size BYTES or --lods R,R');
  }
  if (targets[0] !== undefined && lods !== undefined) throw usage('--lods', `leave out --${targets[0][0]}`);
  if (size !== undefined && values['max-deviation'] !== undefined) throw usage('--size', 'leave out --max-deviation');
  if (placement !== undefined && placement !== 'optimal' && placement !== 'subset') {
    throw usage('--placement', `must be optimal or subset, not '${placement}'`);
  }
  if (preset !== undefined && !isPreset(preset)) {
    throw usage('--preset', `must be ${PRESETS.join(', ')}, not '${preset}'`);
  }
  if (values['weight-scale'] !== undefined && values['weight-attribute'] === undefined) {
    throw usage('--weight-scale', 'needs --weight-attribute beside it');
  }
  return {
    ratio: lods === undefined ? number('--ratio', ratio, 'a number from 0 to 1', (value) => value <= 1) : Math.min(...lods),
    // These look for their levels in the history.
    ...(lods === undefined && size === undefined && !progressive ? {} : { everyLevel: true }),
    triangles: number('--triangles', triangles, 'an integer of at least 0', Number.isSafeInteger),
    error: lengthOf('--error', error),
    maximumDeviation: lengthOf('--max-deviation', values['max-deviation']),
    attributeWeights: attributeWeights(values['attribute-weights']),
    placement: progressive ? 'subset' : placement,
    preset,
    timeBudget: number('--time-budget', values['time-budget'], 'a number of milliseconds of at least 0', () => true),
    memoryLimit: byteCount('--memory-limit', values['memory-limit']),
    lockBorder: values['lock-border'],
    prune: values.prune,
    mergeDistance: lengthOf('--merge-distance', values['merge-distance']),
    weightAttribute: values['weight-attribute'],
    weightScale: number('--weight-scale', values['weight-scale'], 'a number of at least 0', () => true),
  };
}

const PREPARATIONS = ['dedup', 'prune', 'resample'] as const;

function prepareOptions(values: Values): PrepareOptions | undefined {
  const steps = values.prepare?.split(',') ?? [];
  for (const step of steps) {
    if (!PREPARATIONS.some((known) => known === step)) throw usage('--prepare', `must be a list of ${PREPARATIONS.join(', ')}, not '${values.prepare}'`);
  }
  const format = values['texture-format'];
  if (format !== undefined && !isImageFormat(format)) {
    throw usage('--texture-format', `must be ${IMAGE_FORMATS.join(', ')}, not '${format}'`);
  }
  const textures = {
    maxSize: number('--texture-size', values['texture-size'], 'an integer of at least 1', (value) => Number.isSafeInteger(value) && value >= 1),
    format,
    quality: number('--texture-quality', values['texture-quality'], 'a number from 0 to 1', (value) => value <= 1),
  };
  const hasTextures = Object.values(textures).some((value) => value !== undefined);
  if (steps.length === 0 && !hasTextures) return undefined;
  return { ...Object.fromEntries(steps.map((step) => [step, true])), ...(hasTextures ? { textures } : {}) };
}

function attributeWeights(text: string | undefined): AttributeWeights | undefined {
  if (text === undefined) return undefined;
  const option = '--attribute-weights';
  const weights = text.split(',').map((item) => {
    const [name = '', weight] = item.split('=');
    const known = WEIGHT_NAMES.find((one) => one === name);
    if (known === undefined || weight === undefined) {
      throw usage(option, `must be a list such as normal=2,uv=0 of ${WEIGHT_NAMES.join(', ')}, not '${text}'`);
    }
    return [known, number(option, weight, 'numbers from 0 to 1e6', (value) => value <= 1e6)];
  });
  return Object.fromEntries(weights) as AttributeWeights;
}

// Nothing but digits, a point and an exponent: Number() alone would take '' and '0x10'.
const DECIMAL = /^(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

function number(name: string, text: string | undefined, wanted: string, fits: (value: number) => boolean): number | undefined {
  if (text === undefined) return undefined;
  const value = DECIMAL.test(text) ? Number(text) : NaN;
  if (!Number.isFinite(value) || !fits(value)) throw usage(name, `must be ${wanted}, not '${text}'`);
  return value;
}

function lengthOf(name: string, text: string | undefined): DocumentSimplifyOptions['error'] {
  const wanted = 'a number of at least 0, or a percentage such as 0.1%';
  const value = number(name, text?.replace(/%$/, ''), wanted, () => true);
  return text?.endsWith('%') ? `${value as number}%` : value;
}

function levelList(text: string | undefined): number[] | undefined {
  const levels = text?.split(',').map((part) => number('--lods', part, 'numbers from 0 to 1 with commas between', (value) => value <= 1) as number);
  if (levels !== undefined && levels.length > MOST_LODS) throw usage('--lods', `at most ${MOST_LODS} levels`);
  return levels?.sort((a, b) => b - a);
}

const UNITS: Readonly<Record<string, number>> = { '': 1, k: 1e3, m: 1e6, g: 1e9, ki: 1024, mi: 1024 ** 2, gi: 1024 ** 3 };

function byteCount(name: string, text: string | undefined): number | undefined {
  if (text === undefined) return undefined;
  const [, digits, unit = ''] = /^(.*?)\s*([kmg]i?)?b?$/i.exec(text) ?? [];
  const wanted = 'a number of bytes above 0, such as 500k or 2MB';
  const value = DECIMAL.test(digits ?? '') ? Number(digits) * (UNITS[unit.toLowerCase()] as number) : NaN;
  if (!Number.isFinite(value) || value <= 0) throw usage(name, `must be ${wanted}, not '${text}'`);
  return value;
}

/** The error for a wrong command line. */
export function usage(where: string, message: string): DecimeshError {
  return new DecimeshError('usage', message, where);
}
