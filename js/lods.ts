// A chain of levels as one GLB by MSFT_lod: the finest is the file, and each coarser one adds meshes to it.
//
// The levels are GLBs written from one document, so their trees differ in the geometry alone. Nothing else is copied:
// materials, textures, skins and animations are the first level's.

import { buildGlb, encodeTree, parseGlb, type Glb } from './codecs/container.js';
import { arrayAt, objectOr, objects, type Tree } from './codecs/tree.js';
import { Geometry, VertexTable } from './lod_geometry.js';

/** Extensions of a node that are about its mesh, and belong to each of its levels. */
const MESH_EXTENSIONS = ['EXT_mesh_gpu_instancing', 'KHR_node_visibility'];

const PLACEMENT = ['matrix', 'translation', 'rotation', 'scale'];

/**
 * Joins `levels`, the finest first, into one GLB. `coverages` has for each the smallest screen coverage at which it is
 * shown, for `MSFT_screencoverage`.
 */
export function packLods(levels: ReadonlyArray<Uint8Array<ArrayBuffer>>, coverages: readonly number[]): Uint8Array<ArrayBuffer> {
  // Where the constraints allow no second level there is no chain.
  if (levels[0] !== undefined && levels.length === 1) return levels[0];
  const [first, ...coarser] = levels.map(parseGlb);
  if (first === undefined) throw new RangeError('no levels');
  const geometry = new Geometry(first);
  const tables = new Map<string, VertexTable>();
  // For each mesh of the file, that of each coarser level; undefined where the level has no such mesh.
  const meshes = list(first.json, 'meshes');
  const count = meshes.length;
  const meshOf = coarser.map((level, index) =>
    Array.from({ length: count }, (_, mesh) => addMesh(geometry, tables, { first, level }, mesh, index + 1)),
  );
  const chained = addNodes(first.json, (mesh) => meshOf.map((level) => level[mesh] as number), coverages);
  if (chained) {
    const used = arrayAt(first.json, 'extensionsUsed');
    if (!used.includes('MSFT_lod')) used.push('MSFT_lod');
  }
  // It states the buffer's length in the tree.
  const parts = geometry.finish();
  return buildGlb(encodeTree(first.json), parts);
}

/** Appends a level's mesh to the file and returns its number. */
function addMesh(
  geometry: Geometry,
  tables: Map<string, VertexTable>,
  { first, level }: { first: Glb; level: Glb },
  mesh: number,
  number: number,
): number {
  const source = list(level.json, 'meshes')[mesh] as Tree;
  const fileMeshes = list(first.json, 'meshes');
  const candidates = list(fileMeshes[mesh] as Tree, 'primitives');
  const primitives = list(source, 'primitives').map((primitive) => {
    const shared = shareVertices(geometry, tables, candidates, level, primitive);
    return shared ?? geometry.importPrimitive(level, primitive);
  });
  fileMeshes.push({ ...source, ...named(source, number), primitives });
  return fileMeshes.length - 1;
}

/** The primitive over vertices that the file has already, if it has all of them. */
function shareVertices(
  geometry: Geometry,
  tables: Map<string, VertexTable>,
  candidates: readonly Tree[],
  level: Glb,
  primitive: Tree,
): Tree | undefined {
  if (primitive['indices'] === undefined) return undefined;
  const vertices = geometry.vertices(level, primitive);
  if (vertices === undefined) return undefined;
  for (const candidate of candidates) {
    const key = JSON.stringify([candidate['attributes'], candidate['targets']]);
    let table = tables.get(key);
    if (table === undefined) {
      const own = geometry.vertices(geometry.file, candidate);
      if (own === undefined) continue;
      table = new VertexTable(own);
      tables.set(key, table);
    }
    const places = table.find(vertices);
    if (places === undefined) continue;
    const indices = geometry.addIndices(level, primitive['indices'] as number, places, table.vertices.count);
    const { attributes, targets } = candidate;
    return { ...primitive, attributes, indices, ...(targets === undefined ? {} : { targets }) };
  }
  return undefined;
}

