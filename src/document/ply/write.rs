//! A PLY file from a mesh: binary, little end first.

use super::PlyStyle;
use crate::document::SceneLayout;
use crate::document::color::to_byte;
use crate::document::flat::FlatMesh;
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;

/// `mesh` as binary PLY: positions, and of normals, texture coordinates and colours what all
/// vertices have. Colours are bytes unless `style` says that they were floats.
///
/// # Errors
/// `not-finite` if a placement moves a vertex beyond the range of `f32`; `too-large` beyond 2 GB.
pub(in crate::document) fn write(mesh: &Mesh, layout: &SceneLayout, style: &PlyStyle) -> Result<Vec<u8>, Error> {
    let flat = FlatMesh::new(mesh, layout)?;
    let (has_normals, has_texcoords) = (!flat.normals.is_empty(), !flat.texcoords.is_empty());
    let has_colors = !flat.colors.is_empty();
    let has_alpha = has_colors && (style.has_alpha || flat.colors.iter().any(|color| color[3] < 1.0));
    let mut header = String::from("ply\nformat binary_little_endian 1.0\n");
    let mut line = |words: &[&str]| {
        header.push_str(&words.join(" "));
        header.push('\n');
    };
    if style.remarks.is_empty() {
        line(&["comment Decimesh"]);
    }
    style.remarks.iter().for_each(|remark| line(&[remark]));
    line(&["element vertex", &flat.positions.len().to_string()]);
    ["x", "y", "z"].iter().for_each(|name| line(&["property float", name]));
    let mut size = 12;
    if has_normals {
        ["nx", "ny", "nz"].iter().for_each(|name| line(&["property float", name]));
        size += 12;
    }
    if has_texcoords {
        style.texcoord_names.unwrap_or(["s", "t"]).iter().for_each(|name| line(&["property float", name]));
        size += 8;
    }
    let channels = if has_alpha { 4 } else { 3 };
    if has_colors {
        let kind = if style.has_float_colors { "property float" } else { "property uchar" };
        ["red", "green", "blue", "alpha"][..channels].iter().for_each(|name| line(&[kind, name]));
        size += channels * if style.has_float_colors { 4 } else { 1 };
    }
    line(&["element face", &flat.triangles.len().to_string()]);
    line(&["property list uchar int vertex_indices"]);
    line(&["end_header"]);

    let body = size.checked_mul(flat.positions.len()).zip(flat.triangles.len().checked_mul(13));
    let total = body.and_then(|(vertices, faces)| vertices.checked_add(faces)?.checked_add(header.len()));
    let Some(total) = total.filter(|&total| total < i32::MAX as usize) else {
        return Err(Error::new(ErrorCode::TooLarge, "output", "the file would exceed 2 GB"));
    };
    let mut bytes = Vec::with_capacity(total);
    bytes.extend_from_slice(header.as_bytes());
    let put = |bytes: &mut Vec<u8>, values: &[f32]| values.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    for vertex in 0..flat.positions.len() {
        put(&mut bytes, &flat.positions[vertex]);
        if has_normals {
            put(&mut bytes, &flat.normals[vertex]);
        }
        if has_texcoords {
            put(&mut bytes, &flat.texcoords[vertex]);
        }
        if has_colors && style.has_float_colors {
            put(&mut bytes, &flat.colors[vertex][..channels]);
        } else if has_colors {
            bytes.extend(flat.colors[vertex][..channels].iter().map(|&c| to_byte(c)));
        }
    }
    for triangle in &flat.triangles {
        bytes.push(3);
        triangle.iter().for_each(|index| bytes.extend(index.to_le_bytes()));
    }
    Ok(bytes)
}
