// Firefox and WebKitGTK for the main journey: each is asked, in its own protocol of WebDriver, to open an address and to
// run a script. Firefox speaks Marionette by itself, which is what geckodriver translates to; WebKitGTK has a driver.
import { spawn, type ChildProcess } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { connect, createServer, type AddressInfo, type Socket } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

/** A running browser. */
export interface OtherBrowser {
  navigate(address: string): Promise<void>;
  /** Runs `script`, the body of an async function, in the page; resolves to what it returns, a string. */
  run(script: string): Promise<string>;
  close(): Promise<void>;
}

/** Where the programs are, and how to have them where they are not. */
const found = (...paths: string[]): string | undefined => paths.find((path) => existsSync(path));

const firefox = (): string | undefined => found(process.env['FIREFOX'] ?? '', '/usr/bin/firefox-esr', '/usr/bin/firefox');

const miniBrowser = (): string | undefined => {
  const directory = readdirSync('/usr/lib', { withFileTypes: true }).filter((entry) => entry.isDirectory()).map(({ name }) => join('/usr/lib', name));
  return found(...directory.flatMap((parent) => ['4.1', '4.0', '6.0'].map((version) => join(parent, `webkit2gtk-${version}`, 'MiniBrowser'))));
};

/** What keeps a browser from being tried, or nothing. */
export const MISSING: Readonly<Record<'Firefox' | 'WebKitGTK', string | undefined>> = {
  Firefox: firefox() === undefined ? 'no firefox: apt-get install firefox-esr' : undefined,
  WebKitGTK:
    found('/usr/bin/WebKitWebDriver') === undefined || miniBrowser() === undefined || found('/usr/bin/Xvfb') === undefined
      ? 'no driver, MiniBrowser or Xvfb: apt-get install webkit2gtk-driver xvfb'
      : undefined,
};

const freePort = async (): Promise<number> => {
  const server = createServer().listen(0, '127.0.0.1');
  await new Promise((resolve) => server.once('listening', resolve));
  const { port } = server.address() as AddressInfo;
  await new Promise((resolve) => server.close(resolve));
  return port;
};

const pause = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));

/** Tries `attempt` until it does not fail, for half a minute. */
async function soon<Value>(attempt: () => Promise<Value>): Promise<Value> {
  for (let tries = 0; ; tries += 1) {
    try {
      return await attempt();
    } catch (error) {
      if (tries >= 60) throw error;
      await pause(500);
    }
  }
}

async function ended(child: ChildProcess): Promise<void> {
  if (child.exitCode !== null || child.signalCode !== null) return;
  const over = new Promise((resolve) => child.once('exit', resolve));
  child.kill();
  await Promise.race([over, pause(5000)]);
  if (child.exitCode === null && child.signalCode === null) child.kill('SIGKILL');
}

/**
 * A script whose last argument is called with what `body` comes to. `body` runs as one of the page's own scripts: what a
 * driver runs may live beside the page and see other globals.
 */
const asyncScript = (body: string): string => {
  const own = `(async () => { ${body} })().then(String, (error) => 'failed: ' + error).then((text) => document.documentElement.setAttribute('data-result', text));`;
  return `
    const done = arguments[arguments.length - 1];
    const root = document.documentElement;
    root.removeAttribute('data-result');
    const script = document.createElement('script');
    script.textContent = ${JSON.stringify(own)};
    root.append(script);
    script.remove();
    const look = () => (root.hasAttribute('data-result') ? done(root.getAttribute('data-result')) : setTimeout(look, 50));
    look();`;
};

const SCRIPT_TIMEOUT = 100_000;