/** Gives every node with a mesh its chain. Returns whether there is any. */
function addNodes(tree: Tree, meshesOf: (mesh: number) => number[], coverages: readonly number[]): boolean {
  const nodes = list(tree, 'nodes');
  // Chains that the file has already are its own business.
  const taken = new Set(nodes.flatMap((node) => lodOf(node)?.ids ?? []));
  let chained = false;
  for (const [index, node] of [...nodes.entries()]) {
    const mesh = node['mesh'] as number | undefined;
    if (mesh === undefined || lodOf(node) !== undefined || taken.has(index)) continue;
    const alone = list(node, 'children').length === 0 && (node['extras'] === undefined || isObject(node['extras']));
    // A level takes the place of the whole node: one that has more than a mesh gives the mesh to a node of its own.
    const holder = alone ? index : giveMeshAway(nodes, index);
    const from = nodes[holder] as Tree;
    const ids = meshesOf(mesh).map((number, level) => {
      nodes.push({ ...pick(from, [...PLACEMENT, 'skin', 'weights']), ...named(node, level + 1), mesh: number });
      const extensions = pick((from['extensions'] ?? {}) as Tree, MESH_EXTENSIONS);
      if (Object.keys(extensions).length > 0) (nodes.at(-1) as Tree)['extensions'] = extensions;
      return nodes.length - 1;
    });
    from['extensions'] = { ...(from['extensions'] as Tree | undefined), MSFT_lod: { ids } };
    from['extras'] = { ...(from['extras'] as Tree | undefined), MSFT_screencoverage: [...coverages] };
    animate(tree, index, holder, ids);
    chained = true;
  }
  return chained;
}

/** Moves the mesh of a node, with what belongs to it, to a new child of the node, and returns the child's number. */
function giveMeshAway(nodes: Tree[], index: number): number {
  const node = nodes[index] as Tree;
  const extensions = (node['extensions'] ?? {}) as Tree;
  const own = pick(extensions, MESH_EXTENSIONS);
  nodes.push({
    ...pick(node, ['mesh', 'skin', 'weights']),
    ...named(node, 0),
    ...(Object.keys(own).length > 0 ? { extensions: own } : {}),
  });
  for (const key of ['mesh', 'skin', 'weights']) delete node[key];
  for (const key of Object.keys(own)) delete extensions[key];
  if (node['extensions'] !== undefined && Object.keys(extensions).length === 0) delete node['extensions'];
  node['children'] = [...list(node, 'children'), nodes.length - 1];
  return nodes.length - 1;
}

/** Lets what animates the node `index` animate its levels too, which share the samplers. */
function animate(tree: Tree, index: number, holder: number, ids: readonly number[]): void {
  // Nothing has looked at these yet: a file may hold anything there.
  for (const { channels } of objects(tree, 'animations')) {
    if (!Array.isArray(channels)) continue;
    for (const channel of channels.map(objectOr)) {
      const target = objectOr(channel['target']);
      if (target['node'] !== index) continue;
      // The levels of a mesh that was given away stand below the node and move with it.
      if (holder !== index && target['path'] !== 'weights') continue;
      target['node'] = holder;
      for (const node of ids) channels.push({ ...channel, target: { ...target, node } });
    }
  }
}

function lodOf(node: Tree): { ids?: number[] } | undefined {
  return (node['extensions'] as Tree | undefined)?.['MSFT_lod'] as { ids?: number[] } | undefined;
}

/** The name that the extension's text suggests, where there is one to begin with. */
function named({ name }: Tree, level: number): Tree {
  return name === undefined ? {} : { name: `${String(name)}_LOD${level}` };
}

function pick(object: Tree, keys: readonly string[]): Tree {
  return Object.fromEntries(keys.filter((key) => object[key] !== undefined).map((key) => [key, object[key]]));
}

function isObject(value: unknown): boolean {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function list(object: Tree, key: string): Tree[] {
  return (object[key] ?? []) as Tree[];
}
