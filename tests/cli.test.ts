// The command line, as a program: what it writes, prints and returns.
import { readFileSync, readdirSync, statSync, symlinkSync, writeFileSync, mkdirSync, chmodSync } from 'node:fs';
import { join } from 'node:path';
import { describe, expect, it } from 'vitest';
import { openDocument, type Report } from 'decimesh';
import { testWithAsset } from './support/assets.ts';
import { glb, glbTree, gltfOf } from './support/glb.ts';
import { INVALID_FILES, WITHOUT_TRIANGLES } from './support/invalid_files.ts';
import { hills, objOf } from './support/meshes.ts';
import { decimesh, temporaryDirectory } from './support/program.ts';
import { gltfErrors } from './support/validate.ts';

const SIZE = 20;
const TRIANGLES = 2 * SIZE * SIZE;
const model = (): Uint8Array => glb(gltfOf(hills(SIZE)));

/** A directory with `in.glb`, and paths in it. */
function workspace(): { at: (name: string) => string; input: string } {
  const directory = temporaryDirectory();
  const at = (name: string): string => join(directory, name);
  writeFileSync(at('in.glb'), model());
  return { at, input: at('in.glb') };
}

async function expectGlb(path: string, most: number): Promise<void> {
  const bytes = readFileSync(path);
  expect(await gltfErrors(bytes)).toEqual([]);
  const document = await openDocument(bytes);
  expect(document.summary.triangles).toBeLessThanOrEqual(most);
  expect(document.summary.triangles).toBeGreaterThan(0);
  document.dispose();
}

