// The brush in the view: finds the place on the original under it and paints the vertices in the ball around that,
// those on hidden sides too.
import { InstancedMesh, Matrix3, Matrix4, SkinnedMesh, Vector3 } from 'three';
import type { Mesh, PerspectiveCamera } from 'three';
import type { LoadedModel } from '../preview/load.ts';
import { trianglesOf } from '../preview/side.ts';
import { changeBetween } from './history.ts';
import { PaintLayer } from './layer.ts';
import type { Brush, PaintChange, PaintReply, PaintRequest } from './protocol.ts';
import { PaintSurface } from './surface.ts';
import type { Point } from './surface.ts';

/** What the painter works with. */
export interface Easel {
  readonly model: LoadedModel;
  readonly camera: PerspectiveCamera;
  /** Of the picture, in CSS pixels. */
  readonly width: number;
  readonly height: number;
  /** Has it drawn anew. */
  draw(): void;
}

/** Share of the radius in which the brush has its full strength. */
const CORE = 0.5;
/** Share of the radius between two places of the brush in one stroke. */
const SPACING = 0.35;
/** Places of the brush for one movement at most. */
const MOST_PLACES = 40;
/** Instances of one mesh beyond this are not painted on one by one: all show the same paint anyway. */
const MOST_INSTANCES = 10_000;

/** One appearance of a primitive in the scene. */
interface Placement {
  readonly surface: PaintSurface;
  readonly start: number;
  /** From its coordinates to the scene's. */
  readonly matrix: Matrix4;
}

/** Paints on one model, until it is disposed of. */
export class Painter {
  private readonly layer: PaintLayer;
  private placements: Placement[] | null = null;
  private pose = '';
  private epoch: number;
  private stroke: { readonly before: Uint8Array; x: number; y: number } | null = null;

  constructor(
    private readonly easel: () => Easel | null,
    private readonly reply: (reply: PaintReply) => void,
    request: PaintRequest & { type: 'start' },
    private readonly model: LoadedModel,
  ) {
    this.epoch = request.epoch;
    this.layer = new PaintLayer(model, request.parts, request.painted);
    this.tell(null);
    this.draw();
  }

  take(request: PaintRequest): void {
    const { painted } = this.layer;
    if (request.type === 'start' || request.type === 'stop') this.layer.visible = request.type === 'start';
    switch (request.type) {
      case 'dab':
        this.paintTo(request.brush);
        break;
      case 'end':
        this.end();
        break;
      case 'cancel':
        if (this.stroke !== null) painted.set(this.stroke.before);
        this.stroke = null;
        break;
      case 'start':
      case 'set':
        this.epoch = request.epoch;
        this.stroke = null;
        painted.set(request.painted);
        this.tell(null);
    }
    this.layer.update();
    this.draw();
  }

  dispose(): void {
    this.layer.dispose();
    this.draw();
  }

  private draw(): void {
    this.easel()?.draw();
  }

  private end(): void {
    if (this.stroke === null) return;
    const change = changeBetween(this.stroke.before, this.layer.painted);
    this.stroke = null;
    this.tell(change);
  }

  private tell(change: PaintChange | null): void {
    let count = 0;
    for (const paint of this.layer.painted) if (paint > 0) count += 1;
    this.reply({ type: 'painted', epoch: this.epoch, change, count });
  }

  /** Along the line from where the brush was: a fast hand leaves no gaps. */
  private paintTo(brush: Brush): void {
    const easel = this.easel();
    if (easel === null || easel.model !== this.model) return;
    if (this.stroke === null) {
      this.stroke = { before: this.layer.painted.slice(), x: brush.x, y: brush.y };
      this.place();
      this.paintAt(easel, brush);
      return;
    }
    const { x, y } = this.stroke;
    const length = Math.hypot(brush.x - x, brush.y - y);
    const places = Math.min(Math.ceil(length / Math.max(brush.radius * SPACING, 1)), MOST_PLACES);
    for (let place = 1; place <= places; place += 1) {
      const share = place / places;
      this.paintAt(easel, { ...brush, x: x + (brush.x - x) * share, y: y + (brush.y - y) * share });
    }
    [this.stroke.x, this.stroke.y] = [brush.x, brush.y];
  }

