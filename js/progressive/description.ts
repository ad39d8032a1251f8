// What a progressive mesh is made of, as its header says it: counts, attributes, groups.

import { DecimeshError } from '../errors.js';
import type { GroupSummary } from '../types.js';
import type { Grid } from './numbers.js';

/** An attribute of a wedge set. */
export interface AttributeDescription {
  readonly name: string;
  /** Numbers for each wedge, 1 to 256. */
  readonly components: number;
  readonly grid: Grid;
}

/** Wedges (what glTF calls vertices) that have the same attributes. */
export interface WedgeSetDescription {
  /** At full detail. */
  readonly wedges: number;
  readonly attributes: readonly AttributeDescription[];
}

/** Triangles that share a material. */
export interface GroupDescription extends GroupSummary {
  /** At full detail. */
  readonly triangles: number;
}

/** The header. */
export interface Description {
  /** Vertices, which have several wedges on seams, at full detail. */
  readonly vertices: number;
  readonly triangles: number;
  /** Triangles of the base mesh. */
  readonly baseTriangles: number;
  /** Vertex splits after the base mesh. */
  readonly splits: number;
  /** Of the bounding box, model units. */
  readonly diagonal: number;
  readonly positionGrid: Grid;
  /** Whether triangles and wedges come back in the order they had. */
  readonly keepsOrder: boolean;
  readonly wedgeSets: readonly WedgeSetDescription[];
  readonly groups: readonly GroupDescription[];
}

/** More of these is no model. */
const MOST_PARTS = 65536;
const MOST_ELEMENTS = 1 << 30;

/** Whether an attribute is of unit length, and can be guessed from the surface. */
export const isDirection = ({ name, components }: AttributeDescription): boolean => components === 3 && /^normal$/i.test(name);

/** Whether any wedge set has such an attribute. */
export const hasDirections = ({ wedgeSets }: Description): boolean => wedgeSets.some(({ attributes }) => attributes.some(isDirection));

/** A header as it is stored: what many sets and groups have in common is in it once. */
export interface PackedDescription extends Omit<Description, 'wedgeSets' | 'groups'> {
  /** Lists of attributes, each once. */
  readonly attributes: ReadonlyArray<readonly AttributeDescription[]>;
  /** Each once. */
  readonly names: readonly string[];
  /** For each set its wedges and its place in `attributes`. */
  readonly wedgeSets: ReadonlyArray<readonly [wedges: number, attributes: number]>;
  /** For each group triangles, wedge set, mesh, primitive, and the places of object and material in `names`, −1 for none. */
  readonly groups: ReadonlyArray<readonly [triangles: number, wedgeSet: number, mesh: number, primitive: number, object: number, material: number]>;
}

/** The header as it is stored. */
export function packDescription({ wedgeSets, groups, ...description }: Description): PackedDescription {
  const lists = new Map<string, number>();
  const names = new Map<string, number>();
  const placeIn = (map: Map<string, number>, key: string): number => {
    const place = map.get(key) ?? map.size;
    map.set(key, place);
    return place;
  };
  const nameOf = (name: string | null): number => (name === null ? -1 : placeIn(names, name));
  const packed = {
    wedgeSets: wedgeSets.map(({ wedges, attributes }) => [wedges, placeIn(lists, JSON.stringify(attributes))] as const),
    groups: groups.map(({ triangles, wedgeSet, mesh, primitive, object, material }) => [triangles, wedgeSet, mesh, primitive, nameOf(object), nameOf(material)] as const),
  };
  return { ...description, attributes: [...lists.keys()].map((list) => JSON.parse(list) as AttributeDescription[]), names: [...names.keys()], ...packed };
}

