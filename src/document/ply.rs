//! PLY (Turk, *The PLY Polygon File Format*, 1994), both directions.
//!
//! [`header`] says which elements with which properties follow; [`rows`] steps through them, in
//! text or in binary of either byte order; [`read`] takes positions, normals, colours and texture
//! coordinates of vertices, polygons or triangle strips, and the colours and texture coordinates of
//! faces, and steps over everything else; [`write`] puts a mesh into binary.
//!
//! Colours of 8 or 16 bits stand for 0 to 1. A texture named in a comment, as MeshLab does, becomes
//! the material.

mod header;
mod read;
mod rows;
mod write;

use super::content::Content;

pub(super) use read::read;
pub(super) use write::write;

/// A PLY file as read.
#[derive(Debug)]
pub(super) struct PlySource {
    pub(super) content: Content,
    pub(super) style: PlyStyle,
}

/// What a file has that a mesh does not say.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct PlyStyle {
    /// `comment` and `obj_info` lines, whole, in order.
    remarks: Vec<String>,
    /// Colours are floats and not bytes.
    has_float_colors: bool,
    /// Colours have an alpha, even if it is 1 everywhere.
    has_alpha: bool,
    /// Names of the texture coordinates, where they are not `s` and `t`.
    texcoord_names: Option<[&'static str; 2]>,
}

/// Whether `bytes` begin as a PLY file.
pub(super) fn looks_like_ply(bytes: &[u8]) -> bool {
    let rest = bytes.strip_prefix(b"ply").unwrap_or_default();
    let line = rest.iter().position(|b| !matches!(b, b' ' | b'\t')).map_or(0, |at| rest[at]);
    matches!(line, b'\n' | b'\r')
}

/// What a remark of MeshLab calls the texture.
fn texture_of(remark: &str) -> Option<&str> {
    Some(remark.strip_prefix("comment TextureFile ")?.trim()).filter(|name| !name.is_empty())
}

/// The texture that a comment in the header names.
pub(super) fn texture_name(bytes: &[u8]) -> Option<String> {
    let header = header::parse("", bytes).ok()?;
    header.remarks.iter().find_map(|remark| texture_of(remark)).map(str::to_owned)
}
