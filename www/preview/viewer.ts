// The 3D view: draws a loaded model at any level of detail, when something changed and not otherwise.
import { AnimationMixer, Box3, BufferAttribute, BufferGeometry, Color, Group, Mesh, MeshStandardMaterial, NeutralToneMapping, Scene, Vector3, WebGLRenderer } from 'three';
import type { Material } from 'three';
import type { LevelGeometry } from 'decimesh';
import type { Easel } from '../paint/painter.ts';
import { OrbitCamera } from './camera.ts';
import { MorphSetter } from './contents.ts';
import { addDeviation, levelGeometries } from './geometry.ts';
import { LampRig } from './lamp.ts';
import { lineMaterial } from './lines.ts';
import { disposeModel, materialsOf, partKey, scaleLights } from './load.ts';
import type { LoadedModel, Part } from './load.ts';
import { panesOf } from './panes.ts';
import type { Pane } from './panes.ts';
import type { CameraMove, EdgeCounts, Insets, ViewSettings, ViewSize, ViewTheme } from './protocol.ts';
import { STILL_LIFE } from './settings.ts';
import { softShadow } from './shadow.ts';
import { Side } from './side.ts';
import type { LineMaterials } from './side.ts';
import { studioLight, studioProbe } from './studio.ts';
import { Surfaces, makeRoomForLines } from './surfaces.ts';

/** More than two device pixels each way cost four times the work and are not seen on a moving model. */
const PIXEL_RATIO_LIMIT = 2;
/** After a pause an animation goes on where it was, and does not leap. */
const LONGEST_FRAME = 100;
/** Milliseconds between two looks whether the graphics card is done. */
const FENCE_INTERVAL = 4;
/** How bright the room is. */
const ROOM_INTENSITY = 0.58;
/** Seconds in which the turntable goes once around. */
const TURNTABLE_TIME = 16;

/** What the viewer tells. */
export interface ViewerEvents {
  onContextLost(): void;
  onContextRestored(): void;
  /** The classes of edges that are drawn now, of the result where both are; null when none are. */
  onEdges(counts: EdgeCounts | null): void;
}

/** Owns the canvas's WebGL context and everything in it. The constructor throws when there is no WebGL2. */
export class Viewer {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly stage = new Group();
  private readonly shadow = softShadow();
  private readonly lines: LineMaterials = {
    wireframe: lineMaterial(),
    edges: { border: lineMaterial(), seam: lineMaterial(), nonManifold: lineMaterial() },
  };
  private readonly surfaces = new Surfaces();
  /** The room around the model: for materials that may mirror it, and for matt ones alone. */
  private readonly room = studioLight();
  private readonly mattRoom = studioProbe();
  private readonly view: OrbitCamera;
  private readonly lamp: LampRig;
  private model: LoadedModel | null = null;
  private mixer: AnimationMixer | null = null;
  private morphs: MorphSetter | null = null;
  /** The file's own geometry, and what is shown in its place; null without a level. */
  private original: Side | null = null;
  private result: Side | null = null;
  /** The result's geometries and the wedge set of each. */
  private levelParts: { readonly geometries: BufferGeometry[]; readonly wedgeSets: number[] } = { geometries: [], wedgeSets: [] };
  private settings: ViewSettings = STILL_LIFE;
  private panes: Pane[] = [];
  private size: ViewSize = { width: 1, height: 1, pixelRatio: 1 };
  private insets: Insets = { top: 0, right: 0, bottom: 0, left: 0 };
  private contextLost = false;
  private frameRequest = 0;
  private lastFrame = 0;
  private readonly events: ViewerEvents;
  private readonly reducedMotion: boolean;

