// The shapes that callers pass in and get back, shared by the document, its worker and the command line.

/** A file format by its usual extension. */
export type Format = 'glb' | 'gltf' | 'obj' | 'ply' | 'stl' | 'off' | 'smf';

/** How the geometry of a glTF is stored: plainly, by `EXT_meshopt_compression` (or its KHR successor), or by Draco. */
export type Compression = 'none' | 'meshopt' | 'draco';

/** A format that can be written: all that can be read. */
export type OutputFormat = Format;

/**
 * Why there are not fewer triangles: the count was reached, the next step would exceed the error, nothing more can be
 * removed without damage, or the time budget was spent.
 */
export type StopReason = 'target' | 'error' | 'constraints' | 'time';

/**
 * Time against quality. `'fast'` collapses edges and no more; `'balanced'` then fits the remaining vertices to the
 * original surface, one round where it pays; `'best'` takes finer sweeps and three rounds of fitting.
 */
export type Preset = 'fast' | 'balanced' | 'best';

/** Something a reader or writer had to change or leave out, without failing. */
export interface Warning {
  /** Stable name, kebab-case. */
  readonly code: string;
  /** One line for people. */
  readonly message: string;
  /** The place in the file; may be empty. */
  readonly where: string;
}

/** A file in memory. */
export interface NamedBytes {
  /** As a referring file names it, relative and with `/`: `textures/a.png`. Its last part is enough. */
  readonly name: string;
  readonly bytes: Uint8Array | ArrayBuffer;
}

/** A model: the bytes of one file, or the files it consists of, in any order. */
export type DocumentInput =
  | ArrayBuffer
  | Uint8Array
  | File
  | NamedBytes
  | ReadonlyArray<File | NamedBytes>;

/** Triangles that share a material: a glTF primitive, a material or object of an OBJ file, a solid of an STL file. */
export interface GroupSummary {
  /** Index of the glTF mesh; 0 for other formats. */
  readonly mesh: number;
  /** Index of the primitive in its mesh; the group's index for other formats. */
  readonly primitive: number;
  /** Name of the mesh or object. */
  readonly object: string | null;
  /** Name of the material. */
  readonly material: string | null;
  /** Index in `wedgeSets` of the vertices it uses. */
  readonly wedgeSet: number;
}

/** Vertices with the attributes they have. */
export interface WedgeSetSummary {
  readonly vertices: number;
  readonly attributes: ReadonlyArray<{ readonly name: string; readonly components: number }>;
}

/** What a document holds. */
export interface DocumentSummary {
  readonly format: Format;
  /** All bytes that were given. */
  readonly bytes: number;
  /** How the file stored its geometry; other formats than glTF have `'none'`. */
  readonly compression: Compression;
  readonly triangles: number;
  /** Vertices as the file stores them: one on a texture seam counts once for each side. */
  readonly vertices: number;
  readonly meshes: number;
  /** Length of the bounding box's diagonal in model units: the measure of relative errors. */
  readonly diagonal: number;
  readonly groups: readonly GroupSummary[];
  readonly wedgeSets: readonly WedgeSetSummary[];
  readonly warnings: readonly Warning[];
}

/**
 * How many of the edges that are left when a run ends are blocked by what. Each edge counts once, for the first reason
 * in the order of the sweep: what its ends lie on, the error, the topology, the flip test.
 */
export interface Blockers {
  /** Between vertices on seams of texture coordinates, colours, skins or materials, but not along one seam. */
  readonly seam: number;
  /** At a vertex where seams meet, end or reach a border. */
  readonly corner: number;
  /** Between vertices on open borders, but not along the border. */
  readonly border: number;
  /** Where more than two faces meet in an edge, or several sheets in a point. */
  readonly nonManifold: number;
  /** At a vertex that may not move. */
  readonly locked: number;
  /** The surface would hang together in another way, or a part of it would vanish. */
  readonly topology: number;
  /** A triangle would turn over or become degenerate. */
  readonly flip: number;
  /** The estimated error would exceed the limit. */
  readonly error: number;
  /** Nothing stands against the edge by itself. */
  readonly other: number;
}

/** A selected level of detail. */
export interface LevelSummary {
  readonly triangles: number;
  readonly vertices: number;
  /** Estimated deviation from the original in model units; 0 at full detail. Not measured. */
  readonly estimatedError: number;
  readonly stopReason: StopReason;
  /** What blocks the edges that are left, at the last level of a run that ended for `'error'` or `'constraints'`. */
  readonly blockers: Blockers | null;
}

/** Where to stop; of several targets, the first that is reached. */
export interface Targets {
  /** Keep this share of the triangles, 0 to 1. 1 keeps all, 0 goes as far as the shape allows. */
  readonly ratio?: number | undefined;
  /** Keep at most this many triangles, an integer ≥ 0. */
  readonly triangles?: number | undefined;
  /**
   * Largest estimated deviation: a number ≥ 0 in model units, or `'0.1%'` of the bounding box's diagonal. 0 removes
   * only what changes nothing.
   */
  readonly error?: number | `${number}%` | undefined;
}

