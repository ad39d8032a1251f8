//! Accessors: typed elements in a buffer, every offset checked before the first is read.

use super::json::{extension, items};
use super::layout::{Component, Layout, Shape};
use super::resource::Content;
use super::schema::{self, Accessor, MESHOPT_EXTENSIONS, Root};
use crate::document::NamedFile;
use crate::document::json_tree::Value;
use crate::error::{Error, ErrorCode};

/// Elements that a file of no size may claim without a byte behind them; each byte of the files
/// allows one more. So 100 bytes cannot ask for gigabytes, and a zero morph target of a real mesh
/// is always allowed, for its mesh has bytes.
const MOST_ZEROS: usize = 1 << 16;

/// The file as its accessors see it.
#[derive(Clone, Copy)]
pub(super) struct Data<'a> {
    pub(super) root: &'a Root,
    pub(super) tree: &'a Value,
    pub(super) buffers: &'a [Content],
    pub(super) files: &'a [NamedFile],
}

impl Data<'_> {
    /// Bytes of all files.
    pub(super) fn byte_count(self) -> usize {
        self.files.iter().map(|file| file.bytes.len()).sum()
    }
}

/// The elements of one accessor, ready to be read without further checks.
#[derive(Debug)]
pub(super) struct Elements<'a> {
    pub(super) layout: Layout,
    pub(super) count: usize,
    /// From the first element on; `None` where all are zero.
    bytes: Option<&'a [u8]>,
    stride: usize,
    sparse: Option<Sparse<'a>>,
}

/// The elements that differ from the base; `at` ascends.
#[derive(Debug)]
struct Sparse<'a> {
    at: Vec<u32>,
    values: &'a [u8],
}

impl<'a> Sparse<'a> {
    /// Checks the elements of accessor `index` that differ from its base, which has `count`.
    fn open(
        data: Data<'a>,
        index: usize,
        sparse: &schema::Sparse,
        layout: Layout,
        count: usize,
    ) -> Result<Self, Error> {
        let Some(sparse_count) = usize::try_from(sparse.count).ok().filter(|n| (1..=count).contains(n)) else {
            let message = format!("{} is not between 1 and the accessor's count {count}", sparse.count);
            return Err(fault(ErrorCode::OutOfRange, index, "sparse.count", message));
        };
        let open = |(view, offset), size, field, what| {
            tail(view_bytes(data, view)?.0, offset, sparse_count, size, size).ok_or_else(|| {
                let message = format!("{sparse_count} {what} reach past their buffer view");
                fault(ErrorCode::OutOfRange, index, field, message)
            })
        };
        let kind = Layout { component: sparse.index_component, shape: Shape::Scalar, normalized: false };
        let size = kind.byte_size();
        let indices = open(sparse.indices, size, "sparse.indices", "indices")?;
        let at: Vec<u32> = (0..sparse_count).map(|i| read_index(kind.component, &indices[i * size..])).collect();
        if let Some(i) = (0..sparse_count).find(|&i| at[i] as usize >= count || (i > 0 && at[i] <= at[i - 1])) {
            let message = format!("index {i} is {}: they must ascend and stay below the count {count}", at[i]);
            return Err(fault(ErrorCode::OutOfRange, index, "sparse.indices", message));
        }
        let values = open(sparse.values, layout.byte_size(), "sparse.values", "values")?;
        Ok(Self { at, values })
    }
}