describe('one file', () => {
  it('writes a valid GLB of the wanted size and says so on one line', async () => {
    const { at, input } = workspace();
    const result = await decimesh(input, '-o', at('out.glb'), '--ratio', '0.25');
    expect(result).toMatchObject({ code: 0, stderr: '' });
    expect(result.stdout.trimEnd().split('\n')).toHaveLength(1);
    expect(result.stdout).toContain(`${TRIANGLES} → `);
    await expectGlb(at('out.glb'), TRIANGLES / 4);
  });

  it('prints one JSON report with the fields of the contract and nothing else', async () => {
    const { at, input } = workspace();
    const result = await decimesh(input, '-o', at('out.glb'), '-t', '100', '--json');
    expect(result).toMatchObject({ code: 0, stderr: '' });
    const report = JSON.parse(result.stdout) as Report;
    const bytes = statSync(at('out.glb')).size;
    const parts = { geometry: expect.any(Number), textures: 0, animation: 0, other: expect.any(Number) };
    expect(report).toEqual({
      input: { path: input, format: 'glb', bytes: model().length, triangles: TRIANGLES, vertices: (SIZE + 1) ** 2, meshes: 1, parts },
      output: { path: at('out.glb'), format: 'glb', bytes, triangles: expect.any(Number), vertices: expect.any(Number), meshes: 1, parts },
      stopReason: 'target',
      blockers: null,
      estimatedError: expect.any(Number),
      deviation: null,
      timings: { read: expect.any(Number), simplify: expect.any(Number), write: expect.any(Number), measure: 0 },
      warnings: [],
    });
    expect(report.output.triangles).toBeLessThanOrEqual(100);
    expect(report.output.triangles).toBeGreaterThan(90);
    expect(report.estimatedError).toBeGreaterThan(0);
  });

  it('reports alone when there is no output', async () => {
    const { input } = workspace();
    const before = readdirSync(join(input, '..'));
    const { code, stdout } = await decimesh(input, '-r', '0.5', '--json');
    expect(code).toBe(0);
    expect((JSON.parse(stdout) as Report).output).toMatchObject({ path: null, format: 'glb' });
    expect(readdirSync(join(input, '..'))).toEqual(before);
  });

  it('takes the format of the output from its extension', async () => {
    const { at, input } = workspace();
    writeFileSync(at('in.obj'), objOf(hills(SIZE)));
    expect(await decimesh(input, '-o', at('a.obj'), '-r', '0.5')).toMatchObject({ code: 0 });
    expect(readFileSync(at('a.obj'), 'utf8')).toMatch(/^v .*\n/m);
    expect(await decimesh(at('in.obj'), '-o', at('b.GLB'), '-r', '0.5')).toMatchObject({ code: 0 });
    await expectGlb(at('b.GLB'), TRIANGLES / 2);
    expect(await decimesh(at('a.obj'), '-o', at('c.obj'), '-r', '0.5')).toMatchObject({ code: 0 });
  });

  it('measures the deviation when asked to, and says it either way', async () => {
    const { at, input } = workspace();
    const args = [input, '-r', '0.2', '--measure'];
    const { deviation, timings } = JSON.parse((await decimesh(...args, '--json')).stdout) as Report;
    expect(deviation).toEqual({
      max: expect.any(Number),
      mean: expect.any(Number),
      rms: expect.any(Number),
      relativeTo: expect.closeTo(Math.sqrt(2), 1),
      originalToSimplified: expect.objectContaining({ samples: expect.any(Number) }),
      simplifiedToOriginal: expect.objectContaining({ samples: expect.any(Number) }),
      // Of what the tube has besides positions.
      attributes: { normal: expect.objectContaining({ max: expect.any(Number) }), uv: expect.objectContaining({ max: expect.any(Number) }) },
    });
    const { max, mean, rms } = deviation!;
    expect(mean).toBeGreaterThan(0);
    expect(rms).toBeGreaterThan(mean);
    expect(max).toBeGreaterThan(rms);
    expect(max).toBeLessThan(0.1);
    expect(timings.measure).toBeGreaterThan(0);
    const told = await decimesh(...args, '-o', at('out.glb'));
    expect(told).toMatchObject({ code: 0, stderr: '' });
    expect(told.stdout).toMatch(/measured deviation max 0\.\d+ \([\d.]+ %\), mean 0\.\d+ \([\d.]+ %\), rms 0\.\d+ \([\d.]+ %\)/);
    const silent = await decimesh(input, '-r', '0.2', '-o', at('out.glb'));
    expect(silent.stdout).not.toContain('measured');
  });

  it('stops at the error and says so', async () => {
    const { at, input } = workspace();
    const inUnits = await decimesh(input, '-o', at('a.glb'), '-e', '0.01', '--json');
    const report = JSON.parse(inUnits.stdout) as Report;
    expect(report.stopReason).toBe('error');
    expect(report.estimatedError).toBeLessThanOrEqual(0.01);
    // The diagonal is about 1.43: the percentage below is the same error.
    const diagonal = (await openDocument(readFileSync(input))).summary.diagonal;
    const relative = await decimesh(input, '-o', at('b.glb'), '-e', `${1 / diagonal}%`, '--json');
    expect((JSON.parse(relative.stdout) as Report).output.triangles).toBe(report.output.triangles);
  });

  it('says which of several targets stopped it', async () => {
    const { input } = workspace();
    const stopReason = async (...args: string[]): Promise<string | null> =>
      (JSON.parse((await decimesh(input, '--json', ...args)).stdout) as Report).stopReason;
    expect(await stopReason('-r', '0.5', '-e', '50%')).toBe('target');
    expect(await stopReason('-r', '0', '-e', '0.1%')).toBe('error');
    // One triangle always stays.
    expect(await stopReason('-t', '0')).toBe('constraints');
  });

  it('says what blocks the edges that are left', async () => {
    const { at, input } = workspace();
    const { stdout } = await decimesh(input, '-t', '0', '--lock-border', '--json');
    const { stopReason, blockers, output } = JSON.parse(stdout) as Report;
    expect(stopReason).toBe('constraints');
    // Edges of a disc with as many border edges as the plate had.
    const edges = (3 * output.triangles + 4 * SIZE) / 2;
    expect(Object.values(blockers ?? {}).reduce<number>((sum, count) => sum + (count as number), 0)).toBe(edges);
    expect(blockers?.locked).toBeGreaterThan(edges / 2);
    const told = await decimesh(input, '-t', '0', '--lock-border', '-o', at('out.glb'));
    expect(told.stdout).toMatch(/no fewer without damage \(.*of the remaining edges are locked\)/);
  });

  it('works by the preset', async () => {
    const { input } = workspace();
    const rms = async (...args: string[]): Promise<number> => {
      const { code, stdout, stderr } = await decimesh(input, '-r', '0.1', '--measure', '--json', ...args);
      expect({ code, stderr }).toEqual({ code: 0, stderr: '' });
      const { warnings, deviation } = JSON.parse(stdout) as Report;
      expect(warnings).toEqual([]);
      return deviation!.rms;
    };
    const [fast, balanced, best] = [await rms('--preset', 'fast'), await rms('--preset', 'balanced'), await rms('--preset', 'best')];
    expect(best).toBeLessThan(balanced);
    expect(balanced).toBeLessThan(fast);
    expect(await rms()).toBe(balanced);
  });

  it('stops when the time budget is spent, with a whole file, and says so', async () => {
    const { at, input } = workspace();
    const { code, stdout, stderr } = await decimesh(input, '-o', at('out.glb'), '-r', '0.1', '--time-budget', '0');
    expect({ code, stderr }).toEqual({ code: 0, stderr: '' });
    expect(stdout).toMatch(/triangles, the time budget was spent, /);
    await expectGlb(at('out.glb'), TRIANGLES);
    const enough = await decimesh(input, '-r', '0.1', '--time-budget', '600000', '--json');
    expect((JSON.parse(enough.stdout) as Report).stopReason).toBe('target');
    const none = await decimesh(input, '-r', '0.1', '--time-budget', '0', '--json');
    expect(JSON.parse(none.stdout)).toMatchObject({ stopReason: 'time', output: { triangles: TRIANGLES }, estimatedError: 0 });
  });

  it('keeps border vertices with --lock-border and positions with --placement subset', async () => {
    const { at, input } = workspace();
    const locked = await decimesh(input, '-o', at('a.glb'), '-t', '1', '--lock-border', '--json');
    // Every one of the 4 × 20 border edges keeps a triangle.
    expect((JSON.parse(locked.stdout) as Report).output.vertices).toBeGreaterThanOrEqual(4 * SIZE);
    await decimesh(input, '-o', at('b.glb'), '-r', '0.3', '--placement', 'subset');
    const { wedgeSets } = await (await openDocument(readFileSync(at('b.glb')))).geometry();
    const original = new Set(positionsOf(hills(SIZE).positions));
    const kept = positionsOf(wedgeSets[0]!.positions);
    expect(kept.filter((position) => !original.has(position))).toEqual([]);
  });

  it('finds the files of a .gltf beside it, with percent signs and folders in their names', async () => {
    const { at } = workspace();
    const { json, binary } = gltfOf(hills(SIZE));
    json.buffers[0]!.uri = 'data%20files/a%23b.bin';
    mkdirSync(at('data files'));
    writeFileSync(at('data files/a#b.bin'), binary);
    writeFileSync(at('in.gltf'), JSON.stringify(json));
    expect(await decimesh(at('in.gltf'), '-o', at('out.glb'), '-r', '0.5')).toMatchObject({ code: 0, stderr: '' });
    await expectGlb(at('out.glb'), TRIANGLES / 2);
  });

  it('reads no file outside of the folder of a .gltf', async () => {
    const { at } = workspace();
    const { json, binary } = gltfOf(hills(SIZE));
    mkdirSync(at('sub'));
    writeFileSync(at('outside.bin'), binary);
    for (const uri of ['../outside.bin', 'x/../../outside.bin', '%2e%2e/outside.bin', '..\\outside.bin', at('outside.bin'), `file://${at('outside.bin')}`]) {
      json.buffers[0]!.uri = uri;
      writeFileSync(at('sub/in.gltf'), JSON.stringify(json));
      const result = await decimesh(at('sub/in.gltf'), '-o', at('out.glb'), '-r', '0.5');
      expect({ uri, ...result }).toMatchObject({ uri, code: 3, stderr: expect.stringMatching(/^missing-resource: /) });
    }
  });
});

