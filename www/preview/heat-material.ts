// A surface coloured by the vertex attribute `deviation`, lit so that its form shows.
import { Color, MeshStandardMaterial } from 'three';
import type { Side } from 'three';
import { HEAT_COLOURS } from './heat.ts';

/** The distance that has the last colour, in model units; one object for all materials. */
export interface HeatScale {
  value: number;
}

/** `scale` is read at every picture. */
export function heatMaterial(scale: HeatScale, flatShading: boolean, side: Side): MeshStandardMaterial {
  const material = new MeshStandardMaterial({ flatShading, side, roughness: 1, metalness: 0 });
  material.toneMapped = false;
  material.onBeforeCompile = (shader) => {
    shader.uniforms['heatScale'] = scale;
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute float deviation;\nvarying float vDeviation;')
      .replace('#include <begin_vertex>', '#include <begin_vertex>\nvDeviation = deviation;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>\n${RAMP}`)
      // Little of it is light that falls in: the colour is what is to be read.
      .replace('#include <color_fragment>', 'vec3 heatColour = heat(vDeviation / max(heatScale, 1e-30));\ndiffuseColor.rgb = heatColour * 0.3;')
      .replace('#include <emissivemap_fragment>', 'totalEmissiveRadiance = heatColour * 0.6;');
  };
  material.customProgramCacheKey = () => 'heat';
  return material;
}

const STEPS = HEAT_COLOURS.length - 1;

const stop = (colour: (typeof HEAT_COLOURS)[number]): string => {
  // The shader computes with linear light.
  const { r, g, b } = new Color().setRGB(colour[0] / 255, colour[1] / 255, colour[2] / 255, 'srgb');
  return `vec3(${[r, g, b].map((part) => part.toFixed(5)).join(', ')})`;
};

const RAMP = `
uniform float heatScale;
varying float vDeviation;
vec3 heat(float share) {
  vec3 stops[${STEPS + 1}] = vec3[${STEPS + 1}](${HEAT_COLOURS.map(stop).join(', ')});
  float place = clamp(share, 0.0, 1.0) * ${STEPS}.0;
  int from = min(int(place), ${STEPS - 1});
  return mix(stops[from], stops[from + 1], place - float(from));
}`;
