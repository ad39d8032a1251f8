// The engine's arrays of an opened file, by the groups and sets of its summary.

import type { EngineObject } from '../engine.js';
import type { ProgressiveSource } from '../progressive/source.js';
import type { DocumentSummary, LevelGeometry } from '../types.js';
import type { Model } from '../wasm/decimesh.js';

/** The selected level. */
export function levelGeometry(document: EngineObject<Model>, { groups, wedgeSets }: DocumentSummary): LevelGeometry {
  return {
    groups: groups.map(({ mesh, primitive, wedgeSet }, index) => ({
      mesh,
      primitive,
      wedgeSet,
      indices: document.call((model) => model.levelIndices(index)),
    })),
    wedgeSets: wedgeSets.map(({ attributes }, set) => ({
      positions: document.call((model) => model.levelPositions(set)),
      attributes: Object.fromEntries(
        attributes.map(({ name, components }, index) => [
          name,
          { components, values: document.call((model) => model.levelAttribute(set, index)) },
        ]),
      ),
    })),
  };
}

/** The positions of each wedge set as in the file, whatever runs left of them. The selected level stays as it is. */
export function originalPositions(document: EngineObject<Model>, { wedgeSets }: DocumentSummary): Float32Array[] {
  return document.call((model) => {
    model.putAside();
    try {
      return wedgeSets.map((_, set) => model.levelPositions(set));
    } finally {
      model.bringBack();
    }
  });
}

/** Full detail with the record. The selected level stays as it is. Throws `wrong-state` where there is no whole record. */
export function progressiveSource(document: EngineObject<Model>, { groups, wedgeSets, diagonal }: DocumentSummary): ProgressiveSource {
  return document.call((model) => {
    const words = model.history();
    model.putAside();
    try {
      return {
        words,
        diagonal,
        groups: groups.map(({ mesh, primitive, object, material, wedgeSet }, index) => ({
          mesh, primitive, object, material, wedgeSet, indices: model.levelIndices(index),
        })),
        wedgeSets: wedgeSets.map(({ attributes }, set) => ({
          positions: model.levelPositions(set),
          attributes: attributes.map((attribute, index) => ({ ...attribute, values: model.levelAttribute(set, index) })),
        })),
      };
    } finally {
      model.bringBack();
    }
  });
}
