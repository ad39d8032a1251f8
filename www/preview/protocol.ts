// What the page and the view say to each other. Types only. The view lives in a worker where the browser allows it:
// compiling shaders and sending a large mesh to the graphics card can take long, and the page must not wait for it.
import type { LevelGeometry } from 'decimesh';

/** Pixels at each side of the view that something covers. */
export interface Insets {
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
  readonly left: number;
}

/** Size of the canvas in CSS pixels, and device pixels to each of them. */
export interface ViewSize {
  readonly width: number;
  readonly height: number;
  readonly pixelRatio: number;
}

/** How the model is drawn. */
export interface ViewSettings {
  readonly wireframe: boolean;
  readonly playing: boolean;
  /** Index of the animation. */
  readonly animation: number;
  /** The original is drawn instead of the level. */
  readonly comparing: boolean;
}

/** Colours that CSS cannot reach. */
export interface ViewTheme {
  /** Of the wireframe, as CSS writes it. */
  readonly lines: string;
  readonly lineOpacity: number;
  readonly shadowOpacity: number;
}

/** A movement of the camera. Lengths in CSS pixels, positions from the view's top left. */
export type CameraMove =
  | { readonly kind: 'fit' }
  | { readonly kind: 'orbit'; readonly x: number; readonly y: number }
  | { readonly kind: 'pan'; readonly x: number; readonly y: number }
  /** `factor` > 1 comes nearer to what is at `at`, or to the middle. */
  | { readonly kind: 'zoom'; readonly factor: number; readonly at?: { readonly x: number; readonly y: number } };

/** From the page to the view. */
export type ViewRequest =
  /** Comes first. Answered by `failed` without an id when there is no WebGL2. */
  | { readonly type: 'start'; readonly canvas: OffscreenCanvas | HTMLCanvasElement; readonly reducedMotion: boolean }
  /** Parses a GLB; answered by `loaded` or `failed`. It is not shown yet. */
  | { readonly type: 'load'; readonly id: number; readonly bytes: Uint8Array }
  /** Shows what was loaded under `model` in place of the model before, which is freed. Answered by `drawn`. */
  | { readonly type: 'show'; readonly id: number; readonly model: number }
  /** Frees what was loaded and not shown. */
  | { readonly type: 'discard'; readonly id: number }
  /** Swaps the geometry of the model shown; null is the file's own. Answered by `drawn`. */
  | { readonly type: 'level'; readonly id: number; readonly geometry: LevelGeometry | null }
  | { readonly type: 'settings'; readonly settings: ViewSettings }
  | { readonly type: 'theme'; readonly theme: ViewTheme }
  | { readonly type: 'resize'; readonly size: ViewSize; readonly insets: Insets }
  | { readonly type: 'camera'; readonly moves: readonly CameraMove[] };

/** From the view to the page. */
export type ViewReply =
  | { readonly type: 'loaded'; readonly id: number; readonly animations: readonly string[] }
  /** The graphics card is done with the picture that was asked for. */
  | { readonly type: 'drawn'; readonly id: number }
  | { readonly type: 'failed'; readonly id: number | null; readonly message: string }
  | { readonly type: 'context-lost' }
  | { readonly type: 'context-restored' };
