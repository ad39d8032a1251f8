// `npm start`: sets up, builds and serves the page until it is interrupted. PORT overrides port 5173.

import { build } from './build.mjs';
import { at, main } from './project.mjs';
import { portFrom, serve } from './serve.mjs';
import { setup } from './setup.mjs';

await main(async () => {
  const port = portFrom(process.env.PORT); // before minutes of building, not after
  await build(await setup());
  const { url, close } = await serve(at('site'), port);
  console.log(`Decimesh is at ${url}`);
  for (const signal of ['SIGINT', 'SIGTERM']) process.once(signal, close);
  if (process.env.npm_lifecycle_event !== undefined) whenOrphaned(close);
});

// npm passes a signal on to its shell and no further: the server would outlive it and keep the port.
function whenOrphaned(close) {
  const parent = process.ppid;
  const watch = setInterval(() => {
    if (process.ppid === parent) return;
    clearInterval(watch);
    close();
  }, 500);
  watch.unref();
}
