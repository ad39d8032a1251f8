// Parses a whole GLB with three's loader for its materials, skins and animations, and finds its triangle groups again.
import { Box3, Color, Mesh, MeshStandardMaterial, PointLight, SkinnedMesh, SpotLight, Texture, Vector3 } from 'three';
import type { AnimationClip, BufferGeometry, Group, Material, Object3D } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import type { GLTFParser } from 'three/addons/loaders/GLTFLoader.js';

/** A drawable primitive: one per node that uses it. */
export interface Part {
  readonly mesh: Mesh;
  readonly original: BufferGeometry;
  /** The file's own. */
  readonly material: Material | Material[];
}

/** A model that three can draw, and the way back from its objects to the file's primitives. */
export interface LoadedModel {
  readonly root: Group;
  readonly animations: AnimationClip[];
  /** Every object that draws primitive `primitive` of mesh `mesh`, under `partKey(mesh, primitive)`. */
  readonly parts: Map<string, Part[]>;
  /** Bounds of the whole in its rest pose, in model units. */
  readonly bounds: Box3;
  /** Whether no part has a material in the file. */
  readonly unpainted: boolean;
}

export const partKey = (mesh: number, primitive: number): string => `${mesh}/${primitive}`;

/** The mesh in a {@link partKey}. */
export const meshOfPart = (key: string): string => key.slice(0, key.indexOf('/'));

/** What an unpainted surface looks like: plain clay shows form better than three's default, a dull mirror. */
export const CLAY = new Color(0xcfc8bd);

/** Vertices looked at when a skinned mesh is measured: its rest pose is not in its file's bounds. */
const SKIN_SAMPLES = 2000;

/** Parses `bytes`, a GLB with all of its parts inside; rejects with the loader's reason. */
export async function loadModel(bytes: Uint8Array): Promise<LoadedModel> {
  const loader = new GLTFLoader();
  // The loader's own map from objects to primitives keeps only the last scene's; a mark on the object survives cloning.
  loader.register((parser) => ({
    name: 'decimesh_primitive_marks',
    loadMesh: (mesh: number) => parser.loadMesh(mesh).then((object) => markPrimitives(object, mesh, parser)),
  }));
  const buffer =
    bytes.byteOffset === 0 && bytes.byteLength === bytes.buffer.byteLength ? bytes.buffer : bytes.slice().buffer;
  const gltf = await loader.parseAsync(buffer as ArrayBuffer, '');
  const root: Group | undefined = gltf.scene ?? gltf.scenes[0];
  const parts = new Map<string, Part[]>();
  if (root === undefined) throw new Error('the file has no scene');
  root.updateMatrixWorld(true);
  root.traverse((object) => {
    // The whole model is in view or nearly so; culling would ask for bounds of skinned meshes, vertex by vertex.
    object.frustumCulled = false;
    if (!(object instanceof Mesh)) return;
    if (object instanceof SkinnedMesh) object.boundingSphere = object.geometry.boundingSphere;
    const key: unknown = object.userData[MARK];
    if (typeof key !== 'string') return;
    const list = parts.get(key) ?? [];
    list.push({ mesh: object, original: object.geometry, material: object.material as Material | Material[] });
    parts.set(key, list);
  });
  const unpainted = [...parts.values()].flat().every(({ mesh }) => mesh.userData[UNPAINTED] === true);
  return { root, animations: gltf.animations, parts, bounds: sceneBounds(root), unpainted };
}

const MARK = 'decimeshPrimitive';
const UNPAINTED = 'decimeshUnpainted';

function markPrimitives<T extends Object3D>(object: T, mesh: number, parser: GLTFParser): T {
  const definition = (parser.json as { meshes: Array<{ primitives: Array<{ material?: number }> }> }).meshes[mesh];
  const drawn: Object3D[] = object instanceof Mesh ? [object] : object.children;
  drawn.forEach((child, primitive) => {
    child.userData[MARK] = partKey(mesh, primitive);
    const unpainted = definition?.primitives[primitive]?.material === undefined;
    child.userData[UNPAINTED] = unpainted;
    if (unpainted && child instanceof Mesh && child.material instanceof MeshStandardMaterial) {
      child.material.metalness = 0;
      child.material.roughness = 0.62;
      if (!child.material.vertexColors) child.material.color.copy(CLAY);
    }
  });
  return object;
}

function sceneBounds(root: Object3D): Box3 {
  const bounds = new Box3();
  const part = new Box3();
  root.traverse((object) => {
    if (object instanceof SkinnedMesh) bounds.union(skinnedBounds(object));
    else if ('geometry' in object) {
      const { boundingBox } = object.geometry as BufferGeometry;
      if (boundingBox !== null) bounds.union(part.copy(boundingBox).applyMatrix4(object.matrixWorld));
    }
  });
  if (bounds.isEmpty()) bounds.set(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));
  return bounds;
}

function skinnedBounds(mesh: SkinnedMesh): Box3 {
  const bounds = new Box3();
  const position = mesh.geometry.getAttribute('position');
  const step = Math.max(1, Math.floor(position.count / SKIN_SAMPLES));
  const point = new Vector3();
  mesh.skeleton.update();
  for (let vertex = 0; vertex < position.count; vertex += step) {
    point.fromBufferAttribute(position, vertex);
    bounds.expandByPoint(mesh.applyBoneTransform(vertex, point).applyMatrix4(mesh.matrixWorld));
  }
  return bounds;
}

/** Lights in the file, told that the model is shown `scale` times its size: light falls off with the distance squared. */
export function scaleLights(root: Object3D, scale: number): void {
  root.traverse((object) => {
    if (!(object instanceof PointLight || object instanceof SpotLight)) return;
    object.intensity *= scale * scale;
    object.distance *= scale;
  });
}

/** Every material under `root`, once. */
export function materialsOf(root: Object3D): Set<Material> {
  const materials = new Set<Material>();
  root.traverse((object) => {
    if (!('material' in object)) return;
    const { material } = object as { material: Material | Material[] };
    for (const each of Array.isArray(material) ? material : [material]) materials.add(each);
  });
  return materials;
}

/** Frees what the graphics card holds for the model. */
export function disposeModel(model: LoadedModel): void {
  const materials = materialsOf(model.root);
  for (const material of materials) {
    for (const value of Object.values(material)) {
      if (!(value instanceof Texture)) continue;
      value.dispose();
      if (value.image instanceof ImageBitmap) value.image.close();
    }
    material.dispose();
  }
  model.root.traverse((object) => {
    if (object instanceof SkinnedMesh) object.skeleton.dispose();
    if ('geometry' in object) (object.geometry as BufferGeometry).dispose();
  });
  for (const list of model.parts.values()) for (const part of list) part.original.dispose();
}
