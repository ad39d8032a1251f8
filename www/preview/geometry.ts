// Turns a level of detail from the engine into three.js geometries, without computing anything per vertex.
import { BufferAttribute, BufferGeometry } from 'three';
import type { LevelGeometry } from 'decimesh';

type WedgeSet = LevelGeometry['wedgeSets'][number];

/** glTF's attribute names under the names that three's materials look for. */
const THREE_NAMES: Readonly<Record<string, string>> = {
  NORMAL: 'normal',
  TANGENT: 'tangent',
  TEXCOORD_0: 'uv',
  TEXCOORD_1: 'uv1',
  TEXCOORD_2: 'uv2',
  TEXCOORD_3: 'uv3',
  COLOR_0: 'color',
  JOINTS_0: 'skinIndex',
  WEIGHTS_0: 'skinWeight',
};

/** three's names of the attributes that morph targets may change. */
const MORPH_NAMES: Readonly<Record<string, string>> = { POSITION: 'position', NORMAL: 'normal', COLOR_0: 'color' };

/**
 * One geometry for each group of `level`, in its order.
 *
 * Groups of one wedge set share its attributes, so they are uploaded once; `originals` are the file's geometries in
 * the same order and lend their bounds (a simplified surface stays within a hair of them) and count of morph targets.
 */
export function levelGeometries(level: LevelGeometry, originals: ReadonlyArray<BufferGeometry | undefined>): BufferGeometry[] {
  const wedgeSets = level.wedgeSets.map(wedgeSetAttributes);
  return level.groups.map((group, index) => {
    const geometry = new BufferGeometry();
    const shared = wedgeSets[group.wedgeSet];
    const original = originals[index];
    if (shared !== undefined) {
      for (const [name, attribute] of shared.attributes) geometry.setAttribute(name, attribute);
      const targets = Object.values(original?.morphAttributes ?? {})[0]?.length ?? 0;
      if (targets > 0) addMorphTargets(geometry, shared, targets);
    }
    geometry.setIndex(new BufferAttribute(group.indices, 1));
    geometry.boundingBox = original?.boundingBox ?? null;
    geometry.boundingSphere = original?.boundingSphere ?? null;
    return geometry;
  });
}

/**
 * Gives the geometries of a level, made by {@link levelGeometries}, the distances of their vertices from the original.
 * Whether they fit: an array for each wedge set, a number for each of its vertices.
 */
export function addDeviation(geometries: readonly BufferGeometry[], wedgeSetOfGroup: readonly number[], wedgeSets: readonly Float32Array[]): boolean {
  const attributes = wedgeSets.map((values) => new BufferAttribute(values, 1));
  const fits = geometries.every((geometry, index) => geometry.getAttribute('position')?.count === attributes[wedgeSetOfGroup[index] ?? -1]?.count);
  if (!fits) return false;
  geometries.forEach((geometry, index) => {
    const attribute = attributes[wedgeSetOfGroup[index] ?? -1];
    if (attribute !== undefined) geometry.setAttribute('deviation', attribute);
  });
  return true;
}

interface SharedAttributes {
  readonly attributes: Map<string, BufferAttribute>;
  /** By three's name, then by index of the target. */
  readonly morphTargets: Map<string, BufferAttribute[]>;
  readonly vertices: number;
}

function wedgeSetAttributes(wedgeSet: WedgeSet): SharedAttributes {
  const attributes = new Map([['position', new BufferAttribute(wedgeSet.positions, 3)]]);
  const morphTargets = new Map<string, BufferAttribute[]>();
  for (const [name, { components, values }] of Object.entries(wedgeSet.attributes)) {
    const target = /^TARGET_(\d+)\/(.+)$/.exec(name);
    if (target === null) {
      // three knows custom attributes by their names in lower case.
      attributes.set(THREE_NAMES[name] ?? name.toLowerCase(), new BufferAttribute(values, components));
      continue;
    }
    const morphName = MORPH_NAMES[target[2] ?? ''];
    if (morphName === undefined) continue;
    const list = morphTargets.get(morphName) ?? [];
    list[Number(target[1])] = new BufferAttribute(values, components);
    morphTargets.set(morphName, list);
  }
  return { attributes, morphTargets, vertices: wedgeSet.positions.length / 3 };
}

function addMorphTargets(geometry: BufferGeometry, shared: SharedAttributes, targets: number): void {
  for (const [name, given] of shared.morphTargets) {
    const components = given.find((attribute) => attribute !== undefined)?.itemSize ?? 3;
    // A target that leaves this attribute alone has a displacement of zero; three wants every target there.
    const still = new BufferAttribute(new Float32Array(shared.vertices * components), components);
    geometry.morphAttributes[name as 'position'] = Array.from({ length: targets }, (_, target) => given[target] ?? still);
  }
  geometry.morphTargetsRelative = true;
}
