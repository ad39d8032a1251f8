// Progressive meshes in three.js: an object that gets finer while its file arrives.

import { BufferAttribute, BufferGeometry, Group, Loader, Mesh, MeshStandardMaterial, type Material } from 'three';
import { DecimeshError } from './errors.js';
import { decodeProgressive, readProgressive, type ProgressiveInput } from './progressive.js';
import type { ProgressiveMesh } from './progressive/decode.js';
import type { LevelGeometry } from './types.js';

export { DecimeshError } from './errors.js';
export type { ProgressiveMesh } from './progressive/decode.js';

/** Names that three.js gives attributes. */
const NAMES: Readonly<Record<string, string>> = {
  NORMAL: 'normal', TANGENT: 'tangent', COLOR_0: 'color', JOINTS_0: 'skinIndex', WEIGHTS_0: 'skinWeight',
  TEXCOORD_0: 'uv', TEXCOORD_1: 'uv1', TEXCOORD_2: 'uv2', TEXCOORD_3: 'uv3', joints: 'skinIndex', weights: 'skinWeight',
};

/**
 * Loads progressive meshes. {@link load} calls back when the mesh is complete, as three.js's loaders do; until then
 * {@link onLevel} has the object to be shown, once with the base mesh and again each time that it has become finer.
 */
export class ProgressiveLoader extends Loader<Group> {
  /** Called with the object, the same one each time, when it can be shown and whenever it is finer. */
  onLevel: ((object: Group, mesh: ProgressiveMesh) => void) | undefined;
  /** The material of each group of triangles, by its name in the file. Default: one grey material for all. */
  material: ((name: string | null) => Material) | undefined;

  override load(url: string, onLoad: (object: Group) => void, _onProgress?: (event: ProgressEvent) => void, onError?: (error: unknown) => void): void {
    const address = this.manager.resolveURL(this.path + url);
    this.manager.itemStart(address);
    const headers = new Headers(this.requestHeader);
    const credentials = this.withCredentials ? 'include' : 'same-origin';
    fetch(address, { headers, credentials })
      .then((response) => this.read(response))
      .then(onLoad)
      .catch((error: unknown) => {
        if (onError === undefined) console.error(error);
        else onError(error);
        this.manager.itemError(address);
      })
      .finally(() => this.manager.itemEnd(address));
  }

  /** Reads from anything that `readProgressive` takes, with {@link onLevel} on the way, and resolves to the whole object. */
  async read(input: ProgressiveInput, signal?: AbortSignal): Promise<Group> {
    let shown: ProgressiveObject | undefined;
    for await (const mesh of readProgressive(input, { signal })) {
      shown ??= new ProgressiveObject(mesh, this.material);
      shown.update();
      this.onLevel?.(shown.group, mesh);
    }
    if (shown === undefined) throw new DecimeshError('truncated', 'the file ends before its content does');
    return shown.group;
  }

  /** The whole object at once. */
  parse(bytes: ArrayBuffer | Uint8Array): Group {
    return new ProgressiveObject(decodeProgressive(new Uint8Array(bytes)), this.material).update();
  }
}

/** A progressive mesh as a `Group` with a `Mesh` for each group of triangles. */
export class ProgressiveObject {
  /** Stays the same; its geometries change. */
  readonly group = new Group();
  readonly #mesh: ProgressiveMesh;

  constructor(mesh: ProgressiveMesh, material?: (name: string | null) => Material) {
    this.#mesh = mesh;
    const plain = material === undefined ? new MeshStandardMaterial({ color: 0xb0b0b0, roughness: 0.8 }) : undefined;
    for (const { object, material: name } of mesh.description.groups) {
      const part = new Mesh(new BufferGeometry(), plain ?? material?.(name));
      part.name = object ?? '';
      this.group.add(part);
    }
  }

  /** Shows the finest level that has arrived, or the level after so many splits. */
  update(splits?: number): Group {
    return this.show(this.#mesh.geometry(splits));
  }

  /** Shows any of the mesh's geometries: a level, a morph's, one refined in part. */
  show({ groups, wedgeSets }: LevelGeometry): Group {
    const shared = wedgeSets.map(({ positions, attributes }) => {
      const made: Array<[string, BufferAttribute]> = [['position', new BufferAttribute(positions, 3)]];
      for (const [name, { components, values }] of Object.entries(attributes)) {
        // Morph targets would need as many buffers as the material has been compiled for.
        if (!name.includes('/')) made.push([NAMES[name] ?? name, new BufferAttribute(values, components)]);
      }
      return made;
    });
    for (const [index, { indices, wedgeSet }] of groups.entries()) {
      const part = this.group.children[index] as Mesh;
      // Buffers on the graphics card do not grow: the geometry is made anew, and the old one's are freed.
      part.geometry.dispose();
      part.geometry = new BufferGeometry();
      part.geometry.setIndex(new BufferAttribute(indices, 1));
      for (const [name, attribute] of shared[wedgeSet] ?? []) part.geometry.setAttribute(name, attribute);
      if (!part.geometry.hasAttribute('normal')) part.geometry.computeVertexNormals();
    }
    return this.group;
  }
}
