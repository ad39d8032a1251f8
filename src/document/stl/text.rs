//! STL as text: `solid`, and for each facet its corners between `outer loop` and `endloop`.
//!
//! What counts are `vertex` and the ends of loops and facets; other words, and the normals, are
//! stepped over. Keywords are of any case, and lines may be broken anywhere, as in real files.

use super::{Corners, StlSource, StlStyle};
use crate::document::NamedFile;
use crate::document::faces::{Corner, Faces};
use crate::document::scan::{Fault, Scanner};
use crate::error::{Error, ErrorCode};

pub(super) fn read(file: &NamedFile) -> Result<StlSource, Error> {
    let name = &file.name;
    let mut scan = Scanner::new(&file.bytes);
    let mut faces = Faces::new();
    let mut corners = Corners::new();
    let mut polygon: Vec<Corner> = Vec::new();
    let mut is_in_loop = false;
    while !scan.is_at_end() {
        scan.skip_blank_lines();
        let line = scan.line();
        let place = || format!("{name}:{line}");
        let fail = |code, message: &str| Err(Error::new(code, place(), message));
        let word = scan.word().to_ascii_lowercase();
        match &word[..] {
            b"vertex" => {
                let mut point = [0.0; 3];
                for coordinate in &mut point {
                    scan.skip_blank_lines();
                    *coordinate = match scan.next_number() {
                        Ok(value) => value,
                        Err(Fault::Missing) if scan.is_at_end() => {
                            return fail(ErrorCode::Truncated, "in `vertex`: the file ends here");
                        }
                        Err(Fault::NotFinite) => return fail(ErrorCode::NotFinite, "in `vertex`: not a finite number"),
                        Err(_) => return fail(ErrorCode::Syntax, "in `vertex`: not a number"),
                    };
                }
                let vertex = corners.vertex(&mut faces, point, &place)?;
                polygon.push(Corner { vertex, ..Corner::default() });
                is_in_loop = true;
            }
            b"endloop" | b"endfacet" => {
                if is_in_loop {
                    faces.polygon(&polygon, &place)?;
                }
                polygon.clear();
                is_in_loop = false;
            }
            b"solid" | b"endsolid" | b"facet" | b"outer" if is_in_loop => {
                return fail(ErrorCode::Syntax, "a facet begins or the solid ends before `endloop`");
            }
            b"solid" => {
                let title = String::from_utf8_lossy(&scan.rest_of_line()).replace(|c: char| c.is_ascii_control(), " ");
                let title = title.trim_matches(' ');
                faces.begin_group((!title.is_empty()).then(|| title.to_owned()));
            }
            b"endsolid" => scan.finish_line(),
            // Numbers of normals among them.
            _ => {}
        }
    }
    if is_in_loop {
        let place = format!("{name}:{}", scan.line());
        return Err(Error::new(ErrorCode::Truncated, place, "the file ends within a facet"));
    }
    Ok(StlSource { content: faces.finish(name)?, style: StlStyle::default() })
}