  constructor(canvas: OffscreenCanvas | HTMLCanvasElement, events: ViewerEvents, reducedMotion: boolean) {
    this.events = events;
    this.reducedMotion = reducedMotion;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: 'high-performance' });
    // Asking for compile errors waits for the compiler; ours are three's own shaders.
    this.renderer.debug.checkShaderErrors = false;
    this.renderer.toneMapping = NeutralToneMapping;
    this.view = new OrbitCamera(!reducedMotion);
    this.lamp = new LampRig(this.scene, this.view.camera);
    this.scene.add(this.view.camera);
    this.light();
    this.scene.add(this.stage, this.shadow);
    this.warmUp();
    this.shadow.visible = false;

    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.contextLost = true;
      events.onContextLost();
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.contextLost = false;
      // Buffers and pictures are uploaded again from memory.
      events.onContextRestored();
      this.invalidate();
    });
  }

  /** Replaces the model on screen, from its file's geometry, and draws it. */
  show(model: LoadedModel): void {
    this.clear();
    this.model = model;
    const size = model.bounds.getSize(new Vector3());
    // One unit in radius whatever the unit of length: camera and depth have absolute limits.
    const scale = 2 / Math.max(size.length(), Number.MIN_VALUE);
    this.stage.scale.setScalar(scale);
    this.stage.position.copy(model.bounds.getCenter(new Vector3())).multiplyScalar(-scale);
    scaleLights(model.root, scale);
    const box = new Box3().setFromCenterAndSize(new Vector3(), size.multiplyScalar(scale));
    this.shadow.position.y = box.min.y - 0.002;
    this.shadow.scale.set((box.max.x - box.min.x) * 1.5 + 0.15, 1, (box.max.z - box.min.z) * 1.5 + 0.15);
    this.shadow.visible = true;
    this.view.frame(box);
    for (const material of materialsOf(model.root)) makeRoomForLines(material);
    this.stage.add(model.root);
    this.original = new Side(model, this.lines, null);
    this.mixer = model.animations.length > 0 ? new AnimationMixer(model.root) : null;
    this.morphs = new MorphSetter(model);
    this.playAnimation();
    this.paint();
    this.light();
    this.tellEdges();
    this.invalidate();
  }

  /** Draws what there is and resolves when the graphics card has done so, or has lost everything. */
  async drawn(): Promise<void> {
    // The frame that was asked for anyway, now: a large model is not to be drawn twice.
    if (this.frameRequest === 0) this.draw();
    else {
      cancelAnimationFrame(this.frameRequest);
      this.onFrame(performance.now());
    }
    await this.cardDone();
  }

  /** Resolves when the graphics card has done all it was told, or has lost it. */
  private async cardDone(): Promise<void> {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    const fence = this.contextLost ? null : gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (fence === null) return;
    gl.flush();
    // Asking does not wait; the answer changes only between tasks.
    while (!this.contextLost && gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.UNSIGNALED) {
      await new Promise((resolve) => setTimeout(resolve, FENCE_INTERVAL));
    }
    gl.deleteSync(fence);
  }

  /** Resolves when the last picture is on screen and nothing moves, to true; to false as soon as `isWanted` says no. */
  async still(isWanted: () => boolean): Promise<boolean> {
    // What was drawn in one frame is handed to the screen with the next.
    for (let idle = 0; idle < 2; idle = this.frameRequest === 0 ? idle + 1 : 0) {
      await new Promise(requestAnimationFrame);
      if (!isWanted()) return false;
    }
    await this.cardDone();
    return isWanted();
  }

  /** Swaps every group's geometry for `level`; null shows the file's own. */
  setLevel(level: LevelGeometry | null): void {
    const model = this.model;
    if (model === null) return;
    const previous = this.result;
    this.levelParts = { geometries: [], wedgeSets: [] };
    if (level === null) this.result = null;
    else {
      const keys = level.groups.map((group) => partKey(group.mesh, group.primitive));
      const originals = keys.map((key) => model.parts.get(key)?.[0]?.original);
      const geometries = new Map<string, BufferGeometry>();
      const made = levelGeometries(level, originals);
      made.forEach((geometry, index) => geometries.set(keys[index] ?? '', geometry));
      this.levelParts = { geometries: made, wedgeSets: level.groups.map(({ wedgeSet }) => wedgeSet) };
      this.result = new Side(model, this.lines, geometries);
    }
    previous?.dispose();
    this.tellEdges();
    this.invalidate();
  }

  /** Colours the result by its distances from the original, if they are of the level shown. */
  setDeviation(distances: readonly Float32Array[], limit: number): void {
    const { geometries, wedgeSets } = this.levelParts;
    if (!addDeviation(geometries, wedgeSets, distances)) return;
    this.surfaces.heatScale.value = limit;
    this.invalidate();
  }

  setSettings(settings: ViewSettings): void {
    const before = this.settings;
    this.settings = settings;
    const changed = (...names: ReadonlyArray<keyof ViewSettings>): boolean => names.some((name) => before[name] !== settings[name]);
    const told = this.panes.at(-1)?.side;
    if (changed('layout', 'comparing', 'split')) this.arrange();
    if (changed('surface')) this.paint();
    if (changed('animation')) this.playAnimation();
    this.morphs?.change(before.morphs, settings.morphs);
    this.lamp.set(settings.lamp);
    if (changed('lamp', 'surface')) this.light();
    this.original?.trim(settings);
    this.result?.trim(settings);
    if (changed('edgeClasses') || this.panes.at(-1)?.side !== told) this.tellEdges();
    this.invalidate();
  }

  setTheme({ lines, lineOpacity, shadowOpacity, edges }: ViewTheme): void {
    this.lines.wireframe.color = new Color(lines);
    this.lines.wireframe.opacity = lineOpacity;
    for (const name of ['border', 'seam', 'nonManifold'] as const) this.lines.edges[name].color = new Color(edges[name]);
    this.shadow.material.opacity = shadowOpacity;
    this.invalidate();
  }

  resize(size: ViewSize, insets: Insets): void {
    const before = this.size;
    this.size = size;
    this.insets = insets;
    if (size.width === before.width && size.height === before.height && size.pixelRatio === before.pixelRatio) {
      this.arrange();
      this.invalidate();
      return;
    }
    this.renderer.setPixelRatio(Math.min(size.pixelRatio, PIXEL_RATIO_LIMIT));
    this.renderer.setSize(size.width, size.height, false);
    this.arrange();
    // Setting the size clears the canvas: drawn at once, or it would flicker while the window is dragged.
    this.draw();
  }

  moveCamera(moves: readonly CameraMove[]): void {
    for (const move of moves) this.view.move(this.inPane(move));
    this.invalidate();
  }

  /** What painting on the model works with; null without a model. */
  get easel(): Easel | null {
    const { model, size } = this;
    return model && { model, camera: this.view.camera, width: size.width, height: size.height, draw: () => this.invalidate() };
  }

  /** A place under the pointer is one of the pane that it is over. */
  private inPane(move: CameraMove): CameraMove {
    if (move.kind !== 'zoom' || move.at === undefined) return move;
    const { x, y } = move.at;
    const pane = this.panes.find(({ visible }) => x >= visible.left && x < visible.left + visible.width) ?? this.panes[0];
    return { ...move, at: { x: x - (pane?.viewport.left ?? 0), y } };
  }

  /** Divides the canvas as the settings say; the camera's picture is as large as a pane's viewport. */
  private arrange(): void {
    const { layout, comparing, split } = this.settings;
    this.panes = panesOf({ layout, comparing, split, width: this.size.width, insets: this.insets });
    const viewport = this.panes[0]?.viewport ?? { left: 0, width: this.size.width };
    // Side by side the panes are what is free; else the model is centred in it.
    const insets = layout === 'beside' ? { ...this.insets, left: 0, right: 0 } : this.insets;
    this.view.resize(viewport.width, this.size.height, insets);
  }

  private playAnimation(): void {
    const clip = this.model?.animations[this.settings.animation];
    this.mixer?.stopAllAction();
    if (clip !== undefined) this.mixer?.clipAction(clip).play();
    this.morphs?.apply(this.settings.morphs);
  }

  /** Lights the room as the surfaces need it; beside a lamp of its own it is darker. */
  private light(): void {
    // The room alone lights white surfaces evenly; less of it and a lamp show their form.
    const intensity = this.settings.lamp === 'view' ? ROOM_INTENSITY : ROOM_INTENSITY / 3;
    const matt = this.settings.surface !== 'textured' || this.model === null || this.model.unpainted;
    this.scene.environment = matt ? null : this.room;
    this.scene.environmentIntensity = intensity;
    if (matt) this.scene.add(this.mattRoom);
    else this.scene.remove(this.mattRoom);
    // A little less: what it lacks in reflections would else be made up for by glare.
    this.mattRoom.intensity = 0.8 * intensity;
  }

  /** Gives every part the material of the surface that is wanted. */
  private paint(): void {
    for (const part of [...(this.model?.parts.values() ?? [])].flat()) this.paintPart(part);
  }

  private readonly paintPart = ({ mesh, material }: Part): void => {
    const change = (own: Material): Material => this.surfaces.materialFor(this.settings.surface, own, mesh.geometry);
    mesh.material = Array.isArray(material) ? material.map(change) : change(material);
  };

  private side({ side }: Pane): Side | null {
    return side === 'original' ? this.original : (this.result ?? this.original);
  }

  /** Finds the edges of what is to be drawn and tells of them. */
  private tellEdges(): void {
    const pane = this.panes.at(-1);
    const side = pane === undefined ? null : this.side(pane);
    if (this.settings.edgeClasses) {
      side?.enter(this.settings);
      side?.leave();
    }
    const counts = this.settings.edgeClasses ? (side?.edgeCounts ?? null) : null;
    this.events.onEdges(counts);
  }

  private clear(): void {
    this.mixer?.stopAllAction();
    if (this.model !== null) {
      this.mixer?.uncacheRoot(this.model.root);
      this.original?.dispose();
      this.result?.dispose();
      for (const { mesh, material } of [...this.model.parts.values()].flat()) mesh.material = material;
      this.stage.remove(this.model.root);
      disposeModel(this.model);
    }
    this.mixer = null;
    this.morphs = null;
    this.original = null;
    this.result = null;
    this.levelParts = { geometries: [], wedgeSets: [] };
    this.model = null;
  }

  /** Has the shaders of plain surfaces, smooth and flat, compiled while nobody waits: that can take as long as drawing. */
  private warmUp(): void {
    for (const attributes of [['position', 'normal'], ['position']]) {
      const geometry = new BufferGeometry();
      for (const name of attributes) geometry.setAttribute(name, new BufferAttribute(new Float32Array(9), 3));
      const mesh = new Mesh(geometry, this.surfaces.materialFor('shaded', new MeshStandardMaterial(), geometry));
      mesh.frustumCulled = false;
      this.scene.add(mesh);
      this.renderer.render(this.scene, this.view.camera);
      this.scene.remove(mesh);
      geometry.dispose();
    }
  }

  private invalidate(): void {
    if (this.frameRequest === 0) this.frameRequest = requestAnimationFrame((time) => this.onFrame(time));
  }

  private onFrame(time: number): void {
    this.frameRequest = 0;
    // The first frame after a rest has no frame before it.
    const elapsed = this.lastFrame === 0 ? 16 : Math.min(time - this.lastFrame, LONGEST_FRAME);
    const shown = this.model !== null && !this.contextLost;
    if (shown && this.settings.turntable && !this.reducedMotion) this.view.turn((2 * Math.PI * elapsed) / (1000 * TURNTABLE_TIME));
    const turning = shown && !this.reducedMotion && (this.lamp.advance(elapsed) || this.settings.turntable);
    const moving = this.view.advance(elapsed);
    const animating = this.settings.playing && this.mixer !== null;
    if (animating) {
      this.mixer?.update(elapsed / 1000);
      this.morphs?.apply(this.settings.morphs);
    }
    this.draw();
    const again = moving || animating || turning;
    this.lastFrame = again ? time : 0;
    if (again) this.invalidate();
  }

  private draw(): void {
    if (this.contextLost) return;
    const { renderer, size } = this;
    const divided = this.panes.length > 1;
    if (divided) {
      // What no pane covers is empty.
      renderer.setScissorTest(false);
      renderer.clear();
    }
    for (const pane of this.panes) {
      const side = this.side(pane);
      renderer.setViewport(pane.viewport.left, 0, pane.viewport.width, size.height);
      renderer.setScissor(pane.visible.left, 0, pane.visible.width, size.height);
      renderer.setScissorTest(divided);
      // The heat map alone is of one side only.
      side?.enter(this.settings, this.settings.surface === 'deviation' ? this.paintPart : undefined);
      renderer.render(this.scene, this.view.camera);
      side?.leave();
    }
  }
}
