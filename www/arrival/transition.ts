// The pictures on the way from one level to a finer one.
import type { Geomorph } from 'decimesh/progressive';
import type { LevelGeometry } from 'decimesh';

/** Attributes that are shades and places, and have values in between; numbers of joints, say, have none. */
const BLENDED = /^(NORMAL|COLOR_\d+|TEXCOORD_\d+)$/;

/** The mesh at `share`, above 0 and below 1, of the way. The arrays are new. */
export function onTheWay(morph: Geomorph, share: number): LevelGeometry {
  return {
    groups: morph.to.groups.map((group) => ({ ...group, indices: group.indices.slice() })),
    wedgeSets: morph.to.wedgeSets.map(({ positions, attributes }, set) => ({
      positions: morph.positions(set, share, new Float32Array(positions.length)),
      attributes: Object.fromEntries(
        Object.entries(attributes).map(([name, { components, values }]) => [
          name,
          { components, values: BLENDED.test(name) ? morph.attribute(set, name, share, new Float32Array(values.length)) : values.slice() },
        ]),
      ),
    })),
  };
}
