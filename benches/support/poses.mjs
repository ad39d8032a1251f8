// A glTF scene in its poses: world positions of every triangle at rest, at moments of its animations, and with each
// morph target at full weight, by the maths of three.js.
import { AnimationMixer, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

// The loader reports the progress of reading what is in the text itself.
globalThis.ProgressEvent ??= Event;

/** The scene of a GLB, without what only a renderer needs. */
export async function loadScene(glb) {
  const view = new DataView(glb.buffer, glb.byteOffset);
  const length = view.getUint32(12, true);
  const tree = JSON.parse(new TextDecoder().decode(glb.subarray(20, 20 + length)));
  for (const mesh of tree.meshes ?? []) for (const primitive of mesh.primitives) delete primitive.material;
  for (const list of ['materials', 'textures', 'images', 'samplers']) delete tree[list];
  // Levels of a chain are not meant; extensions that matter to positions are core of the loader.
  const binary = glb.slice(28 + length);
  const uri = `data:application/octet-stream;base64,${Buffer.from(binary).toString('base64')}`;
  tree.buffers = [{ ...tree.buffers[0], uri }];
  const { scene, animations } = await new GLTFLoader().parseAsync(JSON.stringify(tree), '');
  return { scene, animations };
}

/** The world positions and triangles of all meshes as they stand. */
export function worldMesh({ scene }) {
  scene.updateMatrixWorld(true);
  const positions = [];
  const indices = [];
  const point = new Vector3();
  scene.traverse((object) => {
    if (!object.isMesh) return;
    object.skeleton?.update();
    const first = positions.length / 3;
    const { count } = object.geometry.getAttribute('position');
    for (let vertex = 0; vertex < count; vertex += 1) {
      object.getVertexPosition(vertex, point).applyMatrix4(object.matrixWorld);
      positions.push(point.x, point.y, point.z);
    }
    for (const index of object.geometry.index.array) indices.push(first + index);
  });
  return { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
}

/** Calls `look` with a label at each of `count` moments, the same in every copy of the scene, spread over its animations. */
export async function atFrames({ scene, animations }, count, look) {
  for (let frame = 0; frame < count; frame += 1) {
    const clip = animations[frame % animations.length];
    const step = Math.floor(frame / animations.length);
    const steps = Math.ceil(count / animations.length);
    const mixer = new AnimationMixer(scene);
    mixer.clipAction(clip).play();
    mixer.setTime(((step + 0.5) / steps) * clip.duration);
    await look(`${clip.name || 'animation'} ${step + 1}/${steps}`);
    mixer.stopAllAction();
  }
}

/** Calls `look` with a label for each morph target at weight 1, all others 0. */
export async function atTargets({ scene }, look) {
  const meshes = [];
  scene.traverse((object) => object.isMesh && object.morphTargetInfluences && meshes.push(object));
  const count = Math.max(0, ...meshes.map(({ morphTargetInfluences }) => morphTargetInfluences.length));
  for (let target = 0; target < count; target += 1) {
    for (const { morphTargetInfluences } of meshes) {
      for (let at = 0; at < morphTargetInfluences.length; at += 1) morphTargetInfluences[at] = at === target ? 1 : 0;
    }
    await look(`target ${target}`);
  }
  for (const { morphTargetInfluences } of meshes) morphTargetInfluences.fill(0);
}

/** At rest: no animation, no morph target. */
export function rest({ scene }) {
  scene.traverse((object) => object.isMesh && object.morphTargetInfluences?.fill(0));
}
