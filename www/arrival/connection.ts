// A connection of so many bytes a second, played from bytes that are there, with a clock that stands while it is paused.

/** Milliseconds between two deliveries. */
const TICK = 16;

/** Bytes that are handed over at once: what can be shown after few bytes is not to wait for more. */
const PIECE = 1024;

/** Bytes after which others get their turn, however fast it is. */
const TURN = 65_536;

/** Plays `bytes` as if they came at `bytesASecond`, above 0, which may be infinite. */
export class Connection {
  /** Bytes handed over. */
  received = 0;
  private before = 0;
  private since: number | null;
  private wake: (() => void) | null = null;

  constructor(
    private readonly bytes: Uint8Array,
    private readonly bytesASecond: number,
    private readonly now: () => number = () => performance.now(),
  ) {
    this.since = now();
  }

  /** Milliseconds since the beginning, without pauses. */
  get elapsed(): number {
    return this.before + (this.since === null ? 0 : this.now() - this.since);
  }

  pause(): void {
    this.before = this.elapsed;
    this.since = null;
  }

  resume(): void {
    this.since ??= this.now();
    this.wake?.();
    this.wake = null;
  }

  /** The bytes as they come. */
  async *[Symbol.asyncIterator](): AsyncGenerator<Uint8Array, void> {
    while (this.received < this.bytes.length) {
      if (this.since === null) {
        await new Promise<void>((resolve) => (this.wake = resolve));
        continue;
      }
      const due = Math.min(Math.floor((this.elapsed / 1000) * this.bytesASecond), this.bytes.length);
      // An infinite speed times nothing is no number.
      const until = Math.min(Number.isNaN(due) ? this.bytes.length : due, this.received + TURN);
      while (this.received < until && this.since !== null) {
        const start = this.received;
        this.received = Math.min(start + PIECE, until);
        yield this.bytes.subarray(start, this.received);
      }
      if (this.received < this.bytes.length) await new Promise((resolve) => setTimeout(resolve, this.received < due ? 0 : TICK));
    }
  }
}
