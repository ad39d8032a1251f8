// How large an error appears on the screen, and what follows for levels of detail.

import { checkNames } from './check.js';
import { invalidArgument } from './errors.js';
import type { LodSwitch, ScreenView } from './types.js';

const VIEW_NAMES = ['distance', 'fieldOfView', 'viewportHeight'];
const SWITCH_NAMES = ['pixels', 'viewportHeight', 'aspectRatio'];

const FIELD_OF_VIEW = 45;
const VIEWPORT_HEIGHT = 1080;

/**
 * The error in model units that takes so many pixels in the middle of a picture of a model with this bounding box's
 * diagonal. Throws `invalid-argument` naming what is out of range.
 */
export function errorOfPixels(pixels: number, view: ScreenView | undefined, diagonal: number): number {
  if (typeof pixels !== 'number' || !(pixels >= 0) || pixels === Infinity) {
    throw invalidArgument('pixels', 'must be a number of at least 0');
  }
  checkNames(view ?? {}, VIEW_NAMES, 'view');
  const { distance, fieldOfView = FIELD_OF_VIEW, viewportHeight = VIEWPORT_HEIGHT } = view ?? {};
  if (typeof fieldOfView !== 'number' || !(fieldOfView > 0 && fieldOfView < 180)) {
    throw invalidArgument('view.fieldOfView', 'must be above 0 and below 180 degrees');
  }
  checkPositive('view.viewportHeight', viewportHeight);
  const half = (fieldOfView * Math.PI) / 360;
  // The box lies in a sphere of half its diagonal; the sphere touches the pyramid of view there.
  const away = distance ?? diagonal / 2 / Math.sin(half);
  if (distance !== undefined) checkPositive('view.distance', distance);
  return (pixels * 2 * away * Math.tan(half)) / viewportHeight;
}

/**
 * For each level of a chain, by its error in model units, the smallest screen coverage at which it is shown: the area
 * of the bounding sphere's disc as a share of the picture's, 0 to 1. The last is 0: a chain never vanishes.
 *
 * A level takes over where its error e appears as `pixels` of the `viewportHeight`, that is where the picture is
 * h = e · viewportHeight / pixels model units high; a sphere of radius r covers π r² / (h² · aspectRatio) of it there. At
 * which distance that is depends on the field of view, the coverage does not.
 */
export function screenCoverages(errors: readonly number[], diagonal: number, options: LodSwitch = {}): number[] {
  checkNames(options, SWITCH_NAMES, 'lodSwitch');
  const { pixels = 1, viewportHeight = VIEWPORT_HEIGHT, aspectRatio = 16 / 9 } = options;
  for (const [name, value] of Object.entries({ pixels, viewportHeight, aspectRatio })) checkPositive(`lodSwitch.${name}`, value);
  let coverage = 1;
  return errors.map((_, level) => {
    const next = errors[level + 1];
    if (next === undefined) return 0;
    const height = (next * viewportHeight) / pixels;
    const covered = (Math.PI * (diagonal / 2) ** 2) / (height * height * aspectRatio);
    // A level without an error shows as soon as any other; none may begin before a finer one has.
    coverage = Math.min(coverage, covered);
    return coverage;
  });
}

function checkPositive(name: string, value: unknown): void {
  if (typeof value !== 'number' || !(value > 0) || value === Infinity) throw invalidArgument(name, 'must be a number above 0');
}
