// The paint over the original, as an attribute of its vertices that an overlay of each mesh shows.
import { BufferAttribute, DynamicDrawUsage, InstancedMesh, Mesh, MeshBasicMaterial, SkinnedMesh } from 'three';
import type { BufferGeometry, Material, Side } from 'three';
import { partKey } from '../preview/load.ts';
import type { LoadedModel, Part } from '../preview/load.ts';
import type { PaintedPart } from './protocol.ts';

/** Of the paint: far from the colours of most things. */
const COLOUR = 0xe5127d;

/** A drawn primitive that can be painted on. */
export interface PaintedMesh {
  readonly part: Part;
  /** Number of its first vertex among the document's. */
  readonly start: number;
}

/** Shows the numbers in `painted` on `model` until it is disposed of. */
export class PaintLayer {
  readonly meshes: readonly PaintedMesh[];
  private readonly attributes = new Map<number, BufferAttribute>();
  private readonly overlays: Mesh[] = [];
  private readonly materials = new Map<Side, Material>();

  constructor(model: LoadedModel, parts: readonly PaintedPart[], readonly painted: Uint8Array<ArrayBuffer>) {
    this.meshes = parts.flatMap(({ mesh, primitive, start, vertices }) =>
      (model.parts.get(partKey(mesh, primitive)) ?? [])
        // What the loader has made other vertices of cannot be told from here.
        .filter(({ original }) => original.getAttribute('position').count === vertices)
        .map((part) => {
          part.original.setAttribute('paint', this.attributeOf(start, vertices));
          this.overlays.push(overlay(part, this.materialFor(part)));
          return { part, start };
        }),
    );
  }

  /** To be called when `painted` has changed. */
  update(): void {
    for (const attribute of this.attributes.values()) attribute.needsUpdate = true;
  }

  set visible(visible: boolean) {
    for (const mesh of this.overlays) mesh.visible = visible;
  }

  /** The overlays' geometries are the model's and freed with it. */
  dispose(): void {
    for (const mesh of this.overlays) mesh.removeFromParent();
    for (const material of this.materials.values()) material.dispose();
  }

  /** Primitives of the same vertices share them. */
  private attributeOf(start: number, vertices: number): BufferAttribute {
    const known = this.attributes.get(start);
    if (known !== undefined) return known;
    const attribute = new BufferAttribute(this.painted.subarray(start, start + vertices), 1, true);
    attribute.setUsage(DynamicDrawUsage);
    this.attributes.set(start, attribute);
    return attribute;
  }

  private materialFor({ material }: Part): Material {
    const { side } = Array.isArray(material) ? (material[0] as Material) : material;
    const made = this.materials.get(side) ?? paintMaterial(side);
    this.materials.set(side, made);
    return made;
  }
}

/** Drawn over the surface, which has room in depth for it, where there is paint; the more, the denser. */
function paintMaterial(side: Side): Material {
  const material = new MeshBasicMaterial({ color: COLOUR, side, transparent: true, depthWrite: false, toneMapped: false });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute float paint;\nvarying float vPaint;')
      .replace('#include <begin_vertex>', '#include <begin_vertex>\nvPaint = paint;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', '#include <common>\nvarying float vPaint;')
      .replace('#include <color_fragment>', 'if (vPaint < 0.002) discard;\ndiffuseColor.a = mix(0.25, 0.78, vPaint);');
  };
  return material;
}

/** A second drawing of the part's original, below its mesh, that moves as the mesh does. */
function overlay({ mesh, original }: Part, material: Material): Mesh {
  const made = overlayOf(mesh, original, material);
  if (mesh.morphTargetInfluences !== undefined) made.morphTargetInfluences = mesh.morphTargetInfluences;
  made.frustumCulled = false;
  made.renderOrder = 1;
  mesh.add(made);
  return made;
}

function overlayOf(mesh: Mesh, geometry: BufferGeometry, material: Material): Mesh {
  if (mesh instanceof SkinnedMesh) {
    const made = new SkinnedMesh(geometry, material);
    if (geometry.boundingSphere !== null) made.boundingSphere = geometry.boundingSphere;
    made.bindMode = mesh.bindMode;
    made.bind(mesh.skeleton, mesh.bindMatrix);
    return made;
  }
  if (!(mesh instanceof InstancedMesh)) return new Mesh(geometry, material);
  const made = new InstancedMesh(geometry, material, mesh.count);
  made.instanceMatrix = mesh.instanceMatrix;
  return made;
}
