//! A binary STL file from a mesh.

use super::color::Scheme;
use super::{FACET, PREFIX, StlStyle};
use crate::document::SceneLayout;
use crate::document::flat::FlatMesh;
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;

/// `mesh` as binary STL, with colours of facets where `style` says that there were some.
///
/// # Errors
/// `not-finite` if a placement moves a vertex beyond the range of `f32`; `too-large` beyond 2 GB.
pub(in crate::document) fn write(mesh: &Mesh, layout: &SceneLayout, style: &StlStyle) -> Result<Vec<u8>, Error> {
    let flat = FlatMesh::new(mesh, layout)?;
    let length = flat.triangles.len().checked_mul(FACET).and_then(|length| length.checked_add(PREFIX));
    let count = u32::try_from(flat.triangles.len()).ok();
    let (Some(length), Some(count)) = (length.filter(|&length| length < i32::MAX as usize), count) else {
        return Err(Error::new(ErrorCode::TooLarge, "output", "the file would exceed 2 GB"));
    };
    let mut bytes = Vec::with_capacity(length);
    bytes.extend_from_slice(if style.header.is_empty() { b"Decimesh" } else { &style.header });
    bytes.resize(80, b' ');
    // Some readers take a header that begins with `solid` for text.
    if bytes[..5].eq_ignore_ascii_case(b"solid") {
        bytes[..5].copy_from_slice(b"model");
    }
    bytes.extend(count.to_le_bytes());
    for triangle in &flat.triangles {
        let corners = triangle.map(|vertex| flat.positions[vertex as usize]);
        for vector in [normal(corners)].iter().chain(&corners) {
            vector.iter().for_each(|c| bytes.extend(c.to_le_bytes()));
        }
        let color = flat.colors.get(triangle[0] as usize).filter(|_| style.colors != Scheme::None);
        bytes.extend(color.map_or(0, |&color| style.colors.word(color)).to_le_bytes());
    }
    Ok(bytes)
}

/// Of unit length by the right-hand rule; 0 for a facet without area.
fn normal([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let edge = |to: [f32; 3]| [0, 1, 2].map(|k| f64::from(to[k]) - f64::from(a[k]));
    let (u, v) = (edge(b), edge(c));
    let cross = [0, 1, 2].map(|k: usize| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    let length = cross.iter().map(|c| c * c).sum::<f64>().sqrt();
    #[allow(clippy::cast_possible_truncation)] // rounding is what is wanted
    if length > 0.0 { cross.map(|c| (c / length + 0.0) as f32) } else { [0.0; 3] }
}
