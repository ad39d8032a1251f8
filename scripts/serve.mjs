// A small static server for a built page, used by `npm start` and by the page tests.
//
//     node scripts/serve.mjs [DIRECTORY] [PORT]

import { createReadStream, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, resolve, sep } from 'node:path';
import { pipeline } from 'node:stream';
import { Stop, at, isMain, main } from './project.mjs';

const TYPES = {
  '.css': 'text/css; charset=utf-8',
  '.glb': 'model/gltf-binary',
  '.gltf': 'model/gltf+json',
  '.gz': 'application/gzip',
  '.hdr': 'image/vnd.radiance',
  '.html': 'text/html; charset=utf-8',
  '.ico': 'image/x-icon',
  '.jpg': 'image/jpeg',
  '.js': 'text/javascript; charset=utf-8',
  '.json': 'application/json; charset=utf-8',
  '.map': 'application/json; charset=utf-8',
  '.mjs': 'text/javascript; charset=utf-8',
  '.mtl': 'model/mtl',
  '.obj': 'model/obj',
  '.ply': 'model/ply',
  '.png': 'image/png',
  '.stl': 'model/stl',
  '.svg': 'image/svg+xml',
  '.txt': 'text/plain; charset=utf-8',
  '.wasm': 'application/wasm',
  '.webmanifest': 'application/manifest+json',
  '.webp': 'image/webp',
  '.woff2': 'font/woff2',
};

const HEADERS = {
  // Threads and precise timers need a cross-origin isolated page; vite.config.ts sends the same two.
  'Cross-Origin-Opener-Policy': 'same-origin',
  'Cross-Origin-Embedder-Policy': 'require-corp',
  'Cross-Origin-Resource-Policy': 'same-origin',
  'X-Content-Type-Options': 'nosniff',
  // A rebuilt page has to show at the next reload.
  'Cache-Control': 'no-cache',
};

/**
 * Serves the files of `directory` on 127.0.0.1; resolves to `{ port, url, close }` once it listens.
 *
 * `port` 0 takes any free one. A port that is taken or not allowed is a Stop.
 */
export function serve(directory, port) {
  const server = createServer((request, response) => answer(resolve(directory), request, response));
  return new Promise((done, failed) => {
    server.once('error', (error) => {
      const reason = { EADDRINUSE: 'is taken', EACCES: 'is not allowed for this user' }[error.code] ?? `cannot be used (${error.message})`;
      failed(new Stop(`Port ${port} ${reason}: set PORT to another one, as in \`PORT=5174 npm start\`.`));
    });
    server.listen(port, '127.0.0.1', () => {
      const actual = server.address().port;
      const close = () => new Promise((closed) => {
        server.close(closed);
        server.closeAllConnections();
      });
      done({ port: actual, url: `http://localhost:${actual}/`, close });
    });
  });
}

function answer(directory, request, response) {
  const refuse = (status, text) => {
    response.writeHead(status, { ...HEADERS, 'Content-Type': TYPES['.txt'], ...(status === 405 && { Allow: 'GET, HEAD' }) });
    response.end(request.method === 'HEAD' ? undefined : `${text}\n`);
  };
  if (request.method !== 'GET' && request.method !== 'HEAD') return refuse(405, 'Only GET and HEAD are answered.');
  const file = findFile(directory, request.url);
  if (file === undefined) return refuse(404, 'There is no such file.');
  response.writeHead(200, {
    ...HEADERS,
    'Content-Type': TYPES[extname(file.path).toLowerCase()] ?? 'application/octet-stream',
    'Content-Length': file.size,
  });
  if (request.method === 'HEAD') return response.end();
  // A reader that goes away in the middle is no error of ours; pipeline closes the file.
  pipeline(createReadStream(file.path), response, () => {});
}

function findFile(directory, url) {
  try {
    const name = decodeURIComponent(new URL(url, 'http://localhost').pathname);
    const path = join(directory, name.endsWith('/') ? `${name}index.html` : name);
    if (!path.startsWith(directory + sep)) return undefined;
    const found = statSync(path);
    return found.isFile() ? { path, size: found.size } : undefined;
  } catch {
    return undefined; // malformed, absent, too long, or below a file: there is no such file
  }
}

/** The port that the text names, 5173 when it is absent; a Stop when it names none. */
export function portFrom(text) {
  if (text === undefined || text === '') return 5173;
  const port = Number(text);
  if (/^\d+$/.test(text) && port <= 65535) return port;
  throw new Stop(`PORT is "${text}", which is no port: give a number from 0 (any free one) to 65535.`);
}

if (isMain(import.meta.url)) {
  await main(async () => {
    const { url } = await serve(process.argv[2] ?? at('site'), portFrom(process.argv[3]));
    console.log(url);
  });
}
