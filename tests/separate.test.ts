// glTF as text with its files: from the package, the worker and the command line, all of them or none.
import { existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { validateBytes } from 'gltf-validator';
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument, type WriteOptions, type Written } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { hills } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';

const helmet = fileURLToPath(new URL('../www/samples/flight-helmet.glb', import.meta.url));
const hillsFile = (): Uint8Array => glb(gltfOf(hills(8)));

beforeAll(() => init());

const tree = (bytes: Uint8Array): Record<string, unknown> => JSON.parse(new TextDecoder().decode(bytes)) as Record<string, unknown>;

async function errors(bytes: Uint8Array, find: (name: string) => Uint8Array | undefined): Promise<string[]> {
  const externalResourceFunction = async (uri: string): Promise<Uint8Array> => {
    const found = find(decodeURIComponent(uri));
    if (found === undefined) throw new Error(`no ${uri}`);
    return found;
  };
  const { issues } = await validateBytes(bytes, { maxIssues: 100, externalResourceFunction });
  return issues.messages.filter(({ severity, code }) => severity === 0 || code === 'IO_ERROR').map(({ code, pointer }) => `${code} ${pointer}`);
}

const errorsOf = ({ bytes, files }: Written): Promise<string[]> => errors(bytes, (name) => files.find((file) => file.name === name)?.bytes);

describe('the package', () => {
  it.each<[string, WriteOptions]>([
    ['plain', {}],
    ['with meshopt', { compress: 'meshopt', quantize: true }],
    ['with Draco', { compress: 'draco' }],
  ])('writes files that are valid together and read again: %s', async (_, options) => {
    using document = await openDocument(new Uint8Array(readFileSync(helmet)));
    const written = await document.write({ format: 'gltf', name: 'Mütze 1', ...options });
    expect(await errorsOf(written)).toEqual([]);
    const images = tree(written.bytes)['images'] as Array<{ uri: string }>;
    expect(written.files.map(({ name }) => name)).toEqual(['Mütze 1.bin', ...images.map(({ uri }) => decodeURIComponent(uri))]);
    expect(images.length).toBeGreaterThan(5);
    for (const { name } of written.files) expect(name).toMatch(/^Mütze 1[\w-]*\.(bin|png|jpg|webp)$/);
    const size = written.files.reduce((sum, { bytes }) => sum + bytes.length, written.bytes.length);
    expect(written.report.output).toMatchObject({ format: 'gltf', bytes: size });
    using again = await openDocument([{ name: 'x.gltf', bytes: written.bytes }, ...written.files]);
    expect(again.summary).toMatchObject({ triangles: document.summary.triangles, groups: document.summary.groups });
    // Everything but where the bytes are is as in one file.
    const one = glbTree((await document.write({ format: 'glb', ...options })).bytes);
    for (const key of ['materials', 'nodes', 'scenes', 'textures', 'samplers', 'extensionsUsed', 'asset']) {
      expect(tree(written.bytes)[key]).toEqual(one[key]);
    }
  });

  it('writes no images where there are none, and nothing beside other formats', async () => {
    using document = await openDocument(hillsFile());
    expect((await document.write({ format: 'gltf' })).files.map(({ name }) => name)).toEqual(['model.bin']);
    expect((await document.write({ format: 'glb' })).files).toEqual([]);
    expect((await document.write({ format: 'obj' })).files).toEqual([]);
  });

  it('refuses a name with a folder', async () => {
    using document = await openDocument(hillsFile());
    for (const name of ['../x', 'a/b', 'a\\b', '', '..']) {
      await expect(document.write({ format: 'gltf', name })).rejects.toMatchObject({ code: 'invalid-argument', where: 'name' });
    }
  });

  it('writes one file of a glTF unless told otherwise', async () => {
    using document = await openDocument(hillsFile());
    const { bytes, files } = await document.write({ format: 'gltf' });
    using again = await openDocument([{ name: 'a.gltf', bytes }, ...files]);
    expect((await again.write()).report.output.format).toBe('glb');
  });

  it('writes in the worker', async () => {
    const client = createWorkerClient();
    try {
      const document = await client.openDocument(new Uint8Array(readFileSync(helmet)));
      const written = await document.write({ format: 'gltf' });
      expect(written.files.length).toBeGreaterThan(5);
      expect(await errorsOf(written)).toEqual([]);
    } finally {
      client.terminate();
    }
  });
});

describe('the command line', () => {
  it('writes all files, which are valid together, and again over them', async () => {
    const directory = temporaryDirectory();
    for (const ratio of ['0.5', '0.2']) {
      const { code, stdout } = await decimesh(helmet, '-o', join(directory, 'out.gltf'), '-r', ratio, '--preset', 'fast', '--json');
      expect(code).toBe(0);
      const names = readdirSync(directory);
      expect(names).toEqual(expect.arrayContaining(['out.gltf', 'out.bin']));
      expect(names.filter((name) => name.startsWith('.'))).toEqual([]);
      const bytes = readFileSync(join(directory, 'out.gltf'));
      expect(await errors(bytes, (name) => readFileSync(join(directory, name)))).toEqual([]);
      const sizes = names.reduce((sum, name) => sum + readFileSync(join(directory, name)).length, 0);
      expect(JSON.parse(stdout)).toMatchObject({ output: { format: 'gltf', bytes: sizes } });
    }
  });

  it('writes none when one cannot be written', async () => {
    const directory = temporaryDirectory();
    writeFileSync(join(directory, 'in.glb'), hillsFile());
    writeFileSync(join(directory, 'out.gltf'), 'kept');
    mkdirSync(join(directory, 'out.bin', 'full'), { recursive: true });
    const { code, stderr } = await decimesh(join(directory, 'in.glb'), '-o', join(directory, 'out.gltf'), '-r', '0.5');
    expect([code, stderr]).toEqual([4, expect.stringMatching(/^cannot-write: .*out\.bin/)]);
    expect(readFileSync(join(directory, 'out.gltf'), 'utf8')).toBe('kept');
    expect(readdirSync(directory).sort()).toEqual(['in.glb', 'out.bin', 'out.gltf']);
    expect(existsSync(join(directory, 'out.bin', 'full'))).toBe(true);
  });

  it('does not write over a file of its input', async () => {
    const directory = temporaryDirectory();
    const { json, binary } = gltfOf(hills(6));
    (json.buffers[0] as { uri?: string }).uri = 'out.bin';
    writeFileSync(join(directory, 'in.gltf'), JSON.stringify(json));
    writeFileSync(join(directory, 'out.bin'), binary);
    const { code, stderr } = await decimesh(join(directory, 'in.gltf'), '-o', join(directory, 'out.gltf'), '-r', '0.5');
    expect([code, stderr]).toEqual([2, expect.stringContaining('is an input')]);
    expect(new Uint8Array(readFileSync(join(directory, 'out.bin')))).toEqual(binary);
    expect(existsSync(join(directory, 'out.gltf'))).toBe(false);
  });
});
