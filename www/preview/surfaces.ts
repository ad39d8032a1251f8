// Materials that show one thing about a surface in place of the file's own: form, texture coordinates, directions.
import { DataTexture, LinearFilter, LinearMipmapLinearFilter, MeshNormalMaterial, MeshStandardMaterial, RepeatWrapping, SRGBColorSpace } from 'three';
import type { BufferGeometry, Material, Side } from 'three';
import { CLAY } from './load.ts';
import { heatMaterial } from './heat-material.ts';
import type { HeatScale } from './heat-material.ts';
import type { Surface } from './protocol.ts';

/** Squares along each side of the texture's unit square. */
const SQUARES = 16;
const SQUARE_PIXELS = 16;

/** Makes each material once and lends it out; all of them are freed by {@link dispose}. */
export class Surfaces {
  private readonly materials = new Map<string, Material>();
  private checker: DataTexture | null = null;
  /** The distance that has the last colour of the heat map, in model units. */
  readonly heatScale: HeatScale = { value: 0 };

  /** What to draw `geometry` with instead of `own`, its file's material. */
  materialFor(surface: Surface, own: Material, geometry: BufferGeometry): Material {
    if (surface === 'textured') return own;
    // Without normals the triangles are drawn flat, as the format says of them.
    const flat = geometry.getAttribute('normal') === undefined;
    const textured = surface === 'checker' && geometry.getAttribute('uv') !== undefined;
    // What has not been measured has no colours to show.
    const measured = surface === 'deviation' && geometry.getAttribute('deviation') !== undefined;
    const key = `${surface} ${flat} ${textured} ${measured} ${own.side}`;
    let material = this.materials.get(key);
    if (material === undefined) {
      material = measured ? heatMaterial(this.heatScale, flat, own.side) : this.make(surface, flat, textured, own.side);
      makeRoomForLines(material);
      this.materials.set(key, material);
    }
    return material;
  }

  dispose(): void {
    for (const material of this.materials.values()) material.dispose();
    this.materials.clear();
    this.checker?.dispose();
    this.checker = null;
  }

  private make(surface: Surface, flatShading: boolean, textured: boolean, side: Side): Material {
    if (surface === 'normals') {
      const material = new MeshNormalMaterial({ flatShading, side });
      material.toneMapped = false;
      return material;
    }
    const material = new MeshStandardMaterial({ flatShading, side, roughness: 0.62, metalness: 0 });
    if (textured) material.map = this.checker ??= checkerTexture();
    else material.color.copy(CLAY);
    return material;
  }
}

/** Room in depth for the lines in front of the surface. */
export function makeRoomForLines(material: Material): void {
  material.polygonOffset = true;
  material.polygonOffsetFactor = 1;
  material.polygonOffsetUnits = 1;
}

/** Light and dark squares whose colour goes around with u and whose lightness goes up with v: stretch, flip and place show. */
function checkerTexture(): DataTexture {
  const size = SQUARES * SQUARE_PIXELS;
  const pixels = new Uint8Array(size * size * 4);
  for (let y = 0; y < size; y += 1) {
    for (let x = 0; x < size; x += 1) {
      const column = Math.floor(x / SQUARE_PIXELS);
      const row = Math.floor(y / SQUARE_PIXELS);
      const light = (column + row) % 2 === 0;
      const level = (light ? 0.74 : 0.34) + (0.2 * row) / SQUARES;
      const hue = column / SQUARES;
      for (let channel = 0; channel < 3; channel += 1) {
        const wave = Math.cos(2 * Math.PI * (hue - channel / 3));
        pixels[4 * (y * size + x) + channel] = 255 * Math.min(level + 0.16 * wave, 1);
      }
      pixels[4 * (y * size + x) + 3] = 255;
    }
  }
  const texture = new DataTexture(pixels, size, size);
  texture.colorSpace = SRGBColorSpace;
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return texture;
}
