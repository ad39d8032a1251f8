// The soft shadow under the model: no picture files needed.
import { DataTexture, LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry } from 'three';

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
