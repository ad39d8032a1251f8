// The edges of every triangle, drawn over a mesh; follows skins and morph targets like the mesh itself.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, Mesh, SkinnedMesh } from 'three';
import { edgeIndices } from './geometry.ts';

/** The lines of one mesh, hung below it; owned by the viewer. */
export interface EdgeOverlay {
  /** Removes the lines and frees their indices; the vertices belong to the mesh. */
  dispose(): void;
}

/** One material for all overlays. */
export function edgeMaterial(): LineBasicMaterial {
  return new LineBasicMaterial({ transparent: true, depthWrite: false, toneMapped: false });
}

/** Draws the edges of `mesh` as it is now; to be disposed of before its geometry changes. */
export function showEdges(mesh: Mesh, material: LineBasicMaterial): EdgeOverlay {
  const geometry = new BufferGeometry();
  for (const [name, attribute] of Object.entries(mesh.geometry.attributes)) geometry.setAttribute(name, attribute);
  geometry.morphAttributes = mesh.geometry.morphAttributes;
  geometry.morphTargetsRelative = mesh.geometry.morphTargetsRelative;
  geometry.boundingSphere = mesh.geometry.boundingSphere;
  geometry.setIndex(new BufferAttribute(edgeIndices(mesh.geometry), 1));

  // three's own LineSegments knows no skins and its `wireframe` builds the same indices twenty times slower, on a
  // plain array; a mesh that claims to be lines is drawn as lines with everything a mesh can do.
  const lines: Mesh = mesh instanceof SkinnedMesh ? new SkinnedMesh(geometry, material) : new Mesh(geometry, material);
  if (lines instanceof SkinnedMesh && mesh instanceof SkinnedMesh) {
    if (geometry.boundingSphere !== null) lines.boundingSphere = geometry.boundingSphere;
    lines.bindMode = mesh.bindMode;
    lines.bind(mesh.skeleton, mesh.bindMatrix);
  }
  if (mesh.morphTargetInfluences !== undefined) lines.morphTargetInfluences = mesh.morphTargetInfluences;
  Object.assign(lines, { isMesh: false, isLine: true, isLineSegments: true });
  lines.frustumCulled = false;
  lines.renderOrder = 1;
  mesh.add(lines);
  return {
    dispose(): void {
      lines.removeFromParent();
      // Disposing of a geometry frees its attributes on the card, and these are the mesh's.
      for (const name of Object.keys(geometry.attributes)) geometry.deleteAttribute(name);
      geometry.morphAttributes = {};
      geometry.dispose();
    },
  };
}
