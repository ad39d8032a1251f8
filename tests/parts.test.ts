// The report of bytes by part, which add up to all that was read and written.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { beforeAll, describe, expect, it } from 'vitest';
import { COMPRESSIONS, init, openDocument, type DocumentInput, type Parts } from 'decimesh';
import { onlyMembers } from '../dist/codecs/skim.js';
import { glb, gltfOf } from './support/glb.ts';
import { ONE_PIXEL, hills, objOf } from './support/meshes.ts';
import { decimesh } from './support/program.ts';
import { gltfErrors } from './support/validate.ts';

const sample = (name: string): Uint8Array => new Uint8Array(readFileSync(fileURLToPath(new URL(`../www/samples/${name}`, import.meta.url))));
const sum = ({ geometry, textures, animation, other }: Parts): number => geometry + textures + animation + other;

beforeAll(() => init());

describe('the members of a text that are looked at', () => {
  const wanted = new Set(['a', 'b']);
  const left = (text: string): unknown => JSON.parse(onlyMembers(text, wanted));

  it.each([
    ['{"a":1,"x":[{"a":2},"}",{}],"b":{"x":3}}', { a: 1, x: null, b: { x: 3 } }],
    [String.raw`{ "x" : "\\" , "a" : "x\"}," , "y":{}}`, { x: null, a: 'x"},', y: null }],
    ['{"a":[1,[2,{"x":":"}]],"x":0}', { a: [1, [2, { x: ':' }]], x: null }],
    ['{}', {}],
    ['[{"x":1}]', [{ x: 1 }]],
    ['"x:,"', 'x:,'],
  ])('of %s', (text, expected) => {
    expect(left(text)).toEqual(expected);
  });

  it.each(['', '{', '{"a":1', '{"a', '{"a":}', '}', '{"a\\'])('stay no JSON in %s', (text) => {
    expect(() => left(text)).toThrow(SyntaxError);
  });
});

async function partsOf(input: DocumentInput): Promise<Parts> {
  using document = await openDocument(input);
  const { report } = await document.write();
  expect(sum(report.input.parts)).toBe(report.input.bytes);
  expect(sum(report.output.parts)).toBe(report.output.bytes);
  return report.input.parts;
}

describe('bytes by part', () => {
  it('are exact for a GLB', async () => {
    const { json, binary } = gltfOf(hills(10));
    const file = glb({ json, binary });
    expect(await partsOf(file)).toEqual({ geometry: binary.length, textures: 0, animation: 0, other: file.length - binary.length });
  });

  it('know textures and animations, before and after, in every encoding', async () => {
    using document = await openDocument(sample('desk-fan.glb'));
    await document.simplify({ ratio: 0.5, preset: 'fast' });
    for (const compress of COMPRESSIONS) {
      for (const format of ['glb', 'gltf'] as const) {
        const { report } = await document.write({ format, compress });
        const [before, after] = [report.input.parts, report.output.parts];
        expect([sum(before), sum(after)]).toEqual([report.input.bytes, report.output.bytes]);
        expect(before.animation).toBeGreaterThan(100);
        expect(after.animation).toBeGreaterThan(100);
        expect(after.textures).toBe(before.textures);
        expect(after.geometry).toBeLessThan(0.7 * before.geometry);
        expect(after.geometry).toBeGreaterThan(1000);
      }
    }
    using helmet = await openDocument(sample('flight-helmet.glb'));
    const { report } = await helmet.write({ format: 'gltf' });
    expect(report.output.parts.textures).toBe(report.input.parts.textures);
    expect(report.input.parts.textures).toBeGreaterThan(10_000);
  });

  it('of a chain are those of all its levels, plain and compressed', async () => {
    using document = await openDocument(sample('desk-fan.glb'));
    await document.simplify({ placement: 'subset' });
    const one = await document.write({ compress: 'none' });
    const sizes: number[] = [];
    for (const options of [{ compress: 'none' }, { compress: 'meshopt' }, { compress: 'meshopt', quantize: true }, { compress: 'draco' }] as const) {
      const { bytes, report } = await document.write({ lods: [1, 0.5, 0.1], ...options });
      expect(await gltfErrors(bytes)).toEqual([]);
      const { parts, bytes: total } = report.output;
      expect([sum(parts), total]).toEqual([total, bytes.length]);
      // Shared by all levels.
      expect(parts.textures).toBe(one.report.output.parts.textures);
      expect(parts.geometry).toBeGreaterThan(1000);
      sizes.push(parts.geometry);
      using again = await openDocument(bytes);
      expect(again.summary.meshes).toBe(3 * document.summary.meshes);
      const triangles = (await again.geometry()).groups.map(({ indices }) => indices.length / 3);
      const levels = report.lods?.map((level) => level.triangles) ?? [];
      // Draco leaves out triangles without an area.
      const missing = levels.reduce((most, count) => most + count, 0) - triangles.reduce((most, count) => most + count, 0);
      expect(missing).toBeGreaterThanOrEqual(0);
      expect(missing).toBeLessThan(options.compress === 'draco' ? 50 : 1);
    }
    // Plain, packed, coarser and packed.
    expect(sizes[1]).toBeLessThan(sizes[0] as number);
    expect(sizes[2]).toBeLessThan(sizes[1] as number);
  });

  it('count base64 with what it holds', async () => {
    const { json, binary } = gltfOf(hills(10));
    const uri = `data:application/octet-stream;base64,${Buffer.from(binary).toString('base64')}`;
    (json.buffers[0] as { uri?: string }).uri = uri;
    const parts = await partsOf(new TextEncoder().encode(JSON.stringify(json)));
    expect(Math.abs(parts.geometry - uri.length)).toBeLessThan(2);
  });

  it('count files by what they are', async () => {
    const obj = objOf(hills(4));
    const files = [
      { name: 'a.obj', bytes: obj },
      { name: 'a.mtl', bytes: new TextEncoder().encode('newmtl a\nmap_Kd a.png\n') },
      { name: 'a.png', bytes: ONE_PIXEL },
    ];
    expect(await partsOf(files)).toEqual({ geometry: obj.length, textures: ONE_PIXEL.length, animation: 0, other: 22 });
  });

  it('are in the report of the command line', async () => {
    const { stdout } = await decimesh(fileURLToPath(new URL('../www/samples/desk-fan.glb', import.meta.url)), '--json', '-r', '0.5', '--preset', 'fast');
    const report = JSON.parse(stdout) as { input: { parts: Parts; bytes: number }; output: { parts: Parts; bytes: number } };
    expect([sum(report.input.parts), sum(report.output.parts)]).toEqual([report.input.bytes, report.output.bytes]);
  });
});
