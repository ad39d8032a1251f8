// The tests in tests/*.test.ts, on Node, importing the package by name from dist/.
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vitest/config';

const at = (path: string): string => fileURLToPath(new URL(path, import.meta.url));

export default defineConfig({
  test: {
    root: at('.'),
    include: ['tests/**/*.test.ts'],
    environment: 'node',
    // A page test loads a browser and a large model; on two busy cores that is not a matter of five seconds.
    testTimeout: 60_000,
    hookTimeout: 60_000,
    // One file at a time: the page tests drive a browser and some tests measure time.
    fileParallelism: false,
  },
});
