// Triangles packed by KHR_draco_mesh_compression. Draco quantises: positions to 1/16383 of the mesh's extent.

import { DecimeshError } from '../errors.js';
import { yieldToEvents } from '../platform.js';
import type { Warning } from '../types.js';
import type { DracoEncoderModule, DracoInt8Array, DracoMesh, DracoMeshBuilder } from './draco_types.js';
import type { Encoded } from './encode.js';
import type { GltfData, Layout, Triangles, Values } from './gltf_data.js';
import { newDracoEncoder } from './modules.js';
import { DRACO_EXTENSION, arrayAt, requireExtension, setExtension, type Tree } from './tree.js';

/**
 * Bits of a quantised float attribute, by the beginning of its semantic. Positions: a step of 0.06 mm on a model of a
 * metre; normals and tangents: 0.1 degrees; texture coordinates: a quarter of a texel of 1024. Whatever is not listed
 * (application's own attributes, which may be numbers of something) is kept exactly.
 */
const QUANTIZATION_BITS: ReadonlyArray<readonly [semantic: string, bits: number]> = [
  ['POSITION', 14],
  ['NORMAL', 10],
  ['TANGENT', 12],
  ['TEXCOORD_', 12],
  ['COLOR_', 10],
  ['WEIGHTS_', 14],
];

/** Draco's own scale from 0, smallest, to 10, fastest. */
const SPEED = 5;

/** A primitive to encode, with vertices of its own. */
interface Source {
  readonly primitive: Triangles;
  readonly indices: Uint32Array;
  /** The vertices it uses, by their numbers in the accessors. */
  readonly vertices: Uint32Array;
  /** One for each attribute. */
  readonly layouts: readonly Layout[];
}

/** A primitive as Draco stores it. */
interface Packed {
  readonly source: Source;
  readonly bytes: Uint8Array;
  readonly points: number;
  readonly faces: number;
}

/** A cube that holds a mesh, for one grid in all of its primitives: a border that two share stays one. */
interface Cube {
  readonly origin: readonly number[];
  readonly size: number;
}

/** The GLB with every list of triangles packed that can be. */
export async function encodeDraco(data: GltfData): Promise<Encoded> {
  const triangles = data.triangles();
  const sources = triangles.flatMap((primitive) => gather(data, primitive) ?? []);
  const left = triangles.length - sources.length;
  if (sources.length === 0) return { bytes: data.build(), warnings: warnOf(left, 0), dropped: 0 };
  const cubes = cubesByMesh(data, sources);
  const encoder = await newDracoEncoder();
  const packed: Packed[] = [];
  for (const source of sources) {
    await yieldToEvents();
    packed.push(encodePrimitive(encoder, data, source, cubes.get(source.primitive.mesh)));
  }
  point(data, packed, accessorsToKeep(data, triangles, sources));
  requireExtension(data.tree, DRACO_EXTENSION);
  const dropped = packed.reduce((sum, { source, faces }) => sum + source.indices.length / 3 - faces, 0);
  return { bytes: data.build(), warnings: warnOf(left, dropped), dropped };
}

function warnOf(left: number, dropped: number): Warning[] {
  const message = `${left} ${left === 1 ? 'primitive is' : 'primitives are'} not compressed: Draco cannot hold what ${left === 1 ? 'its' : 'their'} vertices have`;
  const degenerate = `${dropped} ${dropped === 1 ? 'triangle' : 'triangles'} without an area, which Draco cannot store, left out`;
  return [
    ...(left > 0 ? [{ code: 'not-compressed', message, where: '' }] : []),
    ...(dropped > 0 ? [{ code: 'triangles-dropped', message: degenerate, where: '' }] : []),
  ];
}

