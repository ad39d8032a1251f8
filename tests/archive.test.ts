// Archives: a zip stands for its files, and one made to do harm is a typed error.
import { writeFileSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { zipSync } from 'fflate';
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument } from 'decimesh';
import { createWorkerClient } from 'decimesh/worker';
import { glb, gltfOf } from './support/glb.ts';
import { hills, objOf } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';

const text = (value: string): Uint8Array => new TextEncoder().encode(value);
const coded = (code: string, where: RegExp): unknown =>
  expect.objectContaining({ name: 'DecimeshError', code, where: expect.stringMatching(where) });

/** A glTF in a folder, with its buffer in another below. */
function folder(): Record<string, Uint8Array> {
  const { json, binary } = gltfOf(hills(6));
  (json.buffers[0] as { uri?: string }).uri = 'data/my%20hills.bin';
  return {
    'readme.txt': text('v 1 2 3, said the text'),
    '__MACOSX/models/._hills.gltf': text('{'),
    'models/hills.gltf': text(JSON.stringify(json)),
    'models/data/my hills.bin': binary,
  };
}

beforeAll(() => init());

describe('a zip', () => {
  it.each([0, 6] as const)('stands for its files, at level %i', async (level) => {
    const bytes = zipSync(folder(), { level });
    using document = await openDocument({ name: 'hills.zip', bytes });
    expect(document.summary).toMatchObject({ format: 'gltf', triangles: 72, bytes: bytes.length });
    using unnamed = await openDocument(bytes);
    expect(unnamed.summary.triangles).toBe(72);
  });

  it('may hold an OBJ with its materials, compressed glTF, or a GLB', async () => {
    const obj = zipSync({ 'a.mtl': text('newmtl red\nKd 1 0 0\n'), 'a.obj': text(`mtllib a.mtl\nusemtl red\n${new TextDecoder().decode(objOf(hills(4)))}`) });
    using a = await openDocument(obj);
    expect(a.summary).toMatchObject({ format: 'obj', triangles: 32 });
    expect(a.summary.groups.some(({ material }) => material === 'red')).toBe(true);
    const box = (name: string): Uint8Array => new Uint8Array(readFileSync(new URL(`fixtures/codecs/BoxDraco/${name}`, import.meta.url)));
    using b = await openDocument(zipSync({ 'x/0.bin': box('0.bin'), 'x/BoxDraco.gltf': box('BoxDraco.gltf') }));
    expect(b.summary).toMatchObject({ compression: 'draco', triangles: 12 });
    using c = await openDocument(zipSync({ 'a.glb': glb(gltfOf(hills(4))) }));
    expect(c.summary.triangles).toBe(32);
  });

  it('is unpacked in the worker and by the command line', async () => {
    const bytes = zipSync(folder());
    const client = createWorkerClient();
    try {
      expect((await client.openDocument(new File([bytes as Uint8Array<ArrayBuffer>], 'hills.zip'))).summary.triangles).toBe(72);
    } finally {
      client.terminate();
    }
    const directory = temporaryDirectory();
    writeFileSync(join(directory, 'hills.zip'), bytes);
    const { code, stderr } = await decimesh(join(directory, 'hills.zip'), '-o', join(directory, 'out.glb'), '-r', '0.5');
    expect([code, stderr]).toEqual([0, '']);
  });
});

describe('a zip made to do harm', () => {
  const bytes = (): Uint8Array => zipSync({ 'a.obj': objOf(hills(4)) });
  /** Offset of the first record of the directory, and of the record at the end. */
  const places = (zip: Uint8Array): [number, number] => {
    const end = zip.length - 22;
    return [new DataView(zip.buffer, zip.byteOffset).getUint32(end + 16, true), end];
  };
  const changed = (change: (view: DataView, directory: number, end: number) => void): Uint8Array => {
    const zip = bytes().slice();
    change(new DataView(zip.buffer), ...places(zip));
    return zip;
  };

  it.each([
    ['is cut off', () => bytes().slice(0, -30), 'truncated', /^z\.zip$/],
    ['says that it unpacks to gigabytes', () => changed((view, directory) => view.setUint32(directory + 24, 0x7000_0000, true)), 'too-large', /^z\.zip: a\.obj$/],
    ['unpacks to more than it says', () => changed((view, directory) => view.setUint32(directory + 24, 10, true)), 'syntax', /a\.obj$/],
    ['unpacks to less than it says', () => changed((view, directory) => view.setUint32(directory + 24, 10_000_000, true)), 'syntax', /a\.obj$/],
    ['is encrypted', () => changed((view, directory) => view.setUint16(directory + 8, 1, true)), 'unsupported', /a\.obj$/],
    ['has an unknown method', () => changed((view, directory) => view.setUint16(directory + 10, 99, true)), 'unsupported', /a\.obj$/],
    ['has a wrong checksum', () => changed((view, directory) => view.setUint32(directory + 16, 1, true)), 'syntax', /a\.obj$/],
    ['points out of itself', () => changed((view, directory) => view.setUint32(directory + 42, 0x7fff_ffff, true)), 'syntax', /a\.obj$/],
    ['has a directory elsewhere', () => changed((view, _, end) => view.setUint32(end + 16, 3, true)), 'syntax', /^z\.zip$/],
    ['has more files than its directory', () => changed((view, _, end) => view.setUint16(end + 10, 9, true)), 'syntax', /^z\.zip$/],
    ['has too many files', () => changed((view, _, end) => view.setUint16(end + 10, 60_000, true)), 'too-large', /^z\.zip$/],
    ['is empty', () => zipSync({}), 'unknown-format', /^z\.zip$/],
    ['holds no model', () => zipSync({ 'a.txt': text('hello') }), 'unknown-format', /./],
    ['has files that share their bytes', () => overlapping(bytes(), 40), 'syntax', /^z\.zip: a\.obj$/],
  ])('that %s is a typed error', async (_, make, code, where) => {
    await expect(openDocument({ name: 'z.zip', bytes: make() })).rejects.toEqual(coded(code, where));
  });

  it('is a typed error or a document, whichever byte is wrong', async () => {
    const good = zipSync({ 'a.obj': objOf(hills(2)) });
    for (let at = 0; at < good.length; at += 1) {
      const zip = good.slice();
      zip[at] = (zip[at] as number) ^ 0xff;
      try {
        (await openDocument({ name: 'z.zip', bytes: zip })).dispose();
      } catch (error) {
        expect(error).toMatchObject({ name: 'DecimeshError', code: expect.not.stringMatching(/internal|out-of-memory/) });
      }
    }
  });

  it('a bomb is refused before it is unpacked', async () => {
    const zip = zipSync({ 'zeros.stl': new Uint8Array(80_000_000) }, { level: 9 });
    expect(zip.length).toBeLessThan(200_000);
    await expect(openDocument({ name: 'bomb.zip', bytes: zip })).rejects.toEqual(coded('too-large', /^bomb\.zip: zeros\.stl$/));
  });
});

/** The archive with its only file listed many times. */
function overlapping(zip: Uint8Array, times: number): Uint8Array {
  const end = zip.length - 22;
  const directory = new DataView(zip.buffer, zip.byteOffset).getUint32(end + 16, true);
  const record = zip.slice(directory, end);
  const made = new Uint8Array(directory + record.length * times + 22);
  made.set(zip.subarray(0, directory));
  for (let copy = 0; copy < times; copy += 1) made.set(record, directory + copy * record.length);
  made.set(zip.subarray(end), made.length - 22);
  new DataView(made.buffer).setUint16(made.length - 22 + 10, times, true);
  return made;
}
