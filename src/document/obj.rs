//! Wavefront OBJ, both directions: polygons with names in, triangles with the same names out.
//!
//! Reading: [`statements`] scans the text once, [`assemble`] makes wedges and triangles of it. The
//! whole file is one part, since its objects share their vertices. Kept are positions, the colours
//! many programs write behind them, texture coordinates, normals, `o`, `g`, `s`, `usemtl`,
//! `mtllib`, whose [`materials`] are read if the files are given; points, lines and free-form surfaces are left out with a warning. A face with fewer than three
//! corners is left out with a warning too, as most readers do, and so are indices of texture
//! coordinates and normals that some exporters write without the elements. A vertex index to
//! nothing, or a number that is none, is an error, since guessing would move the surface.
//!
//! What OBJ cannot hold (skins, further texture coordinates, tangents) is not written.

mod assemble;
mod materials;
mod notice;
mod statements;
mod write;

use crate::document::{NamedFile, SceneLayout};
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;
use std::collections::BTreeSet;

use super::content::Content;
use super::scan::{Scanner, looks_like_number};

/// An OBJ file as read.
#[derive(Debug)]
pub(super) struct ObjSource {
    /// One part, one instance in place; a group for each distinct object, `g`, material and
    /// attribute signature; a wedge set for each signature.
    pub(super) content: Content,
    /// `s` of each group, where it is on and the same for all of its faces.
    smoothing_groups: Vec<Option<String>>,
}

/// Reads an OBJ file. Without a single face the mesh is empty.
///
/// # Errors
/// With `name:line` as place: `syntax` for a number that is none or missing, `truncated` if it is
/// missing at the end of the file, `not-finite` for NaN, infinity and what `f32` cannot hold,
/// `out-of-range` for an index to nothing; `too-large` beyond a billion elements.
pub(super) fn read(files: &[NamedFile], main: usize) -> Result<ObjSource, Error> {
    let Some(NamedFile { name, bytes }) = files.get(main) else {
        return Err(Error::new(ErrorCode::InvalidArgument, "files", "no such file"));
    };
    let statements = statements::parse(name, bytes)?;
    let mut source = assemble::assemble(name, statements)?;
    let layout = &mut source.content.layout;
    let (materials, warnings) = materials::read(files, main, &layout.material_libraries);
    layout.materials = materials;
    source.content.warnings.extend(warnings);
    Ok(source)
}

/// The files that an OBJ file (its material libraries) or a material library (its images) names,
/// in order, each once.
pub(super) fn external_files(bytes: &[u8]) -> Vec<String> {
    let mut names = materials::image_names(bytes);
    names.extend(statements::library_names(bytes));
    let mut known = BTreeSet::new();
    names.retain(|name| known.insert(name.clone()));
    names
}

/// The text of `source` with `mesh` in the place of its own, which has the same groups.
///
/// # Errors
/// As [`write_new`].
pub(super) fn write(source: &ObjSource, mesh: &Mesh) -> Result<Vec<u8>, Error> {
    write::write(mesh, &source.content.layout, &source.smoothing_groups)
}

/// The text of a mesh from elsewhere, placed and named by `layout`.
///
/// # Errors
/// `not-finite` if a placement moves a vertex beyond the range of `f32`; `too-large` if the text
/// would exceed 2 GB.
pub(super) fn write_new(mesh: &Mesh, layout: &SceneLayout) -> Result<Vec<u8>, Error> {
    write::write(mesh, layout, &[])
}

/// Statements to look at before giving up.
const SNIFFED_STATEMENTS: usize = 256;

/// Whether `text` is an OBJ file, by its content: an element or face with its numbers, or a
/// material statement, among the first statements. Names alone (`o`, `g`, `s`) say so only if the
/// file has nothing else, because prose has lines that begin with a letter and a blank.
pub(super) fn looks_like_obj(text: &[u8]) -> bool {
    let mut scan = Scanner::new(text);
    let (mut statement_count, mut name_count) = (0, 0);
    while !scan.is_at_end() && statement_count < SNIFFED_STATEMENTS {
        scan.skip_blanks();
        if scan.is_at_line_end() {
            scan.finish_line();
            continue;
        }
        statement_count += 1;
        let keyword = scan.word();
        if keyword.iter().any(|byte| byte.is_ascii_control())
            || (statement_count == 1 && keyword.first() == Some(&b'<'))
        {
            return false;
        }
        let number_count = match keyword {
            b"v" | b"vn" | b"f" | b"l" => 2,
            b"vt" | b"vp" | b"p" => 1,
            b"mtllib" | b"usemtl" => 0,
            _ => {
                name_count += usize::from(matches!(keyword, b"o" | b"g" | b"s"));
                scan.finish_line();
                continue;
            }
        };
        let is_met = (0..number_count).all(|_| {
            scan.skip_blanks();
            !scan.is_at_line_end() && looks_like_number(scan.word())
        });
        if is_met {
            return true;
        }
        scan.finish_line();
    }
    scan.is_at_end() && name_count > 0 && name_count == statement_count
}
