// How a model is drawn before anybody chooses: what the page begins with, and the view until the page has told it.
import type { ViewSettings } from './protocol.ts';

/** The file's own look, at rest. */
export const STILL_LIFE: ViewSettings = {
  surface: 'textured',
  wireframe: false,
  edgeClasses: false,
  playing: false,
  animation: 0,
  comparing: false,
  layout: 'single',
  split: 0.5,
  turntable: false,
  lamp: 'view',
  morphs: [],
};
