// What the page and the view say to each other. Types only. The view lives in a worker where the browser allows it:
// compiling shaders and sending a large mesh to the graphics card can take long, and the page must not wait for it.
import type { LevelGeometry } from 'decimesh';
import type { PaintReply, PaintRequest } from '../paint/protocol.ts';
import type { SceneNode } from '../scene.ts';
import type { PlainPart } from './plain.ts';

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

/**
 * What the surface shows: the file's materials, plain clay, a pattern over the texture coordinates, directions, or the
 * measured distance from the original.
 */
export type Surface = 'textured' | 'shaded' | 'checker' | 'normals' | 'deviation';

/** How original and result are seen: one of them, both with a handle between them, or both side by side. */
export type Layout = 'single' | 'split' | 'beside';

/** Where the lamp is: over the viewer's shoulder, at a place beside the model, or on its way around it. */
export type Lamp = 'view' | 'model' | 'turning';

/** How the model is drawn. */
export interface ViewSettings {
  readonly surface: Surface;
  readonly wireframe: boolean;
  /** Borders, seams and non-manifold edges are drawn over the surface. */
  readonly edgeClasses: boolean;
  readonly playing: boolean;
  /** Index of the animation. */
  readonly animation: number;
  /** The original alone is drawn instead of the level. */
  readonly comparing: boolean;
  readonly layout: Layout;
  /** Share of the free width that shows the original, 0..1, in the layout `split`. */
  readonly split: number;
  readonly turntable: boolean;
  readonly lamp: Lamp;
  /** Weight of each morph target of {@link ViewContents}; null or absent leaves it to the file and its animation. */
  readonly morphs: ReadonlyArray<number | null>;
}

/** What a model has that the view can show. */
export interface ViewContents {
  /** Names, in file order. */
  readonly animations: readonly string[];
  /** Names of the morph targets, each once, with the weight that the file gives them. */
  readonly morphs: ReadonlyArray<{ readonly name: string; readonly weight: number }>;
  /** Whether any part has texture coordinates. */
  readonly textureCoordinates: boolean;
}

/** What the view has read in a plain GLB. */
export interface PlainFile {
  readonly scene: readonly SceneNode[];
  readonly parts: readonly PlainPart[];
}

/** Edges of the geometry on screen by class, each counted once. */
export interface EdgeCounts {
  /** Of one triangle alone. */
  readonly border: number;
  /** Of two triangles that meet in place but not in their attributes or material. */
  readonly seam: number;
  /** Of more than two triangles. */
  readonly nonManifold: number;
}

/** Colours that CSS cannot reach. */
export interface ViewTheme {
  /** Of the wireframe, as CSS writes it. */
  readonly lines: string;
  readonly lineOpacity: number;
  readonly shadowOpacity: number;
  /** Of the classes of edges, as CSS writes them. */
  readonly edges: Readonly<Record<keyof EdgeCounts, string>>;
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
  /** Parses a GLB, if it is a file a plain one; answered by `loaded` or `failed`. It is not shown yet. */
  | { readonly type: 'load'; readonly id: number; readonly content: Uint8Array | Blob }
  /** Shows what was loaded under `model` in place of the model before, which is freed. Answered by `drawn`. */
  | { readonly type: 'show'; readonly id: number; readonly model: number }
  /** Frees what was loaded and not shown. */
  | { readonly type: 'discard'; readonly id: number }
  /** Swaps the geometry of the model shown; null is the file's own. Answered by `drawn`. */
  | { readonly type: 'level'; readonly id: number; readonly geometry: LevelGeometry | null }
  /**
   * Distances from the original in model units, an array for each wedge set of the level shown, and the distance that
   * has the last colour. For a level that is not shown any more it does nothing.
   */
  | { readonly type: 'deviation'; readonly wedgeSets: readonly Float32Array[]; readonly limit: number }
  /** Painting on the original, for which the code is loaded then. */
  | { readonly type: 'paint'; readonly paint: PaintRequest }
  | { readonly type: 'settings'; readonly settings: ViewSettings }
  | { readonly type: 'theme'; readonly theme: ViewTheme }
  | { readonly type: 'resize'; readonly size: ViewSize; readonly insets: Insets }
  | { readonly type: 'camera'; readonly moves: readonly CameraMove[] };

/** From the view to the page. */
export type ViewReply =
  | { readonly type: 'loaded'; readonly id: number; readonly contents: ViewContents; readonly file: PlainFile | null }
  /** The classes of edges of what is drawn now; null when they are not drawn. */
  | { readonly type: 'edges'; readonly counts: EdgeCounts | null }
  | { readonly type: 'paint'; readonly paint: PaintReply }
  /** The graphics card is done with the picture that was asked for. */
  | { readonly type: 'drawn'; readonly id: number }
  /** The picture on screen is what the first `requests` requests asked for, and nothing in it moves. */
  | { readonly type: 'still'; readonly requests: number }
  | { readonly type: 'failed'; readonly id: number | null; readonly message: string }
  | { readonly type: 'context-lost' }
  | { readonly type: 'context-restored' };