function positionsOf(values: Float32Array): string[] {
  return Array.from({ length: values.length / 3 }, (_, vertex) => values.subarray(3 * vertex, 3 * vertex + 3).join());
}

describe('many files', () => {
  it('writes them into a new directory, goes on after a bad one and returns its code', async () => {
    const { at, input } = workspace();
    writeFileSync(at('bad.glb'), 'no');
    writeFileSync(at('third.obj'), objOf(hills(SIZE)));
    const result = await decimesh(input, at('bad.glb'), at('third.obj'), '-d', at('new/dir'), '-r', '0.5', '--json');
    expect(result.code).toBe(3);
    expect(result.stderr).toMatch(/^unknown-format: .*bad\.glb: .*\n$/);
    expect(readdirSync(at('new/dir')).sort()).toEqual(['in.glb', 'third.obj']);
    const reports = JSON.parse(result.stdout) as unknown[];
    expect(reports).toHaveLength(3);
    expect(reports[1]).toMatchObject({ input: { path: at('bad.glb') }, error: { code: 'unknown-format' } });
    await expectGlb(at('new/dir/in.glb'), TRIANGLES / 2);
  });

  it('refuses two inputs that would be written to one file', async () => {
    const { at, input } = workspace();
    const result = await decimesh(input, at('other/in.glb'), '-d', at('out'), '-r', '0.5');
    expect(result).toMatchObject({ code: 2, stderr: expect.stringMatching(/^usage: -d: .*same file/) });
  });
});

