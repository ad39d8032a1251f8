// Puts the ecosystem's codecs into the package: dist/codecs/vendor, loaded only when a file needs one.
//
// Copies and not dependencies, because a worker without a bundler knows no bare names, and because their .wasm has to
// lie beside the script, to be served from the same place with no other host asked.

import { copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Stop, at } from './project.mjs';

const from = (...parts) => {
  const path = at('node_modules', ...parts);
  if (!existsSync(path)) throw new Stop(`${parts[0]} lacks ${parts.slice(1).join('/')}: its version in package.json is another than scripts/vendor.mjs knows.`);
  return path;
};

// Emscripten's script for Node is CommonJS and asks where it is. As far as it can see it is nowhere: it then loads
// nothing by itself and takes the compiled module from its caller, the same way on Node, on a page and in a worker.
const HIDDEN = ['window', 'document', 'importScripts', 'process', '__filename', '__dirname', 'require', 'module', 'exports', 'define'];

function asModule(source, factory) {
  return `// Draco (https://github.com/google/draco), Apache License 2.0, made an ECMAScript module.\nexport default (function (${HIDDEN.join(', ')}) {\n${source}\nreturn ${factory};\n})();\n`;
}

const DRACO_TYPES = `/** Instantiates Draco; what it resolves to is typed by its user. */
export default function create(options: object): Promise<unknown>;
`;

const NOTICE = `This folder holds builds of other projects, unchanged but for the module format:

meshoptimizer (meshopt_*.js), MIT License: LICENSE-meshoptimizer.md
fflate (fflate.js), MIT License: LICENSE-fflate
Draco (draco_*), Copyright The Draco Authors, Apache License 2.0: LICENSE-APACHE in the package's root
`;

/** Fills dist/codecs/vendor from node_modules. */
export function vendor() {
  const target = at('dist', 'codecs', 'vendor');
  mkdirSync(target, { recursive: true });
  const copy = (source, name) => copyFileSync(from(...source), join(target, name));
  copy(['meshoptimizer', 'meshopt_decoder.mjs'], 'meshopt_decoder.js');
  copy(['meshoptimizer', 'meshopt_decoder.d.ts'], 'meshopt_decoder.d.ts');
  copy(['meshoptimizer', 'meshopt_encoder.js'], 'meshopt_encoder.js');
  copy(['meshoptimizer', 'meshopt_encoder.d.ts'], 'meshopt_encoder.d.ts');
  copy(['meshoptimizer', 'LICENSE.md'], 'LICENSE-meshoptimizer.md');
  copy(['fflate', 'esm', 'browser.js'], 'fflate.js');
  copy(['fflate', 'esm', 'browser.d.ts'], 'fflate.d.ts');
  copy(['fflate', 'LICENSE'], 'LICENSE-fflate');
  for (const [part, factory, wasm] of [
    ['decoder', 'DracoDecoderModule', 'draco_decoder_gltf.wasm'],
    ['encoder', 'DracoEncoderModule', 'draco_encoder.wasm'],
  ]) {
    const source = readFileSync(from('draco3dgltf', `draco_${part}_gltf_nodejs.js`), 'utf8');
    writeFileSync(join(target, `draco_${part}.js`), asModule(source, factory));
    writeFileSync(join(target, `draco_${part}.d.ts`), DRACO_TYPES);
    copy(['draco3dgltf', wasm], `draco_${part}.wasm`);
  }
  writeFileSync(join(target, 'NOTICE'), NOTICE);
}
