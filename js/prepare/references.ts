// Which places of a glTF's tree hold the number of something in one of its arrays.

import { objectOr, objects, uint, type Tree } from '../codecs/tree.js';

/** The arrays of a glTF whose elements are referred to by number. */
export const LISTS = [
  'accessors', 'animations', 'bufferViews', 'cameras', 'images', 'materials', 'meshes', 'nodes', 'samplers', 'scenes', 'skins', 'textures',
] as const;

/** The name of such an array. */
export type List = (typeof LISTS)[number];

/** A place that holds a number. */
export interface Reference {
  readonly list: List;
  readonly holder: Tree | unknown[];
  readonly key: string | number;
  readonly index: number;
}

/** What an extension refers to, in its object on an element of `list`. */
type Rule = (extension: Tree, list: List | 'root') => Iterable<Reference>;

const NOTHING: Rule = () => [];

/** The extensions whose references are known. One that is not here may refer to anything. */
const RULES: Readonly<Record<string, Rule>> = {
  EXT_instance_features: NOTHING,
  EXT_mesh_features: (json) => objects(json, 'featureIds').flatMap((id) => [...one('textures', objectOr(id['texture']), 'index')]),
  EXT_mesh_gpu_instancing: (json) => values('accessors', json['attributes']),
  EXT_structural_metadata: metadata,
  EXT_texture_avif: image,
  EXT_texture_webp: image,
  KHR_lights_punctual: NOTHING,
  KHR_materials_variants: (json) => objects(json, 'mappings').flatMap((mapping) => [...one('materials', mapping, 'material')]),
  KHR_mesh_quantization: NOTHING,
  KHR_node_visibility: NOTHING,
  KHR_texture_basisu: image,
  KHR_texture_transform: NOTHING,
  KHR_xmp_json_ld: NOTHING,
  MSFT_lod: (json, list) => (list === 'nodes' || list === 'materials' ? each(list, json, 'ids') : []),
  MSFT_texture_dds: image,
  ...Object.fromEntries(
    ['anisotropy', 'clearcoat', 'diffuse_transmission', 'dispersion', 'emissive_strength', 'ior', 'iridescence', 'pbrSpecularGlossiness',
      'sheen', 'specular', 'transmission', 'unlit', 'volume'].map((name) => [`KHR_materials_${name}`, textures]),
  ),
};

/** The extensions in the tree of which it is not known what they refer to. */
export function unknownExtensions(tree: Tree): string[] {
  const found = new Set<string>();
  const visit = (value: unknown): void => {
    if (Array.isArray(value)) return value.forEach(visit);
    if (typeof value !== 'object' || value === null) return;
    for (const [key, item] of Object.entries(value)) {
      if (key === 'extensions') for (const name of Object.keys(objectOr(item))) if (!Object.hasOwn(RULES, name)) found.add(name);
      if (key !== 'extras') visit(item);
    }
  };
  visit(tree);
  return [...found].sort();
}

/** The references of the tree that are in no array's element. */
export function rootReferences(tree: Tree): Reference[] {
  return [...one('scenes', tree, 'scene'), ...inExtensions(tree, 'root')];
}

/** The references of one element of `list`. */
export function referencesOf(list: List, json: Tree): Reference[] {
  return [...core(list, json), ...inExtensions(json, list)];
}

/** Every reference of the tree. */
export function allReferences(tree: Tree): Reference[] {
  return [...rootReferences(tree), ...LISTS.flatMap((list) => objects(tree, list).flatMap((json) => referencesOf(list, json)))];
}

function* core(list: List, json: Tree): Iterable<Reference> {
  switch (list) {
    case 'accessors': {
      const sparse = objectOr(json['sparse']);
      for (const holder of [json, objectOr(sparse['indices']), objectOr(sparse['values'])]) yield* one('bufferViews', holder, 'bufferView');
      break;
    }
    case 'animations':
      for (const sampler of objects(json, 'samplers')) for (const key of ['input', 'output']) yield* one('accessors', sampler, key);
      for (const channel of objects(json, 'channels')) yield* one('nodes', objectOr(channel['target']), 'node');
      break;
    case 'images':
      yield* one('bufferViews', json, 'bufferView');
      break;
    case 'materials':
      yield* textures(json);
      break;
    case 'meshes':
      for (const primitive of objects(json, 'primitives')) {
        for (const set of [primitive['attributes'], ...objects(primitive, 'targets')]) yield* values('accessors', set);
        yield* one('accessors', primitive, 'indices');
        yield* one('materials', primitive, 'material');
        yield* inExtensions(primitive, list);
      }
      break;
    case 'nodes':
      yield* each('nodes', json, 'children');
      for (const [key, target] of [['mesh', 'meshes'], ['skin', 'skins'], ['camera', 'cameras']] as const) yield* one(target, json, key);
      break;
    case 'scenes':
      yield* each('nodes', json, 'nodes');
      break;
    case 'skins':
      yield* each('nodes', json, 'joints');
      yield* one('nodes', json, 'skeleton');
      yield* one('accessors', json, 'inverseBindMatrices');
      break;
    case 'textures':
      yield* one('images', json, 'source');
      yield* one('samplers', json, 'sampler');
      break;
    default:
  }
}

function inExtensions(json: Tree, list: List | 'root'): Reference[] {
  return Object.entries(objectOr(json['extensions'])).flatMap(([name, value]) =>
    Object.hasOwn(RULES, name) ? [...(RULES[name] as Rule)(objectOr(value), list)] : [],
  );
}

function* one(list: List, holder: Tree, key: string): Iterable<Reference> {
  const index = uint(holder[key]);
  if (index !== undefined) yield { list, holder, key, index };
}

function* each(list: List, holder: Tree, key: string): Iterable<Reference> {
  const numbers = holder[key];
  if (!Array.isArray(numbers)) return;
  for (const [at, value] of numbers.entries()) {
    const index = uint(value);
    if (index !== undefined) yield { list, holder: numbers, key: at, index };
  }
}

function* values(list: List, set: unknown): Iterable<Reference> {
  const holder = objectOr(set);
  for (const key of Object.keys(holder)) yield* one(list, holder, key);
}

/** Every texture of a material is under a key of this form. */
function* textures(json: Tree): Iterable<Reference> {
  for (const [key, value] of Object.entries(json)) {
    if (key === 'extensions' || key === 'extras' || typeof value !== 'object' || value === null) continue;
    if (key.endsWith('Texture')) yield* one('textures', objectOr(value), 'index');
    else yield* textures(objectOr(value));
  }
}

function* image(json: Tree): Iterable<Reference> {
  yield* one('images', json, 'source');
}

function* metadata(json: Tree, list: List | 'root'): Iterable<Reference> {
  // On a primitive it numbers its own tables.
  if (list !== 'root') return;
  for (const { properties } of objects(json, 'propertyTables')) {
    for (const property of Object.values(objectOr(properties))) {
      for (const key of ['values', 'arrayOffsets', 'stringOffsets']) yield* one('bufferViews', objectOr(property), key);
    }
  }
  for (const { properties } of objects(json, 'propertyTextures')) {
    for (const property of Object.values(objectOr(properties))) yield* one('textures', objectOr(property), 'index');
  }
}
