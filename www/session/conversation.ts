// What every part of the conversation with the worker shares: its two ends, and the document that it is about.
import type { DocumentProxy, WorkerClient } from 'decimesh/worker';
import type { Quality } from '../formats.ts';
import type { View } from '../preview/view.ts';
import type { Level, Model, State } from '../state.ts';

/** Where the session reads and changes the page's state. */
export interface Store {
  readonly value: State;
  update(transition: (state: State) => State): void;
}

/** A file, the wish it answers, and a sentence on what its format cannot hold, or nothing. */
export interface WrittenFile {
  readonly key: string;
  readonly bytes: Uint8Array;
  readonly loss: string;
}

/** The document behind the model on screen. */
export interface OpenDocument {
  document: DocumentProxy;
  readonly files: File[];
  recording: AbortController | null;
  /** What the record of levels was or is being made with. */
  recorded: string | null;
  /** Whether what is shown and written is of another run than the one that is or was being recorded. */
  stale: boolean;
  /** The goal that the slider was set for last, with all it depends on. */
  reached: string | null;
  measuring: AbortController | null;
  /** The fit for a download that is under way, and what it is for. */
  fitting: { readonly controller: AbortController; readonly wanted: number; readonly quality: Quality } | null;
  /** What the level on screen, which the document stands at, was fitted with; null: it is the history's. */
  fitted: Quality | null;
  /** The last file written, and what for; Download takes it from here. */
  written: WrittenFile | null;
  /** The wish that failed last: not tried again until it changes. */
  failedKey: string | null;
  /** Whether the documents were lost once without a success since. */
  reopened: boolean;
}

export interface Conversation {
  readonly store: Store;
  readonly client: WorkerClient;
  readonly view: View;
  /** Null: no model is on screen. */
  current: OpenDocument | null;
  /** What is painted on each vertex of the document on screen, by the number of its state; null: nothing. */
  painted: (state: number) => Uint8Array | null;
}

/** A document with which nothing has been done yet. */
export const newlyOpened = (document: DocumentProxy, files: File[]): OpenDocument => ({
  document, files, recording: null, recorded: null, stale: false, reached: null, measuring: null, fitting: null, fitted: null, written: null, failedKey: null, reopened: false,
});

/** Frees the document on screen, if there is one, and ends what is under way with it. */
export function letGo(conversation: Conversation): void {
  const open = conversation.current;
  for (const controller of [open?.measuring, open?.recording]) controller?.abort(superseded());
  open?.document.dispose();
  conversation.current = null;
}

/** Sees to it that the document stands at the level that is wanted. */
export async function selectLevel(open: OpenDocument, model: Model): Promise<Level> {
  // Without a history it stands at full detail; with one, recording it may have left another level.
  if (model.history.kind !== 'ready' || open.fitted !== null) return model.shown;
  const wanted = model.wantedTriangles;
  return open.document.level(wanted === model.source.triangles ? {} : { triangles: wanted });
}

/** Why something ends that something newer has taken the place of. */
export const superseded = (): DOMException => new DOMException('Superseded.', 'AbortError');
