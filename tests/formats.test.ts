// Every format through the package and the command line: in, out, and what is said of losses.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import { OUTPUT_FORMATS, externalFiles, init, openDocument, type OutputFormat, type Report } from 'decimesh';
import { ONE_PIXEL, hills, plyOf } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';
import { gltfErrors } from './support/validate.ts';

const SIZE = 10;
const TRIANGLES = 2 * SIZE * SIZE;

/** The hills with normals, texture coordinates and colours, in `format`. */
async function hillsIn(format: OutputFormat): Promise<Uint8Array> {
  using document = await openDocument(plyOf(hills(SIZE)));
  return (await document.write({ format })).bytes;
}

/** The others are told apart in a test of their own. */
const ONE_FILE = OUTPUT_FORMATS.filter((format) => format !== 'gltf');

describe('the package', () => {
  it('knows seven formats to write', () => {
    expect([...OUTPUT_FORMATS].sort()).toEqual(['glb', 'gltf', 'obj', 'off', 'ply', 'smf', 'stl']);
  });

  it.each(ONE_FILE)('opens, simplifies and writes %s, its own format by default and every other', async (format) => {
    using document = await openDocument(await hillsIn(format));
    expect(document.summary).toMatchObject({ format, triangles: TRIANGLES, warnings: [] });
    await document.simplify({ ratio: 0.5 });
    expect((await document.write()).report.output.format).toBe(format);
    for (const target of ONE_FILE) {
      const { bytes, report } = await document.write({ format: target });
      expect(report.output).toMatchObject({ format: target, bytes: bytes.length });
      using again = await openDocument(bytes);
      expect(again.summary).toMatchObject({ format: target, triangles: report.output.triangles });
      if (target === 'glb') expect(await gltfErrors(bytes)).toEqual([]);
    }
  });

  it('warns once of what a format cannot hold', async () => {
    using document = await openDocument(await hillsIn('glb'));
    expect((await document.write({ format: 'ply' })).report.warnings).toEqual([]);
    expect((await document.write({ format: 'stl' })).report.warnings).toEqual([
      { code: 'not-carried', message: 'STL cannot hold what the file has: normals, texture coordinates, colours', where: '' },
    ]);
    expect(document.summary.warnings).toEqual([]);
  });

  it.each([
    ['ply\nformat ascii 1.0\nelement vertex 9999999\nproperty float x\nend_header\n', 'truncated'],
    ['OFF\n9999999 1 0\n', 'truncated'],
    ['#$SMF 1.0\nv 0 0 0\nf 1 2 3\n', 'out-of-range'],
    ['solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n', 'not-finite'],
  ])('refuses %j with a code', async (text, code) => {
    await expect(openDocument(new TextEncoder().encode(text))).rejects.toMatchObject({ code });
  });

  it('lists the libraries of an OBJ and the images of a library', async () => {
    await init();
    const list = (text: string): string[] => externalFiles(new TextEncoder().encode(text));
    expect(list('mtllib a.mtl b.mtl\nv 0 0 0\n')).toEqual(['a.mtl', 'b.mtl']);
    expect(list('newmtl a\nmap_Kd -s 1 1 1 a b.png\n')).toEqual(['a b.png']);
    expect(list('#$SMF 1.0\nv 0 0 0\n')).toEqual([]);
  });
});

describe('the command line', () => {
  it.each(ONE_FILE)('takes .%s for the output and says the formats', async (format) => {
    const at = (name: string): string => join(directory, name);
    const directory = temporaryDirectory();
    // The extension of the input says nothing.
    writeFileSync(at('in.bin'), await hillsIn(format));
    const target = format === 'ply' ? 'off' : 'ply';
    const result = await decimesh(at('in.bin'), '-o', at(`out.${target.toUpperCase()}`), '-r', '0.5', '--json');
    expect(result).toMatchObject({ code: 0, stderr: '' });
    const report = JSON.parse(result.stdout) as Report;
    expect([report.input.format, report.output.format]).toEqual([format, target]);
    using written = await openDocument(readFileSync(at(`out.${target.toUpperCase()}`)));
    expect(written.summary.triangles).toBe(report.output.triangles);
    const many = await decimesh(at('in.bin'), '-d', at('out'), '-r', '0.5');
    expect(many.code).toBe(0);
    expect(readFileSync(at(`out/in.${format}`)).length).toBeGreaterThan(0);
  });

  it('reads the material libraries and textures of an OBJ, within its folder', async () => {
    const directory = temporaryDirectory();
    const at = (name: string): string => join(directory, name);
    mkdirSync(at('model/materials'), { recursive: true });
    writeFileSync(at('model/a.obj'), 'mtllib materials/a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl wood\nf 1/1 2/2 3/3\n');
    writeFileSync(at('model/materials/a.mtl'), 'newmtl wood\nKd 1 1 1\nmap_Kd .\\wood.png\nmap_Ke ../../secret.png\n');
    writeFileSync(at('model/materials/wood.png'), ONE_PIXEL);
    writeFileSync(at('secret.png'), ONE_PIXEL);
    const result = await decimesh(at('model/a.obj'), '-o', at('out.glb'), '-r', '1', '--json');
    expect(result.code).toBe(0);
    const { warnings } = JSON.parse(result.stdout) as Report;
    expect(warnings.map(({ code }) => code).sort()).toEqual(['missing-image', 'outside-folder']);
    const bytes = readFileSync(at('out.glb'));
    expect(await gltfErrors(bytes)).toEqual([]);
    expect(bytes.includes(ONE_PIXEL)).toBe(true);
  });

  it('warns of what the output cannot hold', async () => {
    const directory = temporaryDirectory();
    writeFileSync(join(directory, 'in.glb'), await hillsIn('glb'));
    const result = await decimesh(join(directory, 'in.glb'), '-o', join(directory, 'out.stl'), '-r', '0.5');
    expect(result.code).toBe(0);
    expect(result.stderr).toMatch(/^warning: not-carried: .*normals, texture coordinates, colours\n$/);
  });
});
