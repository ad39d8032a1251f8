// How large decoded geometry may become, known before anything is allocated for it.

import { tooLarge } from './tree.js';

/** What any file may unpack to, bytes. */
const ALWAYS_ALLOWED = 16 * 1024 * 1024;

/**
 * Bytes that a byte may unpack to. Meshopt's own limit is about 1024, and a flat grid of a million vertices, which no
 * file that is worth opening holds, comes to 690 with Draco. Beyond that the counts are made up.
 */
const LARGEST_FACTOR = 1100;

/** All decoded geometry of a file, bytes: what the engine can hold of numbers. */
const LARGEST_TOTAL = 2 ** 31;

/** Counts the bytes that a file unpacks to. */
export class Budget {
  #left = LARGEST_TOTAL;

  /** Takes `bytes` that `packed` bytes unpack to; throws `too-large` at `where`, also for what is no number. */
  take(bytes: number, packed: number, where: string): void {
    if (!(bytes <= Math.max(ALWAYS_ALLOWED, LARGEST_FACTOR * packed))) {
      throw tooLarge(where, `${packed} bytes cannot hold the ${bytes} that they are said to unpack to`);
    }
    this.#left -= bytes;
    if (this.#left < 0) throw tooLarge(where, 'the decoded geometry does not fit into 2 GiB of memory');
  }
}
