//! Lays out the binary chunk: new columns, what is kept of the old buffers, and images.

use crate::document::json_tree::Value;

use super::column::{Column, bounds_to_json, sparse_index};
use super::json::{items, object, remove, remove_extension, uint};
use super::order::order;
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
    let sparse: Vec<Option<Vec<u32>>> = columns.iter().map(Column::sparse_elements).collect();
    let blocks = make_blocks(tree, columns, &sparse, free_views);
    let (placed, pools) = assign_views(&blocks, free_views.len());
    let mut spare: Vec<usize> =
        (0..free_views.len()).rev().filter(|view| free_views[*view] && placed[*view].is_empty()).collect();
    for (view, members) in placed.iter().enumerate().filter(|(_, members)| !members.is_empty()) {
        write_view(tree, &mut binary, view, members, &blocks, columns);
    }
    for members in &pools {
        let view = take_view(tree, &mut spare);
        write_view(tree, &mut binary, view, members, &blocks, columns);
    }
    write_sparse(tree, &mut binary, columns, &sparse, &mut spare);
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

/// What a buffer holds whose content went into the first: one byte, for there may not be none.
const PLACEHOLDER: &str = "data:application/octet-stream;base64,AA==";

/// All content in the first buffer. Every buffer keeps what else it says (name, extras, extensions); the last ones that
/// say nothing are left out.
pub(super) fn set_buffer(tree: &mut Value, length: usize) {
    // A view of nothing, which is wrong but does no harm, still names a buffer.
    let is_needed = length > 0 || !items(tree, "bufferViews").is_empty();
    let buffers = array(tree, "buffers");
    for buffer in buffers.iter_mut() {
        remove(buffer, "uri");
        remove(buffer, "byteLength");
        MESHOPT_EXTENSIONS.iter().for_each(|name| remove_extension(buffer, name));
    }
    let speaks = |buffer: &Value| buffer.as_object().is_some_and(|buffer| !buffer.is_empty());
    buffers.truncate(buffers.iter().rposition(speaks).map_or(0, |last| last + 1));
    if buffers.is_empty() {
        if !is_needed {
            remove(tree, "buffers");
            return;
        }
        buffers.push(object(Vec::new()));
    }
    for (b, buffer) in buffers.iter_mut().enumerate() {
        let is_chunk = b == 0 && length > 0;
        if !is_chunk {
            buffer["uri"] = PLACEHOLDER.into();
        }
        buffer["byteLength"] = if is_chunk { length } else { 1 }.into();
    }
}

