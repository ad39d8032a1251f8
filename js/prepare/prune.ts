// What nothing refers to is removed, and the rest is numbered anew.

import type { GltfData } from '../codecs/gltf_data.js';
import { objectOr, objects, type Tree } from '../codecs/tree.js';
import type { Warning } from '../types.js';
import { LISTS, referencesOf, rootReferences, unknownExtensions, type List } from './references.js';
import { closeGaps } from './release.js';

/**
 * Removes what neither a scene nor an animation needs. A file without scenes, or without nodes, is a library: its nodes,
 * or meshes, are what it is for. Nothing is removed where an extension is not known: it may refer to anything.
 */
export function prune(data: GltfData): Warning[] {
  const unknown = unknownExtensions(data.tree);
  if (unknown.length > 0) {
    return [{ code: 'not-pruned', message: `nothing is removed: ${unknown.join(', ')} may need it`, where: 'extensionsUsed' }];
  }
  const used = usedOf(data.tree);
  const { tree } = data;
  const numbers = new Map<List, Map<number, number>>();
  for (const list of LISTS) {
    const kept = [...objects(tree, list).keys()].filter((index) => used.get(list)?.has(index));
    numbers.set(list, new Map(kept.map((index, number) => [index, number])));
  }
  for (const list of LISTS) {
    const kept = [...(numbers.get(list) as Map<number, number>).keys()];
    if (list === 'bufferViews') data.keepViews(kept);
    else keep(tree, list, kept);
  }
  for (const reference of [...rootReferences(tree), ...LISTS.flatMap((list) => objects(tree, list).flatMap((json) => referencesOf(list, json)))]) {
    const { list, holder, key, index } = reference;
    const number = numbers.get(list)?.get(index);
    // A number beyond the end refers to nothing, and stays that.
    if (number !== undefined) (holder as Tree)[key] = number;
  }
  closeGaps(data, new Set(data.views.keys()));
  return [];
}

function keep(tree: Tree, list: List, kept: readonly number[]): void {
  const elements = tree[list];
  if (!Array.isArray(elements)) return;
  if (kept.length === 0) delete tree[list];
  else tree[list] = kept.map((index) => elements[index] as unknown);
}

function usedOf(tree: Tree): Map<List, Set<number>> {
  const used = new Map<List, Set<number>>(LISTS.map((list) => [list, new Set<number>()]));
  const queue: Array<readonly [List, number]> = [];
  const mark = (list: List, index: number): void => {
    const marked = used.get(list) as Set<number>;
    if (marked.has(index) || index >= objects(tree, list).length) return;
    marked.add(index);
    queue.push([list, index]);
  };
  const markAll = (list: List): void => [...objects(tree, list).keys()].forEach((index) => mark(list, index));
  const root = (['scenes', 'nodes', 'meshes', 'materials', 'textures', 'images', 'accessors'] as const).find((list) => objects(tree, list).length > 0);
  if (root !== undefined) markAll(root);
  markAll('animations');
  for (const { list, index } of rootReferences(tree)) mark(list, index);
  const elements = new Map(LISTS.map((list) => [list, objects(tree, list)]));
  for (let next = queue.pop(); next !== undefined; next = queue.pop()) {
    const [list, index] = next;
    for (const reference of referencesOf(list, objectOr(elements.get(list)?.[index]))) mark(reference.list, reference.index);
  }
  return used;
}
