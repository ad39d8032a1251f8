//! What every reader but that of glTF yields, whatever the format.

use super::SceneLayout;
use crate::error::Warning;
use crate::mesh::Mesh;

/// The triangles of a file and what goes with them.
#[derive(Debug)]
pub(super) struct Content {
    /// Every triangle.
    pub(super) mesh: Mesh,
    /// Names and placements of its groups and parts.
    pub(super) layout: SceneLayout,
    /// What reading had to change or leave out.
    pub(super) warnings: Vec<Warning>,
}
