// What is on the screen, frame by frame: the browser's own recording of a window, small, with the time of each frame.

/** Milliseconds without a change in the part looked at, after which it is taken to stay as it is. */
const REST = 1500;
/** By so much the values of a pixel that stays may differ, of 255: where a panel comes, a ground's dither changes. */
const TOLERANCE = 3;
/** Frames are recorded at most this wide and high: the recording is work, too. */
const SIZE = { maxWidth: 320, maxHeight: 200 };

/**
 * Begins to record the frames of `page`; resolves to `{ firstLikeLast }`.
 *
 * A frame's time is when it has been handed out, in milliseconds since 1970: the time in it is when it was begun, and
 * without a graphics card it may be drawn half a second later.
 */
export async function filmFrames(page) {
  const session = await page.context().newCDPSession(page);
  const frames = [];
  session.on('Page.screencastFrame', ({ data, sessionId }) => {
    frames.push({ time: Date.now(), data });
    session.send('Page.screencastFrameAck', { sessionId }).catch(() => {});
  });
  await session.send('Page.startScreencast', { format: 'png', ...SIZE });
  return {
    /** Ends the recording when `part` (left, top, right, bottom as shares) rests; the time of the first frame from which on it looks as in the last. */
    async firstLikeLast(part) {
      let first = 0;
      let rested = Date.now();
      for (let next = 1; Date.now() - rested < REST; await page.waitForTimeout(100)) {
        for (; next < frames.length; next += 1) {
          if (await looksAlike(page, [frames[first].data, frames[next].data], part)) continue;
          first = next;
          rested = Date.now();
        }
      }
      await session.send('Page.stopScreencast');
      await session.detach();
      return frames[first].time;
    },
  };
}

/** Whether `part` of two pictures, PNG files in base64, is the same. */
function looksAlike(page, pictures, part) {
  return page.evaluate(
    async ({ files, share: [left, top, right, bottom], tolerance }) => {
      const [a, b] = await Promise.all(
        files.map(async (base64) => {
          const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (character) => character.charCodeAt(0))]));
          const [x, y] = [Math.round(left * picture.width), Math.round(top * picture.height)];
          const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d', { willReadFrequently: true });
          context.drawImage(picture, 0, 0);
          return context.getImageData(x, y, Math.round(right * picture.width) - x, Math.round(bottom * picture.height) - y).data;
        }),
      );
      return a.length === b.length && a.every((value, index) => Math.abs(value - b[index]) <= tolerance);
    },
    { files: pictures, share: part, tolerance: TOLERANCE },
  );
}
