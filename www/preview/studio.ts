// Image-based light of a small studio, computed by formula: a bright room with soft boxes, at every roughness.
//
// A map that is drawn and filtered by the graphics card costs seconds without one, and a second on a telephone, before
// the first picture. Lobes that are Gaussian on the sphere need no filtering: a blurred one is a wider one.
import { CubeTexture, DataTexture, DataUtils, HalfFloatType, LightProbe, LinearFilter, LinearMipmapLinearFilter, RGBAFormat, SphericalHarmonics3, Vector3 } from 'three';
import type { Texture } from 'three';

/** Side of a face at the sharpest level, in pixels; halved at each of the next. */
const SIZE = 64;
/** Levels that are used, from a mirror to the roughest. */
const LEVELS = 4;

/** Directions in which the light is looked at for the probe. */
const PROBE_SAMPLES = 4096;

/** A soft box: where it is seen from the model, its light (radiance times solid angle) and how narrow it is. */
interface Box {
  readonly towards: readonly [x: number, y: number, z: number];
  readonly light: number;
  readonly sharpness: number;
}

const BOXES: readonly Box[] = [
  { towards: [0, 0.35, 0.94], light: 3.9, sharpness: 40 },
  { towards: [0.86, 0.5, -0.1], light: 1.3, sharpness: 34 },
  { towards: [-0.76, 0.52, 0.39], light: 0.6, sharpness: 60 },
  { towards: [-0.7, 0.63, -0.35], light: 0.45, sharpness: 60 },
  { towards: [0.2, 0.52, -0.83], light: 0.4, sharpness: 60 },
  { towards: [0, 1, 0], light: 0.4, sharpness: 50 },
];

/** Radiance of the walls at the height of the model, and what it gains towards the top and loses towards the floor. */
const WALLS = 0.82;
const SLOPE = 0.3;

/** Sharpness of light that falls on a matt surface: that of the cosine. */
const MATT = 2.1;

/** The studio as an environment for three's physical materials. */
export function studioLight(): Texture {
  // three counts the levels of such a map by its mipmaps without the first, and that less one: one more is never read.
  const levels = Array.from({ length: LEVELS + 1 }, (_, level) => {
    // Which roughness three looks up at which level.
    const roughness = 1 - Math.sqrt(1 - Math.min(level / (LEVELS - 1), 1));
    return Array.from({ length: 6 }, (__, face) => drawFace(face, SIZE >> level, roughness));
  });
  const texture = new CubeTexture(levels[0] ?? []);
  texture.mipmaps = levels.slice(1).map((image) => ({ image })) as unknown as CubeTexture['mipmaps'];
  texture.type = HalfFloatType;
  texture.format = RGBAFormat;
  texture.generateMipmaps = false;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.isPMREMTexture = true;
  texture.needsUpdate = true;
  return texture;
}

/**
 * The same light for surfaces that are matt, by nine numbers: without a graphics card a picture with it takes a third
 * of the time. Nothing is mirrored in it.
 */
export function studioProbe(): LightProbe {
  const harmonics = new SphericalHarmonics3();
  const radiance = radianceAt(0);
  const direction = new Vector3();
  const basis: number[] = Array.from({ length: 9 }, () => 0);
  for (let sample = 0; sample < PROBE_SAMPLES; sample += 1) {
    // Evenly spread over the sphere on a spiral of the golden angle.
    const y = 1 - (2 * sample + 1) / PROBE_SAMPLES;
    const around = sample * Math.PI * (3 - Math.sqrt(5));
    direction.set(Math.cos(around) * Math.sqrt(1 - y * y), y, Math.sin(around) * Math.sqrt(1 - y * y));
    SphericalHarmonics3.getBasisAt(direction, basis);
    const weight = (radiance(direction.x, direction.y, direction.z) * 4 * Math.PI) / PROBE_SAMPLES;
    harmonics.coefficients.forEach((coefficient, index) => coefficient.addScalar(weight * (basis[index] ?? 0)));
  }
  return new LightProbe(harmonics);
}

function drawFace(face: number, size: number, roughness: number): DataTexture {
  const pixels = new Uint16Array(size * size * 4);
  const one = DataUtils.toHalfFloat(1);
  const radiance = radianceAt(roughness);
  for (let row = 0; row < size; row += 1) {
    for (let column = 0; column < size; column += 1) {
      const [x, y, z] = directionOf(face, (2 * column + 1) / size - 1, (2 * row + 1) / size - 1);
      const length = Math.hypot(x, y, z);
      // three looks such maps up from their other side.
      const value = DataUtils.toHalfFloat(radiance(-x / length, y / length, z / length));
      pixels.set([value, value, value, one], 4 * (row * size + column));
    }
  }
  const texture = new DataTexture(pixels, size, size, RGBAFormat, HalfFloatType);
  return texture;
}

/** The direction of a pixel of a cube's face, in the order and orientation of OpenGL. */
function directionOf(face: number, s: number, t: number): [number, number, number] {
  switch (face) {
    case 0:
      return [1, -t, -s];
    case 1:
      return [-1, -t, s];
    case 2:
      return [s, 1, t];
    case 3:
      return [s, -1, -t];
    case 4:
      return [s, -t, 1];
    default:
      return [-s, -t, -1];
  }
}

/** What a surface of `roughness` reflects from a direction. */
function radianceAt(roughness: number): (x: number, y: number, z: number) => number {
  // GGX as a Gaussian on the sphere (Wang et al. 2009, "All-Frequency Rendering of Dynamic, Spatially-Varying
  // Reflectance"), of the reflected direction seen along the normal; a mirror leaves everything as it is.
  const alpha = roughness * roughness;
  const filter = alpha === 0 ? Infinity : Math.max(1 / (2 * alpha * alpha), MATT);
  // The linear part of a function on the sphere loses what the mean of the filter's directions is short of 1.
  const slope = filter === Infinity ? SLOPE : SLOPE * (1 / Math.tanh(filter) - 1 / filter);
  const boxes = BOXES.map(({ towards, light, sharpness }) => {
    const narrow = filter === Infinity ? sharpness : (sharpness * filter) / (sharpness + filter);
    const length = Math.hypot(...towards);
    return {
      x: towards[0] / length,
      y: towards[1] / length,
      z: towards[2] / length,
      sharpness: narrow,
      // The same light in a wider lobe.
      peak: (light * narrow) / (2 * Math.PI * (1 - Math.exp(-2 * narrow))),
    };
  });
  return (x, y, z) =>
    boxes.reduce((sum, box) => sum + box.peak * Math.exp(box.sharpness * (x * box.x + y * box.y + z * box.z - 1)), WALLS + slope * y);
}