describe('wrong usage', () => {
  const cases: Array<[title: string, args: string[], place: string]> = [
    ['no input', ['-r', '0.5'], 'INPUT'],
    ['no target', ['in.glb', '-o', 'out.glb'], 'options'],
    ['no output', ['in.glb', '-r', '0.5'], '-o'],
    ['a ratio above 1', ['in.glb', '-o', 'out.glb', '-r', '1.5'], '--ratio'],
    ['a ratio that is no number', ['in.glb', '-o', 'out.glb', '-r', ''], '--ratio'],
    ['a broken triangle count', ['in.glb', '-o', 'out.glb', '-t', '10.5'], '--triangles'],
    ['a negative error', ['in.glb', '-o', 'out.glb', '--error=-1'], '--error'],
    ['an error in a unknown unit', ['in.glb', '-o', 'out.glb', '-e', '3mm'], '--error'],
    ['an unknown option', ['in.glb', '-o', 'out.glb', '-r', '0.5', '--fast'], 'arguments'],
    ['an unknown placement', ['in.glb', '-o', 'out.glb', '-r', '0.5', '--placement', 'best'], '--placement'],
    ['an unknown weight', ['in.glb', '-o', 'out.glb', '-r', '0.5', '--attribute-weights', 'uv=1,uw=2'], '--attribute-weights'],
    ['a broken weight', ['in.glb', '-o', 'out.glb', '-r', '0.5', '--attribute-weights', 'uv=much'], '--attribute-weights'],
    ['an unknown preset', ['in.glb', '-o', 'out.glb', '-r', '0.5', '--preset', 'turbo'], '--preset'],
    ['a broken time budget', ['in.glb', '-o', 'out.glb', '-r', '0.5', '--time-budget', '1s'], '--time-budget'],
    ['a time budget alone', ['in.glb', '-o', 'out.glb', '--time-budget', '100'], 'options'],
    ['an unknown output format', ['in.glb', '-o', 'out.fbx', '-r', '0.5'], '-o'],
    ['both -o and -d', ['in.glb', '-o', 'out.glb', '-d', 'dir', '-r', '0.5'], '-o, -d'],
    ['several inputs for one output', ['in.glb', 'b.glb', '-o', 'out.glb', '-r', '0.5'], '-o'],
    ['--lods', ['in.glb', '-o', 'out.glb', '-r', '0.5', '--lods', '0.5,0.25'], '--lods'],
    ['--compress zip', ['in.glb', '-o', 'out.glb', '-r', '0.5', '--compress', 'zip'], '--compress'],
  ];
  it.each(cases)('%s: exit code 2 and one line that names the argument', async (_, args, place) => {
    const result = await decimesh(...args);
    expect(result).toMatchObject({ code: 2, stdout: '' });
    expect(result.stderr.split('\n')).toEqual([expect.stringContaining(`usage: ${place}: `), '']);
  });

  it('never writes over its input, under whatever name', async () => {
    const { at, input } = workspace();
    symlinkSync(input, at('link.glb'));
    for (const output of [input, at('link.glb')]) {
      const result = await decimesh(input, '-o', output, '-r', '0.5');
      expect(result).toMatchObject({ code: 2, stderr: expect.stringMatching(/^usage: -o: .*is an input/) });
    }
    expect(new Uint8Array(readFileSync(input))).toEqual(model());
  });
});

