// One state of the model that can be on screen, the original or a level: its geometries and the lines over them.
import type { BufferGeometry, LineBasicMaterial } from 'three';
import { classifyEdges } from './edge-classes.ts';
import type { ClassifiedEdges, Triangles } from './edge-classes.ts';
import { edgeIndices, showLines } from './lines.ts';
import type { LineOverlay } from './lines.ts';
import { meshOfPart } from './load.ts';
import type { LoadedModel, Part } from './load.ts';
import type { EdgeCounts } from './protocol.ts';

/** Materials of the lines over a surface. */
export interface LineMaterials {
  readonly wireframe: LineBasicMaterial;
  readonly edges: Readonly<Record<keyof EdgeCounts, LineBasicMaterial>>;
}

/** Which lines are wanted. */
export interface LineWish {
  readonly wireframe: boolean;
  readonly edgeClasses: boolean;
}

const CLASSES = ['seam', 'border', 'nonManifold'] as const;

/** Both sides draw with the same objects: {@link enter} puts one's geometries into them for the next picture. */
export class Side {
  private wireframe: LineOverlay[] | null = null;
  private classes: { overlays: LineOverlay[]; counts: EdgeCounts } | null = null;

  /** `level` has a geometry for each part by its key; parts that it lacks, and all without it, have the file's own. */
  constructor(
    private readonly model: LoadedModel,
    private readonly materials: LineMaterials,
    private readonly level: ReadonlyMap<string, BufferGeometry> | null,
  ) {}

  /** Has the model drawn in this state, with the lines that are wanted; `paint` may change each part's material. */
  enter(wish: LineWish, paint?: (part: Part) => void): void {
    for (const [key, parts] of this.model.parts) {
      for (const part of parts) {
        part.mesh.geometry = this.level?.get(key) ?? part.original;
        paint?.(part);
      }
    }
    if (wish.wireframe) this.wireframe ??= this.drawWireframe();
    if (wish.edgeClasses) this.classes ??= this.drawClasses();
    this.show(wish);
  }

  /** Hides the lines: the other state is drawn next. */
  leave(): void {
    this.show({ wireframe: false, edgeClasses: false });
  }

  /** Frees lines that are not wanted any more. */
  trim(wish: LineWish): void {
    if (!wish.wireframe) {
      for (const overlay of this.wireframe ?? []) overlay.dispose();
      this.wireframe = null;
    }
    if (!wish.edgeClasses) {
      for (const overlay of this.classes?.overlays ?? []) overlay.dispose();
      this.classes = null;
    }
  }

  /** Of the lines that {@link enter} has drawn, or null. */
  get edgeCounts(): EdgeCounts | null {
    return this.classes?.counts ?? null;
  }

  /** Frees the lines and the level's geometries; the file's own belong to the model. */
  dispose(): void {
    this.trim({ wireframe: false, edgeClasses: false });
    for (const geometry of this.level?.values() ?? []) geometry.dispose();
  }

  private show(wish: LineWish): void {
    for (const overlay of this.wireframe ?? []) overlay.visible = wish.wireframe;
    for (const overlay of this.classes?.overlays ?? []) overlay.visible = wish.edgeClasses;
  }

  private drawWireframe(): LineOverlay[] {
    const pairs = new Map<BufferGeometry, Uint32Array>();
    return [...this.model.parts.values()].flat().map(({ mesh }) => {
      const { geometry } = mesh;
      const edges = pairs.get(geometry) ?? edgeIndices(geometry);
      pairs.set(geometry, edges);
      return showLines(mesh, geometry, edges, this.materials.wireframe);
    });
  }

  private drawClasses(): { overlays: LineOverlay[]; counts: EdgeCounts } {
    const overlays: LineOverlay[] = [];
    const counts = { border: 0, seam: 0, nonManifold: 0 };
    for (const keys of this.keysByMesh()) {
      const geometries = keys.map((key) => this.model.parts.get(key)?.[0]?.mesh.geometry).filter((geometry) => geometry !== undefined);
      const found = classifyEdges(geometries.map(trianglesOf));
      if (found === null) continue;
      for (const name of CLASSES) counts[name] += found.counts[name];
      keys.forEach((key, index) => {
        const edges = found.edges[index];
        if (edges !== undefined) overlays.push(...this.drawEdges(key, edges));
      });
    }
    return { overlays, counts };
  }

  private drawEdges(key: string, edges: ClassifiedEdges): LineOverlay[] {
    const drawn = CLASSES.filter((name) => edges[name].length > 0);
    return (this.model.parts.get(key) ?? []).flatMap(({ mesh }) =>
      drawn.map((name) => showLines(mesh, mesh.geometry, edges[name], this.materials.edges[name])),
    );
  }

  /** The primitives of each mesh together: an edge where two of them meet is no border. */
  private keysByMesh(): Iterable<string[]> {
    const meshes = new Map<string, string[]>();
    for (const key of this.model.parts.keys()) {
      const mesh = meshOfPart(key);
      const keys = meshes.get(mesh) ?? [];
      keys.push(key);
      meshes.set(mesh, keys);
    }
    return meshes.values();
  }
}

/** The triangles of `geometry` as plain arrays. */
export function trianglesOf(geometry: BufferGeometry): Triangles {
  const position = geometry.getAttribute('position');
  const indices = geometry.index?.array ?? null;
  if (!('isInterleavedBufferAttribute' in position) && position.itemSize === 3) return { positions: position.array, indices };
  const positions = new Float32Array(position.count * 3);
  for (let vertex = 0; vertex < position.count; vertex += 1) {
    positions.set([position.getX(vertex), position.getY(vertex), position.getZ(vertex)], 3 * vertex);
  }
  return { positions, indices };
}
