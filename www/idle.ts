// Work that can wait until the browser has nothing else to do.

/** Calls `act` when the page is idle, within twenty seconds. */
export function whenIdle(act: () => void): void {
  if ('requestIdleCallback' in globalThis) requestIdleCallback(act, { timeout: 20_000 });
  else setTimeout(act, 5000);
}
