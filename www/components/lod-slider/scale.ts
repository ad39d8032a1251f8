// The slider's logarithmic scale: equal distances are equal ratios of triangles.

/** The count at `position` (0..1) between `fewest` and `all`; both ends exact. */
export function trianglesAtPosition(position: number, fewest: number, all: number): number {
  const low = Math.max(fewest, 1);
  if (all <= low) return position <= 0 ? fewest : all;
  if (position <= 0) return fewest;
  if (position >= 1) return all;
  return Math.round(low * (all / low) ** position);
}

/** Where `triangles` is between `fewest` and `all`, 0..1. */
export function positionOfTriangles(triangles: number, fewest: number, all: number): number {
  const low = Math.max(fewest, 1);
  if (all <= low) return triangles <= fewest && fewest < all ? 0 : 1;
  if (triangles <= low) return 0;
  return Math.min(Math.log(triangles / low) / Math.log(all / low), 1);
}
