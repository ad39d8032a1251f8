// A plugin for Vite that tells the service worker which files the build has made.

import { createHash } from 'node:crypto';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { partOf } from './page-budget.mjs';

const WORKER = 'service-worker.js';

/** Compiled files that are kept at the first visit, by their part of the page; the others are kept later or when used. */
const CORE = ['shell', 'app'];

/** Of the samples, which are small. */
const PICTURE = /\.webp$/;

/** Puts `BUILD` at the head of the service worker; `publicDirectory` has the files that are copied as they are. */
export function precache(publicDirectory) {
  return {
    name: 'decimesh-precache',
    enforce: 'post',
    apply: 'build',
    generateBundle(_options, bundle) {
      const worker = bundle[WORKER];
      if (worker === undefined) this.error(`the build made no ${WORKER}`);
      const names = Object.keys(bundle).filter((name) => name !== WORKER);
      const content = (name) => ('code' in bundle[name] ? bundle[name].code : bundle[name].source);
      const copied = listFiles(publicDirectory);
      const hash = createHash('sha256');
      for (const name of [...names].sort()) hash.update(name).update(content(name));
      for (const name of copied) hash.update(name).update(readFileSync(join(publicDirectory, name)));
      hash.update(worker.code);
      const address = (name) => `./${name}`;
      const core = [...names.filter((name) => CORE.includes(partOf(name))), ...copied].map(address);
      const more = names.filter((name) => partOf(name) === 'on demand' || PICTURE.test(name)).map(address);
      worker.code = `const BUILD=${JSON.stringify({ version: hash.digest('hex').slice(0, 16), core, more })};\n${worker.code}`;
    },
  };
}

function listFiles(directory) {
  if (!existsSync(directory)) return [];
  return readdirSync(directory, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath ?? entry.path, entry.name).slice(directory.length).replaceAll('\\', '/').replace(/^\//, ''))
    .sort();
}