  private paintAt({ camera, width, height }: Easel, { x, y, radius, strength, erase }: Brush): void {
    const from = new Vector3().setFromMatrixPosition(camera.matrixWorld);
    const along = new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, 0.5).unproject(camera).sub(from).normalize();
    const found = this.firstHit(from, along);
    if (found === Infinity) return;
    const centre = from.clone().addScaledVector(along, found);
    const depth = -centre.clone().applyMatrix4(camera.matrixWorldInverse).z;
    // Pixels of the picture at that depth, in the scene's units.
    const reach = (radius * 2 * depth) / (height * (camera.projectionMatrix.elements[5] ?? 1));
    const core = CORE * reach;
    const { painted } = this.layer;
    const local = new Vector3();
    for (const { surface, start, matrix } of this.placements ?? []) {
      const inverse = matrix.clone().invert();
      local.copy(centre).applyMatrix4(inverse);
      const [a = 0, b = 0, c = 0, d = 0, e = 0, f = 0, g = 0, h = 0, i = 0] = new Matrix3().setFromMatrix4(matrix).elements;
      const { positions } = surface;
      surface.near(pointOf(local), reach * stretchOf(inverse), (vertex) => {
        const px = (positions[3 * vertex] ?? 0) - local.x;
        const py = (positions[3 * vertex + 1] ?? 0) - local.y;
        const pz = (positions[3 * vertex + 2] ?? 0) - local.z;
        const distance = Math.hypot(a * px + d * py + g * pz, b * px + e * py + h * pz, c * px + f * py + i * pz);
        if (distance >= reach) return;
        const rim = distance <= core ? 0 : (distance - core) / (reach - core);
        // Smooth at both ends.
        const value = Math.round(255 * strength * (1 - rim * rim * (3 - 2 * rim)));
        const old = painted[start + vertex] ?? 0;
        // However often the brush goes over a place, it is what the brush paints there and no more.
        painted[start + vertex] = erase ? Math.min(old, 255 - value) : Math.max(old, value);
      });
    }
  }

  private firstHit(from: Vector3, along: Vector3): number {
    let nearest = Infinity;
    const inverse = new Matrix4();
    for (const { surface, matrix } of this.placements ?? []) {
      if (matrix.determinant() === 0) continue;
      inverse.copy(matrix).invert();
      const origin = from.clone().applyMatrix4(inverse);
      // Not made a unit vector: distances along it are the same in every placement.
      const direction = along.clone().applyMatrix3(new Matrix3().setFromMatrix4(inverse));
      nearest = Math.min(nearest, surface.hit(pointOf(origin), pointOf(direction), nearest));
    }
    return nearest;
  }

  /** Finds out where everything is, if that is not known or skins, morph targets and instances have moved. */
  private place(): void {
    // Where nodes are animated, their meshes may have moved though nothing was bent.
    for (const { part } of this.layer.meshes) part.mesh.updateWorldMatrix(true, false);
    const pose = this.layer.meshes.map(({ part: { mesh } }) => (mesh instanceof InstancedMesh ? mesh.matrixWorld.elements.join() : poseOf(mesh))).join();
    if (this.placements !== null && pose === this.pose) return;
    this.pose = pose;
    const surfaces = new Map<object, PaintSurface>();
    this.placements = this.layer.meshes.flatMap(({ part: { mesh, original }, start }) => {
      if (poseOf(mesh) !== '') {
        // The level shown lends its geometry to the mesh: positions are those of the original.
        const { geometry } = mesh;
        mesh.geometry = original;
        const positions = posedPositions(mesh);
        mesh.geometry = geometry;
        return [{ surface: new PaintSurface(positions, original.index?.array ?? null), start, matrix: mesh.matrixWorld }];
      }
      let surface = surfaces.get(original);
      if (surface === undefined) {
        const { positions, indices } = trianglesOf(original);
        surface = new PaintSurface(positions, indices);
        surfaces.set(original, surface);
      }
      const found = surface;
      return matricesOf(mesh).map((matrix) => ({ surface: found, start, matrix }));
    });
  }
}

/** At least what the matrix makes of the length 1: its Frobenius norm. */
const stretchOf = (matrix: Matrix4): number => Math.hypot(...new Matrix3().setFromMatrix4(matrix).elements);

const pointOf = ({ x, y, z }: Vector3): Point => [x, y, z];

/** A text that changes when the mesh is bent; empty for one that cannot be. */
function poseOf(mesh: Mesh): string {
  const morphs = mesh.morphTargetInfluences?.join() ?? '';
  if (!(mesh instanceof SkinnedMesh)) return morphs;
  const bones = mesh.skeleton.bones.map(({ matrixWorld }) => matrixWorld.elements.reduce((sum, value, index) => sum + value * (index + 1), 0));
  return `${morphs} ${bones.join()}`;
}

/** Where skin and morph targets put the vertices, in the mesh's own coordinates. */
function posedPositions(mesh: Mesh): Float32Array {
  const { count } = mesh.geometry.getAttribute('position');
  const positions = new Float32Array(3 * count);
  const point = new Vector3();
  if (mesh instanceof SkinnedMesh) mesh.skeleton.update();
  for (let vertex = 0; vertex < count; vertex += 1) mesh.getVertexPosition(vertex, point).toArray(positions, 3 * vertex);
  return positions;
}

/** Of each appearance of the mesh; the matrix of a single one is the mesh's own and moves with it. */
function matricesOf(mesh: Mesh): Matrix4[] {
  if (!(mesh instanceof InstancedMesh)) return [mesh.matrixWorld];
  return Array.from({ length: Math.min(mesh.count, MOST_INSTANCES) }, (_, index) => {
    const matrix = new Matrix4();
    mesh.getMatrixAt(index, matrix);
    return matrix.premultiply(mesh.matrixWorld);
  });
}
