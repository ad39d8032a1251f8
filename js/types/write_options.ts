// How to write: format, encoding, size, chain of levels, and what to prepare.
import type { Compression, OutputFormat } from './document.js';
import type { LevelTargets } from './levels.js';

/** How to write. */
export interface WriteOptions {
  /**
   * Default: the format that was read, `'glb'` for glTF. `'gltf'` is text with files beside it, in `Written.files`. PLY and
   * STL are written in binary. What the format cannot hold is left out, with one warning in the report.
   */
  readonly format?: OutputFormat | undefined;
  /**
   * What the names of the files beside a `'gltf'` begin with; letters that a file name may have. Default `'model'`.
   */
  readonly name?: string | undefined;
  /**
   * How to store the geometry of a GLB or glTF. `'meshopt'` loses nothing, and puts triangles and vertices in the order of the
   * caches; `'draco'` is smaller, slower to read, and rounds positions to 1/16383 of the mesh's extent. Default: as the
   * input had it (`summary.compression`); `'none'` for other formats, which have nothing else.
   */
  readonly compress?: Compression | undefined;
  /**
   * Stores attributes of a GLB or glTF as integers (`KHR_mesh_quantization`): positions on a grid of 14 bits of the mesh's
   * extent, normals of 10, texture coordinates of 14. Draco does so by itself. Default false; what the input had as
   * integers stays that.
   */
  readonly quantize?: boolean | undefined;
  /** Preparation of a GLB or glTF beside its geometry. Default: none. */
  readonly prepare?: PrepareOptions | undefined;
  /**
   * The largest the output may be, bytes > 0: selects and writes the largest recorded level that fits, or the smallest
   * there is, with the stop reason it has. Encodes at most four times. Needs a simplification whose levels all count.
   */
  readonly size?: number | undefined;
  /**
   * A chain of 2 to 32 recorded levels in one GLB, by MSFT_lod, the finest first. A number is a `ratio`. Vertices
   * that a level has in common with the first, as all are where `placement` is `'subset'`, are stored once.
   */
  readonly lods?: ReadonlyArray<number | LevelTargets> | undefined;
  /** When a chain is to switch. */
  readonly lodSwitch?: LodSwitch | undefined;
}

/** What textures are to become. */
export interface TextureOptions {
  /** The longer side at most, pixels, an integer ≥ 1; the other side follows. Default: as it is. */
  readonly maxSize?: number | undefined;
  /** Default: what each image was. `'webp'` needs `EXT_texture_webp` of a reader, and is named in the file as required. */
  readonly format?: 'webp' | 'jpeg' | 'png' | undefined;
  /** Of lossy formats, 0 to 1: 0 small and coarse, 1 large and nearly exact. Default 0.8; normal maps have at least 0.95. */
  readonly quality?: number | undefined;
}

/**
 * What else to do for a smaller GLB or glTF. The tree is edited and not built anew: names, extras and unknown extensions
 * stay. The report's `parts` say what it gave.
 */
export interface PrepareOptions {
  /**
   * Equal accessors, images, textures and materials (of the same name) become one, buffers with the same bytes too.
   * Default false.
   */
  readonly dedup?: boolean | undefined;
  /**
   * What no scene and no animation needs is removed, and the rest numbered anew. With extensions that are not known,
   * which may refer to anything, nothing is removed, with the warning `not-pruned`. Default false.
   */
  readonly prune?: boolean | undefined;
  /** Keys of animations that interpolation between the others gives too are left out. Default false. */
  readonly resample?: boolean | undefined;
  /** Scales and encodes textures that become smaller by it. On Node this needs the package `sharp`. Default: none. */
  readonly textures?: TextureOptions | undefined;
}

/** When a level takes over from the finer one: where its error appears as small as this. */
export interface LodSwitch {
  /** Pixels that the estimated error may take, > 0. Default 1. */
  readonly pixels?: number | undefined;
  /** Height of the picture in pixels, > 0. Default 1080. */
  readonly viewportHeight?: number | undefined;
  /** Width of the picture by its height, > 0. Default 16/9. */
  readonly aspectRatio?: number | undefined;
}
