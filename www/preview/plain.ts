// A GLB that the view can read as it came: plain triangles, nothing compressed, nothing outside the file. What the
// engine would write of it at full detail is the same model, and need not be waited for.

/** A primitive as the file describes it. */
export interface PlainPart {
  /** Numbers of the glTF mesh and of the primitive in it. */
  readonly mesh: number;
  readonly primitive: number;
  readonly vertices: number;
  readonly triangles: number;
}

/** Extensions that say nothing about where geometry or images are to be found. */
const HARMLESS = /^(KHR_materials_\w+|KHR_texture_transform|KHR_lights_punctual|EXT_texture_webp)$/;

const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const HEADER = 20;
const TRIANGLES = 4;

interface Gltf {
  readonly extensionsUsed?: readonly string[];
  readonly extensionsRequired?: readonly string[];
  readonly buffers?: ReadonlyArray<{ readonly uri?: string }>;
  readonly images?: ReadonlyArray<{ readonly uri?: string }>;
  readonly accessors?: ReadonlyArray<{ readonly count: number; readonly bufferView?: number; readonly sparse?: unknown }>;
  readonly meshes?: ReadonlyArray<{
    readonly primitives: ReadonlyArray<{ readonly mode?: number; readonly indices?: number; readonly attributes: Readonly<Record<string, number>> }>;
  }>;
}

/** The content of `file` and its primitives; rejects where it is not plain, and may do so with any error. */
export async function readPlainGlb(file: Blob): Promise<{ bytes: Uint8Array<ArrayBuffer>; parts: PlainPart[] }> {
  // What is no GLB is not read to its end.
  const head = new DataView(await file.slice(0, HEADER).arrayBuffer());
  const starts = head.byteLength === HEADER && head.getUint32(0, true) === MAGIC && head.getUint32(4, true) === 2 && head.getUint32(16, true) === JSON_CHUNK;
  if (!starts) throw new Error('not a GLB');
  const bytes = new Uint8Array(await file.arrayBuffer());
  const text = bytes.subarray(HEADER, HEADER + head.getUint32(12, true));
  const parts = plainParts(JSON.parse(new TextDecoder().decode(text)) as Gltf);
  if (parts === null) throw new Error('not plain');
  return { bytes, parts };
}

/** The primitives of `gltf`, null where it is not plain; may throw where it is not even glTF. */
export function plainParts(gltf: Gltf): PlainPart[] | null {
  const { extensionsUsed = [], extensionsRequired = [], buffers = [], images = [], accessors = [], meshes = [] } = gltf;
  if (![...extensionsUsed, ...extensionsRequired].every((name) => HARMLESS.test(name))) return null;
  if ([...buffers, ...images].some(({ uri }) => uri !== undefined)) return null;
  // Without bytes of its own an accessor may claim any length.
  if (accessors.some(({ bufferView, sparse }) => bufferView === undefined || sparse !== undefined)) return null;
  if (meshes.some(({ primitives }) => primitives.some(({ mode = TRIANGLES }) => mode !== TRIANGLES))) return null;
  return meshes.flatMap(({ primitives }, mesh) =>
    primitives.map(({ indices, attributes }, primitive) => {
      const vertices = accessors[attributes['POSITION'] ?? -1]?.count ?? 0;
      const corners = indices === undefined ? vertices : (accessors[indices]?.count ?? 0);
      return { mesh, primitive, vertices, triangles: Math.floor(corners / 3) };
    }),
  );
}
