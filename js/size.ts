// The largest level whose output fits a number of bytes, found in few encodes.

/** What a level came to when it was written. */
export interface Encoded<Output> {
  readonly triangles: number;
  readonly bytes: number;
  readonly output: Output;
}

/** Encodes may be slow. Four find a level within `CLOSE` for any encoding whose size is nearly linear in the triangles. */
const MOST_ENCODES = 4;

/** Good enough: this share of the bytes that may be used. */
const CLOSE = 0.985;

/** What is aimed at: a little below the limit, so that a small error of the estimate still fits. */
const AIM = 0.993;

/**
 * Finds a level of at least `least` and at most `most` triangles whose output has at most `limit` bytes, as large as
 * possible. `encode(triangles)` writes the level of at most so many and says what it came to. If even the smallest level is too
 * large, that is the result.
 *
 * Regula falsi over the triangle count: the smallest level gives what does not depend on it (textures, animations), and
 * `bytesPerTriangle` is the first guess of the rest. A level that does not fit is never the result if one does.
 */
export async function findSize<Output>(
  limit: number,
  { least, most, bytesPerTriangle }: { readonly least: number; readonly most: number; readonly bytesPerTriangle: number },
  encode: (triangles: number) => Promise<Encoded<Output>> | Encoded<Output>,
): Promise<Encoded<Output>> {
  let low = await encode(least);
  if (low.bytes >= limit || low.triangles >= most) return low;
  let high: { readonly triangles: number; readonly bytes: number } | undefined;
  let slope = Math.max(bytesPerTriangle, 1e-3);
  let misses = 0;
  for (let encodes = 1; encodes < MOST_ENCODES && low.bytes < CLOSE * limit; encodes += 1) {
    if (high !== undefined) slope = (high.bytes - low.bytes) / Math.max(high.triangles - low.triangles, 1);
    const guess = Math.floor(low.triangles + (AIM * limit - low.bytes) / slope);
    // Where the line through two levels is no guide, as with a mesh each whose overhead comes and goes, the middle is.
    const between = misses > 1 && high !== undefined ? Math.floor((low.triangles + high.triangles) / 2) : guess;
    const wanted = Math.min(Math.max(between, low.triangles + 1), high === undefined ? most : high.triangles - 1);
    // Two levels side by side: there is nothing between them.
    if (wanted <= low.triangles) break;
    const found = await encode(wanted);
    if (found.bytes > limit) {
      high = found;
      misses += 1;
      continue;
    }
    misses = 0;
    if (found.triangles <= low.triangles) break;
    slope = (found.bytes - low.bytes) / (found.triangles - low.triangles);
    low = found;
    if (found.triangles >= most) break;
  }
  return low;
}
