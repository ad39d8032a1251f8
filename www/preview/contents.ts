// What a model has to be looked at: animations, morph targets, texture coordinates.
import type { Mesh } from 'three';
import type { LoadedModel } from './load.ts';
import type { ViewContents } from './protocol.ts';

export function contentsOf(model: LoadedModel): ViewContents {
  const morphs = new Map<string, number>();
  let textureCoordinates = false;
  for (const { mesh, original } of [...model.parts.values()].flat()) {
    textureCoordinates ||= original.getAttribute('uv') !== undefined;
    for (const [name, target] of targetsOf(mesh)) {
      if (!morphs.has(name)) morphs.set(name, mesh.morphTargetInfluences?.[target] ?? 0);
    }
  }
  return {
    animations: model.animations.map((clip, index) => clip.name || `Animation ${index + 1}`),
    morphs: [...morphs].map(([name, weight]) => ({ name, weight })),
    textureCoordinates,
  };
}

/** Weights of morph targets, set by name for all meshes at once. */
export class MorphSetter {
  /** For each name the places that it stands for, and what the file has there. */
  private readonly targets: Array<Array<{ readonly influences: number[]; readonly target: number; readonly weight: number }>> = [];

  constructor(model: LoadedModel) {
    const byName = new Map<string, (typeof this.targets)[number]>();
    const meshes = new Set([...model.parts.values()].flat().map(({ mesh }) => mesh));
    for (const mesh of meshes) {
      const influences = mesh.morphTargetInfluences;
      if (influences === undefined) continue;
      for (const [name, target] of targetsOf(mesh)) {
        const places = byName.get(name) ?? [];
        places.push({ influences, target, weight: influences[target] ?? 0 });
        byName.set(name, places);
      }
    }
    this.targets.push(...byName.values());
  }

  /** Puts the weights given in place, over what an animation has put there. */
  apply(weights: ReadonlyArray<number | null>): void {
    weights.forEach((weight, index) => {
      if (weight === null) return;
      for (const { influences, target } of this.targets[index] ?? []) influences[target] = weight;
    });
  }

  /** As {@link apply}; targets that are let go of have what the file says, until an animation moves them. */
  change(before: ReadonlyArray<number | null>, now: ReadonlyArray<number | null>): void {
    before.forEach((weight, index) => {
      if (weight === null || (now[index] ?? null) !== null) return;
      for (const { influences, target, weight: own } of this.targets[index] ?? []) influences[target] = own;
    });
    this.apply(now);
  }
}

// In the order of the targets: files without names have their numbers.
const targetsOf = (mesh: Mesh): Array<[string, number]> =>
  Object.entries(mesh.morphTargetDictionary ?? {}).sort(([, a], [, b]) => a - b);
