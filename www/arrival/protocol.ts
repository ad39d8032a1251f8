// What the page and the worker that reads an arriving model say to each other. Types only.
import type { LevelGeometry } from 'decimesh';

/** From the page. */
export type ReaderRequest =
  /** Comes once: the whole file, how fast it is to come, and whether levels go over into each other. */
  | { readonly type: 'start'; readonly bytes: Uint8Array; readonly bytesASecond: number; readonly smooth: boolean }
  | { readonly type: 'pause' }
  | { readonly type: 'resume' }
  /** What was last sent to be shown is on screen. */
  | { readonly type: 'drawn' };

/** From the worker. */
export type ReaderReply =
  /** To be shown and answered by `drawn`; its arrays are transferred. Triangles are those of the level it is or becomes. */
  | { readonly type: 'show'; readonly geometry: LevelGeometry; readonly triangles: number; readonly elapsed: number; readonly received: number }
  | { readonly type: 'progress'; readonly elapsed: number; readonly received: number }
  /** The last level, the whole mesh, is on screen. */
  | { readonly type: 'arrived'; readonly elapsed: number; readonly received: number }
  | { readonly type: 'failed'; readonly code: string; readonly message: string };
