// How the page gathers a model's files from drops, without a browser: entries are made up, files are Node's.
import { describe, expect, it } from 'vitest';
import { fileNameOf } from '../www/download.ts';
import { baseName, filesOfDrop, modelFile, relativeToModel } from '../www/files.ts';

interface Tree {
  readonly [name: string]: string | Tree;
}

// A directory reader hands out entries in portions and ends with an empty one.
const entry = (name: string, content: string | Tree): FileSystemEntry => {
  if (typeof content === 'string') {
    return { name, isFile: true, isDirectory: false, file: (done: (file: File) => void) => done(new File([content], name)) } as unknown as FileSystemEntry;
  }
  const children = Object.entries(content).map(([child, inside]) => entry(child, inside));
  const createReader = () => {
    let at = 0;
    return { readEntries: (done: (entries: FileSystemEntry[]) => void) => done(children.slice(at, (at += 2))) };
  };
  return { name, isFile: false, isDirectory: true, createReader } as unknown as FileSystemEntry;
};

const dropOf = (tree: Tree): DataTransfer => {
  const items = Object.entries(tree).map(([name, content]) => ({ kind: 'file', webkitGetAsEntry: () => entry(name, content) }));
  const files = Object.entries(tree).flatMap(([name, content]) => (typeof content === 'string' ? [new File([content], name)] : []));
  return { items, files } as unknown as DataTransfer;
};

const names = (files: File[]): string[] => files.map(({ name }) => name).sort();

describe('a drop', () => {
  it('of files is those files', async () => {
    expect(names(await filesOfDrop(dropOf({ 'a.gltf': '{}', 'a.bin': '' })))).toEqual(['a.bin', 'a.gltf']);
  });

  it('of a folder has every file under its path from the model', async () => {
    const files = relativeToModel(await filesOfDrop(dropOf({ shoe: { source: { 'shoe.gltf': '{}', 'shoe.bin': '1', textures: { 'a.png': '2', 'b.png': '3', 'c.png': '4' } }, 'readme.txt': '' } })));
    expect(names(files)).toEqual(['shoe.bin', 'shoe.gltf', 'shoe/readme.txt', 'textures/a.png', 'textures/b.png', 'textures/c.png']);
    expect(await files.find(({ name }) => name === 'textures/c.png')?.text()).toBe('4');
    expect(modelFile(files)?.name).toBe('shoe.gltf');
  });

  it('of an empty folder is nothing', async () => {
    expect(await filesOfDrop(dropOf({ empty: {} }))).toEqual([]);
  });
});

describe('names', () => {
  it('finds the model among other files, else takes the first', () => {
    expect(modelFile([new File([], 'a.png'), new File([], 'B.OBJ')])?.name).toBe('B.OBJ');
    for (const name of ['a.ply', 'a.STL', 'a.off', 'a.smf']) {
      expect(modelFile([new File([], 'a.png'), new File([], 'a.mtl'), new File([], name)])?.name).toBe(name);
    }
    expect(modelFile([new File([], 'notes.txt')])?.name).toBe('notes.txt');
    expect(modelFile([])).toBeUndefined();
  });

  it('takes folders and the last extension off', () => {
    expect(['models/vase.v2.glb', 'vase', '.glb'].map(baseName)).toEqual(['vase.v2', 'vase', '.glb']);
  });

  it('reads the name out of an address', () => {
    expect(fileNameOf(new URL('https://example.org/a/my%20vase.glb?x=1'))).toBe('my vase.glb');
    expect(fileNameOf(new URL('https://example.org/'))).toBe('model');
    expect(fileNameOf(new URL('https://example.org/100%.glb'))).toBe('100%.glb');
  });
});
