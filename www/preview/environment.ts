// Image-based light from a small drawn room, and the soft shadow under the model: no picture files needed.
import { DataTexture, LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, PMREMGenerator } from 'three';
import type { WebGLRenderTarget, WebGLRenderer } from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';

/** The room as light; the caller disposes of it, and makes a new one after a lost context. */
export function roomLight(renderer: WebGLRenderer): Pick<WebGLRenderTarget, 'texture' | 'dispose'> {
  const generator = new PMREMGenerator(renderer);
  const room = new RoomEnvironment();
  // Half of the usual size: filtering it is most of the time from opening the page to the first picture.
  const light = generator.fromScene(room, 0.03, 0.1, 100, { size: 128 });
  room.dispose();
  generator.dispose();
  return light;
}

/** A round, soft shadow of diameter 1 lying in the plane y = 0, visible from above only. */
export function softShadow(): Mesh<PlaneGeometry, MeshBasicMaterial> {
  const size = 64;
  const pixels = new Uint8Array(size * size * 4);
  for (let pixel = 0; pixel < size * size; pixel += 1) {
    const x = ((pixel % size) + 0.5) / size - 0.5;
    const y = (Math.floor(pixel / size) + 0.5) / size - 0.5;
    const inside = Math.max(0, 1 - 4 * (x * x + y * y));
    // A cubic fall-off ends without an edge.
    pixels[4 * pixel + 3] = 255 * inside ** 3;
  }
  const map = new DataTexture(pixels, size, size);
  map.magFilter = LinearFilter;
  map.needsUpdate = true;
  const material = new MeshBasicMaterial({ map, transparent: true, depthWrite: false, toneMapped: false });
  const mesh = new Mesh(new PlaneGeometry(1, 1).rotateX(-Math.PI / 2), material);
  mesh.renderOrder = -1;
  return mesh;
}
