//! Binary STL: 80 bytes of header, a count, 50 bytes for each facet.

use super::color::Scheme;
use super::{Corners, FACET, PREFIX, StlSource, StlStyle, declared_facets};
use crate::document::NamedFile;
use crate::document::faces::{Corner, Faces};
use crate::error::{Error, ErrorCode, Warning};
use crate::mesh::Blend;

pub(super) fn read(file: &NamedFile) -> Result<StlSource, Error> {
    let (name, bytes) = (&file.name, &file.bytes);
    let truncated =
        |message: String| Error::new(ErrorCode::Truncated, format!("{name}: byte {}", bytes.len()), message);
    let count = declared_facets(bytes).ok_or_else(|| truncated("the file ends within its header".into()))?;
    let available = (bytes.len() - PREFIX) / FACET;
    if count > available {
        return Err(truncated(format!("{count} facets are declared and {available} are there")));
    }
    let (facets, rest) = bytes[PREFIX..].split_at(count * FACET);
    let words = || facets.chunks_exact(FACET).map(|facet| u16::from_le_bytes([facet[48], facet[49]]));
    let scheme = Scheme::of(&bytes[..80], words());
    let mut faces = Faces::new();
    faces.color_blend = Blend::Nearest;
    faces.reserve(count);
    let mut corners = Corners::new();
    for (number, facet) in facets.chunks_exact(FACET).enumerate() {
        let place = || format!("{name}: facet {number}");
        let color = match scheme {
            Scheme::None => 0,
            _ => faces.color(scheme.color(u16::from_le_bytes([facet[48], facet[49]]))),
        };
        let mut triangle = [Corner { color, ..Corner::default() }; 3];
        for (corner, point) in triangle.iter_mut().zip(facet[12..48].chunks_exact(12)) {
            let coordinate = |at: usize| f32::from_le_bytes([point[at], point[at + 1], point[at + 2], point[at + 3]]);
            corner.vertex = corners.vertex(&mut faces, [0, 4, 8].map(coordinate), &place)?;
        }
        faces.polygon(&triangle, &place)?;
    }
    let mut content = faces.finish(name)?;
    let mut warn = |code, message: String| {
        content.warnings.push(Warning { code, message, place: name.clone() });
    };
    if scheme == Scheme::None && words().any(|word| word != 0) {
        warn("attribute-words-ignored", "attribute words that are no colours are left out".into());
    }
    if !rest.is_empty() {
        warn("extra-bytes-ignored", format!("{} bytes after the last facet are left out", rest.len()));
    }
    Ok(StlSource { content, style: StlStyle { header: bytes[..80].to_vec(), colors: scheme } })
}
