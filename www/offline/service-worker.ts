// The page without a network: keeps the build's files, answers from them, and takes files that other programs share.
//
// A new build is kept beside the old one and takes over when the page says so or when no page of the old one is left.

/** Put in by the build: what the page needs to open and simplify a model, and what it may need besides. */
declare const BUILD: { readonly version: string; readonly core: readonly string[]; readonly more: readonly string[] };

declare const self: ServiceWorkerGlobalScope;

const PREFIX = 'decimesh-build-';
const CACHE = PREFIX + BUILD.version;
/** Files on their way from another program to the page. */
const SHARED = 'decimesh-shared';
/** Files of the build: their content is in their names, so that what is kept under one never changes. */
const ASSETS = new URL('./assets/', self.registration.scope).href;
/** The rest of what is kept. */
const KNOWN = new Set(BUILD.core.map((path) => new URL(path, self.registration.scope).href));
const START = new URL('./index.html', self.registration.scope).href;
/** Bytes of shared files beyond which they are refused: they pass through storage. */
const SHARED_LIMIT = 2 ** 30;

self.addEventListener('install', (event) => {
  // Past the browser's cache for index.html alone: the other files have their content in their names.
  const requests = BUILD.core.map((path) => new Request(path, path === './index.html' ? { cache: 'reload' } : {}));
  event.waitUntil(caches.open(CACHE).then((cache) => cache.addAll(requests)));
});

self.addEventListener('activate', (event) => {
  event.waitUntil(takeOver());
});

self.addEventListener('message', (event) => {
  if (event.data === 'take-over') void self.skipWaiting();
  // Codecs and what else a file may need, fetched when the page has nothing better to do.
  if (event.data === 'keep-more') event.waitUntil(keepMore());
});

self.addEventListener('fetch', (event) => {
  const { request } = event;
  const url = new URL(request.url);
  if (url.origin !== self.location.origin) return;
  if (isPage(url)) {
    if (request.method === 'POST' && url.searchParams.has('share')) event.respondWith(receive(request));
    else if (request.method === 'GET' && request.mode === 'navigate') event.respondWith(answer(START, request));
    return;
  }
  url.search = '';
  if (request.method === 'GET' && (url.href.startsWith(ASSETS) || KNOWN.has(url.href))) event.respondWith(answer(url.href, request));
});

/** Whether `url` is that of the page itself, with whatever parameters. */
function isPage(url: URL): boolean {
  const scope = new URL(self.registration.scope);
  return url.pathname === scope.pathname || url.pathname === new URL(START).pathname;
}

async function takeOver(): Promise<void> {
  const names = await caches.keys();
  await Promise.all(names.filter((name) => name.startsWith(PREFIX) && name !== CACHE).map((name) => caches.delete(name)));
  await self.clients.claim();
}

async function keepMore(): Promise<void> {
  const cache = await caches.open(CACHE);
  for (const path of BUILD.more) {
    try {
      if ((await cache.match(path)) === undefined) await cache.add(path);
    } catch {
      // The network has gone, or the disk is full: these files are fetched when they are needed.
      return;
    }
  }
}

/** The file kept under `key`; else from the network, and kept if it can be. */
async function answer(key: string, request: Request): Promise<Response> {
  const cache = await caches.open(CACHE);
  const kept = await cache.match(key);
  if (kept !== undefined) return kept;
  const response = await fetch(request);
  if (response.status === 200) await cache.put(key, response.clone()).catch(() => {});
  return response;
}

/** Puts shared files where the page finds them and sends the browser there. */
async function receive(request: Request): Promise<Response> {
  const form = await request.formData();
  const files = form.getAll('model').filter((value) => value instanceof File);
  const bytes = files.reduce((sum, { size }) => sum + size, 0);
  const cache = await caches.open(SHARED);
  if (bytes <= SHARED_LIMIT) {
    await Promise.all(files.map((file, index) => cache.put(`./shared/${index}`, new Response(file, { headers: { 'X-Name': encodeURIComponent(file.name) } }))));
  }
  return Response.redirect('./?shared', 303);
}
