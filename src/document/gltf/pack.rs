//! Lays out the binary chunk: new columns, what is kept of the old buffers, and images.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::column::{Column, bounds_to_json};
use super::json::{items, remove, remove_extension, uint};
use super::schema::MESHOPT_EXTENSIONS;
use super::write::array;

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// What `byteStride` may be at most.
const LARGEST_STRIDE: usize = 252;

/// An image to embed.
pub(super) struct Image<'a> {
    pub(super) index: usize,
    pub(super) bytes: &'a [u8],
    pub(super) mime_type: &'a str,
}

/// Columns of one wedge set whose elements alternate, or one column alone.
struct Block {
    columns: Vec<usize>,
    stride: usize,
    is_indices: bool,
    /// The free view where its columns were.
    view: Option<usize>,
    first_offset: usize,
}

/// Fills the binary chunk and makes buffer views and accessors of the tree point into it.
/// `free_views` may be overwritten, all others are copied from `buffers`.
pub(super) fn pack(
    tree: &mut Value,
    columns: &[Column<'_>],
    free_views: &[bool],
    buffers: &[&[u8]],
    images: &[Image<'_>],
) -> Vec<u8> {
    let mut binary = Vec::new();
    let blocks = make_blocks(tree, columns, free_views);
    let (placed, pool) = assign_views(&blocks);
    let mut spare: Vec<usize> =
        (0..free_views.len()).rev().filter(|view| free_views[*view] && !placed.contains_key(view)).collect();
    for (&view, members) in &placed {
        write_view(tree, &mut binary, view, members, &blocks, columns);
    }
    for members in pool.values() {
        let view = take_view(tree, &mut spare);
        write_view(tree, &mut binary, view, members, &blocks, columns);
    }
    for column in columns.iter().filter(|column| is_blank(column)) {
        let zeros = vec![(0.0, 0.0); column.layout.components()];
        edit_accessor(&mut tree["accessors"][column.accessor], column, None, &zeros);
    }
    copy_kept_views(tree, &mut binary, free_views, buffers);
    for image in images {
        let view = take_view(tree, &mut spare);
        align(&mut binary, 4, 0);
        place_view(tree, view, binary.len(), image.bytes.len());
        binary.extend_from_slice(image.bytes);
        let json = &mut tree["images"][image.index];
        remove(json, "uri");
        json["bufferView"] = view.into();
        json["mimeType"] = image.mime_type.into();
    }
    bury(tree, &mut binary, spare);
    binary
}

/// One buffer, which keeps what else the first one said.
pub(super) fn set_buffer(tree: &mut Value, length: usize) {
    if length == 0 {
        remove(tree, "buffers");
        return;
    }
    let buffers = array(tree, "buffers");
    buffers.truncate(1);
    if buffers.is_empty() {
        buffers.push(json!({}));
    }
    let buffer = &mut buffers[0];
    remove(buffer, "uri");
    MESHOPT_EXTENSIONS.iter().for_each(|name| remove_extension(buffer, name));
    buffer["byteLength"] = length.into();
}

fn make_blocks(tree: &Value, columns: &[Column<'_>], free_views: &[bool]) -> Vec<Block> {
    let old_place = |c: usize| columns[c].old_place.filter(|(view, _)| free_views.get(*view) == Some(&true));
    let mut order: Vec<usize> = (0..columns.len()).filter(|&c| !is_blank(&columns[c])).collect();
    // Columns without an old place stay in the order in which they were made.
    order.sort_by_key(|&c| (old_place(c).is_none(), old_place(c), c));
    let mut blocks: Vec<Block> = Vec::new();
    for c in order {
        let column = &columns[c];
        let is_indices = column.set.is_none();
        let size = column.layout.byte_size();
        let stride = if is_indices { size } else { size.next_multiple_of(4) };
        let (view, offset) = old_place(c).map_or((None, 0), |(view, offset)| (Some(view), offset));
        let old_stride = view.and_then(|view| uint(&tree["bufferViews"][view], "byteStride")).unwrap_or(0);
        // They alternated in the file, so they do again.
        let joins = |block: &&mut Block| {
            let first = &columns[block.columns[0]];
            view.is_some()
                && block.view == view
                && first.set == column.set
                && first.count() == column.count()
                && !is_indices
                && offset < block.first_offset + old_stride
                && block.stride + stride <= LARGEST_STRIDE
        };
        match blocks.last_mut().filter(joins) {
            Some(block) => {
                block.columns.push(c);
                block.stride += stride;
            }
            None => blocks.push(Block { columns: vec![c], stride, is_indices, view, first_offset: offset }),
        }
    }
    blocks
}

/// Blocks that share a buffer view: of one kind and stride.
type Pool = BTreeMap<(bool, usize), Vec<usize>>;

/// Each free view takes the first kind of block that was there; all others are pooled by kind.
fn assign_views(blocks: &[Block]) -> (BTreeMap<usize, Vec<usize>>, Pool) {
    let mut placed: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut pool = Pool::new();
    for (b, block) in blocks.iter().enumerate() {
        let kind = (block.is_indices, block.stride);
        if let Some(view) = block.view {
            let members = placed.entry(view).or_default();
            if members.first().is_none_or(|&first: &usize| (blocks[first].is_indices, blocks[first].stride) == kind) {
                members.push(b);
                continue;
            }
        }
        pool.entry(kind).or_default().push(b);
    }
    (placed, pool)
}

fn write_view(
    tree: &mut Value,
    binary: &mut Vec<u8>,
    view: usize,
    members: &[usize],
    blocks: &[Block],
    columns: &[Column<'_>],
) {
    align(binary, 4, 0);
    let start = binary.len();
    let mut column_count = 0;
    let (mut is_indices, mut stride, mut tight) = (false, 0, 0);
    for block in members.iter().map(|&b| &blocks[b]) {
        align(binary, 4, 0);
        let mut offset = binary.len();
        let count = block.columns.first().map_or(0, |&c| columns[c].count());
        binary.resize(offset + count * block.stride, 0);
        for column in block.columns.iter().map(|&c| &columns[c]) {
            let bounds = column.store(binary, offset, block.stride);
            let accessor = &mut tree["accessors"][column.accessor];
            edit_accessor(accessor, column, Some((view, offset - start)), &bounds);
            offset += column.layout.byte_size().next_multiple_of(4);
            tight = column.layout.byte_size();
        }
        column_count += block.columns.len();
        (is_indices, stride) = (block.is_indices, block.stride);
    }
    place_view(tree, view, start, binary.len() - start);
    let json = &mut tree["bufferViews"][view];
    if !is_indices && (column_count > 1 || stride != tight) {
        json["byteStride"] = stride.into();
    }
    json["target"] = if is_indices { ELEMENT_ARRAY_BUFFER } else { ARRAY_BUFFER }.into();
}

/// Zeros that had no bytes in the file get none in the output.
fn is_blank(column: &Column<'_>) -> bool {
    column.old_place.is_none() && column.is_zero()
}

fn edit_accessor(json: &mut Value, column: &Column<'_>, place: Option<(usize, usize)>, bounds: &[(f64, f64)]) {
    for key in ["sparse", "min", "max", "byteOffset"] {
        remove(json, key);
    }
    if let Some((view, offset)) = place {
        json["bufferView"] = view.into();
        if offset > 0 {
            json["byteOffset"] = offset.into();
        }
    }
    json["count"] = column.count().into();
    if column.bounds {
        let (min, max) = bounds_to_json(column.layout, bounds);
        json["min"] = min;
        json["max"] = max;
    }
}

/// Copies the ranges that kept views cover. Views may overlap; each byte is copied once, and keeps
/// its offset modulo 8, hence every alignment it had.
fn copy_kept_views(tree: &mut Value, binary: &mut Vec<u8>, free_views: &[bool], buffers: &[&[u8]]) {
    struct Range {
        view: usize,
        buffer: usize,
        start: usize,
        end: usize,
    }
    let views = items(tree, "bufferViews").iter().take(free_views.len()).enumerate();
    let mut ranges: Vec<Range> = views
        .filter(|(view, _)| !free_views[*view])
        .map(|(view, json)| {
            let start = uint(json, "byteOffset").unwrap_or(0);
            let end = start + uint(json, "byteLength").unwrap_or(0);
            Range { view, buffer: uint(json, "buffer").unwrap_or(0), start, end }
        })
        .collect();
    ranges.sort_by_key(|range| (range.buffer, range.start, range.end));
    // Of the run of overlapping ranges at hand: buffer, bytes copied so far, and how far they moved.
    let mut run: Option<(usize, usize, usize)> = None;
    for Range { view, buffer, start, end } in ranges {
        let source = buffers.get(buffer).copied().unwrap_or_default();
        let (copied, run_start) = match run {
            Some((of, copied, run_start)) if of == buffer && start <= copied => (copied, run_start),
            _ => {
                align(binary, 8, start);
                // The place in the output of byte 0 of the buffer may lie before the output.
                (start, binary.len().wrapping_sub(start))
            }
        };
        if end > copied {
            binary.extend_from_slice(source.get(copied..end).unwrap_or_default());
        }
        run = Some((buffer, copied.max(end), run_start));
        let json = &mut tree["bufferViews"][view];
        json["buffer"] = 0.into();
        json["byteOffset"] = run_start.wrapping_add(start).into();
        MESHOPT_EXTENSIONS.iter().for_each(|name| remove_extension(json, name));
    }
}

/// A view without content, or a new one.
fn take_view(tree: &mut Value, spare: &mut Vec<usize>) -> usize {
    match spare.pop() {
        Some(view) => {
            remove(&mut tree["bufferViews"][view], "name");
            view
        }
        None => {
            let views = array(tree, "bufferViews");
            views.push(json!({}));
            views.len() - 1
        }
    }
}

fn place_view(tree: &mut Value, view: usize, offset: usize, length: usize) {
    let json = &mut tree["bufferViews"][view];
    for key in ["byteStride", "target"] {
        remove(json, key);
    }
    MESHOPT_EXTENSIONS.iter().for_each(|name| remove_extension(json, name));
    json["buffer"] = 0.into();
    json["byteOffset"] = offset.into();
    json["byteLength"] = length.into();
}

/// Views that lost their content keep their place in the array, for the numbers of those behind
/// them, over a few bytes that others own. The last of the array can go.
fn bury(tree: &mut Value, binary: &mut Vec<u8>, mut spare: Vec<usize>) {
    spare.sort_unstable();
    while let Some(&last) = spare.last().filter(|&&last| last + 1 == items(tree, "bufferViews").len()) {
        array(tree, "bufferViews").truncate(last);
        spare.pop();
    }
    if items(tree, "bufferViews").is_empty() {
        remove(tree, "bufferViews");
    }
    if !spare.is_empty() && binary.len() < 4 {
        binary.resize(4, 0);
    }
    for view in spare {
        place_view(tree, view, 0, 4);
    }
}

/// Pads until the length is `to` modulo `unit`.
fn align(binary: &mut Vec<u8>, unit: usize, to: usize) {
    while binary.len() % unit != to % unit {
        binary.push(0);
    }
}
