// Reaches into the view's worker from a test or a benchmark: its WebGL context, and what is alive on the graphics card.

/**
 * To be given to `page.addInitScript` before the page is opened. In the worker called `decimesh view` the globals
 * `viewContext` (its WebGL context) and `liveObjects()` (how many buffers with how many bytes, textures, programs and vertex arrays are alive) are
 * there from then on. The worker runs the same program; requests wait until it is there.
 */
export function openViewWorker() {
  const prelude = `
    const alive = { buffers: new Map(), textures: new Map(), programs: new Set(), vertexArrays: new Set() };
    const prototype = WebGL2RenderingContext.prototype;
    const wrap = (name, act) => {
      const call = prototype[name];
      prototype[name] = function (...values) {
        const result = call.apply(this, values);
        act(this, result, ...values);
        return result;
      };
    };
    const bound = new Map();
    wrap('createBuffer', (_gl, buffer) => alive.buffers.set(buffer, 0));
    wrap('deleteBuffer', (_gl, _none, buffer) => alive.buffers.delete(buffer));
    wrap('createTexture', (_gl, texture) => alive.textures.set(texture, 0));
    wrap('deleteTexture', (_gl, _none, texture) => alive.textures.delete(texture));
    wrap('createProgram', (_gl, program) => alive.programs.add(program));
    wrap('deleteProgram', (_gl, _none, program) => alive.programs.delete(program));
    wrap('createVertexArray', (_gl, array) => alive.vertexArrays.add(array));
    wrap('deleteVertexArray', (_gl, _none, array) => alive.vertexArrays.delete(array));
    wrap('bindBuffer', (_gl, _none, target, buffer) => bound.set(target, buffer));
    wrap('bufferData', (_gl, _none, target, data) => {
      const buffer = bound.get(target);
      if (alive.buffers.has(buffer)) alive.buffers.set(buffer, typeof data === 'number' ? data : data.byteLength);
    });
    // The index buffer is part of the vertex array that is bound.
    wrap('bindVertexArray', () => bound.delete(34963));
    const getContext = OffscreenCanvas.prototype.getContext;
    OffscreenCanvas.prototype.getContext = function (...values) {
      const context = getContext.apply(this, values);
      if (context instanceof WebGL2RenderingContext) self.viewContext = context;
      return context;
    };
    self.liveObjects = () => {
      const sum = (map) => [...map.values()].reduce((total, bytes) => total + bytes, 0);
      return { buffers: alive.buffers.size, bufferBytes: sum(alive.buffers), textures: alive.textures.size, programs: alive.programs.size, vertexArrays: alive.vertexArrays.size };
    };
    const early = [];
    const keep = (event) => { early.push(event.data); event.stopImmediatePropagation(); };
    self.addEventListener('message', keep);
  `;
  const OwnWorker = globalThis.Worker;
  globalThis.Worker = class extends OwnWorker {
    constructor(address, options) {
      if (options?.name !== 'decimesh view') super(address, options);
      else {
        const source = `${prelude}
          await import(${JSON.stringify(String(new URL(address, location.href)))});
          self.removeEventListener('message', keep);
          for (const data of early) self.dispatchEvent(new MessageEvent('message', { data }));`;
        super(URL.createObjectURL(new Blob([source], { type: 'text/javascript' })), options);
      }
    }
  };
}

/** The view's worker of a page that was opened with {@link openViewWorker}. */
export async function viewWorkerOf(page) {
  for (;;) {
    for (const worker of page.workers()) {
      if (await worker.evaluate(() => globalThis.name === 'decimesh view').catch(() => false)) return worker;
    }
    await page.waitForTimeout(50);
  }
}
