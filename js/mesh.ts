// A mesh of bare arrays, checked, and its attributes as the engine takes and returns them.

import { invalidArgument } from './errors.js';
import type { AttributeArray, MeshInput } from './types.js';

/** How an attribute's values are combined where vertices merge; the engine's names. */
type Blend = 'linear' | 'direction' | 'tangent' | 'nearest' | 'joints' | 'weights';

/** An attribute in the engine's form, and the type of array it came in. */
export interface EngineAttribute {
  readonly name: string;
  readonly components: number;
  readonly blend: Blend;
  readonly values: Float32Array;
  readonly original: AttributeArray;
}

/** Of the names that have a meaning: the component counts they may have, and their blend. */
const KNOWN: Readonly<Record<string, { readonly components: readonly number[]; readonly blend: Blend }>> = {
  normal: { components: [3], blend: 'direction' },
  uv: { components: [2], blend: 'linear' },
  color: { components: [3, 4], blend: 'linear' },
  tangent: { components: [4], blend: 'tangent' },
  joints: { components: [4], blend: 'joints' },
  weights: { components: [4], blend: 'weights' },
};

const MOST_COMPONENTS = 16;

const ARRAY_TYPES = [
  Float32Array,
  Float64Array,
  Int8Array,
  Uint8Array,
  Uint8ClampedArray,
  Int16Array,
  Uint16Array,
  Int32Array,
  Uint32Array,
];

/** Checks types and lengths, which the engine could only misread. Values are the engine's to check. */
export function checkMesh(mesh: MeshInput): { positions: Float32Array; indices: Uint32Array | undefined } {
  if (typeof mesh !== 'object' || mesh === null) throw invalidArgument('mesh', 'must be { positions, indices? }');
  const { positions, indices } = mesh;
  if (!(positions instanceof Float32Array)) throw invalidArgument('positions', 'must be a Float32Array');
  if (positions.length % 3 !== 0) throw invalidArgument('positions', 'must have three numbers for each vertex');
  if (indices === undefined) {
    if (positions.length % 9 !== 0) {
      throw invalidArgument('positions', 'must have three vertices for each triangle when there are no indices');
    }
    return { positions, indices };
  }
  if (!(indices instanceof Uint32Array || indices instanceof Uint16Array)) {
    throw invalidArgument('indices', 'must be a Uint32Array or Uint16Array');
  }
  if (indices.length % 3 !== 0) throw invalidArgument('indices', 'must have three numbers for each triangle');
  return { positions, indices: indices instanceof Uint32Array ? indices : Uint32Array.from(indices) };
}

/** The attributes of `mesh` in the engine's form; joints come just before their weights, as it wants them. */
export function attributesForEngine({ positions, attributes = {} }: MeshInput): EngineAttribute[] {
  if (typeof attributes !== 'object' || attributes === null) throw invalidArgument('attributes', 'must be an object');
  const vertices = positions.length / 3;
  const others: EngineAttribute[] = [];
  const skins: EngineAttribute[] = [];
  for (const [name, original] of Object.entries(attributes)) {
    if (original === undefined) continue;
    const where = `attributes.${name}`;
    if (!ARRAY_TYPES.some((type) => original instanceof type)) throw invalidArgument(where, 'must be a typed array');
    const known = KNOWN[kindOf(name)];
    const components = original.length / Math.max(vertices, 1);
    const fits = known?.components.includes(components) ?? (Number.isInteger(components) && components <= MOST_COMPONENTS);
    if (!fits || (components === 0 && vertices > 0)) {
      const wanted = known === undefined ? `1 to ${MOST_COMPONENTS}` : known.components.join(' or ');
      throw invalidArgument(where, `must have ${wanted} numbers for each of the ${vertices} vertices`);
    }
    const blend = known?.blend ?? (isFloat(original) ? 'linear' : 'nearest');
    const values = original instanceof Float32Array ? original : Float32Array.from(original);
    const attribute = { name, components, blend, values, original };
    (blend === 'joints' || blend === 'weights' ? skins : others).push(attribute);
  }
  // `joints` < `weights`, and `joints1` is to stand before `weights1`.
  const order = ({ name }: EngineAttribute): string => name.slice(kindOf(name).length);
  skins.sort((a, b) => order(a).localeCompare(order(b), 'en') || a.name.localeCompare(b.name, 'en'));
  for (const skin of skins) {
    const partner = (skin.blend === 'joints' ? 'weights' : 'joints') + order(skin);
    if (!skins.some(({ name }) => name === partner)) {
      throw invalidArgument(`attributes.${skin.name}`, `needs ${partner} beside it`);
    }
  }
  return [...others, ...skins];
}

/** The level's attributes, by `valuesOf(index)`, in arrays of the types they came in. */
export function attributesFromEngine(
  attributes: readonly EngineAttribute[],
  valuesOf: (index: number) => Float32Array,
): Record<string, AttributeArray> {
  return Object.fromEntries(attributes.map(({ name, original }, index) => [name, sameType(original, valuesOf(index))]));
}

function sameType(original: AttributeArray, values: Float32Array): AttributeArray {
  if (original instanceof Float32Array) return values;
  const type = original.constructor as { new (length: number): AttributeArray };
  const result = new type(values.length);
  // Storing in an integer array cuts the fraction off.
  const whole = !isFloat(original);
  for (let index = 0; index < values.length; index += 1) {
    const value = values[index] as number;
    result[index] = whole ? Math.round(value) : value;
  }
  return result;
}

// `uv1` and `color2` are further sets of `uv` and `color`; any other name is its own kind.
function kindOf(name: string): string {
  const kind = name.replace(/\d+$/, '');
  return Object.hasOwn(KNOWN, kind) ? kind : name;
}

function isFloat(array: AttributeArray): boolean {
  return array instanceof Float32Array || array instanceof Float64Array;
}