/** From where a model is looked at, to turn an error into pixels. */
export interface ScreenView {
  /** From the eye to the model's centre, model units, > 0. Default: where the model's bounding sphere just fits. */
  readonly distance?: number | undefined;
  /** Vertical angle of view in degrees, above 0 and below 180. Default 45. */
  readonly fieldOfView?: number | undefined;
  /** Height of the picture in pixels, > 0. Default 1080. */
  readonly viewportHeight?: number | undefined;
}

/** Which of the recorded levels; of several targets, the first that is reached. */
export interface LevelTargets extends Targets {
  /**
   * Largest estimated deviation as it appears on the screen, in pixels ≥ 0, when the model is looked at as `view` says:
   * an error of e model units takes e · viewportHeight / (2 · distance · tan(fieldOfView / 2)) pixels.
   */
  readonly pixels?: number | undefined;
  /** What `pixels` refers to; without them it has no effect. */
  readonly view?: ScreenView | undefined;
}

/**
 * What attributes weigh in the cost of a collapse beside positions, each as a multiple (a number ≥ 0) of a weight that
 * is found for the model. 0: nothing is done to keep it; its values follow the vertices all the same. Default 1 for each.
 */
export interface AttributeWeights {
  /** Normals, and with them the shading. */
  readonly normal?: number | undefined;
  /** Texture coordinates, by the length on the surface that a texture would be displaced. */
  readonly uv?: number | undefined;
  /** Vertex colours. */
  readonly color?: number | undefined;
  /** Displacements of the first eight morph targets, and of skins over the animations of a file. */
  readonly morph?: number | undefined;
}

/** How to simplify. */
export interface SimplifyOptions extends Targets {
  /** Open borders do not move. Default false. */
  readonly lockBorder?: boolean | undefined;
  /** Parts that are down to one triangle or tetrahedron may vanish, cheapest first; one always stays. Default false. */
  readonly prune?: boolean | undefined;
  /** What attributes weigh; by default what looks best. */
  readonly attributeWeights?: AttributeWeights | undefined;
  /** `'optimal'` (default) puts vertices where the error is least; `'subset'` uses only original positions. */
  readonly placement?: 'optimal' | 'subset' | undefined;
  /** Default `'balanced'`. It matters for a run to one level; one whose every level is wanted is the same with each. */
  readonly preset?: Preset | undefined;
  /**
   * Milliseconds that the simplification may take, a number ≥ 0; no target, but a limit on the way to one. When they
   * are spent, what was done so far is the result and its stop reason is `'time'`. Looked at about every 10 ms, and not
   * while a large mesh is made ready; the same budget gives another result on another machine. Default: no limit.
   */
  readonly timeBudget?: number | undefined;
  /**
   * Vertices of separate parts of a mesh that are nearer than this may merge although no edge joins them: a number ≥ 0
   * in model units, or `'0.1%'` of the bounding box's diagonal. 0 (default) keeps separate what is. Where parts have
   * merged, more than two faces may meet in an edge.
   */
  readonly mergeDistance?: number | `${number}%` | undefined;
  /**
   * Most bytes the engine may take for the run beside the mesh, a number ≥ 0. What the run will take is estimated before
   * it starts, from above; more is the error `too-large`, which names both figures. Default: what WebAssembly can have.
   */
  readonly memoryLimit?: number | undefined;
}

/** How to simplify bare arrays. */
export interface MeshSimplifyOptions extends SimplifyOptions {
  /**
   * How dear collapses are at each vertex: a finite number ≥ 0 multiplies their cost by 1 + weight, so that they come
   * later. 0 is neutral, 10 protects, 1e6 is the most there is and gives way only when nothing else is left. Positions
   * and the estimated error are not weighted. What changes nothing, as in a flat place, goes all the same.
   */
  readonly weights?: Float32Array | undefined;
  /** For each vertex whether it stays: where it is not 0 the vertex neither moves nor vanishes. */
  readonly locked?: Uint8Array | undefined;
}

