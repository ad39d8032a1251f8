// Files that must be refused: each a small valid model with one thing wrong.
import type { ErrorCode } from 'decimesh';
import { glb, gltfOf, type GlbFields } from './glb.ts';
import { hills } from './meshes.ts';

export interface InvalidFile {
  readonly name: string;
  readonly bytes: Uint8Array;
  readonly code: ErrorCode;
  /** What the place has to name. */
  readonly place: RegExp;
}

type Parts = ReturnType<typeof gltfOf>;

const encode = (text: string): Uint8Array => new TextEncoder().encode(text);

/** A GLB after `change` to its tree or binary, with `fields` of the container in place of the right ones. */
function changed(change: (parts: Parts) => void, fields: Partial<GlbFields> = {}): Uint8Array {
  const parts = gltfOf(hills(3));
  change(parts);
  return glb({ ...parts, ...fields });
}

const floats = ({ binary }: Parts): Float32Array => new Float32Array(binary.buffer);

/** A .gltf whose only buffer has this address. */
function gltf(uri: string): Uint8Array {
  const { json } = gltfOf(hills(3));
  json.buffers[0] = { byteLength: json.buffers[0]?.byteLength ?? 0, uri };
  return encode(JSON.stringify(json));
}

const whole = changed(() => {});

export const INVALID_FILES: readonly InvalidFile[] = [
  { name: 'empty.glb', bytes: new Uint8Array(), code: 'unknown-format', place: /empty\.glb/ },
  { name: 'text.glb', bytes: encode('Dear sir or madam,\nthis is not a model.\n'), code: 'unknown-format', place: /text\.glb/ },
  { name: 'magic.glb', bytes: changed(() => {}, { magic: 'glTX' }), code: 'unknown-format', place: /magic\.glb/ },
  { name: 'header-only.glb', bytes: whole.slice(0, 12), code: 'truncated', place: /byte/ },
  { name: 'half.glb', bytes: whole.slice(0, whole.length / 2), code: 'truncated', place: /byte/ },
  { name: 'chunk-length.glb', bytes: changed(() => {}, { jsonLength: 0xffff_fff0 }), code: 'truncated', place: /byte/ },
  { name: 'version-1.glb', bytes: changed(() => {}, { version: 1 }), code: 'unsupported', place: /version/ },
  { name: 'nested.glb', bytes: glb({ json: 0, jsonText: '['.repeat(100_000) }), code: 'syntax', place: /JSON|line/i },
  { name: 'cut-json.gltf', bytes: encode('{"asset":{"version":"2.0"},"meshes":[{"primi'), code: 'truncated', place: /line/ },
  {
    name: 'index.glb',
    bytes: changed((parts) => void (new Uint32Array(parts.binary.buffer)[5] = 4_000_000_000)),
    code: 'out-of-range',
    place: /primitives\[0\]\.indices/,
  },
  {
    name: 'nan.glb',
    bytes: changed((parts) => void (floats(parts)[parts.json.bufferViews[1]!.byteOffset / 4 + 7] = NaN)),
    code: 'not-finite',
    place: /POSITION/,
  },
  {
    name: 'view-past-end.glb',
    bytes: changed(({ json }) => void (json.bufferViews[1]!.byteLength = 1_000_000)),
    code: 'out-of-range',
    place: /bufferViews\[1\]/,
  },
  {
    name: 'accessor-past-end.glb',
    bytes: changed(({ json }) => void (json.accessors[1]!.count = 4_000_000_000)),
    code: 'out-of-range',
    place: /accessors\[1\]/,
  },
  {
    name: 'no-such-accessor.glb',
    bytes: changed(({ json }) => void (json.meshes[0]!.primitives[0]!.attributes['POSITION'] = 77)),
    code: 'out-of-range',
    place: /POSITION/,
  },
  { name: 'missing-buffer.gltf', bytes: gltf('nowhere.bin'), code: 'missing-resource', place: /buffers\[0\]/ },
  { name: 'outside.gltf', bytes: gltf('../../etc/passwd'), code: 'missing-resource', place: /buffers\[0\]/ },
  { name: 'base64.gltf', bytes: gltf('data:application/octet-stream;base64,*not*base64*'), code: 'syntax', place: /buffers\[0\]/ },
  { name: 'index.obj', bytes: encode('v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n'), code: 'out-of-range', place: /index\.obj:4/ },
  { name: 'nan.obj', bytes: encode('v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n'), code: 'not-finite', place: /nan\.obj:2/ },
  { name: 'infinite.obj', bytes: encode('v 0 0 0\nv 1 0 1e999\nv 0 1 0\nf 1 2 3\n'), code: 'not-finite', place: /infinite\.obj:2/ },
  { name: 'words.obj', bytes: encode('v 0 0 0\nv one 0 0\nv 0 1 0\nf 1 2 3\n'), code: 'syntax', place: /words\.obj:2/ },
  { name: 'points.obj', bytes: encode('v 0 0 0\nv 1 0 0\nv 0 1 0\n'), code: 'no-triangles', place: /points\.obj/ },
];

/** Files without a triangle, which a page has no use for and which else go through as they are. */
export const WITHOUT_TRIANGLES: readonly InvalidFile[] = [
  {
    name: 'no-triangles.glb',
    bytes: changed(({ json }) => void (json.meshes[0]!.primitives[0]!.mode = 0)),
    code: 'no-triangles',
    place: /no-triangles\.glb/,
  },
  {
    name: 'no-meshes.glb',
    bytes: glb({ json: { asset: { version: '2.0' } } }),
    code: 'no-triangles',
    place: /no-meshes\.glb/,
  },
];
