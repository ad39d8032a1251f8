// The camera: turns around the model, follows its goal smoothly, and fits to what the panels leave free of the view.
import { MathUtils, PerspectiveCamera, Spherical, Vector3 } from 'three';
import type { Box3 } from 'three';
import type { CameraMove, Insets } from './protocol.ts';

const HOME = new Spherical().setFromVector3(new Vector3(0.62, 0.34, 1));
const FIELD_OF_VIEW = 32;
const TANGENT = Math.tan(MathUtils.degToRad(FIELD_OF_VIEW) / 2);
/** Room left around a fitted model. */
const MARGIN = 1.1;
/** Milliseconds in which the camera covers two thirds of the way to its goal. */
const EASE_TIME = 70;
/** Distances in units of the model's radius. */
const NEAREST = 0.02;
const FARTHEST = 40;
/** Below this share of the distance a movement is no longer seen. */
const STILL = 1e-4;

/** Where the camera is: on a sphere around a point. */
class Pose {
  readonly target = new Vector3();
  readonly around = HOME.clone();

  copy(other: Pose): this {
    this.target.copy(other.target);
    this.around.copy(other.around);
    return this;
  }
}

/** Looks at a scene of about one unit in radius around the origin. */
export class OrbitCamera {
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
  private readonly now = new Pose();
  private readonly goal = new Pose();
  private readonly half = new Vector3(1, 1, 1);
  private width = 1;
  private height = 1;
  private insets: Insets = { top: 0, right: 0, bottom: 0, left: 0 };
  /** Whether the camera still stands where fitting put it: then it is fitted again when the window changes. */
  private fitted = true;

  /** `eased` false: every movement is a jump, for people who want no motion. */
  constructor(private readonly eased: boolean) {}

  /** Sets what is to be seen, a box around the origin, and jumps there. */
  frame(box: Box3): void {
    box.getSize(this.half).multiplyScalar(0.5);
    this.fit();
    this.jump();
  }

  resize(width: number, height: number, insets: Insets): void {
    this.width = Math.max(width, 1);
    this.height = Math.max(height, 1);
    this.insets = insets;
    this.camera.aspect = this.width / this.height;
    // The picture's centre moves to the centre of the free part.
    const right = (insets.right - insets.left) / 2;
    const down = (insets.bottom - insets.top) / 2;
    this.camera.setViewOffset(this.width, this.height, right, down, this.width, this.height);
    if (this.fitted) {
      this.fit();
      this.jump();
    }
    this.place();
  }

  move(move: CameraMove): void {
    this.fitted = move.kind === 'fit';
    switch (move.kind) {
      case 'fit':
        this.fit();
        break;
      case 'orbit':
        this.goal.around.theta -= (2 * Math.PI * move.x) / this.height;
        this.goal.around.phi -= (2 * Math.PI * move.y) / this.height;
        this.goal.around.makeSafe();
        break;
      case 'pan':
        this.goal.target.add(this.across(-move.x, move.y));
        break;
      case 'zoom':
        this.zoom(move.factor, move.at);
    }
    if (!this.eased) this.jump();
  }

  /** Goes around the model by `angle`, in radians, at once. */
  turn(angle: number): void {
    this.now.around.theta += angle;
    this.goal.around.theta += angle;
  }

  /** Comes nearer to the goal by `milliseconds` of time; true while it is not there. */
  advance(milliseconds: number): boolean {
    const { now, goal } = this;
    const left = Math.exp(-milliseconds / EASE_TIME);
    const approach = (from: number, to: number): number => to + (from - to) * left;
    now.target.lerpVectors(goal.target, now.target, left);
    now.around.theta = approach(now.around.theta, goal.around.theta);
    now.around.phi = approach(now.around.phi, goal.around.phi);
    now.around.radius = approach(now.around.radius, goal.around.radius);
    const radius = goal.around.radius;
    const rest =
      Math.abs(now.around.theta - goal.around.theta) +
      Math.abs(now.around.phi - goal.around.phi) +
      Math.abs(now.around.radius - radius) / radius +
      now.target.distanceTo(goal.target) / radius;
    if (rest < STILL) now.copy(goal);
    this.place();
    return rest >= STILL;
  }

  /** The whole model from its front, a little from above. */
  private fit(): void {
    const freeWidth = Math.max(this.width - this.insets.left - this.insets.right, this.width * 0.2);
    const freeHeight = Math.max(this.height - this.insets.top - this.insets.bottom, this.height * 0.2);
    const { x, y, z } = this.half;
    // The box seen from the home direction: its half extents across and up the picture, and towards the eye.
    const across = x * Math.abs(Math.cos(HOME.theta)) + z * Math.abs(Math.sin(HOME.theta));
    const depth = x * Math.abs(Math.sin(HOME.theta)) + z * Math.abs(Math.cos(HOME.theta));
    const up = y * Math.sin(HOME.phi) + depth * Math.cos(HOME.phi);
    const distance = Math.max((up * this.height) / freeHeight, (across * this.height) / freeWidth) / TANGENT;
    this.goal.target.set(0, 0, 0);
    this.goal.around.copy(HOME);
    this.goal.around.radius = distance * MARGIN + depth * 0.7;
  }

  private zoom(factor: number, at: { readonly x: number; readonly y: number } | undefined): void {
    const { around, target } = this.goal;
    const before = around.radius;
    around.radius = MathUtils.clamp(before / factor, NEAREST, FARTHEST);
    if (at === undefined) return;
    // What is under the pointer stays there.
    const fromCentre = this.across(
      at.x - (this.width + this.insets.left - this.insets.right) / 2,
      (this.height + this.insets.top - this.insets.bottom) / 2 - at.y,
      before,
    );
    target.addScaledVector(fromCentre, 1 - around.radius / before);
  }

  /** Pixels to the right and up as a vector in the plane of the target. */
  private across(right: number, up: number, radius = this.goal.around.radius): Vector3 {
    const scale = (2 * TANGENT * radius) / this.height;
    const eye = new Vector3().setFromSpherical(this.goal.around).normalize();
    const toRight = new Vector3(0, 1, 0).cross(eye).normalize();
    const toTop = new Vector3().crossVectors(eye, toRight);
    return toRight.multiplyScalar(right * scale).addScaledVector(toTop, up * scale);
  }

  private jump(): void {
    this.now.copy(this.goal);
    this.place();
  }

  private place(): void {
    const { camera, now } = this;
    camera.position.setFromSpherical(now.around).add(now.target);
    camera.lookAt(now.target);
    const distance = now.around.radius;
    camera.near = Math.max(distance / 500, distance - 8);
    camera.far = distance + 30;
    camera.updateProjectionMatrix();
  }
}