describe('help', () => {
  it('names every option of the contract on standard output', async () => {
    const { code, stdout, stderr } = await decimesh('--help');
    expect({ code, stderr }).toEqual({ code: 0, stderr: '' });
    const options = [
      'ratio', 'triangles', 'error', 'max-deviation', 'size', 'lods', 'placement', 'attribute-weights', 'preset', 'time-budget', 'memory-limit', 'lock-border',
      'prune', 'merge-distance', 'weight-attribute', 'weight-scale', 'compress', 'quantize', 'prepare', 'texture-size', 'texture-format', 'texture-quality',
      'output', 'directory', 'measure', 'json', 'version',
    ];
    for (const option of options) expect(stdout).toContain(`--${option}`);
  });

  it('prints the version of package.json', async () => {
    const { version } = JSON.parse(readFileSync(new URL('../package.json', import.meta.url), 'utf8')) as { version: string };
    expect(await decimesh('--version')).toEqual({ code: 0, stdout: `${version}\n`, stderr: '' });
  });

});

describe('bad files', () => {
  it.each(INVALID_FILES)('$name: exit code 3, one line with $code and the place, no output', async ({ name, bytes, code, place }) => {
    const directory = temporaryDirectory();
    const input = join(directory, name);
    writeFileSync(input, bytes);
    const result = await decimesh(input, '-o', join(directory, 'out.glb'), '-r', '0.5');
    expect(result).toMatchObject({ code: 3, stdout: '' });
    expect(result.stderr).toMatch(/^[^\n]+\n$/);
    expect(result.stderr.startsWith(`${code}: ${directory}`), result.stderr).toBe(true);
    expect(result.stderr).toMatch(place);
    expect(readdirSync(directory)).toEqual([name]);
  });

  it('keeps to a limit of memory', async () => {
    const { at, input } = workspace();
    const refused = await decimesh(input, '-o', at('out.glb'), '-r', '0.5', '--memory-limit', '1k');
    expect([refused.code, refused.stderr]).toEqual([3, expect.stringMatching(/^too-large: /)]);
    expect((await decimesh(input, '-o', at('out.glb'), '-r', '0.5', '--memory-limit', '500MB')).code).toBe(0);
    expect((await decimesh(input, '-o', at('out.glb'), '-r', '0.5', '--memory-limit', 'much')).code).toBe(2);
  });

  it.each(WITHOUT_TRIANGLES)('$name goes through with a warning, as a glTF alone', async ({ name, bytes }) => {
    const directory = temporaryDirectory();
    const input = join(directory, name);
    writeFileSync(input, bytes);
    for (const output of ['out.glb', 'out.gltf']) {
      for (const target of [['-r', '0.5', '--measure', '--compress', 'meshopt', '--quantize'], ['--size', '100k'], ['-t', '0', '--compress', 'draco']]) {
        const { code, stdout, stderr } = await decimesh(input, '-o', join(directory, output), '--json', ...target);
        expect([code, stderr], `${output} ${target.join(' ')}`).toEqual([0, expect.stringMatching(/^warning: no-triangles: [^\n]+\n$/)]);
        expect(JSON.parse(stdout)).toMatchObject({ stopReason: 'target', output: { triangles: 0 }, estimatedError: 0 });
      }
    }
    expect(await gltfErrors(readFileSync(join(directory, 'out.glb')))).toEqual([]);
    expect((await decimesh(input, '-o', join(directory, 'chain.glb'), '--lods', '1,0.5')).code).toBe(0);
    expect(JSON.stringify(glbTree(readFileSync(join(directory, 'chain.glb'))))).not.toContain('MSFT_lod');
    const refused = await decimesh(input, '-o', join(directory, 'out.obj'), '-r', '0.5');
    expect([refused.code, refused.stderr]).toEqual([3, expect.stringContaining('no-triangles: ')]);
    expect(readdirSync(directory)).not.toContain('out.obj');
  });

  it('has no control characters of the file in the message', async () => {
    const { at } = workspace();
    writeFileSync(at('red.obj'), 'v 0 0 0\nv \u001b[31mred 0 0\nv 0 1 0\nf 1 2 3\n');
    const { code, stderr } = await decimesh(at('red.obj'), '-o', at('out.glb'), '-r', '0.5');
    expect(code).toBe(3);
    expect([...stderr.trimEnd()].filter((character) => character < ' ')).toEqual([]);
  });

  it('leaves an existing output as it is', async () => {
    const { at } = workspace();
    writeFileSync(at('bad.glb'), 'no');
    writeFileSync(at('out.glb'), 'precious');
    expect(await decimesh(at('bad.glb'), '-o', at('out.glb'), '-r', '0.5')).toMatchObject({ code: 3 });
    expect(readFileSync(at('out.glb'), 'utf8')).toBe('precious');
    expect(readdirSync(at('.')).sort()).toEqual(['bad.glb', 'in.glb', 'out.glb']);
  });

  it('names a file that is not there', async () => {
    const result = await decimesh('nowhere.glb', '-o', 'out.glb', '-r', '0.5');
    expect(result).toEqual({ code: 3, stdout: '', stderr: 'cannot-read: nowhere.glb: there is no such file or directory\n' });
  });
});

