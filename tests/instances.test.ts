// Instances and feature ids: what refers to a mesh from outside stays, and what belongs to its vertices follows them.
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument, type WriteOptions } from 'decimesh';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { gltfErrors } from './support/validate.ts';

const PLACES = [0, 0, 0, 5, 0, 0, 0, 7, 0];
const INSTANCE_IDS = [4, 5, 6];

/** Hills at three places, with an id for each half of the vertices and for each instance, and a table of the ids. */
function tagged(): Uint8Array {
  const { json, binary } = gltfOf(hills(16));
  const positions = new Float32Array(binary.buffer, json.bufferViews[1]?.byteOffset, 3 * (json.accessors[1]?.count ?? 0));
  const ids = Float32Array.from({ length: positions.length / 3 }, (_, vertex) => ((positions[3 * vertex] as number) < 0.5 ? 1 : 2));
  const parts = [
    { values: ids, type: 'SCALAR', stride: 4 },
    { values: Float32Array.from(PLACES), type: 'VEC3', stride: 0 },
    { values: Float32Array.from(INSTANCE_IDS), type: 'SCALAR', stride: 0 },
    { values: Uint16Array.from([10, 20, 30, 40]), type: '', stride: 0 },
  ];
  let length = binary.length;
  const chunks = [binary];
  for (const { values, type, stride } of parts) {
    json.bufferViews.push({ buffer: 0, byteOffset: length, byteLength: values.byteLength, ...(stride > 0 ? { target: 34962 } : {}) } as never);
    if (type !== '') {
      const count = values.length / (type === 'VEC3' ? 3 : 1);
      json.accessors.push({ bufferView: json.bufferViews.length - 1, componentType: 5126, count, type });
    }
    chunks.push(new Uint8Array(values.buffer));
    length += values.byteLength;
  }
  const [attributes] = json.meshes[0]?.primitives.map((primitive) => primitive.attributes as Record<string, number>) ?? [];
  const first = json.accessors.length - 3;
  Object.assign(attributes as object, { _FEATURE_ID_0: first });
  Object.assign(json.meshes[0]?.primitives[0] as object, {
    extensions: { EXT_mesh_features: { featureIds: [{ featureCount: 4, attribute: 0, propertyTable: 0 }] } },
  });
  Object.assign(json.nodes[0] as object, {
    extensions: {
      EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: first + 1, _FEATURE_ID_0: first + 2 } },
      EXT_instance_features: { featureIds: [{ featureCount: 7, attribute: 0 }] },
    },
  });
  const schema = { id: 's', classes: { c: { properties: { height: { type: 'SCALAR', componentType: 'UINT16' } } } } };
  const table = { class: 'c', count: 4, properties: { height: { values: json.bufferViews.length - 1 } } };
  Object.assign(json, {
    extensionsUsed: ['EXT_mesh_gpu_instancing', 'EXT_mesh_features', 'EXT_instance_features', 'EXT_structural_metadata'],
    extensions: { EXT_structural_metadata: { schema, propertyTables: [table] } },
  });
  (json.buffers[0] as { byteLength: number }).byteLength = length;
  const bytes = new Uint8Array(length);
  for (const chunk of chunks.reverse()) bytes.set(chunk, (length -= chunk.length));
  return glb({ json, binary: bytes });
}

interface Accessor {
  bufferView: number;
  byteOffset?: number;
  count: number;
  type: string;
}

/** The tree of a GLB that is not packed, and the bytes of its views. */
function apart(bytes: Uint8Array) {
  const tree = glbTree(bytes) as {
    accessors: Accessor[];
    bufferViews: Array<{ byteOffset?: number; byteLength: number }>;
    nodes: Array<{ extensions: { EXT_mesh_gpu_instancing: { attributes: Record<string, number> } } }>;
    extensions: { EXT_structural_metadata: { propertyTables: Array<{ properties: { height: { values: number } } }> } };
  };
  const binaryAt = 28 + new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  const view = (index: number): Uint8Array => {
    const { byteOffset = 0, byteLength } = tree.bufferViews[index] as { byteOffset?: number; byteLength: number };
    return bytes.slice(binaryAt + byteOffset, binaryAt + byteOffset + byteLength);
  };
  return { tree, view };
}

beforeAll(() => init());

describe('instances and ids', () => {
  it.each<WriteOptions>([{}, { compress: 'meshopt' }, { quantize: true }, { compress: 'meshopt', quantize: true }, { compress: 'draco' }])('are kept at half of the triangles with %o', async (options) => {
    const file = tagged();
    expect(await gltfErrors(file)).toEqual([]);
    using document = await openDocument(file);
    await document.simplify({ ratio: 0.5 });
    const { bytes, report } = await document.write(options);
    expect(await gltfErrors(bytes)).toEqual([]);
    expect(report.warnings).toEqual([]);
    // What was packed is unpacked again to look at it.
    using again = await openDocument(bytes);
    const { tree, view } = apart((await again.write({ compress: 'none' })).bytes);
    const before = apart(file).tree;
    expect(tree.nodes[0]?.extensions).toEqual(before.nodes[0]?.extensions);
    expect(tree.extensions).toEqual(before.extensions);
    const { TRANSLATION, _FEATURE_ID_0 } = (tree.nodes[0]?.extensions.EXT_mesh_gpu_instancing.attributes ?? {}) as Record<string, number>;
    const numbers = (index: number | undefined, components: number): number[] => {
      const { bufferView, byteOffset = 0, count } = tree.accessors[index ?? -1] as Accessor;
      return [...new Float32Array(view(bufferView).slice(byteOffset, byteOffset + 4 * components * count).buffer)];
    };
    expect(numbers(TRANSLATION, 3)).toEqual(PLACES);
    expect(numbers(_FEATURE_ID_0, 1)).toEqual(INSTANCE_IDS);
    const height = tree.extensions.EXT_structural_metadata.propertyTables[0]?.properties.height.values ?? -1;
    expect([...new Uint16Array(view(height).slice(0, 8).buffer)]).toEqual([10, 20, 30, 40]);
    // An id belongs to its side of the hills, but for a vertex at the middle.
    const [set] = (await again.geometry()).wedgeSets;
    const ids = set?.attributes['_FEATURE_ID_0']?.values ?? new Float32Array();
    expect(new Set(ids)).toEqual(new Set([1, 2]));
    const x = [...ids.keys()].map((vertex) => set?.positions[3 * vertex] as number);
    const [low, high] = [Math.min(...x), Math.max(...x)];
    const wrong = [...ids].filter((id, vertex) => {
      const share = ((x[vertex] as number) - low) / (high - low);
      return Math.abs(share - 0.5) > 0.1 && id !== (share < 0.5 ? 1 : 2);
    });
    expect(wrong.length).toBe(0);
  });

  it('count in the one budget as often as they appear', async () => {
    using document = await openDocument(tagged());
    const obj = new TextDecoder().decode((await document.write({ format: 'obj' })).bytes);
    expect(obj.split('\n').filter((line) => line.startsWith('f ')).length).toBe(3 * document.summary.triangles);
  });
});
