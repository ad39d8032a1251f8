// What can be chosen beside the slider, without a browser: the address, the recipes, undo, limits, the tree, reasons, words.
import { readFileSync } from 'node:fs';
import { beforeAll, describe, expect, it } from 'vitest';
import { init, openDocument } from 'decimesh';
import { at } from '../scripts/project.mjs';
import { readArguments } from '../js/cli/arguments.ts';
import { batchEnded, batchProgress, batchStarted, countsOf, newBatch, resultChanged } from '../www/batch/batch_state.ts';
import { mainBlocker, reasonsOf } from '../www/blockers.ts';
import { DEFAULT_CHOICES, DEFAULT_RUN, readShares, readWish, runKey, withWishes, writeWish } from '../www/choices.ts';
import type { Choices } from '../www/choices.ts';
import { modelsOf } from '../www/files.ts';
import { formatDownloadTime, readNumber } from '../www/format.ts';
import { noticeText, warningText } from '../www/notices.ts';
import { codeOf, commandOf } from '../www/recipe.ts';
import { readScene } from '../www/scene.ts';
import * as transitions from '../www/state.ts';
import type { State } from '../www/state.ts';

beforeAll(() => init());

const changed: Choices = {
  goal: { kind: 'error', percent: 0.25 },
  run: { lockBorder: true, prune: true, weights: { normal: 2, uv: 0, color: 1, morph: 1 }, kept: [0, 3], paint: 0 },
  lods: [1, 0.5, 0.125],
  outputFormat: 'ply',
  encoding: 'draco',
  quality: 'best',
  preparation: { tidy: true, textureSize: 512, textureFormat: 'jpeg', textureQuality: 55 },
};

describe('the address', () => {
  it('gives back what was written into it, and keeps what is not its own', () => {
    const query = new URLSearchParams('model=a.glb&triangles=5');
    writeWish(query, changed, 500);
    expect(withWishes(DEFAULT_CHOICES, readWish(query))).toEqual(changed);
    expect(query.get('model')).toBe('a.glb');
    // A limit sets the count.
    expect(query.has('triangles')).toBe(false);
    writeWish(query, DEFAULT_CHOICES, 500);
    expect(query.toString()).toBe('model=a.glb&triangles=500');
    writeWish(query, DEFAULT_CHOICES, null);
    expect(query.toString()).toBe('model=a.glb');
  });

  it('is left alone where it makes no sense', () => {
    const query = new URLSearchParams('triangles=0.5&error=-1&size=NaN&quality=x&format=gltf&compression=7&lods=100&weights=uv&keep=a,-1&prune=0');
    expect(withWishes(DEFAULT_CHOICES, readWish(query))).toEqual(DEFAULT_CHOICES);
    expect(readWish(query).triangles).toBeUndefined();
  });
});

