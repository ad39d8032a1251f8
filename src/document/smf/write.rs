//! The text of an SMF file from a mesh.

use crate::document::SceneLayout;
use crate::document::flat::FlatMesh;
use crate::document::text::Text;
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;

/// `mesh` as SMF: positions, and of normals, colours and texture coordinates what all vertices have.
///
/// # Errors
/// `not-finite` if a placement moves a vertex beyond the range of `f32`; `too-large` beyond 2 GB.
pub(in crate::document) fn write(mesh: &Mesh, layout: &SceneLayout) -> Result<Vec<u8>, Error> {
    let flat = FlatMesh::new(mesh, layout)?;
    if flat.triangles.len().saturating_add(flat.positions.len()) > i32::MAX as usize / 40 {
        return Err(Error::new(ErrorCode::TooLarge, "output", "the text would exceed 2 GB"));
    }
    let mut text = Text::with_capacity(32 * (flat.positions.len() + flat.triangles.len()) + 64);
    text.line("#$SMF", "1.0");
    text.line("#$vertices", &flat.positions.len().to_string());
    text.line("#$faces", &flat.triangles.len().to_string());
    let mut rows = |keyword: &str, row: &[f32]| {
        text.numbers(keyword, row);
        text.end_line();
    };
    flat.positions.iter().for_each(|row| rows("v", row));
    if !flat.normals.is_empty() {
        text.line("bind n", "vertex");
        for row in &flat.normals {
            text.numbers("n", row);
            text.end_line();
        }
    }
    if !flat.colors.is_empty() {
        text.line("bind c", "vertex");
        for row in &flat.colors {
            text.numbers("c", &row[..3]);
            text.end_line();
        }
    }
    if !flat.texcoords.is_empty() {
        text.line("bind r", "vertex");
        for row in &flat.texcoords {
            text.numbers("r", row);
            text.end_line();
        }
    }
    for triangle in &flat.triangles {
        text.indices("f", triangle.map(|index| index as usize + 1));
    }
    Ok(text.into_bytes())
}
