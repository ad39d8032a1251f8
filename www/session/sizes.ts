// How large a file is and where its bytes are, told to the state: of what was written, and of the model at full detail.
import type { Report } from 'decimesh/worker';
import { NO_PREPARATION, preparationKey } from '../preparation.ts';
import * as transitions from '../state.ts';
import type { Output } from '../state.ts';
import type { Conversation, OpenDocument, Store } from './conversation.ts';

/** What the view gets of a model at first, and its size. */
export const FULL_DETAIL = { format: 'glb', compress: 'none' } as const;

/** A file's size, and what the engine reported of writing it. */
export interface Weighed {
  readonly bytes: { readonly byteLength: number };
  readonly report: Report;
}

/** Tells what was written for `wish`. */
export function tellSize(store: Store, { bytes, report }: Weighed, wish: Pick<Output, 'format' | 'encoding' | 'preparation' | 'wantedTriangles' | 'lods'>): void {
  const output = { ...wish, bytes: bytes.byteLength, parts: report.output.parts, levels: report.lods ?? [] };
  store.update((state) => transitions.outputMeasured(transitions.inputMeasured(state, report.input.parts), output));
}

/** Tells how large the file is at full detail; writes it for that unless it is `written`. */
export async function tellFullSize(conversation: Conversation, open: OpenDocument, written: Weighed | null): Promise<void> {
  try {
    const weighed = written ?? (await open.document.write(FULL_DETAIL));
    if (conversation.current !== open) return;
    tellSize(conversation.store, weighed, {
      format: 'glb', encoding: 'none', preparation: preparationKey('glb', NO_PREPARATION), wantedTriangles: open.document.summary.triangles, lods: [],
    });
  } catch {
    // It is written once more when nothing else is to be done, and then what is wrong is told.
  }
}
