// A queue of models: what it holds, and how each of them fares.
import type { Notice } from '../state.ts';

/** What became of one model of the queue. */
export type BatchResult =
  | { readonly kind: 'waiting' }
  | { readonly kind: 'running'; readonly fraction: number | null }
  | { readonly kind: 'done'; readonly before: BatchFigures; readonly after: BatchFigures; /** In the zip. */ readonly fileName: string }
  | { readonly kind: 'failed'; readonly notice: Notice }
  | { readonly kind: 'cancelled' };

export interface BatchFigures {
  readonly triangles: number;
  readonly bytes: number;
}

/** A model of the queue. */
export interface BatchItem {
  /** Path as it was dropped. */
  readonly name: string;
  readonly result: BatchResult;
}

/** The queue as the page shows it. */
export interface BatchState {
  readonly items: readonly BatchItem[];
  /** How much of each model's triangles is to be left. */
  readonly share: number;
  readonly running: boolean;
}

/** The shares that are offered, as for one model. */
export const BATCH_SHARES: readonly number[] = [0.75, 0.5, 0.25, 0.1, 0.05];

/** A queue that has not begun. */
export const newBatch = (names: readonly string[]): BatchState => ({
  items: names.map((name) => ({ name, result: { kind: 'waiting' } })),
  share: 0.5,
  running: false,
});

export const shareChosen = (batch: BatchState, share: number): BatchState => (batch.running ? batch : { ...batch, share });

export const resultChanged = (batch: BatchState, index: number, result: BatchResult): BatchState => ({
  ...batch,
  items: batch.items.map((item, at) => (at === index ? { ...item, result } : item)),
});

/** All that was not done waits again; what was done with another share is done again too. */
export const batchStarted = (batch: BatchState): BatchState => ({
  ...batch,
  running: true,
  items: batch.items.map((item) => ({ ...item, result: { kind: 'waiting' } })),
});

/** What still waited was cancelled, if anything was. */
export const batchEnded = (batch: BatchState): BatchState => ({
  ...batch,
  running: false,
  items: batch.items.map((item) =>
    item.result.kind === 'waiting' || item.result.kind === 'running' ? { ...item, result: { kind: 'cancelled' } } : item,
  ),
});

/** How many have come to an end, and of those how many well. */
export const countsOf = ({ items }: BatchState): { readonly ended: number; readonly done: number; readonly failed: number } => {
  const count = (kind: BatchResult['kind']): number => items.filter(({ result }) => result.kind === kind).length;
  const [done, failed] = [count('done'), count('failed')];
  return { ended: done + failed, done, failed };
};

/** All of it, 0..1. */
export const batchProgress = (batch: BatchState): number => {
  const sum = batch.items.reduce((total, { result }) => total + (result.kind === 'running' ? (result.fraction ?? 0) : result.kind === 'waiting' ? 0 : 1), 0);
  return batch.items.length === 0 ? 0 : sum / batch.items.length;
};
