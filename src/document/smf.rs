//! SMF, the format of Garland's QSlim (*SMF: a simple model format*, 1999), both directions.
//!
//! Lines of a keyword and numbers: `v` vertices; `f` faces by numbers from 1, counted anew in each
//! `begin` … `end`; `n`, `c`, `r` normals, colours and texture coordinates, which belong to vertices
//! or faces in their order as `bind` says; `trans`, `scale`, `rot`, `mmult`, `mload`, which move the
//! vertices that follow in their block; `set`, `inc`, `dec` of `vertex_correction`, which is added
//! to the numbers in faces. Other statements are left out with a warning.

mod read;
mod transform;
mod write;

use super::content::Content;
use super::scan::{Scanner, looks_like_number};

pub(super) use read::read;
pub(super) use write::write;

/// An SMF file as read.
#[derive(Debug)]
pub(super) struct SmfSource {
    pub(super) content: Content,
}

/// Statements to look at before giving up.
const SNIFFED_STATEMENTS: usize = 4096;

/// Whether `text` is SMF: it says so in its first comment, or has a statement that OBJ, which
/// looks the same otherwise, does not have, besides vertices.
pub(super) fn looks_like_smf(text: &[u8]) -> bool {
    if text.trim_ascii_start().starts_with(b"#$SMF") {
        return true;
    }
    let mut scan = Scanner::new(text);
    let (mut has_vertices, mut has_own) = (false, false);
    for _ in 0..SNIFFED_STATEMENTS {
        scan.skip_blank_lines();
        if scan.is_at_end() {
            break;
        }
        let keyword = scan.word();
        scan.skip_blanks();
        let mut ahead = scan.clone();
        let argument = ahead.word();
        match keyword {
            b"v" if looks_like_number(argument) => has_vertices = true,
            b"begin" => has_own |= argument.is_empty(),
            b"bind" => has_own |= matches!(argument, b"c" | b"n" | b"r"),
            b"trans" | b"scale" | b"mmult" | b"mload" => has_own |= looks_like_number(argument),
            b"rot" => has_own |= matches!(argument, b"x" | b"y" | b"z"),
            _ => {}
        }
        if has_vertices && has_own {
            return true;
        }
        scan.finish_line();
    }
    false
}
