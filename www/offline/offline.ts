// The page's side of working offline: starts the service worker, tells of a new version, and takes shared files over.
import { whenIdle } from '../idle.ts';

/** Milliseconds between two looks for a new version while the page is open. */
const LOOK_INTERVAL = 3_600_000;
const SHARED = 'decimesh-shared';

/**
 * Has the page kept for use without a network, where the browser can do that.
 *
 * `onUpdate` is told when a new version is there, with what loads it; nothing changes until that is called.
 */
export async function keepOffline(onUpdate: (load: () => void) => void): Promise<void> {
  if (!('serviceWorker' in navigator)) return;
  const { serviceWorker } = navigator;
  const wasControlled = serviceWorker.controller !== null;
  // Private windows, managed browsers and privacy tools may forbid it, or answer nothing; the page works all the same.
  const registering: Promise<ServiceWorkerRegistration | undefined> = serviceWorker.register('./service-worker.js', { updateViaCache: 'none' });
  const registration = await registering.catch(() => undefined);
  if (registration === undefined) return;
  const offer = (): void => {
    const { waiting } = registration;
    // Without an older one in charge there is nothing to be updated.
    if (waiting === null || serviceWorker.controller === null) return;
    onUpdate(() => {
      serviceWorker.addEventListener('controllerchange', () => location.reload(), { once: true });
      waiting.postMessage('take-over');
    });
  };
  registration.addEventListener('updatefound', () => registration.installing?.addEventListener('statechange', offer));
  offer();
  setInterval(() => void registration.update().catch(() => {}), LOOK_INTERVAL);
  // Not while the first model may be loading.
  const keepMore = (): void => serviceWorker.controller?.postMessage('keep-more');
  if (wasControlled) whenIdle(keepMore);
  else serviceWorker.addEventListener('controllerchange', () => whenIdle(keepMore), { once: true });
}

/** Files that another program has shared with the page, which are taken out of their place; empty when there are none. */
export async function takeSharedFiles(): Promise<File[]> {
  if (!('caches' in globalThis)) return [];
  const cache = await caches.open(SHARED);
  const files = await Promise.all(
    (await cache.keys()).map(async (request) => {
      const response = await cache.match(request);
      const name = decodeURIComponent(response?.headers.get('X-Name') ?? 'model');
      return response === undefined ? [] : [new File([await response.blob()], name)];
    }),
  );
  await caches.delete(SHARED);
  return files.flat();
}

/** Files that the system opens with the installed page. */
export function onLaunchFiles(open: (files: File[]) => void): void {
  const { launchQueue } = globalThis as { launchQueue?: { setConsumer(act: (parameters: { files?: ReadonlyArray<{ getFile?(): Promise<File> }> }) => void): void } };
  launchQueue?.setConsumer(({ files = [] }) => {
    void Promise.all(files.map((handle) => handle.getFile?.())).then((found) => {
      const given = found.filter((file) => file !== undefined);
      if (given.length > 0) open(given);
    });
  });
}
