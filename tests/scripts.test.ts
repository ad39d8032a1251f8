// The scripts' own decisions: what counts as a failure, which files are served, where tools are kept.
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { request } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { stagesFrom } from '../scripts/build.mjs';
import { compact, countCargo, countVitest, judge, none } from '../scripts/counts.mjs';
import { run } from '../scripts/project.mjs';
import { portFrom, serve } from '../scripts/serve.mjs';
import { cacheDirectory, wasmBindgenVersion } from '../scripts/setup.mjs';

const summary = (passed: number, failed: number, ignored: number): string =>
  `test result: ${failed > 0 ? 'FAILED' : 'ok'}. ${passed} passed; ${failed} failed; ${ignored} ignored; 0 measured; 0 filtered out\n`;

describe('counting', () => {
  it('adds up the test programs of one cargo run', () => {
    expect(countCargo(`${summary(3, 0, 1)}noise\n${summary(2, 1, 0)}`)).toEqual({ passed: 5, failed: 1, skipped: 1 });
  });

  it('moves tests that say they were skipped', () => {
    expect(countCargo(`---- a stdout ----\nskipped: no bunny\n\n${summary(3, 0, 1)}`)).toEqual({ passed: 2, failed: 0, skipped: 2 });
  });

  it('counts a test file that does not load as failed', () => {
    const report = {
      numPassedTests: 2, numFailedTests: 1, numPendingTests: 1, numTodoTests: 1,
      testResults: [
        { status: 'failed', assertionResults: [] },
        { status: 'failed', assertionResults: [{ status: 'failed' }] },
        { status: 'passed', assertionResults: [{ status: 'passed' }] },
      ],
    };
    expect(countVitest(JSON.stringify(report))).toEqual({ passed: 2, failed: 2, skipped: 2 });
  });

  it('counts nothing where no report was written', () => {
    expect(countVitest(undefined)).toEqual(none);
  });
});

describe('what a failed run shows', () => {
  it('is what failed', () => {
    const output = `   Compiling a v1.0.0\ntest a ... ok\ntest b ... FAILED\n\nsuccesses:\n\n---- a stdout ----\nnote\n\n\nsuccesses:\n    a\n\n${summary(1, 1, 0)}`;
    expect(compact(output)).toBe(`test b ... FAILED\n\nsuccesses:\n\n---- a stdout ----\nnote\n\n${summary(1, 1, 0).trim()}`);
  });
});

describe('judging', () => {
  const fine = { code: 0, output: '', timedOut: false };
  const some = { passed: 3, failed: 0, skipped: 0 };

  it('leaves good counts alone', () => {
    expect(judge(fine, some)).toEqual({ counts: some });
  });

  it.each([
    ['a crash after passing tests', { ...fine, code: 101 }, some],
    ['a signal', { ...fine, code: null }, some],
    ['a timeout', { ...fine, code: null, timedOut: true }, some],
    ['no tests at all', fine, none],
  ])('makes %s a failure', (_, result, counts) => {
    const judged = judge(result, counts);
    expect(judged.counts.failed).toBe(1);
    expect(judged.reason).toMatch(/\.$/);
  });

  it('does not count a failure twice', () => {
    expect(judge({ ...fine, code: 1 }, { passed: 3, failed: 2, skipped: 0 }).counts.failed).toBe(2);
  });
});

describe('running', () => {
  const node = (script: string, timeout?: number) => run(process.execPath, ['-e', script], { capture: true, ...(timeout && { timeout }) });

  it('gives the exit code and what was printed on both streams', async () => {
    const { code, output } = await node('console.log(1); console.error(2); process.exitCode = 3');
    expect({ code, lines: output.split('\n').sort() }).toEqual({ code: 3, lines: ['', '1', '2'] });
  });

  it('ends a program that hangs, with what it started', async () => {
    const start = performance.now();
    const nested = `require('child_process').spawn(process.execPath, ['-e', 'setInterval(() => {}, 1000)'], { stdio: 'inherit' })`;
    expect(await node(nested, 0.5)).toMatchObject({ timedOut: true });
    expect(performance.now() - start).toBeLessThan(4500);
  });

  it('reports a program that does not exist', async () => {
    expect((await run('no-such-program', [], { capture: true })).code).toBe(127);
  });
});