/** The header from what is stored, checked as {@link checkDescription} does. */
export function unpackDescription(value: unknown): Description {
  const { attributes, names, wedgeSets, groups, ...rest } = record(value, 'header');
  const lists = list(attributes, 'attributes');
  const texts = list(names, 'names');
  const row = (entry: unknown, length: number, where: string): readonly unknown[] => {
    if (!Array.isArray(entry) || entry.length !== length) throw wrong(where);
    return entry;
  };
  const nameAt = (place: unknown, where: string): unknown => {
    if (place === -1) return null;
    if (typeof place !== 'number' || !Object.hasOwn(texts, place)) throw wrong(where);
    return texts[place];
  };
  return checkDescription({
    ...rest,
    wedgeSets: list(wedgeSets, 'wedgeSets').map((entry, set) => {
      const [wedges, place] = row(entry, 2, `wedgeSets[${set}]`);
      return { wedges, attributes: typeof place === 'number' ? lists[place] : undefined };
    }),
    groups: list(groups, 'groups').map((entry, group) => {
      const where = `groups[${group}]`;
      const [triangles, wedgeSet, mesh, primitive, object, material] = row(entry, 6, where);
      return { triangles, wedgeSet, mesh, primitive, object: nameAt(object, where), material: nameAt(material, where) };
    }),
  });
}

/** Checks a header that was read; throws `syntax`, `out-of-range` or `too-large` with the field's name. */
export function checkDescription(value: unknown): Description {
  const header = record(value, 'header');
  for (const name of ['vertices', 'triangles', 'baseTriangles', 'splits']) count(header[name], name);
  number(header['diagonal'], 'diagonal');
  grid(header['positionGrid'], 'positionGrid');
  if (typeof header['keepsOrder'] !== 'boolean') throw wrong('keepsOrder');
  const sets = list(header['wedgeSets'], 'wedgeSets');
  for (const [index, set] of sets.entries()) {
    const where = `wedgeSets[${index}]`;
    const { wedges, attributes } = record(set, where);
    count(wedges, `${where}.wedges`);
    for (const [k, attribute] of list(attributes, `${where}.attributes`).entries()) {
      const place = `${where}.attributes[${k}]`;
      const { name, components, grid: step } = record(attribute, place);
      if (typeof name !== 'string') throw wrong(`${place}.name`);
      count(components, `${place}.components`);
      if (components === 0 || (components as number) > 256) throw new DecimeshError('out-of-range', 'must be 1 to 256', `${place}.components`);
      grid(step, `${place}.grid`);
    }
  }
  for (const [index, group] of list(header['groups'], 'groups').entries()) {
    const where = `groups[${index}]`;
    const fields = record(group, where);
    for (const name of ['triangles', 'wedgeSet', 'mesh', 'primitive']) count(fields[name], `${where}.${name}`);
    if ((fields['wedgeSet'] as number) >= sets.length) throw new DecimeshError('out-of-range', 'no such wedge set', `${where}.wedgeSet`);
    for (const name of ['object', 'material']) {
      if (fields[name] !== null && typeof fields[name] !== 'string') throw wrong(`${where}.${name}`);
    }
  }
  return header as unknown as Description;
}

function wrong(where: string): DecimeshError {
  return new DecimeshError('syntax', 'is missing or of the wrong type', where);
}

function record(value: unknown, where: string): Record<string, unknown> {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw wrong(where);
  return value as Record<string, unknown>;
}

function list(value: unknown, where: string): readonly unknown[] {
  if (!Array.isArray(value)) throw wrong(where);
  if (value.length > MOST_PARTS) throw new DecimeshError('too-large', `more than ${MOST_PARTS} entries`, where);
  return value;
}

function number(value: unknown, where: string): void {
  if (typeof value !== 'number' || !Number.isFinite(value) || value < 0) throw wrong(where);
}

function count(value: unknown, where: string): void {
  number(value, where);
  if (!Number.isInteger(value)) throw wrong(where);
  if ((value as number) > MOST_ELEMENTS) throw new DecimeshError('too-large', 'more than a billion elements', where);
}

function grid(value: unknown, where: string): void {
  number(value, where);
  if (value !== 0 && ((value as number) < 1 || (value as number) > 2 ** 40)) throw new DecimeshError('out-of-range', 'no such grid', where);
}
