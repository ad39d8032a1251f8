// The page's bundler: www/ → site/, with the package taken from dist/ under the name users import it by.
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';
import { precache } from './scripts/precache.mjs';

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
      { find: /^decimesh\/progressive$/, replacement: at('./dist/progressive.js') },
      { find: /^decimesh\/worker$/, replacement: at('./dist/worker/client.js') },
    ],
  },
  plugins: [precache(at('./www/public'))],
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
    rolldownOptions: {
      input: { index: at('./www/index.html'), 'service-worker': at('./www/offline/service-worker.ts') },
      // The service worker's address has to stay, and its place says what it may serve.
      output: { entryFileNames: (chunk) => (chunk.name === 'service-worker' ? 'service-worker.js' : 'assets/[name]-[hash].js') },
    },
  },
  server: {
    host: '127.0.0.1',
    port: 5173,
    headers: crossOriginIsolation,
    fs: { allow: [at('.')] },
  },
});
