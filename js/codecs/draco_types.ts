// The part of Draco's interface that is used. Types only: the scripts come without any.

/** An object in Draco's memory. */
export interface DracoObject {
  /** 0 for a null pointer. */
  readonly ptr: number;
}

export interface DracoStatus extends DracoObject {
  ok(): boolean;
  error_msg(): string;
}

export interface DracoMesh extends DracoObject {
  num_faces(): number;
  num_points(): number;
}

export interface DracoAttribute extends DracoObject {
  num_components(): number;
}

interface DracoMemory {
  readonly HEAPU8: Uint8Array;
  readonly HEAP8: Int8Array;
  _malloc(bytes: number): number;
  _free(pointer: number): void;
  destroy(object: object): void;
}

export interface DracoDecoder extends DracoObject {
  DecodeArrayToMesh(data: Int8Array, size: number, mesh: DracoMesh): DracoStatus;
  GetAttributeByUniqueId(mesh: DracoMesh, id: number): DracoAttribute;
  GetAttributeDataArrayForAllPoints(mesh: DracoMesh, attribute: DracoAttribute, type: number, size: number, pointer: number): boolean;
  GetTrianglesUInt32Array(mesh: DracoMesh, size: number, pointer: number): boolean;
}

export interface DracoDecoderModule extends DracoMemory {
  readonly Decoder: new () => DracoDecoder;
  readonly Mesh: new () => DracoMesh;
  readonly DT_INT8: number;
  readonly DT_UINT8: number;
  readonly DT_INT16: number;
  readonly DT_UINT16: number;
  readonly DT_UINT32: number;
  readonly DT_FLOAT32: number;
}

export interface DracoInt8Array extends DracoObject {
  size(): number;
  GetValue(index: number): number;
}

export interface DracoMeshBuilder extends DracoObject {
  AddFacesToMesh(mesh: DracoMesh, faces: number, indices: Uint16Array | Uint32Array): boolean;
  AddFloatAttribute(mesh: DracoMesh, kind: number, points: number, components: number, values: Float32Array): number;
  AddInt8Attribute(mesh: DracoMesh, kind: number, points: number, components: number, values: Int8Array): number;
  AddUInt8Attribute(mesh: DracoMesh, kind: number, points: number, components: number, values: Uint8Array): number;
  AddInt16Attribute(mesh: DracoMesh, kind: number, points: number, components: number, values: Int16Array): number;
  AddUInt16Attribute(mesh: DracoMesh, kind: number, points: number, components: number, values: Uint16Array): number;
  AddUInt32Attribute?(mesh: DracoMesh, kind: number, points: number, components: number, values: Uint32Array): number;
  SetNormalizedFlagForAttribute(mesh: DracoMesh, attribute: number, normalized: boolean): boolean;
}

export interface DracoExpertEncoder extends DracoObject {
  SetEncodingMethod(method: number): void;
  SetSpeedOptions(encoding: number, decoding: number): void;
  SetAttributeQuantization(attribute: number, bits: number): void;
  SetAttributeExplicitQuantization(attribute: number, bits: number, components: number, origin: readonly number[], range: number): void;
  SetTrackEncodedProperties(track: boolean): void;
  EncodeToDracoBuffer(deduplicate: boolean, out: DracoInt8Array): number;
  GetNumberOfEncodedPoints(): number;
  GetNumberOfEncodedFaces(): number;
}

export interface DracoEncoderModule extends DracoMemory {
  readonly MeshBuilder: new () => DracoMeshBuilder;
  readonly Mesh: new () => DracoMesh;
  readonly ExpertEncoder: new (mesh: DracoMesh) => DracoExpertEncoder;
  readonly DracoInt8Array: new () => DracoInt8Array;
  readonly POSITION: number;
  readonly NORMAL: number;
  readonly COLOR: number;
  readonly TEX_COORD: number;
  readonly GENERIC: number;
  readonly MESH_SEQUENTIAL_ENCODING: number;
  readonly MESH_EDGEBREAKER_ENCODING: number;
}
