// The 3D view: draws a loaded model at any level of detail, when something changed and not otherwise.
import { AnimationMixer, Box3, Color, DirectionalLight, Group, NeutralToneMapping, Scene, Vector3, WebGLRenderer } from 'three';
import type { BufferGeometry } from 'three';
import type { LevelGeometry } from 'decimesh';
import { OrbitCamera } from './camera.ts';
import { roomLight, softShadow } from './environment.ts';
import { levelGeometries } from './geometry.ts';
import { disposeModel, materialsOf, partKey, scaleLights } from './load.ts';
import type { LoadedModel } from './load.ts';
import type { CameraMove, Insets, ViewSettings, ViewSize, ViewTheme } from './protocol.ts';
import { edgeMaterial, showEdges } from './wireframe.ts';
import type { EdgeOverlay } from './wireframe.ts';

/** More than two device pixels each way cost four times the work and are not seen on a moving model. */
const PIXEL_RATIO_LIMIT = 2;
/** After a pause an animation goes on where it was, and does not leap. */
const LONGEST_FRAME = 100;
/** Milliseconds between two looks whether the graphics card is done. */
const FENCE_INTERVAL = 4;

/** What happens to the graphics card's memory. */
export interface ViewerEvents {
  onContextLost(): void;
  onContextRestored(): void;
}

/** Owns the canvas's WebGL context and everything in it. The constructor throws when there is no WebGL2. */
export class Viewer {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly stage = new Group();
  private readonly shadow = softShadow();
  private readonly edges = edgeMaterial();
  private readonly view: OrbitCamera;
  private light: ReturnType<typeof roomLight>;
  private model: LoadedModel | null = null;
  private mixer: AnimationMixer | null = null;
  private level: { geometries: BufferGeometry[]; keys: string[] } | null = null;
  private overlays: EdgeOverlay[] = [];
  private settings: ViewSettings = { wireframe: false, playing: false, animation: 0, comparing: false };
  private contextLost = false;
  private frameRequest = 0;
  private lastFrame = 0;

