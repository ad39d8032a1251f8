// What a file is: its format, how it is given, what it holds.

/** A file format by its usual extension. */
export type Format = 'glb' | 'gltf' | 'obj' | 'ply' | 'stl' | 'off' | 'smf';

/** How the geometry of a glTF is stored: plainly, by `EXT_meshopt_compression` (or its KHR successor), or by Draco. */
export type Compression = 'none' | 'meshopt' | 'draco';

/** A format that can be written: all that can be read. */
export type OutputFormat = Format;

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
