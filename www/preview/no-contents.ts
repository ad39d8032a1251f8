// A model that has nothing to be looked at but its surface; apart from the view, so that the page's state needs no three.
import type { ViewContents } from './protocol.ts';

/** Nothing to choose from. */
export const NO_CONTENTS: ViewContents = { animations: [], morphs: [], textureCoordinates: false };
