// What the page and the view say to each other about painting. Types only. Painted are the vertices of the document,
// numbered as the package numbers them; 0 is unpainted, 255 stays as it is.

/** Where the vertices of one primitive are among the document's. */
export interface PaintedPart {
  /** Numbers of the glTF mesh and of the primitive in it. */
  readonly mesh: number;
  readonly primitive: number;
  /** Number of its first vertex. */
  readonly start: number;
  readonly vertices: number;
}

/** The brush, in CSS pixels of the view. */
export interface Brush {
  readonly x: number;
  readonly y: number;
  /** In the picture: nearer, the same brush paints less of the model. */
  readonly radius: number;
  /** What the brush's middle paints, above 0 to 1; towards its rim it is less. */
  readonly strength: number;
  /** Takes paint away instead. */
  readonly erase: boolean;
}

/**
 * What a stroke has changed, as the exclusive or of before and after: it leads either way. Either `values` has all
 * vertices, or `indices` says which they are of.
 */
export interface PaintChange {
  readonly indices: Uint32Array<ArrayBuffer> | null;
  readonly values: Uint8Array<ArrayBuffer>;
}

/** From the page to the view. */
export type PaintRequest =
  /** Shows what is painted on the original from now on. Answered; `epoch` is repeated in this and later answers. */
  | { readonly type: 'start'; readonly parts: readonly PaintedPart[]; readonly painted: Uint8Array<ArrayBuffer>; readonly epoch: number }
  /** Puts this in the place of what is painted, and drops a stroke that is under way. Answered. */
  | { readonly type: 'set'; readonly painted: Uint8Array<ArrayBuffer>; readonly epoch: number }
  /** Moves the brush over the picture in a line from where it was in this stroke; the first one begins the stroke. */
  | { readonly type: 'dab'; readonly brush: Brush }
  /** Ends the stroke. Answered. */
  | { readonly type: 'end' }
  /** Takes the stroke back. */
  | { readonly type: 'cancel' }
  | { readonly type: 'stop' };

/** From the view to the page. */
export type PaintReply =
  | {
      readonly type: 'painted';
      readonly epoch: number;
      /** What a stroke has changed; null when it has changed nothing, and after `start` and `set`. */
      readonly change: PaintChange | null;
      /** Vertices that have paint on them. */
      readonly count: number;
    }
  /** Nothing can be painted: the code for it has not come, say. */
  | { readonly type: 'failed'; readonly message: string };
