// Buffer views packed by EXT_meshopt_compression, without filters: what is decoded is what was there, bit for bit.

import type { GltfData, PackedView } from './gltf_data.js';
import { meshoptEncoder } from './modules.js';
import { reorder } from './reorder.js';
import { objectOr, objects, requireExtension, uint, type Tree } from './tree.js';

const EXTENSION = 'EXT_meshopt_compression';

/** Below this a description of the packed view is longer than what it saves, bytes. */
const SMALLEST_VIEW = 64;

/** The GLB with ordered triangles and with every view packed that becomes smaller. */
export async function encodeMeshopt(data: GltfData): Promise<Uint8Array<ArrayBuffer>> {
  await reorder(data);
  const encoder = await meshoptEncoder();
  const users = accessorsByView(data);
  const triangleLists = new Set(data.triangles().map(({ indices }) => indices));
  const indices = new Set(objects(data.tree, 'meshes').flatMap((mesh) => objects(mesh, 'primitives').map((json) => uint(json['indices']) ?? -1)));
  const packed = new Map<number, PackedView>();
  for (const [view, accessors] of users) {
    const isIndices = accessors.every((accessor) => indices.has(accessor));
    const form = isIndices ? indexForm(data, view, accessors, triangleLists) : rowForm(data, view, accessors);
    if (form === undefined) continue;
    const bytes = data.views[view] as Uint8Array;
    // Version 0 of the codecs, which is what the EXT extension has.
    const encoded = encoder.encodeGltfBuffer(bytes, form.count, form.stride, form.mode, 0);
    if (encoded.length < bytes.length) packed.set(view, { bytes: encoded, ...form });
  }
  if (packed.size === 0) return data.build();
  requireExtension(data.tree, EXTENSION);
  return data.build(packed, EXTENSION);
}

/** The accessors in each view that only accessors use. */
function accessorsByView(data: GltfData): Map<number, number[]> {
  const users = new Map<number, number[]>();
  const barred = new Set(objects(data.tree, 'images').map((image) => uint(image['bufferView'])));
  const visit = (json: Tree, accessor: number): void => {
    const view = uint(json['bufferView']);
    if (view !== undefined) users.set(view, [...(users.get(view) ?? []), accessor]);
  };
  for (const [index, accessor] of objects(data.tree, 'accessors').entries()) {
    visit(accessor, index);
    for (const key of ['indices', 'values']) {
      const view = uint(objectOr(objectOr(accessor['sparse'])[key])['bufferView']);
      if (view !== undefined) barred.add(view);
    }
  }
  for (const view of users.keys()) {
    const tooSmall = (data.views[view]?.length ?? 0) < SMALLEST_VIEW;
    if (tooSmall || barred.has(view) || data.view(view)['extensions'] !== undefined) users.delete(view);
  }
  return users;
}

/** A view of indices, put together without the gaps that glTF does not need either. */
function indexForm(data: GltfData, view: number, accessors: readonly number[], triangleLists: ReadonlySet<number>): Omit<PackedView, 'bytes'> | undefined {
  const layouts = accessors.map((accessor) => ({ accessor, layout: data.layout(accessor) }));
  const stride = layouts[0]?.layout?.size;
  if (stride !== 2 && stride !== 4) return undefined;
  const pieces: Array<{ accessor: number; bytes: Uint8Array }> = [];
  for (const { accessor, layout } of layouts) {
    if (layout?.size !== stride || layout.components !== 1 || layout.stride !== stride) return undefined;
    const start = layout.offset;
    pieces.push({ accessor, bytes: (data.views[view] as Uint8Array).subarray(start, start + stride * layout.count) });
  }
  const joined = new Uint8Array(pieces.reduce((sum, { bytes }) => sum + bytes.length, 0));
  let offset = 0;
  for (const { accessor, bytes } of pieces) {
    joined.set(bytes, offset);
    const json = data.accessor(accessor);
    if (offset > 0) json['byteOffset'] = offset;
    else delete json['byteOffset'];
    offset += bytes.length;
  }
  data.views[view] = joined;
  const mode = accessors.every((accessor) => triangleLists.has(accessor)) ? 'TRIANGLES' : 'INDICES';
  return { stride, count: joined.length / stride, mode };
}

/** A view of rows of one length: vertices, or the keys of animations. */
function rowForm(data: GltfData, view: number, accessors: readonly number[]): Omit<PackedView, 'bytes'> | undefined {
  const bytes = data.views[view] as Uint8Array;
  const stated = uint(data.view(view)['byteStride']);
  const sizes = accessors.map((accessor) => data.layout(accessor)?.size);
  const stride = stated ?? sizes[0];
  if (stride === undefined || stride % 4 !== 0 || stride === 0 || stride > 256 || bytes.length % stride !== 0) return undefined;
  if (stated === undefined && !sizes.every((size) => size === stride)) return undefined;
  return { stride, count: bytes.length / stride, mode: 'ATTRIBUTES' };
}
