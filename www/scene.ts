// The tree of a model as its file has it: what is in it, under which names, with how many triangles.

/** A node that has a mesh, or leads to one. */
export interface SceneNode {
  /** Of the node or its mesh; may be empty. */
  readonly name: string;
  /** 0 for a root. */
  readonly depth: number;
  /** Number of the glTF mesh; null for a node that only leads to others. */
  readonly mesh: number | null;
  /** Of the mesh, or of all below. */
  readonly triangles: number;
}

/** Trees beyond this are cut off: nobody reads them to the end. */
const MOST_NODES = 1000;
/** Text beyond this is not parsed on the page's thread, bytes. */
const MOST_TEXT = 4_000_000;

interface Gltf {
  readonly scene?: number;
  readonly scenes?: ReadonlyArray<{ readonly nodes?: readonly number[] }>;
  readonly nodes?: ReadonlyArray<{ readonly name?: string; readonly mesh?: number; readonly children?: readonly number[] }>;
  readonly meshes?: ReadonlyArray<{ readonly name?: string; readonly primitives: ReadonlyArray<Primitive> }>;
  readonly accessors?: ReadonlyArray<{ readonly count: number }>;
}

interface Primitive {
  readonly mode?: number;
  readonly indices?: number;
  readonly attributes: Readonly<Record<string, number>>;
}

/** The nodes of `glb`, which nobody may have looked at yet, each before its children; empty where that would take long. */
export function readScene(glb: Uint8Array): SceneNode[] {
  const length = new DataView(glb.buffer, glb.byteOffset).getUint32(12, true);
  if (length > MOST_TEXT) return [];
  const gltf = JSON.parse(new TextDecoder().decode(glb.subarray(20, 20 + length))) as Gltf;
  const triangles = (gltf.meshes ?? []).map(({ primitives }) => primitives.reduce((sum, primitive) => sum + trianglesOf(gltf, primitive), 0));
  const found: SceneNode[] = [];
  // Of what is no tree every node is visited once: following it around would not end.
  const seen = new Set<number>();
  const visit = (index: number, depth: number): number => {
    const node = gltf.nodes?.[index];
    if (node === undefined || seen.has(index) || found.length >= MOST_NODES) return 0;
    seen.add(index);
    const at = found.length;
    const mesh = node.mesh ?? null;
    const name = node.name || (mesh === null ? '' : (gltf.meshes?.[mesh]?.name ?? ''));
    const own = mesh === null ? 0 : (triangles[mesh] ?? 0);
    found.push({ name, depth, mesh, triangles: own });
    const below = (node.children ?? []).reduce((sum, child) => sum + visit(child, depth + 1), 0);
    // A bone or a camera is nothing that can be simplified.
    if (mesh === null && below === 0) found.splice(at);
    else if (mesh === null) found[at] = { name, depth, mesh, triangles: below };
    return own + below;
  };
  for (const root of gltf.scenes?.[gltf.scene ?? 0]?.nodes ?? []) visit(root, 0);
  return found;
}

function trianglesOf(gltf: Gltf, { mode = 4, indices, attributes }: Primitive): number {
  const count = gltf.accessors?.[indices ?? attributes['POSITION'] ?? -1]?.count ?? 0;
  return mode === 4 ? Math.floor(count / 3) : mode === 5 || mode === 6 ? Math.max(count - 2, 0) : 0;
}
