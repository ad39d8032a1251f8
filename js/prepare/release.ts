// Accessors that lost their use give their bytes back, and keep their place for the numbers of those behind them.

import type { GltfData, Layout } from '../codecs/gltf_data.js';
import { objectOr, objects, uint } from '../codecs/tree.js';

/** Empties those of `candidates` that nothing uses any more, and closes the gaps in the views where they were. */
export function releaseAccessors(data: GltfData, candidates: ReadonlySet<number>): void {
  const used = data.usedElsewhere([]);
  const views = new Set<number>();
  for (const index of candidates) {
    if (used.has(index)) continue;
    const json = data.accessor(index);
    const sparse = objectOr(json['sparse']);
    for (const holder of [json, objectOr(sparse['indices']), objectOr(sparse['values'])]) {
      const view = uint(holder['bufferView']);
      if (view !== undefined) views.add(view);
    }
    // The smallest valid thing: one zero.
    for (const key of ['bufferView', 'byteOffset', 'sparse', 'min', 'max']) delete json[key];
    json['count'] = 1;
  }
  data.freeViews(views);
  closeGaps(data, views);
}

/** The elements of accessors, from the first byte to behind the last. */
interface Range {
  readonly start: number;
  readonly end: number;
  readonly accessor: number;
  readonly layout: Layout;
}

/** Puts what the accessors of each view use together, in its order. */
export function closeGaps(data: GltfData, views: ReadonlySet<number>): void {
  const barred = data.viewsBesideAccessors();
  const ranges = new Map<number, Range[] | undefined>();
  for (const [accessor, json] of objects(data.tree, 'accessors').entries()) {
    const view = uint(json['bufferView']);
    if (view === undefined || !views.has(view)) continue;
    const layout = data.layout(accessor);
    const known = ranges.has(view) ? ranges.get(view) : [];
    if (layout === undefined || known === undefined || barred.has(view)) {
      ranges.set(view, undefined);
      continue;
    }
    const end = layout.offset + (layout.count - 1) * layout.stride + layout.size;
    ranges.set(view, [...known, { start: layout.offset, end, accessor, layout }]);
  }
  for (const [view, list] of ranges) if (list !== undefined) pack(data, view, list);
}

function pack(data: GltfData, view: number, ranges: readonly Range[]): void {
  const bytes = data.views[view];
  if (bytes === undefined) return;
  const sorted = [...ranges].sort((a, b) => a.start - b.start || b.end - a.end);
  const pieces: Array<{ from: number; end: number; to: number }> = [];
  const offsets = new Map<number, number>();
  let length = 0;
  for (const { start, end, accessor, layout } of sorted) {
    let piece = pieces.at(-1);
    // Those that alternate stay together.
    if (piece === undefined || start >= piece.end) {
      length = Math.ceil(length / 4) * 4;
      const from = start - (start % 4);
      piece = { from, end, to: length };
      pieces.push(piece);
    }
    // A whole number of rows, as the codecs want it.
    const rows = Math.ceil((end - piece.from) / layout.stride) * layout.stride;
    piece.end = Math.max(piece.end, Math.min(piece.from + rows, bytes.length));
    length = piece.to + piece.end - piece.from;
    offsets.set(accessor, piece.to + start - piece.from);
  }
  if (length >= bytes.length) return;
  const packed = new Uint8Array(length);
  for (const { from, end, to } of pieces) packed.set(bytes.subarray(from, end), to);
  data.views[view] = packed;
  for (const [accessor, offset] of offsets) {
    const json = data.accessor(accessor);
    if (offset > 0) json['byteOffset'] = offset;
    else delete json['byteOffset'];
  }
}