describe('set-up', () => {
  it('reads the version of wasm-bindgen and of nothing that begins alike', () => {
    const lock = '[[package]]\nname = "wasm-bindgen-macro"\nversion = "9.9.9"\n\n[[package]]\nname = "wasm-bindgen"\nversion = "0.2.130"\n';
    expect(wasmBindgenVersion(lock)).toBe('0.2.130');
    expect(() => wasmBindgenVersion('')).toThrow(/Cargo\.lock/);
  });

  it('keeps tools where the platform keeps caches', () => {
    expect(cacheDirectory('linux', {}, '/home/a')).toBe('/home/a/.cache/decimesh');
    expect(cacheDirectory('linux', { XDG_CACHE_HOME: '/c' }, '/home/a')).toBe('/c/decimesh');
    expect(cacheDirectory('darwin', {}, '/Users/a')).toBe('/Users/a/Library/Caches/decimesh');
  });

  it('knows the stages that are asked for', () => {
    expect([[], ['--no-page'], ['--wasm-only']].map(stagesFrom)).toEqual([['wasm', 'js', 'page'], ['wasm', 'js'], ['wasm']]);
  });
});

describe('serving', () => {
  const parent = mkdtempSync(join(tmpdir(), 'decimesh-serve-'));
  const site = join(parent, 'site');
  let server: Awaited<ReturnType<typeof serve>>;
  beforeAll(async () => {
    mkdirSync(site);
    writeFileSync(join(parent, 'secret.txt'), 'secret');
    writeFileSync(join(site, 'index.html'), '<title>page</title>');
    writeFileSync(join(site, 'a.wasm'), '\0asm');
    server = await serve(site, 0);
  });
  afterAll(async () => {
    await server.close();
    rmSync(parent, { recursive: true });
  });

  // fetch() would tidy the path up before sending it.
  const get = (path: string, method = 'GET'): Promise<{ status: number | undefined; headers: NodeJS.Dict<string | string[]> }> =>
    new Promise((done, failed) => {
      request({ host: '127.0.0.1', port: server.port, path, method }, (response) => {
        response.resume().on('end', () => done({ status: response.statusCode, headers: response.headers }));
      }).on('error', failed).end();
    });

  it('isolates the page and names the types', async () => {
    const { status, headers } = await get('/a.wasm?x');
    expect(status).toBe(200);
    expect(headers).toMatchObject({
      'content-type': 'application/wasm',
      'cross-origin-opener-policy': 'same-origin',
      'cross-origin-embedder-policy': 'require-corp',
    });
    expect((await get('/')).headers['content-type']).toMatch(/^text\/html/);
  });

  it.each(['/../secret.txt', '/%2e%2e/secret.txt', '/..%2fsecret.txt', '/%00', '/%zz', '/absent', '/index.html/'])(
    'serves nothing for %s',
    async (path) => expect((await get(path)).status).toBe(404),
  );

  it('only reads', async () => {
    expect((await get('/', 'POST')).status).toBe(405);
  });

  it('says in one sentence that the port is taken', async () => {
    await expect(serve(site, server.port)).rejects.toThrow(new RegExp(`^Port ${server.port} is taken: set PORT`));
  });

  it('takes only numbers that are ports', () => {
    expect([undefined, '', '0', '8080'].map(portFrom)).toEqual([5173, 5173, 0, 8080]);
    for (const wrong of ['abc', '-1', '80000', '1.5', ' 1']) expect(() => portFrom(wrong)).toThrow(/no port/);
  });
});