  constructor(canvas: OffscreenCanvas | HTMLCanvasElement, events: ViewerEvents, reducedMotion: boolean) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: 'high-performance' });
    // Asking for compile errors waits for the compiler; ours are three's own shaders.
    this.renderer.debug.checkShaderErrors = false;
    this.renderer.toneMapping = NeutralToneMapping;
    this.light = roomLight(this.renderer);
    this.scene.environment = this.light.texture;
    // The room alone lights white surfaces evenly; less of it and a lamp over the viewer's shoulder show their form.
    this.scene.environmentIntensity = 0.58;
    const lamp = new DirectionalLight(0xffffff, 1.25);
    lamp.position.set(-0.8, 1.3, 0.9);
    this.view = new OrbitCamera(!reducedMotion);
    this.view.camera.add(lamp, lamp.target);
    lamp.target.position.set(0, 0, -1);
    this.scene.add(this.view.camera);
    this.shadow.visible = false;
    this.scene.add(this.stage, this.shadow);

    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.contextLost = true;
      events.onContextLost();
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.contextLost = false;
      // Buffers and pictures are uploaded again from memory; what was drawn on the card is gone.
      this.light.dispose();
      this.light = roomLight(this.renderer);
      this.scene.environment = this.light.texture;
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
    for (const material of materialsOf(model.root)) {
      // Room for the lines in front of the surface.
      material.polygonOffset = true;
      material.polygonOffsetFactor = 1;
      material.polygonOffsetUnits = 1;
    }
    this.stage.add(model.root);
    this.mixer = model.animations.length > 0 ? new AnimationMixer(model.root) : null;
    this.playAnimation();
    this.refreshOverlays();
    this.invalidate();
  }

  /** Draws what there is and resolves when the graphics card has done so, or has lost everything. */
  async drawn(): Promise<void> {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.draw();
    const fence = this.contextLost ? null : gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (fence === null) return;
    gl.flush();
    // Asking does not wait; the answer changes only between tasks.
    while (!this.contextLost && gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.UNSIGNALED) {
      await new Promise((resolve) => setTimeout(resolve, FENCE_INTERVAL));
    }
    gl.deleteSync(fence);
  }

  /** Swaps every group's geometry for `level`; null shows the file's own. */
  setLevel(level: LevelGeometry | null): void {
    const model = this.model;
    if (model === null) return;
    const previous = this.level;
    if (level === null) this.level = null;
    else {
      const keys = level.groups.map((group) => partKey(group.mesh, group.primitive));
      const originals = keys.map((key) => model.parts.get(key)?.[0]?.original);
      this.level = { keys, geometries: levelGeometries(level, originals) };
    }
    this.applyGeometry();
    for (const geometry of previous?.geometries ?? []) geometry.dispose();
  }

  setSettings(settings: ViewSettings): void {
    const before = this.settings;
    this.settings = settings;
    if (before.comparing !== settings.comparing) this.applyGeometry();
    else if (before.wireframe !== settings.wireframe) this.refreshOverlays();
    if (before.animation !== settings.animation) this.playAnimation();
    this.invalidate();
  }

  setTheme({ lines, lineOpacity, shadowOpacity }: ViewTheme): void {
    this.edges.color = new Color(lines);
    this.edges.opacity = lineOpacity;
    this.shadow.material.opacity = shadowOpacity;
    this.invalidate();
  }

  resize({ width, height, pixelRatio }: ViewSize, insets: Insets): void {
    this.renderer.setPixelRatio(Math.min(pixelRatio, PIXEL_RATIO_LIMIT));
    this.renderer.setSize(width, height, false);
    this.view.resize(width, height, insets);
    // Setting the size clears the canvas: drawn at once, or it would flicker while the window is dragged.
    this.draw();
  }

  moveCamera(moves: readonly CameraMove[]): void {
    for (const move of moves) this.view.move(move);
    this.invalidate();
  }

  private playAnimation(): void {
    const clip = this.model?.animations[this.settings.animation];
    this.mixer?.stopAllAction();
    if (clip !== undefined) this.mixer?.clipAction(clip).play();
  }

  private applyGeometry(): void {
    const { model, level } = this;
    if (model === null) return;
    const shown = new Map<string, BufferGeometry>();
    if (level !== null && !this.settings.comparing) {
      level.keys.forEach((key, index) => {
        const geometry = level.geometries[index];
        if (geometry !== undefined) shown.set(key, geometry);
      });
    }
    for (const [key, parts] of model.parts) {
      for (const part of parts) part.mesh.geometry = shown.get(key) ?? part.original;
    }
    this.refreshOverlays();
    this.invalidate();
  }

  private refreshOverlays(): void {
    for (const overlay of this.overlays) overlay.dispose();
    this.overlays = [];
    if (!this.settings.wireframe || this.model === null) return;
    for (const parts of this.model.parts.values()) {
      for (const { mesh } of parts) this.overlays.push(showEdges(mesh, this.edges));
    }
  }

  private clear(): void {
    for (const overlay of this.overlays) overlay.dispose();
    this.overlays = [];
    this.mixer?.stopAllAction();
    this.mixer = null;
    for (const geometry of this.level?.geometries ?? []) geometry.dispose();
    this.level = null;
    if (this.model !== null) {
      this.stage.remove(this.model.root);
      disposeModel(this.model);
    }
    this.model = null;
  }

  private invalidate(): void {
    if (this.frameRequest === 0) this.frameRequest = requestAnimationFrame((time) => this.onFrame(time));
  }

  private onFrame(time: number): void {
    this.frameRequest = 0;
    // The first frame after a rest has no frame before it.
    const elapsed = this.lastFrame === 0 ? 16 : Math.min(time - this.lastFrame, LONGEST_FRAME);
    const moving = this.view.advance(elapsed);
    const animating = this.settings.playing && this.mixer !== null;
    if (animating) this.mixer?.update(elapsed / 1000);
    this.draw();
    this.lastFrame = moving || animating ? time : 0;
    if (moving || animating) this.invalidate();
  }

  private draw(): void {
    if (!this.contextLost) this.renderer.render(this.scene, this.view.camera);
  }
}
