// The scale of the heat map: how distances become colours, the same for the picture and its legend.
import type { Deviation } from '../state.ts';

/** Colours from no distance to the limit, evenly spaced, as sRGB: told apart without red and green, too. */
export const HEAT_COLOURS: ReadonlyArray<readonly [red: number, green: number, blue: number]> = [
  [40, 66, 148],
  [86, 158, 204],
  [232, 236, 214],
  [248, 186, 84],
  [186, 24, 38],
];

/** The distance that has the last colour, in model units: a few far places must not leave the rest without colour. */
export const heatLimit = ({ max, rms }: Pick<Deviation, 'max' | 'rms'>): number => Math.min(max, 6 * rms);