impl<'a> Elements<'a> {
    /// Checks an accessor of the file.
    ///
    /// # Errors
    /// `out-of-range` when it reaches past its buffer view, or that past its buffer; `syntax` for
    /// values that make no sense; `unsupported` for compressed data without a fallback.
    pub(super) fn open(data: Data<'a>, index: usize) -> Result<Self, Error> {
        let Some(accessor) = data.root.accessors.get(index) else {
            return Err(fault(
                ErrorCode::OutOfRange,
                index,
                "",
                format!("there are {} accessors", data.root.accessors.len()),
            ));
        };
        let layout = accessor.layout;
        let Some(count) = usize::try_from(accessor.count).ok().filter(|&count| count < u32::MAX as usize) else {
            return Err(fault(
                ErrorCode::TooLarge,
                index,
                "count",
                format!("{} elements are too many", accessor.count),
            ));
        };
        if count == 0 {
            return Err(fault(ErrorCode::Syntax, index, "count", "an accessor has at least one element".into()));
        }
        let most_zeros = MOST_ZEROS.saturating_add(data.byte_count());
        if accessor.view.is_none() && count > most_zeros {
            let message = format!("{count} elements of zeros without a buffer view; at most {most_zeros} are read");
            return Err(fault(ErrorCode::TooLarge, index, "count", message));
        }
        let base = accessor.view.map(|view| base(data, index, view, accessor, count)).transpose()?;
        let sparse =
            accessor.sparse.as_ref().map(|sparse| Sparse::open(data, index, sparse, layout, count)).transpose()?;
        let (bytes, stride) = base.map_or((None, layout.byte_size()), |(bytes, stride)| (Some(bytes), stride));
        Ok(Self { layout, count, bytes, stride, sparse })
    }

    /// The numbers of the elements at `picked`, which ascend and are below `count`, or of all; `out` has zeros and the
    /// size.
    pub(super) fn read(&self, picked: Option<&[u32]>, out: &mut [f32]) {
        let components = self.layout.components();
        let rows = out.chunks_exact_mut(components);
        match (self.bytes, picked) {
            (None, _) => {}
            // Floating-point elements have no gaps, matrices neither.
            (Some(bytes), None) if self.layout.component == Component::F32 && self.stride == 4 * components => {
                out.iter_mut().zip(bytes.as_chunks::<4>().0).for_each(|(to, &from)| *to = f32::from_le_bytes(from));
            }
            (Some(bytes), None) => rows.zip(bytes.chunks(self.stride)).for_each(|(row, bytes)| self.decode(bytes, row)),
            (Some(bytes), Some(picked)) => {
                for (row, &index) in rows.zip(picked) {
                    self.decode(bytes.get(index as usize * self.stride..).unwrap_or_default(), row);
                }
            }
        }
        let Some(Sparse { at, values }) = &self.sparse else {
            return;
        };
        for (&index, bytes) in at.iter().zip(values.chunks_exact(self.layout.byte_size())) {
            let row = picked.map_or(Ok(index as usize), |picked| picked.binary_search(&index));
            if let Some(row) = row.ok().and_then(|row| out.get_mut(row * components..(row + 1) * components)) {
                self.decode(bytes, row);
            }
        }
    }

    /// The numbers of the element at the start of `bytes`.
    fn decode(&self, bytes: &[u8], row: &mut [f32]) {
        if self.layout.component == Component::F32 {
            row.iter_mut().zip(bytes.as_chunks::<4>().0).for_each(|(to, &from)| *to = f32::from_le_bytes(from));
            return;
        }
        for (c, to) in row.iter_mut().enumerate() {
            *to = self.layout.decode(bytes.get(self.layout.offset(c)..).unwrap_or_default());
        }
    }

    /// All elements of an accessor of indices, unsigned integers; `out` has zeros and the size.
    pub(super) fn read_indices(&self, out: &mut [u32]) {
        // Index views have no stride; if one has, the slow way reads it.
        match (self.layout.component, self.bytes) {
            (_, None) => {}
            (Component::U16, Some(bytes)) if self.stride == 2 => {
                let all = out.iter_mut().zip(bytes.as_chunks::<2>().0);
                all.for_each(|(to, &from)| *to = u16::from_le_bytes(from).into());
            }
            (Component::U32, Some(bytes)) if self.stride == 4 => {
                out.iter_mut().zip(bytes.as_chunks::<4>().0).for_each(|(to, &from)| *to = u32::from_le_bytes(from));
            }
            (component, Some(bytes)) => {
                let all = out.iter_mut().zip(bytes.chunks(self.stride));
                all.for_each(|(to, from)| *to = read_index(component, from));
            }
        }
        if let Some(Sparse { at, values }) = &self.sparse {
            for (&index, bytes) in at.iter().zip(values.chunks_exact(self.layout.byte_size())) {
                if let Some(to) = out.get_mut(index as usize) {
                    *to = read_index(self.layout.component, bytes);
                }
            }
        }
    }
}

