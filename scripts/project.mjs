// What every script shares: where things are, how a process is run, and how a script stops with one sentence.
//
// Only `node:` modules may be imported here and by the scripts' first lines: they run before node_modules exists.

import { spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, readdirSync, readFileSync, statSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

/** The repository's root. */
export const root = resolve(dirname(fileURLToPath(import.meta.url)), '..');

/** A path inside the repository. */
export const at = (...parts) => join(root, ...parts);

/** A reason to stop that is the user's to mend: shown as its one sentence, without a stack. */
export class Stop extends Error {}

/** Runs a script's body; a Stop ends it with its sentence and exit code 1, any other error with its stack. */
export async function main(body) {
  try {
    await body();
  } catch (error) {
    console.error(error instanceof Stop ? error.message : error);
    process.exitCode = 1;
  }
}

/** Whether `url` (a module's import.meta.url) is the script that Node was started with. */
export const isMain = (url) => process.argv[1] !== undefined && resolve(process.argv[1]) === fileURLToPath(url);

// Groups of processes that are running; stopped together with the script, so that no browser outlives it.
const running = new Set();
function stopAll(signal) {
  for (const child of running) stopGroup(child);
  process.exit(signal === 'SIGINT' ? 130 : 143);
}

function stopGroup(child, signal = 'SIGTERM') {
  try {
    // A negative id means the whole group: cargo, the tests it started and the browser's driver. The driver ends the
    // browser, which is in a group of its own, but only when it is asked politely.
    if (process.platform === 'win32') child.kill();
    else process.kill(-child.pid, signal);
  } catch {
    // It ended by itself in the meantime.
  }
}

/**
 * Runs a program to its end and resolves to `{ code, output, timedOut }`; never rejects.
 *
 * With `capture` standard output and error are gathered, in order, in `output`; without it they are shown as they
 * come. `timeout` is in seconds (default: none) and ends the program with everything it started. `code` is null when
 * it was ended by a signal and 127 when it could not be started.
 */
export function run(program, programArguments, { env = process.env, cwd = root, capture = false, timeout } = {}) {
  return new Promise((done) => {
    // A captured program gets a process group of its own so that it can be ended whole; one that shows its output
    // stays in the terminal's group, where Ctrl-C reaches it.
    const grouped = capture && process.platform !== 'win32';
    const child = spawn(program, programArguments, {
      env,
      cwd,
      detached: grouped,
      stdio: capture ? ['ignore', 'pipe', 'pipe'] : 'inherit',
    });
    let output = '';
    let timedOut = false;
    let timer;
    if (grouped) {
      if (running.size === 0) for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, stopAll);
      running.add(child);
    }
    if (timeout !== undefined) {
      timer = setTimeout(() => {
        timedOut = true;
        stopGroup(child);
        timer = setTimeout(() => {
          stopGroup(child, 'SIGKILL');
          end(null); // whatever still holds the pipes open is not waited for
        }, 5000);
      }, timeout * 1000);
    }
    const end = (code) => {
      clearTimeout(timer);
      if (running.delete(child) && running.size === 0) {
        for (const signal of ['SIGINT', 'SIGTERM']) process.off(signal, stopAll);
      }
      done({ code, output, timedOut });
    };
    if (capture) {
      for (const stream of [child.stdout, child.stderr]) {
        stream.setEncoding('utf8');
        stream.on('data', (text) => (output += text));
      }
    }
    child.on('error', (error) => {
      output += `${error.message}\n`;
      end(127);
    });
    child.on('close', end);
  });
}

/** The first of `names` that is a program in the directories of `path`, or undefined. */
export function findProgram(names, path = process.env.PATH ?? '') {
  const windows = process.platform === 'win32';
  for (const name of names) {
    for (const directory of path.split(windows ? ';' : ':')) {
      const candidate = join(directory, windows ? `${name}.exe` : name);
      if (directory !== '' && isProgram(candidate)) return candidate;
    }
  }
  return undefined;
}

/** Whether `path` is a file that may be run. */
export function isProgram(path) {
  const found = statSync(path, { throwIfNoEntry: false });
  return found !== undefined && found.isFile() && (process.platform === 'win32' || (found.mode & 0o111) !== 0);
}

/** All files at or below the given paths of the repository, sorted; missing ones are left out. */
function filesBelow(paths) {
  const files = [];
  const visit = (path) => {
    const found = statSync(at(path), { throwIfNoEntry: false });
    if (found === undefined) return;
    if (!found.isDirectory()) return void files.push(path);
    for (const name of readdirSync(at(path))) visit(`${path}/${name}`);
  };
  paths.forEach(visit);
  return files.sort();
}

/**
 * A hash over the names and contents of all files at or below `paths`, and over `extra`.
 *
 * Contents and not times, so that a checkout or a restored cache does not build anything again.
 */
export function hashFiles(paths, extra = '') {
  const hash = createHash('sha256').update(extra);
  for (const file of filesBelow(paths)) {
    const content = readFileSync(at(file));
    hash.update(`\0${file}\0${content.length}\0`).update(content);
  }
  return hash.digest('hex');
}

/** The text of a file of the repository, or undefined when it is absent. */
export const readIfThere = (path) => (existsSync(path) ? readFileSync(path, 'utf8') : undefined);

/** Seconds since `start` (a performance.now()), for people. */
export const secondsSince = (start) => `${((performance.now() - start) / 1000).toFixed(1)} s`;
