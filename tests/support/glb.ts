// GLB and glTF files assembled from their fields, so that a malformed one is a change of one of them.

/** What a GLB consists of; the header's and chunks' fields follow from the content unless they are given. */
export interface GlbFields {
  json: unknown;
  /** In place of `json`: the JSON chunk's text. */
  jsonText?: string;
  binary?: Uint8Array;
  magic?: string;
  version?: number;
  /** The header's length of the whole file. */
  length?: number;
  jsonLength?: number;
  binaryLength?: number;
}

const padded = (bytes: Uint8Array, filler: number): Uint8Array => {
  const result = new Uint8Array(Math.ceil(bytes.length / 4) * 4).fill(filler);
  result.set(bytes);
  return result;
};

/** The bytes of a GLB. */
export function glb({ json, jsonText, binary, magic = 'glTF', version = 2, length, jsonLength, binaryLength }: GlbFields): Uint8Array {
  const text = padded(new TextEncoder().encode(jsonText ?? JSON.stringify(json)), 0x20);
  const data = binary === undefined ? undefined : padded(binary, 0);
  const total = 20 + text.length + (data === undefined ? 0 : 8 + data.length);
  const bytes = new Uint8Array(total);
  const view = new DataView(bytes.buffer);
  bytes.set(new TextEncoder().encode(magic), 0);
  view.setUint32(4, version, true);
  view.setUint32(8, length ?? total, true);
  view.setUint32(12, jsonLength ?? text.length, true);
  bytes.set(new TextEncoder().encode('JSON'), 16);
  bytes.set(text, 20);
  if (data !== undefined) {
    view.setUint32(20 + text.length, binaryLength ?? data.length, true);
    bytes.set(new TextEncoder().encode('BIN\0'), 24 + text.length);
    bytes.set(data, 28 + text.length);
  }
  return bytes;
}

/** A mesh as arrays, as the package takes it. */
export interface ArrayMesh {
  positions: Float32Array;
  indices: Uint32Array;
  attributes: { normal?: Float32Array; uv?: Float32Array };
}

/** The glTF tree and binary of `mesh`, for a test to change before it becomes a file. */
export function gltfOf({ positions, indices, attributes }: ArrayMesh) {
  const arrays = [
    { name: 'indices', values: indices, type: 'SCALAR', components: 1 },
    { name: 'POSITION', values: positions, type: 'VEC3', components: 3 },
    ...(attributes.normal ? [{ name: 'NORMAL', values: attributes.normal, type: 'VEC3', components: 3 }] : []),
    ...(attributes.uv ? [{ name: 'TEXCOORD_0', values: attributes.uv, type: 'VEC2', components: 2 }] : []),
  ];
  let offset = 0;
  const bufferViews: Array<{ buffer: number; byteOffset: number; byteLength: number; target: number }> = [];
  const accessors: Array<{ bufferView: number; componentType: number; count: number; type: string; min?: number[]; max?: number[] }> = [];
  for (const [index, { name, values, type, components }] of arrays.entries()) {
    const target = name === 'indices' ? 34963 : 34962;
    bufferViews.push({ buffer: 0, byteOffset: offset, byteLength: values.byteLength, target });
    accessors.push({
      bufferView: index,
      componentType: name === 'indices' ? 5125 : 5126,
      count: values.length / components,
      type,
      ...(name === 'POSITION' ? bounds(positions) : {}),
    });
    offset += values.byteLength;
  }
  const binary = new Uint8Array(offset);
  for (const [index, { values }] of arrays.entries()) {
    const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    binary.set(bytes, bufferViews[index]?.byteOffset);
  }
  const named = arrays.map(({ name }, index) => [name, index] as const).filter(([name]) => name !== 'indices');
  const json = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: 'node' }],
    meshes: [{ name: 'mesh', primitives: [{ attributes: Object.fromEntries(named), indices: 0, mode: 4, material: 0 }] }],
    materials: [{ name: 'material' }],
    buffers: [{ byteLength: binary.length }] as Array<{ byteLength: number; uri?: string }>,
    bufferViews,
    accessors,
  };
  return { json, binary };
}

function bounds(positions: Float32Array): { min: number[]; max: number[] } {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  for (const [index, value] of positions.entries()) {
    min[index % 3] = Math.min(min[index % 3] as number, value);
    max[index % 3] = Math.max(max[index % 3] as number, value);
  }
  return { min, max };
}

/** The JSON of a GLB. */
export function glbTree(bytes: Uint8Array): Record<string, unknown> {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  return JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length))) as Record<string, unknown>;
}
