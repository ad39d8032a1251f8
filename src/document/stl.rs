//! STL, both directions: facets in text or binary in, binary out.
//!
//! Corners at one place become one vertex, since STL has no other way to say that facets meet.
//! Normals are not read: they follow from the corners, and files often have zeros there. The
//! attribute word of binary facets is a colour in files of VisCAM and SolidView, and by another
//! layout of Materialise Magics; [`color`] tells them apart and keeps them.

mod binary;
mod color;
mod text;
mod write;

use super::NamedFile;
use super::content::Content;
use super::faces::Faces;
use super::row_table::RowTable;
use crate::error::{Error, ErrorCode};

pub(super) use write::write;

/// An STL file as read.
#[derive(Debug)]
pub(super) struct StlSource {
    /// One part; a group for each solid.
    pub(super) content: Content,
    pub(super) style: StlStyle,
}

/// What a file has that a mesh does not say.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct StlStyle {
    /// The first 80 bytes of a binary file; empty for others.
    header: Vec<u8>,
    colors: color::Scheme,
}

impl StlStyle {
    /// Whether facets have colours.
    pub(super) fn has_colors(&self) -> bool {
        self.colors != color::Scheme::None
    }
}

/// Bytes before the first facet of a binary file: header and count.
const PREFIX: usize = 84;
/// Bytes of a binary facet: normal, three corners, attribute word.
const FACET: usize = 50;

/// Reads an STL file.
///
/// # Errors
/// `truncated` if a binary file is shorter than its count says or a text ends within a facet;
/// `syntax` and `not-finite` with the line or the facet's number.
pub(super) fn read(file: &NamedFile) -> Result<StlSource, Error> {
    if looks_like_text(&file.bytes) { text::read(file) } else { binary::read(file) }
}

/// The facets that the count in a binary file says, if there is one.
fn declared_facets(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..PREFIX)?;
    usize::try_from(u32::from_le_bytes(count.try_into().ok()?)).ok()
}

/// Whether `bytes` are an STL file of either kind. A binary one has nothing but its length to tell
/// it by; with `is_hinted` (by its name) a length that does not fit will do too, so that a file
/// that was cut is called so.
pub(super) fn looks_like_stl(bytes: &[u8], is_hinted: bool) -> bool {
    let Some(count) = declared_facets(bytes) else { return looks_like_text(bytes) };
    let length = FACET.checked_mul(count).and_then(|length| length.checked_add(PREFIX));
    if count > 0 && length == Some(bytes.len()) {
        return true;
    }
    if looks_like_text(bytes) {
        return true;
    }
    // Text has no zeros, and a cut binary file hardly none.
    is_hinted && bytes.contains(&0)
}

/// `solid` and then, within the first lines, `facet` or `endsolid`; and not the length of a binary
/// file, which many programs begin with `solid` too.
fn looks_like_text(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    if !bytes.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return false;
    }
    if let Some(count) = declared_facets(bytes)
        && FACET.checked_mul(count).and_then(|length| length.checked_add(PREFIX)) == Some(bytes.len())
    {
        return false;
    }
    let beginning = &bytes[..bytes.len().min(1024)];
    let has = |word: &[u8]| beginning.windows(word.len()).any(|window| window.eq_ignore_ascii_case(word));
    !beginning.contains(&0) && (has(b"facet") || has(b"endsolid"))
}

/// Takes corners and gives each distinct place a vertex.
struct Corners {
    table: RowTable<3>,
}

impl Corners {
    fn new() -> Self {
        Self { table: RowTable::new() }
    }

    /// The vertex at `point`; 0 and -0 are one place.
    #[inline(never)]
    fn vertex(&mut self, faces: &mut Faces, point: [f32; 3], place: &dyn Fn() -> String) -> Result<u32, Error> {
        if !point.iter().all(|c| c.is_finite()) {
            return Err(Error::new(ErrorCode::NotFinite, place(), "a coordinate is not a finite number"));
        }
        let number = self.table.number(point.map(|c| (c + 0.0).to_bits()));
        if number as usize == faces.positions.len() {
            faces.positions.push(point);
        }
        Ok(number)
    }
}
