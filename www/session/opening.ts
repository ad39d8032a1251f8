// From files to a model on screen: read by the engine and perhaps the view at once, shown, and only then recorded.
import { DecimeshError } from 'decimesh/worker';
import type { DocumentProxy } from 'decimesh/worker';
import { readEarly } from '../early.ts';
import type { EarlyModel } from '../early.ts';
import { baseName } from '../files.ts';
import { t } from '../messages/messages.ts';
import type { PreparedModel, View } from '../preview/view.ts';
import { readScene } from '../scene.ts';
import type { SceneNode } from '../scene.ts';
import * as transitions from '../state.ts';
import type { Model } from '../state.ts';
import { letGo, newlyOpened, type Conversation } from './conversation.ts';
import type { Recording } from './recording.ts';
import { FULL_DETAIL, tellFullSize, type Weighed } from './sizes.ts';

/** Milliseconds that the first picture is waited for before the recording starts. */
const PICTURE_TIME = 3000;

/** A model that can be shown. */
interface PreparedDocument {
  readonly prepared: PreparedModel;
  readonly scene: readonly SceneNode[];
  /** The size of the file that the engine wrote for it; null: it wrote none. */
  readonly written: Weighed | null;
}

export class Opening {
  constructor(
    private readonly conversation: Conversation,
    private readonly recording: Recording,
    /** Resolves when the page is laid out with what the state says, and the view knows what of it is free. */
    private readonly layOut: () => Promise<void>,
  ) {}

  /** Puts the model of `files` in place of the one on screen, which stays if that fails. */
  async replaceDocument(files: File[], from: Pick<Model, 'fileName' | 'credit' | 'origin'>, signal: AbortSignal): Promise<void> {
    const { conversation } = this;
    const { store, view } = conversation;
    store.update((state) => transitions.taskProgressed(state, null));
    const onProgress = (fraction: number): void => store.update((state) => transitions.taskProgressed(state, fraction));
    const early = readEarly(view, files);
    const document = await conversation.client.openDocument(files, { signal, onProgress }).catch((error: unknown) => {
      early.drop();
      throw error;
    });
    try {
      const { prepared, scene, written } = await prepare(view, document, early, signal);
      letGo(conversation);
      const { summary } = document;
      const open = newlyOpened(document, files);
      conversation.current = open;
      store.update((state) =>
        transitions.modelOpened(state, {
          ...from,
          name: baseName(from.fileName),
          scene,
          source: summary,
          warnings: summary.warnings,
          animations: prepared.animations,
        }),
      );
      // With the panel in its place the picture need not be drawn twice.
      await this.layOut();
      if (conversation.current !== open) return prepared.discard();
      const drawn = prepared.show().then(() => {
        if (conversation.current === open) store.update(transitions.modelDrawn);
      });
      // The picture next: side by side with the recording both would take as long as one after the other.
      await Promise.race([drawn, delay(PICTURE_TIME)]);
      if (conversation.current !== open) return;
      void tellFullSize(conversation, open, written);
      if (signal.aborted) store.update((state) => transitions.recordingEnded(state, t('status.cancelledRecording')));
      else void this.recording.record(open);
    } catch (error) {
      if (conversation.current?.document !== document) document.dispose();
      throw error;
    }
  }
}

/** The model for the view: of the file itself where that is enough, else of what the engine writes. */
async function prepare(view: View, document: DocumentProxy, early: EarlyModel, signal: AbortSignal): Promise<PreparedDocument> {
  const none = document.summary.warnings.find(({ code }) => code === 'no-triangles');
  if (signal.aborted || none !== undefined) early.drop();
  signal.throwIfAborted();
  // The library passes it through; here there would be nothing to see or to choose.
  if (none !== undefined) throw new DecimeshError('no-triangles', none.message, none.where);
  const plain = await early.take(document.summary);
  if (plain !== null) {
    if (signal.aborted) plain.model.discard();
    signal.throwIfAborted();
    return { prepared: plain.model, scene: plain.scene, written: null };
  }
  const { bytes, report } = await document.write(FULL_DETAIL);
  signal.throwIfAborted();
  // The view takes the bytes over.
  const written = { bytes: { byteLength: bytes.byteLength }, report };
  const scene = readScene(bytes);
  const prepared = await view.load(bytes);
  if (signal.aborted) prepared.discard();
  signal.throwIfAborted();
  return { prepared, scene, written };
}

const delay = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));