/** Starts Firefox without a window. */
export async function startFirefox(): Promise<OtherBrowser> {
  const profile = mkdtempSync(join(tmpdir(), 'decimesh-firefox-'));
  const port = await freePort();
  writeFileSync(join(profile, 'user.js'), [
    `user_pref('marionette.port', ${port});`,
    // Nothing that phones home or asks.
    ...['datareporting.policy.dataSubmissionEnabled', 'app.normandy.enabled', 'browser.shell.checkDefaultBrowser', 'network.captive-portal-service.enabled', 'network.connectivity-service.enabled']
      .map((name) => `user_pref('${name}', false);`),
    `user_pref('webgl.force-enabled', true);`,
  ].join('\n'));
  const child = spawn(firefox() as string, ['--headless', '--marionette', '--no-remote', '--profile', profile], {
    stdio: 'ignore', env: { ...process.env, HOME: profile, MOZ_REMOTE_SETTINGS_DEVTOOLS: '1' },
  });
  const socket = await soon(() => new Promise<Socket>((resolve, reject) => {
    const attempt = connect(port, '127.0.0.1', () => resolve(attempt));
    attempt.once('error', reject);
  }));
  const send = marionette(socket);
  await send('WebDriver:NewSession', {});
  await send('WebDriver:SetTimeouts', { script: SCRIPT_TIMEOUT });
  return {
    navigate: async (url) => void (await send('WebDriver:Navigate', { url })),
    run: async (body) => {
      const { value } = (await send('WebDriver:ExecuteAsyncScript', { script: asyncScript(body), args: [] })) as { value: string };
      return value;
    },
    close: async () => {
      socket.destroy();
      await ended(child);
      rmSync(profile, { recursive: true, force: true });
    },
  };
}

/** Marionette's messages are `length:[type, id, …]`; answers have type 1, an error and a result. */
function marionette(socket: Socket): (command: string, parameters: object) => Promise<unknown> {
  let received = Buffer.alloc(0);
  let lastId = 0;
  const pending = new Map<number, { resolve(value: unknown): void; reject(error: Error): void }>();
  socket.on('data', (data) => {
    received = Buffer.concat([received, data]);
    for (;;) {
      const colon = received.indexOf(':');
      const length = Number(received.subarray(0, Math.max(colon, 0)).toString());
      if (colon < 1 || received.length < colon + 1 + length) return;
      const message = JSON.parse(received.subarray(colon + 1, colon + 1 + length).toString()) as unknown;
      received = received.subarray(colon + 1 + length);
      // The greeting is an object.
      if (!Array.isArray(message)) continue;
      const [, id, error, result] = message as [number, number, { message: string } | null, unknown];
      const waiting = pending.get(id);
      pending.delete(id);
      if (error === null) waiting?.resolve(result);
      else waiting?.reject(new Error(error.message));
    }
  });
  return (command, parameters) =>
    new Promise((resolve, reject) => {
      lastId += 1;
      pending.set(lastId, { resolve, reject });
      const text = JSON.stringify([0, lastId, command, parameters]);
      socket.write(`${Buffer.byteLength(text)}:${text}`);
    });
}

/** Starts WebKitGTK's small browser on a display that nobody sees. */
export async function startWebKit(): Promise<OtherBrowser> {
  const home = mkdtempSync(join(tmpdir(), 'decimesh-webkit-'));
  const display = `:${90 + (process.pid % 100)}`;
  const screen = spawn('/usr/bin/Xvfb', [display, '-screen', '0', '1280x900x24', '-nolisten', 'tcp'], { stdio: 'ignore' });
  const port = await freePort();
  const driver = spawn('/usr/bin/WebKitWebDriver', [`--port=${port}`, '--host=127.0.0.1'], {
    stdio: 'ignore',
    env: { ...process.env, DISPLAY: display, HOME: home, XDG_RUNTIME_DIR: home, LIBGL_ALWAYS_SOFTWARE: '1', WEBKIT_DISABLE_SANDBOX_THIS_IS_DANGEROUS: '1' },
  });
  const ask = async (path: string, body: object): Promise<unknown> => {
    const response = await fetch(`http://127.0.0.1:${port}${path}`, { method: 'POST', body: JSON.stringify(body) });
    const { value } = (await response.json()) as { value: { message?: string } | null };
    if (!response.ok) throw new Error(value?.message ?? `status ${response.status}`);
    return value;
  };
  const capabilities = { alwaysMatch: { 'webkitgtk:browserOptions': { binary: miniBrowser(), args: ['--automation'] } } };
  const { sessionId } = (await soon(() => ask('/session', { capabilities }))) as { sessionId: string };
  await ask(`/session/${sessionId}/timeouts`, { script: SCRIPT_TIMEOUT });
  return {
    navigate: async (url) => void (await ask(`/session/${sessionId}/url`, { url })),
    run: async (body) => (await ask(`/session/${sessionId}/execute/async`, { script: asyncScript(body), args: [] })) as string,
    close: async () => {
      await fetch(`http://127.0.0.1:${port}/session/${sessionId}`, { method: 'DELETE' }).catch(() => {});
      await ended(driver);
      await ended(screen);
      rmSync(home, { recursive: true, force: true });
    },
  };
}
