// The landing's background: one mesh that is fine on the left and coarse on the right, without a crack between.
import { useEffect, useState } from 'preact/hooks';

const WIDTH = 1600;
const HEIGHT = 900;
const ROOT = 800;

/** Longest edge that is left alone at `x`. Its slope is gentle enough (< 0.58) that neighbours always split together. */
const longestEdgeAt = (x: number): number => 22 + 0.16 * x;

type Point = readonly [number, number];

/** Bisects a right triangle, whose right angle is at `apex`, until its long side is short enough; adds its outline. */
function refine(apex: Point, left: Point, right: Point, path: string[]): void {
  const middle: Point = [(left[0] + right[0]) / 2, (left[1] + right[1]) / 2];
  if (Math.hypot(left[0] - right[0], left[1] - right[1]) > longestEdgeAt(middle[0])) {
    refine(middle, apex, left, path);
    refine(middle, right, apex, path);
  } else {
    path.push(`M${left[0]} ${left[1]}L${apex[0]} ${apex[1]} ${right[0]} ${right[1]}Z`);
  }
}

function drawField(): string {
  const path: string[] = [];
  for (let x = 0; x < WIDTH; x += ROOT) {
    for (let y = 0; y < HEIGHT + ROOT; y += ROOT) {
      const corners: [Point, Point, Point, Point] = [[x, y], [x + ROOT, y], [x + ROOT, y + ROOT], [x, y + ROOT]];
      // Diagonals alternate so that roots meet at whole sides.
      const turned = (x / ROOT + y / ROOT) % 2 === 1;
      const [a, b, c, d] = turned ? [corners[1], corners[2], corners[3], corners[0]] : corners;
      refine(b, a, c, path);
      refine(d, c, a, path);
    }
  }
  return path.join('');
}

/** Drawn in a task of its own, so that the landing does not wait for its ornament. */
export function MeshField() {
  const [field, setField] = useState('');
  useEffect(() => {
    const timer = setTimeout(() => setField(drawField()));
    return () => clearTimeout(timer);
  }, []);
  return (
    <svg class="mesh-field" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} preserveAspectRatio="xMidYMid slice" aria-hidden="true">
      <path d={field} />
    </svg>
  );
}
