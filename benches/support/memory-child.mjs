// A process of its own for one call: prints how large the WebAssembly memory was before and after it.
//
//     node memory-child.mjs ours|sequence|simplify|update OPTIONS MODEL RATIO
import { benchModel } from './models.mjs';

// Neither package shows its memory, so every instance is noted as it is made.
const memories = [];
const instantiate = WebAssembly.instantiate;
WebAssembly.instantiate = async (...words) => {
  const result = await instantiate.apply(WebAssembly, words);
  const { memory } = (result.instance ?? result).exports;
  if (memory instanceof WebAssembly.Memory) memories.push(memory);
  return result;
};
const bytes = () => Math.max(...memories.map(({ buffer }) => buffer.byteLength));

const [engine, options, name, share] = process.argv.slice(2);
const mesh = benchModel(name);
const triangles = mesh.indices.length / 3;
const target = Math.floor(triangles * Number(share));

// Only the engine that is measured is loaded, so that its memory is the only one.
const calls = {
  ours: async () => {
    const { init, simplify } = await import('../../dist/index.js');
    await init();
    return () => simplify(mesh, { triangles: target, ...JSON.parse(options) });
  },
  sequence: async () => {
    const { init, simplifySequence } = await import('../../dist/index.js');
    await init();
    return () => simplifySequence(mesh, JSON.parse(options));
  },
  simplify: async () => {
    const { MeshoptSimplifier } = await import('meshoptimizer/simplifier');
    await MeshoptSimplifier.ready;
    return () => MeshoptSimplifier.simplify(mesh.indices, mesh.positions, 3, target * 3, 1e9);
  },
  update: async () => {
    const { MeshoptSimplifier } = await import('meshoptimizer/simplifier');
    await MeshoptSimplifier.ready;
    const none = new Float32Array(0);
    return () => MeshoptSimplifier.simplifyWithUpdate(mesh.indices, mesh.positions, 3, none, 0, [], null, target * 3, 1e9);
  },
};
const call = await calls[engine]();
const before = bytes();
call();
console.log(JSON.stringify({ before, after: bytes(), vertices: mesh.positions.length / 3, triangles }));
