// Decoding, scaling and encoding of images: the browser's canvas, or on Node the package `sharp` if it is there.

import { DecimeshError } from '../errors.js';

/** What an image can be encoded as. */
export type ImageFormat = 'webp' | 'jpeg' | 'png';

/** How to encode an image. */
export interface ImageRequest {
  readonly type: string;
  /** The longer side at most, pixels; undefined: as it is. */
  readonly maxSize: number | undefined;
  /** Undefined: what it was. */
  readonly format: ImageFormat | undefined;
  /** 0 to 1. */
  readonly quality: number;
}

/** An image as a file, and what it is a file of. */
export interface EncodedImage {
  readonly bytes: Uint8Array;
  readonly format: ImageFormat;
}

/** Encodes images. Rejects when one cannot be decoded. */
export type ImageCodec = (bytes: Uint8Array, request: ImageRequest) => Promise<EncodedImage>;

/** More pixels than these are not decoded: a few kilobytes can hold a billion of one colour. */
const MOST_PIXELS = 1 << 28;

/** The part of sharp that is used. */
interface Sharp {
  metadata(): Promise<{ width?: number; height?: number }>;
  resize(width: number, height: number, options: object): Sharp;
  toFormat(format: string, options: object): Sharp;
  toBuffer(): Promise<Uint8Array>;
}

/** The codec of this platform; rejects with `unsupported` where there is none. */
export async function imageCodec(): Promise<ImageCodec> {
  if (typeof OffscreenCanvas !== 'undefined' && typeof createImageBitmap !== 'undefined') return encodeOnCanvas;
  // Not for a bundler: it is for Node alone, and need not be there.
  const name = 'sharp';
  try {
    const module = (await import(/* @vite-ignore */ name)) as { default: (bytes: Uint8Array, options: object) => Sharp };
    return (bytes, request) => encodeWithSharp(module.default, bytes, request);
  } catch (error) {
    const message = 'textures on Node need the package sharp, which is not there: npm install sharp';
    throw new DecimeshError('unsupported', message, 'prepare.textures', { cause: error });
  }
}

/** The size of an image whose longer side is at most `maxSize`. */
function sizeWithin(width: number, height: number, maxSize: number | undefined): readonly [number, number] {
  const scale = maxSize === undefined ? 1 : Math.min(1, maxSize / Math.max(width, height));
  return [Math.max(1, Math.round(width * scale)), Math.max(1, Math.round(height * scale))];
}

function formatOf({ type, format }: ImageRequest): ImageFormat {
  return format ?? (type === 'image/webp' ? 'webp' : type === 'image/jpeg' ? 'jpeg' : 'png');
}

async function encodeWithSharp(sharp: (bytes: Uint8Array, options: object) => Sharp, bytes: Uint8Array, request: ImageRequest): Promise<EncodedImage> {
  const format = formatOf(request);
  const image = sharp(bytes, { limitInputPixels: MOST_PIXELS });
  const { width = 1, height = 1 } = await image.metadata();
  const [toWidth, toHeight] = sizeWithin(width, height, request.maxSize);
  const scaled = toWidth === width && toHeight === height ? image : image.resize(toWidth, toHeight, { fit: 'fill' });
  const quality = Math.max(1, Math.round(100 * request.quality));
  const encoded = await scaled.toFormat(format, format === 'png' ? { compressionLevel: 9 } : { quality }).toBuffer();
  // A buffer of Node's may be a part of a larger one.
  return { bytes: new Uint8Array(encoded), format };
}

async function encodeOnCanvas(bytes: Uint8Array, request: ImageRequest): Promise<EncodedImage> {
  const format = formatOf(request);
  const blob = new Blob([bytes as Uint8Array<ArrayBuffer>], { type: request.type });
  // The numbers as they are: a texture's meaning is not always a colour.
  const bitmap = await createImageBitmap(blob, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
  try {
    const { width, height } = bitmap;
    if (width * height > MOST_PIXELS) throw new RangeError(`${width} × ${height} pixels are too many`);
    const [toWidth, toHeight] = sizeWithin(width, height, request.maxSize);
    const canvas = new OffscreenCanvas(toWidth, toHeight);
    const context = canvas.getContext('2d');
    if (context === null) throw new RangeError('there is no canvas');
    context.imageSmoothingQuality = 'high';
    context.drawImage(bitmap, 0, 0, toWidth, toHeight);
    const type = `image/${format}`;
    const encoded = await canvas.convertToBlob({ type, quality: request.quality });
    // A browser without the format gives PNG in its place.
    if (encoded.type !== type) throw new DecimeshError('unsupported', `this browser cannot encode ${format}`, 'prepare.textures.format');
    return { bytes: new Uint8Array(await encoded.arrayBuffer()), format };
  } finally {
    bitmap.close();
  }
}
