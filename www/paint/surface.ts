// Finds what is under a ray and in a ball on a mesh, by the boxes of neighbouring triangles and vertices: files list
// them near one another, so that most boxes are passed over, and where they do not it is only slower.

/** Triangles, and vertices, that share a box. */
const RUN = 256;

/** A mesh to be painted on, in coordinates of its own. */
export class PaintSurface {
  private readonly triangleBoxes: Float32Array;
  private readonly vertexBoxes: Float32Array;

  /** `positions` three for a vertex; without `indices` every three vertices are a triangle. */
  constructor(
    readonly positions: ArrayLike<number>,
    private readonly indices: ArrayLike<number> | null,
  ) {
    const vertices = Math.floor(positions.length / 3);
    const corners = indices?.length ?? vertices;
    this.triangleBoxes = boxesOf(positions, corners - (corners % 3), 3 * RUN, (corner) => indices?.[corner] ?? corner);
    this.vertexBoxes = boxesOf(positions, vertices, RUN, (vertex) => vertex);
  }

  /**
   * How far along the ray, in multiples of `direction`, the first triangle is hit, from either side; Infinity if none is
   * before `limit`.
   */
  hit(origin: Point, direction: Point, limit = Infinity): number {
    const { triangleBoxes, positions, indices } = this;
    const corners = indices?.length ?? Math.floor(positions.length / 3);
    let nearest = limit;
    for (let box = 0; box * 6 < triangleBoxes.length; box += 1) {
      if (!boxIsHit(triangleBoxes, box * 6, origin, direction, nearest)) continue;
      const end = Math.min((box + 1) * 3 * RUN, corners - 2);
      for (let corner = box * 3 * RUN; corner < end; corner += 3) {
        const a = 3 * (indices?.[corner] ?? corner);
        const b = 3 * (indices?.[corner + 1] ?? corner + 1);
        const c = 3 * (indices?.[corner + 2] ?? corner + 2);
        nearest = Math.min(nearest, triangleHit(positions, a, b, c, origin, direction));
      }
    }
    return nearest < limit ? nearest : Infinity;
  }

  /** Calls `visit` for the vertices in boxes that a ball of `radius` around `centre` reaches: those in it, and more. */
  near(centre: Point, radius: number, visit: (vertex: number) => void): void {
    const { vertexBoxes } = this;
    const vertices = Math.floor(this.positions.length / 3);
    for (let box = 0; box * 6 < vertexBoxes.length; box += 1) {
      let squared = 0;
      for (let axis = 0; axis < 3; axis += 1) {
        const low = (vertexBoxes[box * 6 + axis] ?? 0) - (centre[axis] ?? 0);
        const high = (centre[axis] ?? 0) - (vertexBoxes[box * 6 + 3 + axis] ?? 0);
        squared += Math.max(low, high, 0) ** 2;
      }
      if (!(squared <= radius * radius)) continue;
      const end = Math.min((box + 1) * RUN, vertices);
      for (let vertex = box * RUN; vertex < end; vertex += 1) visit(vertex);
    }
  }
}

export type Point = readonly [x: number, y: number, z: number];

/** The least and the greatest coordinates of each `run` of `count` vertices: six numbers a run. */
function boxesOf(positions: ArrayLike<number>, count: number, run: number, vertexAt: (index: number) => number): Float32Array {
  const boxes = new Float32Array(Math.ceil(count / run) * 6);
  for (let index = 0; index < count; index += 1) {
    const box = Math.floor(index / run) * 6;
    const vertex = vertexAt(index);
    for (let axis = 0; axis < 3; axis += 1) {
      const value = positions[3 * vertex + axis] ?? 0;
      const first = index % run === 0;
      if (first || value < (boxes[box + axis] ?? 0)) boxes[box + axis] = value;
      if (first || value > (boxes[box + 3 + axis] ?? 0)) boxes[box + 3 + axis] = value;
    }
  }
  return boxes;
}

/** Whether the ray comes through the box before `limit` (slabs, Kay and Kajiya 1986). */
function boxIsHit(boxes: Float32Array, at: number, origin: Point, direction: Point, limit: number): boolean {
  let from = 0;
  let to = limit;
  for (let axis = 0; axis < 3; axis += 1) {
    const start = origin[axis] ?? 0;
    const step = direction[axis] ?? 0;
    const low = boxes[at + axis] ?? 0;
    const high = boxes[at + 3 + axis] ?? 0;
    if (step === 0) {
      if (start < low || start > high) return false;
      continue;
    }
    const first = (low - start) / step;
    const second = (high - start) / step;
    from = Math.max(from, Math.min(first, second));
    to = Math.min(to, Math.max(first, second));
    if (from > to) return false;
  }
  return true;
}

/** Where the ray meets the triangle of the vertices at `a`, `b`, `c`, Infinity if nowhere (Möller and Trumbore 1997). */
function triangleHit(p: ArrayLike<number>, a: number, b: number, c: number, origin: Point, direction: Point): number {
  const [ax, ay, az] = [p[a] ?? 0, p[a + 1] ?? 0, p[a + 2] ?? 0];
  const [ux, uy, uz] = [(p[b] ?? 0) - ax, (p[b + 1] ?? 0) - ay, (p[b + 2] ?? 0) - az];
  const [vx, vy, vz] = [(p[c] ?? 0) - ax, (p[c + 1] ?? 0) - ay, (p[c + 2] ?? 0) - az];
  const [dx, dy, dz] = direction;
  const [sx, sy, sz] = [origin[0] - ax, origin[1] - ay, origin[2] - az];
  const [px, py, pz] = [dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx];
  const determinant = ux * px + uy * py + uz * pz;
  if (determinant === 0) return Infinity;
  const u = (sx * px + sy * py + sz * pz) / determinant;
  if (!(u >= 0 && u <= 1)) return Infinity;
  const [qx, qy, qz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
  const v = (dx * qx + dy * qy + dz * qz) / determinant;
  if (!(v >= 0 && u + v <= 1)) return Infinity;
  const t = (vx * qx + vy * qy + vz * qz) / determinant;
  return t > 0 ? t : Infinity;
}
