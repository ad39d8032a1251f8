//! OFF (Geomview's Object File Format), both directions, with the prefixes `ST`, `C` and `N`.
//!
//! After the keyword come the counts of vertices, faces and edges; then vertices as position,
//! normal, colour, texture coordinates, each if the prefix says so; then faces as a count, indices
//! and perhaps a colour. Colours written as integers are bytes. A colour of a face as an index in a
//! colour map, whose content is not in the file, is left out. Four-dimensional, n-dimensional and
//! binary files are refused.

mod read;
mod write;

use super::content::Content;

pub(super) use read::read;
pub(super) use write::write;

/// An OFF file as read.
#[derive(Debug)]
pub(super) struct OffSource {
    pub(super) content: Content,
    pub(super) style: OffStyle,
}

/// What a file has that a mesh does not say.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct OffStyle {
    /// Colours are written as 0 to 1 and not as bytes.
    has_float_colors: bool,
}

/// What the keyword says of the vertices.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Keyword {
    has_texcoords: bool,
    has_colors: bool,
    has_normals: bool,
    /// `4` or `n`.
    is_other_space: bool,
}

impl Keyword {
    /// `[ST][C][N][4][n]OFF`.
    fn parse(word: &[u8]) -> Option<Self> {
        let mut rest = word.strip_suffix(b"OFF")?;
        let mut take = |prefix: &[u8]| match rest.strip_prefix(prefix) {
            Some(after) => {
                rest = after;
                true
            }
            None => false,
        };
        let keyword = Self {
            has_texcoords: take(b"ST"),
            has_colors: take(b"C"),
            has_normals: take(b"N"),
            is_other_space: take(b"4") | take(b"n"),
        };
        rest.is_empty().then_some(keyword)
    }
}

/// Whether the first word that is no comment is a keyword of OFF.
pub(super) fn looks_like_off(text: &[u8]) -> bool {
    let mut scan = super::scan::Scanner::new(text);
    scan.skip_blank_lines();
    Keyword::parse(scan.word()).is_some()
}