describe('a recipe', () => {
  const recipe = { fileName: "it's a vase.glb", name: "it's a vase", triangles: 1234, choices: DEFAULT_CHOICES };

  it('is a command that the command line takes', () => {
    const wordsOf = (command: string): string[] =>
      [...command.matchAll(/(?:'[^']*'|\\'|[^\s'])+/g)].map(([word]) => word.replace(/'([^']*)'|\\'/g, (_, inner?: string) => inner ?? "'")).slice(2);
    expect(readArguments(wordsOf(commandOf(recipe)))).toMatchObject({
      inputs: ["it's a vase.glb"], output: "it's a vase-small.glb", options: { triangles: 1234 }, compress: 'none',
    });
    const choices = { ...changed, outputFormat: 'glb', encoding: 'meshopt-quantized', lods: [] } as const;
    expect(readArguments(wordsOf(commandOf({ ...recipe, choices })))).toMatchObject({
      options: { error: '0.25%', preset: 'best', lockBorder: true, prune: true, attributeWeights: { normal: 2, uv: 0 } },
      compress: 'meshopt',
      quantize: true,
    });
    const chain = { ...DEFAULT_CHOICES, lods: [1, 0.25], run: DEFAULT_RUN };
    expect(readArguments(wordsOf(commandOf({ ...recipe, choices: chain })))).toMatchObject({ lods: [1, 0.25] });
    const size = { ...DEFAULT_CHOICES, goal: { kind: 'size', bytes: 5000 } } as const;
    expect(readArguments(wordsOf(commandOf({ ...recipe, choices: size })))).toMatchObject({ size: 5000 });
  });

  it.each([
    ['a count', DEFAULT_CHOICES],
    ['everything', { ...changed, outputFormat: 'glb', encoding: 'quantized', lods: [] }],
    ['a chain', { ...DEFAULT_CHOICES, lods: [0.5, 0.25] }],
    ['a size', { ...DEFAULT_CHOICES, goal: { kind: 'size', bytes: 900_000 } }],
  ] as ReadonlyArray<readonly [string, Choices]>)('is a program that runs: %s', async (_, choices) => {
    const lines = codeOf({ ...recipe, triangles: 4000, choices }).split('\n');
    const written: Uint8Array[] = [];
    const body = lines.filter((line) => !line.startsWith('import ')).join('\n');
    const run = new Function('openDocument', 'readFile', 'writeFile', `return (async () => {\n${body}\n})();`) as (...names: unknown[]) => Promise<void>;
    const read = (name: string): Uint8Array => {
      expect(name).toBe("it's a vase.glb");
      return new Uint8Array(readFileSync(at('www', 'samples', 'flight-helmet.glb')));
    };
    await run(openDocument, read, (_name: string, bytes: Uint8Array) => written.push(bytes));
    using document = await openDocument(written[0] as Uint8Array);
    expect(document.summary.triangles).toBeLessThan(94_722);
  });
});

describe('undo', () => {
  const source = { format: 'glb', compression: 'none' as const, bytes: 5000, triangles: 1000, vertices: 500, meshes: 1, diagonal: 2 };
  const ready = (): State =>
    transitions.historyReady(transitions.modelOpened(transitions.initialState, { name: 'vase', credit: '', source, warnings: [], animations: [] }), 4);

  it('goes back through every kind of choice, and forth again', () => {
    const steps = [
      (state: State) => transitions.targetMoved(state, 300, 1),
      (state: State) => transitions.qualityChosen(state, 'best'),
      (state: State) => transitions.runChanged(state, { lockBorder: true }),
      (state: State) => transitions.goalChosen(state, { kind: 'error', percent: 1 }),
      (state: State) => transitions.lodsChosen(state, [1, 0.5]),
      (state: State) => transitions.encodingChosen(state, 'draco'),
      (state: State) => transitions.outputFormatChosen(state, 'obj'),
      (state: State) => transitions.choicesReset(state),
    ];
    const seen = [ready()];
    for (const step of steps) seen.push(step(seen.at(-1) as State));
    const parts = (state: State) => [state.model?.wantedTriangles, transitions.choicesOf(state)];
    let state = seen.at(-1) as State;
    for (const before of seen.slice(0, -1).reverse()) {
      state = transitions.undone(state);
      expect(parts(state)).toEqual(parts(before));
    }
    expect(transitions.undone(state)).toBe(state);
    for (const after of seen.slice(1)) {
      state = transitions.redone(state);
      expect(parts(state)).toEqual(parts(after));
    }
  });

  it('has no step for what changes nothing, or for what a limit does', () => {
    expect(transitions.qualityChosen(ready(), 'balanced')).toEqual(ready());
    const limited = transitions.goalReached(transitions.goalChosen(ready(), { kind: 'error', percent: 1 }), 200);
    expect(limited.model?.wantedTriangles).toBe(200);
    expect(transitions.undone(limited)).toMatchObject({ goal: { kind: 'triangles' }, model: { wantedTriangles: 1000 } });
    expect(transitions.targetMoved(limited, 100, 3).goal).toEqual({ kind: 'triangles' });
  });

  it('is of one model: what is kept of another is not', () => {
    const kept = transitions.runChanged(ready(), { kept: [1], prune: true });
    const next = transitions.modelOpened(kept, { name: 'b', credit: '', source, warnings: [], animations: [] });
    expect(next.run).toEqual({ ...DEFAULT_RUN, prune: true });
    expect(runKey(next.run)).not.toBe(runKey(kept.run));
  });
});

describe('what is typed', () => {
  it('is a number with a point or a comma', () => {
    expect(['0.5', '0,5', '1 234,5', '1,234.5', '12', '.5', '5.'].map(readNumber)).toEqual([0.5, 0.5, 1234.5, 1234.5, 12, 0.5, 5]);
    expect(['1.234.567', '1,234,567', '1.234.567,5'].map(readNumber)).toEqual([1234567, 1234567, 1234567.5]);
    expect(['', 'x', '1e5', '-1', '1.2x'].map(readNumber)).toEqual([null, null, null, null, null]);
  });

  it('is a list of shares', () => {
    expect(readShares('50 100, 25 25 0 400')).toEqual([1, 0.5, 0.25]);
    expect(readShares('x')).toEqual([]);
  });
});

describe('the tree of a model', () => {
  it('has names and counts that add up', () => {
    const scene = readScene(new Uint8Array(readFileSync(at('www', 'samples', 'flight-helmet.glb'))));
    const meshes = scene.filter(({ mesh }) => mesh !== null);
    expect(meshes.length).toBe(6);
    expect(meshes.reduce((sum, { triangles }) => sum + triangles, 0)).toBe(94_722);
    expect(meshes.every(({ name }) => name !== '')).toBe(true);
  });

  it('ends where nodes lead back to themselves, or to one another twice', () => {
    const text = new TextEncoder().encode(JSON.stringify({
      scenes: [{ nodes: [0, 0] }],
      nodes: [{ name: 'a', mesh: 0, children: [1, 1] }, { name: 'b', mesh: 0, children: [0, 1] }],
      meshes: [{ primitives: [] }],
    }));
    const glb = new Uint8Array(20 + text.length);
    new DataView(glb.buffer).setUint32(12, text.length, true);
    glb.set(text, 20);
    expect(readScene(glb).map(({ name, depth }) => `${depth} ${name}`)).toEqual(['0 a', '1 b']);
  });
});

describe('words', () => {
  const none = { seam: 0, corner: 0, border: 0, nonManifold: 0, locked: 0, topology: 0, flip: 0, error: 0, other: 0 };

  it('say why there are no fewer triangles, the main reason first', () => {
    expect(reasonsOf({ ...none, seam: 50, corner: 11, border: 39 }).map(({ kind }) => kind)).toEqual(['seam', 'border']);
    expect(mainBlocker({ ...none, seam: 50, corner: 11, border: 39 })).toBe('61 % of the remaining edges lie on UV seams or the borders of materials');
    expect(mainBlocker(none)).toBe('no edge is left');
  });

  it('are there for errors that have a code, and for others', () => {
    const notice = (code: string) => ({ code, message: 'x', where: '' });
    expect(noticeText(notice('truncated'))).toContain('download or export it again');
    expect(noticeText(notice('never-heard-of'))).toBe(noticeText(notice('internal')));
    expect(warningText({ code: 'degenerate-face', message: '3 faces', where: '' })).toMatch(/without an area/);
    expect(warningText({ code: 'new', message: 'something else', where: '' })).toBe('Something else.');
    expect(formatDownloadTime(1_125_000)).toBe('1 s');
    expect(formatDownloadTime(200_000_000)).toBe('178 s');
  });
});

describe('a queue', () => {
  it('has its models with the files they may need, and no others', () => {
    const file = (name: string): File => new File(['x'], name);
    const models = modelsOf(['a/x.gltf', 'a/x.bin', 'a/t/p.png', 'b/y.obj', 'b/y.mtl', 'c.glb', 'c.png', 'd.zip', 'notes.txt'].map(file));
    expect(models.map((files) => files.map(({ name }) => name))).toEqual([
      ['x.gltf', 'x.bin', 't/p.png'], ['y.obj', 'y.mtl'], ['c.glb'], ['d.zip'],
    ]);
  });

  it('counts what was done, failed and cancelled', () => {
    let batch = batchStarted(newBatch(['a', 'b', 'c', 'd']));
    const figures = { triangles: 1, bytes: 1 };
    batch = resultChanged(batch, 0, { kind: 'done', before: figures, after: figures, fileName: 'a.glb' });
    batch = resultChanged(batch, 1, { kind: 'failed', notice: { code: 'x', message: '', where: '' } });
    batch = resultChanged(batch, 2, { kind: 'running', fraction: 0.5 });
    expect(batchProgress(batch)).toBe(0.625);
    batch = batchEnded(batch);
    expect(countsOf(batch)).toEqual({ ended: 2, done: 1, failed: 1 });
    expect(batch.items.map(({ result }) => result.kind)).toEqual(['done', 'failed', 'cancelled', 'cancelled']);
    expect(batchStarted(batch).items.every(({ result }) => result.kind === 'waiting')).toBe(true);
  });
});