describe('output that cannot be written', () => {
  it('exits with 4 and leaves nothing behind', async () => {
    const { at, input } = workspace();
    mkdirSync(at('dir.glb'));
    for (const output of [at('nowhere/out.glb'), at('dir.glb'), join(input, 'out.glb')]) {
      const result = await decimesh(input, '-o', output, '-r', '0.5');
      expect({ output, ...result }).toMatchObject({ output, code: 4, stdout: '', stderr: expect.stringMatching(/^cannot-write: [^\n]+\n$/) });
    }
    expect(readdirSync(at('.')).sort()).toEqual(['dir.glb', 'in.glb']);
  });

  it('replaces an existing file whole, through a link, with its mode', async () => {
    const { at, input } = workspace();
    writeFileSync(at('real.glb'), 'old');
    chmodSync(at('real.glb'), 0o640);
    symlinkSync('real.glb', at('link.glb'));
    expect(await decimesh(input, '-o', at('link.glb'), '-r', '0.5')).toMatchObject({ code: 0 });
    await expectGlb(at('real.glb'), TRIANGLES / 2);
    expect(statSync(at('real.glb')).mode & 0o777).toBe(0o640);
    expect(readdirSync(at('.')).sort()).toEqual(['in.glb', 'link.glb', 'real.glb']);
  });
});

describe('real models', () => {
  const models = [
    ['gltf/hand-left.glb', 2314],
    ['gltf/oculus-touch-right.glb', 12623],
    ['gltf/FlightHelmet/FlightHelmet.gltf', 94722],
    ['gltf/TeapotsGalore/TeapotsGalore.gltf', 4034],
  ] as const;
  for (const [name, triangles] of models) {
    testWithAsset(name, `${name} to a quarter, without an error of the validator`, async (path) => {
      const output = join(temporaryDirectory(), 'out.glb');
      const result = await decimesh(path, '-o', output, '-r', '0.25', '--json');
      expect(result.code).toBe(0);
      expect((JSON.parse(result.stdout) as Report).input.triangles).toBe(triangles);
      await expectGlb(output, triangles / 4);
    });
  }
});
