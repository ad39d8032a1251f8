//! The text of an OFF file from a mesh.

use super::OffStyle;
use crate::document::SceneLayout;
use crate::document::color::to_byte;
use crate::document::flat::FlatMesh;
use crate::document::text::Text;
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;

/// `mesh` as OFF: positions, and of normals, colours and texture coordinates what all vertices
/// have, as the prefix says. Colours are bytes unless `style` says that they were floats.
///
/// # Errors
/// `not-finite` if a placement moves a vertex beyond the range of `f32`; `too-large` beyond 2 GB.
pub(in crate::document) fn write(mesh: &Mesh, layout: &SceneLayout, style: OffStyle) -> Result<Vec<u8>, Error> {
    let flat = FlatMesh::new(mesh, layout)?;
    if flat.triangles.len().saturating_add(flat.positions.len()) > i32::MAX as usize / 40 {
        return Err(Error::new(ErrorCode::TooLarge, "output", "the text would exceed 2 GB"));
    }
    let (has_normals, has_texcoords) = (!flat.normals.is_empty(), !flat.texcoords.is_empty());
    let has_colors = !flat.colors.is_empty();
    let mut text = Text::with_capacity(32 * (flat.positions.len() + flat.triangles.len()) + 64);
    let prefix = |has: bool, prefix: &'static str| if has { prefix } else { "" };
    let [st, c, n] = [prefix(has_texcoords, "ST"), prefix(has_colors, "C"), prefix(has_normals, "N")];
    text.line(&format!("{st}{c}{n}OFF"), "");
    text.line(&format!("{} {} 0", flat.positions.len(), flat.triangles.len()), "");
    for (vertex, position) in flat.positions.iter().enumerate() {
        text.first_numbers(position);
        if has_normals {
            text.more_numbers(&flat.normals[vertex]);
        }
        if has_colors {
            let color = &flat.colors[vertex];
            if style.has_float_colors {
                // A point in the number tells it from a byte, where all four are 0 or 1.
                text.more_decimals(color);
            } else {
                text.more_numbers(&color.map(|c| f32::from(to_byte(c))));
            }
        }
        if has_texcoords {
            text.more_numbers(&flat.texcoords[vertex]);
        }
        text.end_line();
    }
    for &[a, b, c] in &flat.triangles {
        text.indices("3", [a as usize, b as usize, c as usize]);
    }
    Ok(text.into_bytes())
}
