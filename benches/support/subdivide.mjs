// Makes large meshes out of small ones: every triangle in four, with a little noise so that nothing is flat for free.

/** A generator of numbers in [0, 1) that gives the same ones everywhere for the same `seed` (xorshift32). */
export function seededRandom(seed) {
  let state = seed >>> 0 || 1;
  return () => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return (state >>> 0) / 2 ** 32;
  };
}

/**
 * Subdivides a mesh `times` times at its edges' midpoints; new vertices move by at most `noise` of their edge's length
 * in each coordinate (default 0.05). `positions` has 3 numbers a vertex, `indices` 3 a triangle; shared edges stay shared.
 */
export function subdivide({ positions, indices }, times, { noise = 0.05, seed = 1 } = {}) {
  const random = seededRandom(seed);
  let mesh = { positions, indices };
  for (let round = 0; round < times; round += 1) mesh = subdivideOnce(mesh, noise, random);
  return mesh;
}

function subdivideOnce({ positions, indices }, noise, random) {
  const vertices = positions.length / 3;
  const triangles = indices.length / 3;
  const middles = new Map();
  // A closed mesh has half as many edges again as triangles; an open one a few more.
  let grown = new Float32Array(positions.length + triangles * 3 * 3);
  grown.set(positions);
  let next = vertices;
  const middle = (a, b) => {
    const key = a < b ? a * 2 ** 26 + b : b * 2 ** 26 + a;
    const known = middles.get(key);
    if (known !== undefined) return known;
    let length = 0;
    for (let axis = 0; axis < 3; axis += 1) length += (grown[3 * a + axis] - grown[3 * b + axis]) ** 2;
    const reach = Math.sqrt(length) * noise;
    for (let axis = 0; axis < 3; axis += 1) {
      grown[3 * next + axis] = (grown[3 * a + axis] + grown[3 * b + axis]) / 2 + (random() * 2 - 1) * reach;
    }
    middles.set(key, next);
    return next++;
  };
  const finer = new Uint32Array(indices.length * 4);
  for (let corner = 0, at = 0; corner < indices.length; corner += 3) {
    const [a, b, c] = [indices[corner], indices[corner + 1], indices[corner + 2]];
    const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    finer.set([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], at);
    at += 12;
  }
  grown = grown.slice(0, next * 3);
  return { positions: grown, indices: finer };
}

/** The positions and indices of the first primitive of a GLB that has float positions and integer indices. */
export function readFirstPrimitive(glb) {
  const view = new DataView(glb.buffer, glb.byteOffset, glb.byteLength);
  const jsonLength = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(glb.subarray(20, 20 + jsonLength)));
  const binary = glb.byteOffset + 28 + jsonLength;
  const read = (accessor) => {
    const { bufferView, byteOffset = 0, componentType, count, type } = json.accessors[accessor];
    const start = binary + (json.bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
    const length = count * { SCALAR: 1, VEC3: 3 }[type];
    const Type = { 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array }[componentType];
    return new Type(glb.buffer.slice(start, start + length * Type.BYTES_PER_ELEMENT));
  };
  const { attributes, indices } = json.meshes[0].primitives[0];
  return { positions: read(attributes.POSITION), indices: Uint32Array.from(read(indices)) };
}

/** A GLB of one mesh. */
export function writeGlb({ positions, indices }) {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, at) => {
    min[at % 3] = Math.min(min[at % 3], value);
    max[at % 3] = Math.max(max[at % 3], value);
  });
  const byteLength = positions.byteLength + indices.byteLength;
  const json = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: 'VEC3', min, max },
      { bufferView: 1, componentType: 5125, count: indices.length, type: 'SCALAR' },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: positions.byteLength, target: 34962 },
      { buffer: 0, byteOffset: positions.byteLength, byteLength: indices.byteLength, target: 34963 },
    ],
    buffers: [{ byteLength }],
  };
  return glbOf(json, [positions, indices]);
}

// A GLB of this JSON and these arrays one after the other.
function glbOf(json, arrays) {
  const text = Buffer.from(JSON.stringify(json));
  const jsonChunk = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const parts = arrays.map((array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength));
  const size = parts.reduce((sum, part) => sum + part.length, 0);
  const padding = Buffer.alloc((4 - (size % 4)) % 4);
  const header = Buffer.alloc(20);
  header.write('glTF', 0);
  header.writeUInt32LE(2, 4);
  header.writeUInt32LE(28 + jsonChunk.length + size + padding.length, 8);
  header.writeUInt32LE(jsonChunk.length, 12);
  header.write('JSON', 16);
  const binaryHeader = Buffer.alloc(8);
  binaryHeader.writeUInt32LE(size + padding.length, 0);
  binaryHeader.write('BIN\0', 4);
  return Buffer.concat([header, jsonChunk, binaryHeader, ...parts, padding]);
}
