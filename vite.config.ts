// The page's bundler: www/ → site/, with the package taken from dist/ under the name users import it by.
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';

const at = (path: string): string => fileURLToPath(new URL(path, import.meta.url));

// Threads and precise timers need a cross-origin isolated page; scripts/serve.mjs sends the same two.
const crossOriginIsolation = {
  'Cross-Origin-Opener-Policy': 'same-origin',
  'Cross-Origin-Embedder-Policy': 'require-corp',
};

const jsx = { runtime: 'automatic', importSource: 'preact' } as const;

export default defineConfig({
  root: at('./www'),
  base: './',
  resolve: {
    alias: [
      { find: /^decimesh$/, replacement: at('./dist/index.js') },
      { find: /^decimesh\/worker$/, replacement: at('./dist/worker/client.js') },
    ],
  },
  oxc: { jsx },
  // The development server looks for dependencies with a bundler of its own, which has to be told again.
  optimizeDeps: { rolldownOptions: { transform: { jsx } } },
  worker: { format: 'es' },
  build: {
    outDir: at('./site'),
    emptyOutDir: true,
    target: 'es2022',
    // Inlined as base64 the wasm would grow by a third and could not compile while it streams.
    assetsInlineLimit: (file: string) => (file.endsWith('.wasm') ? false : undefined),
    chunkSizeWarningLimit: 1000,
  },
  server: {
    host: '127.0.0.1',
    port: 5173,
    headers: crossOriginIsolation,
    fs: { allow: [at('.')] },
  },
});
