// The lamp: over the viewer's shoulder, beside the model, or going around it, so that faults of shading show.
import { DirectionalLight, Group } from 'three';
import type { Camera, Scene } from 'three';
import type { Lamp } from './protocol.ts';

/** Seconds in which a turning lamp goes once around. */
const TURN_TIME = 8;

/** A directional light that hangs at the camera or in the scene. */
export class LampRig {
  private readonly light = new DirectionalLight(0xffffff, 1.25);
  private readonly carousel = new Group();
  private place: Lamp = 'view';

  constructor(
    private readonly scene: Scene,
    private readonly camera: Camera,
  ) {
    this.light.target.position.set(0, 0, -1);
    this.scene.add(this.carousel);
    this.put('view');
  }

  /** Moves the lamp; a turning one begins from the front. */
  set(place: Lamp): void {
    if (place === this.place) return;
    this.carousel.rotation.y = 0;
    this.put(place);
  }

  /** Lets a turning lamp go on by `milliseconds`; whether it turns. */
  advance(milliseconds: number): boolean {
    if (this.place !== 'turning') return false;
    this.carousel.rotation.y += (2 * Math.PI * milliseconds) / (1000 * TURN_TIME);
    return true;
  }

  private put(place: Lamp): void {
    this.place = place;
    const holder = place === 'view' ? this.camera : this.carousel;
    holder.add(this.light, this.light.target);
    if (place === 'view') {
      this.light.position.set(-0.8, 1.3, 0.9);
      this.light.target.position.set(0, 0, -1);
    } else {
      // Low, so that light rakes over the surface.
      this.light.position.set(-1.6, 0.9, 1.6);
      this.light.target.position.set(0, 0, 0);
    }
    // Light beside the model is to be seen against the room's, which shines from everywhere.
    this.light.intensity = place === 'view' ? 1.25 : 2.2;
  }
}