/** The primitive's data; undefined where Draco cannot stand for them: an attribute that cannot be read. */
function gather(data: GltfData, primitive: Triangles): Source | undefined {
  const layouts = primitive.attributes.map(([, accessor]) => data.layout(accessor));
  const count = layouts[0]?.count ?? 0;
  const fits = layouts.every((layout): layout is Layout => layout?.count === count && layout.componentType !== 5125);
  const targets = primitive.targets.flat().map(([, accessor]) => data.accessor(accessor)['count']);
  if (!fits || targets.some((own) => own !== count) || !primitive.attributes.some(([semantic]) => semantic === 'POSITION')) return undefined;
  const values = Uint32Array.from(data.values(data.layout(primitive.indices) as Layout));
  const remap = new Uint32Array(count).fill(0xffff_ffff);
  for (const vertex of values) {
    if (vertex >= count) return undefined;
    remap[vertex] = 0;
  }
  // Morph targets are not packed: they number the vertices as they are.
  if (targets.length > 0) return { primitive, indices: values, vertices: Uint32Array.from(remap.keys()), layouts };
  const vertices = new Uint32Array(count);
  let used = 0;
  for (let vertex = 0; vertex < count; vertex += 1) {
    if (remap[vertex] !== 0) continue;
    vertices[used] = vertex;
    remap[vertex] = used++;
  }
  if (used === 0) return undefined;
  const indices = values.map((vertex) => remap[vertex] as number);
  return { primitive, indices, vertices: vertices.subarray(0, used), layouts };
}