fn make_blocks(tree: &Value, columns: &[Column<'_>], sparse: &[Option<Vec<u32>>], free_views: &[bool]) -> Vec<Block> {
    let old_place = |c: usize| columns[c].old_place.filter(|(view, _)| free_views.get(*view) == Some(&true));
    // Columns without an old place stay in the order in which they were made.
    let keys: Vec<_> = (0..columns.len()).map(|c| (old_place(c).is_none(), old_place(c))).collect();
    let mut blocks: Vec<Block> = Vec::new();
    for c in order(columns.len(), &|a, b| keys[a] < keys[b]) {
        if is_blank(&columns[c]) || sparse[c].is_some() {
            continue;
        }
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

/// Each free view takes the first kind of block that was there; all others are pooled by kind, so that the blocks of a
/// view have one kind and stride. The blocks of each view (none: it takes nothing), and those of each pool.
fn assign_views(blocks: &[Block], view_count: usize) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
    let mut placed: Vec<Vec<usize>> = vec![Vec::new(); view_count];
    let mut pools: Vec<Vec<usize>> = Vec::new();
    let kind = |b: usize| (blocks[b].is_indices, blocks[b].stride);
    for (b, block) in blocks.iter().enumerate() {
        if let Some(members) = block.view.and_then(|view| placed.get_mut(view))
            && members.first().is_none_or(|&first| kind(first) == kind(b))
        {
            members.push(b);
            continue;
        }
        match pools.iter_mut().find(|pool| pool.first().is_some_and(|&first| kind(first) == kind(b))) {
            Some(pool) => pool.push(b),
            None => pools.push(vec![b]),
        }
    }
    (placed, pools)
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
            let bounds = column.store(&mut (0..column.count()), binary, offset, block.stride);
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

/// The columns of which only `elements` are stored, with their numbers in one view and their values in another.
fn write_sparse(
    tree: &mut Value,
    binary: &mut Vec<u8>,
    columns: &[Column<'_>],
    elements: &[Option<Vec<u32>>],
    spare: &mut Vec<usize>,
) {
    let sparse = || columns.iter().zip(elements).filter_map(|(column, elements)| Some((column, elements.as_ref()?)));
    if sparse().next().is_none() {
        return;
    }
    let [indices, values] = [take_view(tree, spare), take_view(tree, spare)];
    align(binary, 4, 0);
    let start = binary.len();
    for (column, elements) in sparse() {
        let last = elements.last().copied().unwrap_or(0);
        let (component, size) = sparse_index(last);
        align(binary, size, 0);
        let place = object(vec![
            ("bufferView", indices.into()),
            ("byteOffset", (binary.len() - start).into()),
            ("componentType", component.into()),
        ]);
        tree["accessors"][column.accessor]["sparse"] =
            object(vec![("count", elements.len().into()), ("indices", place)]);
        elements.iter().for_each(|element| binary.extend_from_slice(&element.to_le_bytes()[..size]));
    }
    place_view(tree, indices, start, binary.len() - start);
    align(binary, 4, 0);
    let start = binary.len();
    for (column, elements) in sparse() {
        align(binary, 4, 0);
        let (offset, size) = (binary.len(), column.layout.byte_size());
        binary.resize(offset + elements.len() * size, 0);
        let mut bounds = column.store(&mut elements.iter().map(|&e| e as usize), binary, offset, size);
        // All others are zero.
        bounds.iter_mut().for_each(|(low, high)| (*low, *high) = (low.min(0.0), high.max(0.0)));
        let json = &mut tree["accessors"][column.accessor];
        let mut sparse = json["sparse"].take();
        sparse["values"] = object(vec![("bufferView", values.into()), ("byteOffset", (offset - start).into())]);
        edit_accessor(json, column, None, &bounds);
        json["sparse"] = sparse;
    }
    place_view(tree, values, start, binary.len() - start);
}

/// Zeros that had no bytes in the file get none in the output.
fn is_blank(column: &Column<'_>) -> bool {
    (column.old_place.is_none() || column.sparse) && column.is_zero()
}

fn edit_accessor(json: &mut Value, column: &Column<'_>, place: Option<(usize, usize)>, bounds: &[(f64, f64)]) {
    for key in ["sparse", "min", "max", "byteOffset"] {
        remove(json, key);
    }
    match place {
        Some((view, offset)) => {
            json["bufferView"] = view.into();
            if offset > 0 {
                json["byteOffset"] = offset.into();
            }
        }
        None => remove(json, "bufferView"),
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
    let ranges: Vec<Range> = views
        .filter(|(view, _)| !free_views[*view])
        .map(|(view, json)| {
            let start = uint(json, "byteOffset").unwrap_or(0);
            let end = start + uint(json, "byteLength").unwrap_or(0);
            Range { view, buffer: uint(json, "buffer").unwrap_or(0), start, end }
        })
        .collect();
    let key = |range: &Range| (range.buffer, range.start, range.end);
    let sorted = order(ranges.len(), &|a, b| key(&ranges[a]) < key(&ranges[b]));
    // Of the run of overlapping ranges at hand: buffer, bytes copied so far, and how far they moved.
    let mut run: Option<(usize, usize, usize)> = None;
    for &Range { view, buffer, start, end } in sorted.iter().map(|&range| &ranges[range]) {
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
            views.push(object(Vec::new()));
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
fn bury(tree: &mut Value, binary: &mut Vec<u8>, spare: Vec<usize>) {
    let mut spare: Vec<usize> = order(spare.len(), &|a, b| spare[a] < spare[b]).into_iter().map(|s| spare[s]).collect();
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