fn read_index(component: Component, bytes: &[u8]) -> u32 {
    match (component, bytes) {
        (Component::U8, &[a, ..]) => u32::from(a),
        (Component::U16, &[a, b, ..]) => u32::from(u16::from_le_bytes([a, b])),
        (_, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]),
        // Unreachable, as in `Layout::decode`.
        _ => 0,
    }
}

/// The bytes of the `count` elements of accessor `index`, which are in `view`, and how far apart they are.
fn base<'a>(
    data: Data<'a>,
    index: usize,
    view: usize,
    &Accessor { offset, layout, .. }: &Accessor,
    count: usize,
) -> Result<(&'a [u8], usize), Error> {
    let (content, stride) = view_bytes(data, view)?;
    let size = layout.byte_size();
    let stride = stride.unwrap_or(size);
    if stride < size {
        let place = format!("bufferViews[{view}].byteStride");
        return Err(Error::new(
            ErrorCode::Syntax,
            place,
            format!("{stride} is less than the {size} bytes of an element"),
        ));
    }
    let Some(bytes) = tail(content, offset, count, stride, size) else {
        let length = content.len();
        let message =
            format!("{count} elements from byte {offset} on reach past the {length} bytes of bufferViews[{view}]");
        return Err(fault(ErrorCode::OutOfRange, index, "", message));
    };
    Ok((bytes, stride))
}

/// The error of a field of accessor `index`; of the accessor itself without a `field`.
#[inline(never)]
fn fault(code: ErrorCode, index: usize, field: &str, message: String) -> Error {
    let dot = if field.is_empty() { "" } else { "." };
    Error::new(code, format!("accessors[{index}]{dot}{field}"), message)
}

/// `bytes` from `offset` on, if `count` elements of `size` bytes, `stride` apart, fit there.
fn tail(bytes: &[u8], offset: u64, count: usize, stride: usize, size: usize) -> Option<&[u8]> {
    let needed = (count as u64 - 1).checked_mul(stride as u64)?.checked_add(size as u64)?;
    let end = offset.checked_add(needed)?;
    if end > bytes.len() as u64 {
        return None;
    }
    bytes.get(usize::try_from(offset).ok()?..)
}

/// The bytes of a buffer view, and its stride.
pub(super) fn view_bytes<'a>(data: Data<'a>, index: usize) -> Result<(&'a [u8], Option<usize>), Error> {
    let place = || format!("bufferViews[{index}]");
    let Some(view) = data.root.views.get(index) else {
        return Err(Error::new(ErrorCode::OutOfRange, place(), "no such buffer view"));
    };
    let buffer = data.buffers.get(view.buffer).and_then(|buffer| buffer.bytes(data.files));
    let Some(buffer) = buffer else {
        let json = items(data.tree, "bufferViews").get(index);
        let packed = MESHOPT_EXTENSIONS.iter().find(|name| json.is_some_and(|json| extension(json, name).is_some()));
        return Err(match packed {
            Some(name) => Error::new(
                ErrorCode::Unsupported,
                format!("{}.extensions.{name}", place()),
                "meshopt-compressed geometry cannot be decoded yet",
            ),
            None => Error::new(ErrorCode::MissingResource, place(), "its buffer has no data"),
        });
    };
    let (offset, length) = (view.offset, view.length);
    let range = offset.checked_add(length).filter(|&end| end <= buffer.len() as u64).map(|end| offset..end);
    match range {
        Some(range) => Ok((&buffer[range.start as usize..range.end as usize], view.stride)),
        None => Err(Error::new(
            ErrorCode::OutOfRange,
            place(),
            format!("{length} bytes from byte {offset} on reach past the {} bytes of its buffer", buffer.len()),
        )),
    }
}

/// The numbers of the first elements, for small accessors such as a skin's matrices.
pub(super) fn read_all(data: Data<'_>, index: usize, limit: usize) -> Result<Vec<f32>, Error> {
    let mut elements = Elements::open(data, index)?;
    elements.count = elements.count.min(limit);
    let mut out = vec![0.0; elements.count * elements.layout.components()];
    elements.read(None, &mut out);
    Ok(out)
}