function cubesByMesh(data: GltfData, sources: readonly Source[]): Map<number, Cube> {
  const bounds = new Map<number, { low: number[]; high: number[] }>();
  for (const { primitive, vertices, layouts } of sources) {
    const layout = layouts[primitive.attributes.findIndex(([semantic]) => semantic === 'POSITION')] as Layout;
    if (layout.componentType !== 5126) continue;
    const values = data.values(layout);
    const box = bounds.get(primitive.mesh) ?? { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
    for (const vertex of vertices) {
      for (let axis = 0; axis < 3; axis += 1) {
        const value = values[3 * vertex + axis] as number;
        box.low[axis] = Math.min(box.low[axis] as number, value);
        box.high[axis] = Math.max(box.high[axis] as number, value);
      }
    }
    bounds.set(primitive.mesh, box);
  }
  const cubes = [...bounds].map(([mesh, { low, high }]): [number, Cube] => {
    // Draco works with single precision: rounded down, the largest coordinate would lie outside.
    const size = Math.fround(Math.max(...high.map((value, axis) => value - (low[axis] as number))) * (1 + 2 ** -22));
    return [mesh, { origin: low, size: size || 1 }];
  });
  return new Map(cubes);
}

function encodePrimitive(draco: DracoEncoderModule, data: GltfData, source: Source, cube: Cube | undefined): Packed {
  const { primitive, indices, vertices, layouts } = source;
  const builder = new draco.MeshBuilder();
  const mesh = new draco.Mesh();
  builder.AddFacesToMesh(mesh, indices.length / 3, indices);
  const ids = primitive.attributes.map(([semantic], index) => addAttribute(draco, builder, mesh, semantic, rows(data, layouts[index] as Layout, vertices), layouts[index] as Layout));
  const encoder = new draco.ExpertEncoder(mesh);
  const out = new draco.DracoInt8Array();
  // The better method puts vertices in an order of its own.
  const keepsOrder = primitive.targets.some((target) => target.length > 0);
  encoder.SetEncodingMethod(keepsOrder ? draco.MESH_SEQUENTIAL_ENCODING : draco.MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(SPEED, SPEED);
  encoder.SetTrackEncodedProperties(true);
  for (const [index, [semantic]] of primitive.attributes.entries()) {
    const bits = QUANTIZATION_BITS.find(([start]) => semantic.startsWith(start))?.[1];
    if (bits === undefined || layouts[index]?.componentType !== 5126) continue;
    const id = ids[index] as number;
    if (semantic === 'POSITION' && cube !== undefined) encoder.SetAttributeExplicitQuantization(id, bits, 3, cube.origin, cube.size);
    else encoder.SetAttributeQuantization(id, bits);
  }
  const length = encoder.EncodeToDracoBuffer(false, out);
  if (length <= 0) throw new DecimeshError('unsupported', 'Draco cannot encode this geometry', `meshes[${primitive.mesh}]`);
  const points = encoder.GetNumberOfEncodedPoints();
  if (keepsOrder && points !== vertices.length) {
    throw new DecimeshError('unsupported', 'Draco does not keep the order of the vertices', `meshes[${primitive.mesh}]`);
  }
  const packed = { source, bytes: bytesOf(out, length), points, faces: encoder.GetNumberOfEncodedFaces() };
  for (const object of [out, encoder, mesh, builder]) draco.destroy(object);
  return packed;
}

/** The elements of the vertices that are used. */
function rows(data: GltfData, layout: Layout, vertices: Uint32Array): Values {
  const values = data.values(layout);
  const { components } = layout;
  const picked = values.slice(0, vertices.length * components);
  for (const [row, vertex] of vertices.entries()) {
    for (let at = 0; at < components; at += 1) picked[row * components + at] = values[vertex * components + at] as number;
  }
  return picked;
}

function addAttribute(
  draco: DracoEncoderModule,
  builder: DracoMeshBuilder,
  mesh: DracoMesh,
  semantic: string,
  values: Values,
  { components, normalized }: Layout,
): number {
  const { POSITION, NORMAL, COLOR, TEX_COORD, GENERIC } = draco;
  const starts: ReadonlyArray<readonly [string, number]> = [['POSITION', POSITION], ['NORMAL', NORMAL], ['COLOR_', COLOR], ['TEXCOORD_', TEX_COORD]];
  const kind = starts.find(([start]) => semantic.startsWith(start))?.[1] ?? GENERIC;
  const points = values.length / components;
  const add = (): number => {
    if (values instanceof Float32Array) return builder.AddFloatAttribute(mesh, kind, points, components, values);
    if (values instanceof Int8Array) return builder.AddInt8Attribute(mesh, kind, points, components, values);
    if (values instanceof Uint8Array) return builder.AddUInt8Attribute(mesh, kind, points, components, values);
    if (values instanceof Int16Array) return builder.AddInt16Attribute(mesh, kind, points, components, values);
    return builder.AddUInt16Attribute(mesh, kind, points, components, values as Uint16Array);
  };
  const id = add();
  if (normalized) builder.SetNormalizedFlagForAttribute(mesh, id, true);
  return id;
}

function bytesOf(array: DracoInt8Array, length: number): Uint8Array {
  const bytes = new Uint8Array(length);
  for (let at = 0; at < length; at += 1) bytes[at] = array.GetValue(at);
  return bytes;
}

function accessorsToKeep(data: GltfData, triangles: readonly Triangles[], sources: readonly Source[]): Set<number> {
  const kept = data.usedElsewhere(triangles);
  const packed = new Set(sources.map(({ primitive }) => primitive));
  for (const primitive of triangles.filter((primitive) => !packed.has(primitive))) {
    for (const [, accessor] of [primitive.attributes, ...primitive.targets].flat()) kept.add(accessor);
    kept.add(primitive.indices);
  }
  for (const primitive of packed) for (const [, accessor] of primitive.targets.flat()) kept.add(accessor);
  return kept;
}

/** Lets primitives and accessors refer to the Draco data; accessors that several need are copied. */
function point(data: GltfData, packed: readonly Packed[], kept: ReadonlySet<number>): void {
  const taken = new Set(kept);
  const emptied = new Set<number>();
  const claim = (index: number, change: Tree): number => {
    const accessors = arrayAt(data.tree, 'accessors');
    const number = taken.has(index) ? accessors.push(structuredClone(data.accessor(index))) - 1 : index;
    taken.add(number);
    const json = data.accessor(number);
    if (number === index && typeof json['bufferView'] === 'number') emptied.add(json['bufferView']);
    for (const key of ['bufferView', 'byteOffset', 'sparse']) delete json[key];
    Object.assign(json, change);
    return number;
  };
  for (const { source, points, faces } of packed) {
    const { json, indices, attributes } = source.primitive;
    json['indices'] = claim(indices, { count: 3 * faces, componentType: points <= 0xffff ? 5123 : 5125 });
    json['attributes'] = Object.fromEntries(attributes.map(([semantic, accessor]) => [semantic, claim(accessor, { count: points })]));
  }
  data.freeViews(emptied);
  for (const { source, bytes } of packed) {
    const { json, attributes } = source.primitive;
    const bufferView = data.addView(bytes, {});
    // The numbers that Draco gives are those of the order in which attributes were added.
    setExtension(json, DRACO_EXTENSION, { bufferView, attributes: Object.fromEntries(attributes.map(([semantic], id) => [semantic, id])) });
  }
}
