// Lines drawn over a mesh that follow its skin and its morph targets like the mesh itself.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, Mesh, SkinnedMesh } from 'three';

/** The lines of one mesh, hung below it. */
export interface LineOverlay {
  /** Whether they are drawn. */
  visible: boolean;
  /** Removes the lines and frees their indices; the vertices belong to the mesh. */
  dispose(): void;
}

/** A material for lines over a surface; one serves all overlays of its colour. */
export function lineMaterial(): LineBasicMaterial {
  return new LineBasicMaterial({ transparent: true, depthWrite: false, toneMapped: false });
}

/** Draws lines between pairs of vertices of `surface`, a geometry of `mesh`; to be disposed of before the geometry. */
export function showLines(mesh: Mesh, surface: BufferGeometry, pairs: Uint32Array, material: LineBasicMaterial): LineOverlay {
  const geometry = new BufferGeometry();
  for (const [name, attribute] of Object.entries(surface.attributes)) geometry.setAttribute(name, attribute);
  geometry.morphAttributes = surface.morphAttributes;
  geometry.morphTargetsRelative = surface.morphTargetsRelative;
  geometry.boundingSphere = surface.boundingSphere;
  geometry.setIndex(new BufferAttribute(pairs, 1));

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
    get visible() {
      return lines.visible;
    },
    set visible(visible) {
      lines.visible = visible;
    },
    dispose(): void {
      lines.removeFromParent();
      // Disposing of a geometry frees its attributes on the card, and these are the mesh's.
      for (const name of Object.keys(geometry.attributes)) geometry.deleteAttribute(name);
      geometry.morphAttributes = {};
      geometry.dispose();
    },
  };
}

/** The edges of every triangle as pairs of vertices; shared edges come twice, which the screen does not mind. */
export function edgeIndices(geometry: BufferGeometry): Uint32Array {
  const index = geometry.index?.array;
  const corners = index?.length ?? geometry.getAttribute('position').count;
  const edges = new Uint32Array(corners * 2);
  for (let corner = 0, edge = 0; corner + 2 < corners; corner += 3) {
    const a = index?.[corner] ?? corner;
    const b = index?.[corner + 1] ?? corner + 1;
    const c = index?.[corner + 2] ?? corner + 2;
    edges[edge++] = a;
    edges[edge++] = b;
    edges[edge++] = b;
    edges[edge++] = c;
    edges[edge++] = c;
    edges[edge++] = a;
  }
  return edges;
}