/** How to simplify a document, whose levels can be asked for afterwards. */
export interface DocumentSimplifyOptions extends SimplifyOptions {
  /**
   * The largest distance of either surface from the other that may be measured: a number > 0 in model units, or `'0.1%'` of
   * the bounding box's diagonal. Records every level, and selects the coarsest level found whose maximum, measured both ways
   * as {@link Document.measure} does, is below it by 1 %, for what another look may find.
   * Collapses that would lead beyond it are refused, and others go on, unless there is a `timeBudget` or a `weightAttribute`:
   * then the level is one of the record. Takes up to twenty runs and measurements. Beside other targets, the first that is
   * reached counts. Default: nothing is measured.
   */
  readonly maximumDeviation?: number | `${number}%` | undefined;
  /**
   * Levels beside the target are wanted too. Each is then as good as a sweep to that level alone, but the final fit of
   * the presets, which improves the target's level only, is left out. Default: true when no target is given.
   */
  readonly everyLevel?: boolean | undefined;
  /**
   * The levels recorded by an earlier run stay at hand for `level()`; this run gives the selected level alone. Without
   * an earlier run it has no effect. Default false.
   */
  readonly keepLevels?: boolean | undefined;
  /**
   * The vertex attribute that has the weights of {@link MeshSimplifyOptions}, by the file's name for it, with a component
   * or else the first: `'_WEIGHT'`, `'COLOR_0.g'`. Vertices without it weigh 0. Default: nothing is weighted.
   */
  readonly weightAttribute?: string | undefined;
  /**
   * As {@link MeshSimplifyOptions}' `weights`, one number for each of the document's vertices: those of its wedge sets
   * in order. Instead of `weightAttribute`.
   */
  readonly weights?: Float32Array | undefined;
  /** For each of the document's vertices, in the same order, whether it stays: where it is not 0 it neither moves nor vanishes. */
  readonly locked?: Uint8Array | undefined;
  /** Multiplies the weights of `weightAttribute`, a number ≥ 0: colours go from 0 to 1. Default 1. */
  readonly weightScale?: number | undefined;
}

/** What may accompany a run that takes time. */
export interface RunOptions {
  /** Called at most about 20 times a second with the share of the work that is done; last, and only once, with 1. */
  readonly onProgress?: ((fraction: number) => void) | undefined;
  /** Aborting rejects with the signal's reason and leaves everything as it was before the call. */
  readonly signal?: AbortSignal | undefined;
}

/** How to measure. */
export interface MeasureOptions {
  /**
   * Samples on the faces of either side, an integer from 1 to 1e9; vertices and edges come on top. Default 400,000,
   * with which mean and rms are exact to a small part of a per cent. The maximum is climbed to from the farthest samples; very
   * few may miss the spot.
   */
  readonly samples?: number | undefined;
}

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

/** The vertices of a level that some groups share. */
export interface WedgeSetGeometry {
  /** x, y, z for each vertex, in the mesh's local space. */
  readonly positions: Float32Array;
  /** By name; `components` numbers for each vertex. */
  readonly attributes: Readonly<Record<string, { readonly components: number; readonly values: Float32Array }>>;
}

/** The triangles of a level in one group. */
export interface GroupGeometry {
  readonly mesh: number;
  readonly primitive: number;
  /** Three for each triangle, into the wedge set's vertices. */
  readonly indices: Uint32Array;
  readonly wedgeSet: number;
}

/** A level as arrays, ready for a renderer. The arrays are the caller's own. */
export interface LevelGeometry {
  readonly groups: readonly GroupGeometry[];
  readonly wedgeSets: readonly WedgeSetGeometry[];
}

/** Arrays of numbers that attributes may come in. */
export type AttributeArray =
  | Float32Array
  | Float64Array
  | Int8Array
  | Uint8Array
  | Uint8ClampedArray
  | Int16Array
  | Uint16Array
  | Int32Array
  | Uint32Array;

/**
 * Vertex attributes by name, each an array of the same number of values for every vertex.
 *
 * Known names: `normal` (3, unit length), `uv` (2), `color` (3 or 4), `tangent` (4, the last ±1), `joints` (4) with
 * `weights` (4). `uv1`, `color2`… are further sets of the same kind. Other names may have 1 to 16 components; where
 * vertices merge, theirs are interpolated in float arrays and taken from the nearer vertex in integer arrays.
 */
export interface MeshAttributes {
  readonly normal?: AttributeArray;
  readonly uv?: AttributeArray;
  readonly color?: AttributeArray;
  readonly tangent?: AttributeArray;
  readonly joints?: AttributeArray;
  readonly weights?: AttributeArray;
  readonly [name: string]: AttributeArray | undefined;
}

/** A triangle mesh as arrays. */
export interface MeshInput {
  /** x, y, z for each vertex; finite. */
  readonly positions: Float32Array;
  /** Three for each triangle; absent: every three vertices are a triangle. */
  readonly indices?: Uint32Array | Uint16Array | undefined;
  readonly attributes?: MeshAttributes | undefined;
}

/** A simplified mesh. The arrays are the caller's own. */
export interface SimplifiedMesh {
  readonly positions: Float32Array;
  readonly indices: Uint32Array;
  /** The attributes that were given, in arrays of the type they came in. */
  readonly attributes: Readonly<Record<string, AttributeArray>>;
  /** Estimated deviation from the original in the units of the positions. Not measured. */
  readonly estimatedError: number;
  readonly stopReason: StopReason;
  /** As in {@link LevelSummary}. */
  readonly blockers: Blockers | null;
  /** For each vertex, the vertex of the input that it came from. */
  readonly vertexMap: Uint32Array;
}
