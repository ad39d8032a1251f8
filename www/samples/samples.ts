// The sample models; README.md in this folder has their origins and licences.
import bicyclePicture from './bicycle.webp';
import bicycle from './bicycle.glb?url';
import fanPicture from './desk-fan.webp';
import fan from './desk-fan.glb?url';
import helmetPicture from './flight-helmet.webp';
import helmet from './flight-helmet.glb?url';
import nefertitiPicture from './nefertiti.webp';
import nefertiti from './nefertiti.glb?url';

/** A model to try the page with. */
export interface Sample {
  readonly name: string;
  /** What a download of it is called. */
  readonly fileName: string;
  readonly address: string;
  readonly picture: string;
  readonly triangles: number;
  /** Of the file. */
  readonly bytes: number;
  /** What it shows. */
  readonly shows: 'textures' | 'animation' | 'scan' | 'parts';
  /** Shown with the model, as its licence asks. */
  readonly credit: string;
}

export const samples: readonly Sample[] = [
  { name: 'Flight helmet', fileName: 'flight-helmet.glb', address: helmet, picture: helmetPicture, triangles: 94_722, bytes: 2_988_408, shows: 'textures', credit: '“FlightHelmet” by Microsoft, CC0' },
  { name: 'Desk fan', fileName: 'desk-fan.glb', address: fan, picture: fanPicture, triangles: 21_080, bytes: 1_655_848, shows: 'animation', credit: '“Vintage desk fan” from the Babylon.js MeshesLibrary, CC BY 4.0, textures scaled down' },
  { name: 'Nefertiti', fileName: 'nefertiti.glb', address: nefertiti, picture: nefertitiPicture, triangles: 70_000, bytes: 1_261_084, shows: 'scan', credit: '“Nefertiti” scan by N. Al-Badri and J. N. Nelles, public domain' },
  { name: 'Bicycle', fileName: 'bicycle.glb', address: bicycle, picture: bicyclePicture, triangles: 274_536, bytes: 1_250_816, shows: 'parts', credit: '“Bike” from the pmnd.rs market, CC0' },
];
