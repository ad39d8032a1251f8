//! Level of detail: the mesh at any triangle count or error, from a recorded history.
//!
//! [`Levels`] is an index of the history for many levels; [`extract`] takes one and leaves nothing.

mod blend;
mod history;
mod levels;
mod making;
mod once;
mod segment;
mod versions;

pub use levels::Levels;

use std::sync::Arc;

use crate::collapse_sequence::CollapseSequence;
use crate::mesh::Mesh;
use crate::mesh::weld::NO_VERTEX;
use history::History;
use making::Making;
use segment::{Source, is_plain};

/// Which level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Level {
    /// The mesh as it was, degenerate triangles left out.
    Full,
    /// At most this many triangles, or the fewest that were recorded.
    Triangles(usize),
    /// The fewest triangles whose error, in world units, is not above this.
    Error(f32),
}

/// A mesh at a level.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelMesh {
    /// Has the same groups, sets and parts as the original, in the same order; only the wedges
    /// that its triangles use.
    pub mesh: Mesh,
    /// For each wedge of the level, the wedge of the original that it came from.
    pub wedge_map: Vec<u32>,
    /// Estimated deviation, world units; 0 at full detail.
    pub error: f32,
}

/// Number of collapses that lead to `level`.
#[must_use]
pub fn collapse_count(sequence: &CollapseSequence, level: Level) -> usize {
    match level {
        Level::Full => 0,
        Level::Triangles(n) => sequence.triangle_counts.collapses_to(n),
        Level::Error(e) => sequence.collapses.partition_point(|c| c.error <= e),
    }
}

/// Extracts one level, in time linear in the original. `mesh` is the one the sequence was made from.
#[must_use]
pub fn extract(mesh: &Mesh, sequence: &CollapseSequence, level: Level) -> LevelMesh {
    let count = collapse_count(sequence, level);
    let source = Source { mesh, sequence, plain: is_plain(sequence) };
    once::extract(&source, count).unwrap_or_else(|| {
        let history = History::whole(&source, count);
        let mut segment = Making::whole(&source, &history, (0, count));
        let level = segment.finish(&source).level;
        Arc::try_unwrap(level).unwrap_or_else(|shared| shared.as_ref().clone())
    })
}

/// Whether the mesh itself is the level [`Level::Full`]: every triangle counts, and every wedge is in use.
#[must_use]
pub fn is_whole(mesh: &Mesh, sequence: &CollapseSequence) -> bool {
    sequence.initial_triangle_count == mesh.triangles.len()
        && !sequence.vertex_of_wedge.contains(&NO_VERTEX)
        && (sequence.fitted.is_empty() || !sequence.collapses.is_empty())
}
