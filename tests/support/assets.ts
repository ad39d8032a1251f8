// Large real models, which are not part of the repository: tests that want one skip loudly where they are absent.
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { test } from 'vitest';

const folder = new URL('../../../shared/assets/', import.meta.url);

/** The path of a real model, whether it is there or not. */
export const assetPath = (name: string): string => fileURLToPath(new URL(name, folder));

/** A test that runs where the model `name` is there, and else says that it does not. */
export function testWithAsset(name: string, title: string, run: (path: string) => Promise<void>, milliseconds?: number): void {
  const path = assetPath(name);
  const present = existsSync(path);
  if (!present) console.log(`skipped: ${title}: ${name} is not there`);
  test.skipIf(!present)(title, () => run(path), milliseconds);
}
