// The largest level whose output fits a number of bytes, found in few encodes.

/** What a level came to when it was written. */
export interface Encoded<Output> {
  readonly triangles: number;
  readonly bytes: number;
  /** How many of the bytes are geometry; the others (textures, animations, text) are nearly the same for each level. */
  readonly geometry: number;
  readonly output: Output;
}

/** Encodes may be slow: once something fits, so many are enough. */
const MOST_ENCODES = 3;

/** Until something fits it may take so many; then the smallest level is the answer. */
const MOST_MISSES = 8;

/** Good enough: this share of the bytes that may be used. */
const CLOSE = 0.98;

/** What is aimed at: a little below the limit, so that a small error of the estimate still fits. */
const AIM = 0.991;

/** With one level known the geometry's bytes go with this power of the triangles: fewer ones have more bytes each. */
const POWER = 0.93;

/** With two it is theirs between them, and halfway to that beyond them, if they are far enough apart to tell. */
const POWERS = { least: 0.4, most: 1.6, apart: 1.02 };

/**
 * Finds a level of at least `least` and at most `most` triangles whose output has at most `limit` bytes, as large as
 * possible. `encode(triangles)` writes the level of at most so many and says what it came to; `first` triangles are tried
 * first. If even the smallest level is too large, that is the result.
 *
 * The bytes that are no geometry are known after the first encode, and the others are taken to go with a power of the
 * triangles: from the second encode on through the two nearest ones. A level that does not fit is never the result if one does.
 */
export async function findSize<Output>(
  limit: number,
  { least, most, first }: { readonly least: number; readonly most: number; readonly first: number },
  encode: (triangles: number) => Promise<Encoded<Output>> | Encoded<Output>,
): Promise<Encoded<Output>> {
  let fits: Encoded<Output> | undefined;
  let tooLarge: Encoded<Output> | undefined;
  let last: Encoded<Output> | undefined;
  let wanted = Math.min(Math.max(first, least), most);
  for (let encodes = 1; ; encodes += 1) {
    const found = await encode(wanted);
    if (found.bytes > limit) {
      if (found.triangles <= least || wanted <= least) return fits ?? found;
      if (tooLarge === undefined || found.triangles < tooLarge.triangles) tooLarge = found;
    } else if (fits === undefined || found.bytes >= fits.bytes) fits = found;
    if (fits !== undefined && (fits.bytes >= CLOSE * limit || fits.triangles >= most || encodes >= MOST_ENCODES)) return fits;
    // Every miss makes it more careful.
    const aim = (fits === undefined ? AIM - 0.009 * (encodes - 1) : AIM) * limit;
    const other = fits === found ? (tooLarge ?? last) : (fits ?? last);
    const guess = Math.floor(estimate(found, other, aim));
    last = found;
    const below = (tooLarge?.triangles ?? most + 1) - 1;
    wanted = Math.max(Math.min(guess, below, most), least, (fits?.triangles ?? least - 1) + 1);
    // Two levels side by side: there is nothing between them.
    if (fits !== undefined && wanted > below) return fits;
    if (fits === undefined && encodes >= MOST_MISSES) wanted = least;
  }
}

/** The triangles whose output has `aim` bytes, by one level that is known, or by two. */
function estimate(near: Encoded<unknown>, far: Encoded<unknown> | undefined, aim: number): number {
  const wanted = aim - (near.bytes - near.geometry);
  if (wanted <= 0 || near.geometry <= 0) return 0;
  const apart = far === undefined ? 0 : Math.log(near.triangles / far.triangles);
  let power = POWER;
  if (far !== undefined && Math.abs(apart) > Math.log(POWERS.apart)) {
    const measured = Math.min(Math.max(Math.log(near.geometry / far.geometry) / apart, POWERS.least), POWERS.most);
    const isBetween = (near.bytes < aim) !== (far.bytes < aim);
    power = isBetween ? measured : (measured + POWER) / 2;
  }
  return near.triangles * (wanted / near.geometry) ** (1 / power);
}
