//! `CollapseSequence`: the recorded history of one run, from which every level is extracted.

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The triangle count was reached.
    Target,
    /// The next collapse would exceed the error.
    Error,
    /// No legal collapse is left.
    Constraints,
    /// The owner had no more time.
    Time,
}

impl StopReason {
    /// The stable name in reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Target => "target",
            Self::Error => "error",
            Self::Constraints => "constraints",
            Self::Time => "time",
        }
    }
}

/// One edge collapse: vertex `from` goes into vertex `into`, which moves to `position`.
/// Vertices are named by the wedge that the weld chose to represent them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collapse {
    /// The vertex that vanishes.
    pub from: u32,
    /// The vertex that stays.
    pub into: u32,
    /// Where it stays, in the part's local space.
    pub position: [f32; 3],
    /// Running maximum of the estimated deviation after this collapse, in world units.
    pub error: f32,
}

/// The history of one run over one [`crate::mesh::Mesh`].
#[derive(Debug, Clone, PartialEq)]
pub struct CollapseSequence {
    /// In the order they were done; `error` never falls.
    pub collapses: Vec<Collapse>,
    /// Wedge merges `(from, into)` of all collapses, in order.
    pub wedge_merges: Vec<(u32, u32)>,
    /// For each collapse, the end of its merges in `wedge_merges`.
    pub wedge_merge_ends: Vec<u32>,
    /// For each collapse, how many triangles are left after it.
    pub triangle_counts: Vec<u32>,
    /// Vertex of each wedge (the weld), named by one of its wedges.
    pub vertex_of_wedge: Vec<u32>,
    /// Triangles at the start, degenerate ones left out.
    pub initial_triangle_count: usize,
    /// Why the run ended.
    pub stop_reason: StopReason,
    /// Positions at the last level of vertices that were fitted to the original after the last
    /// collapse, named as in [`Collapse`]; often empty.
    pub fitted: Vec<(u32, [f32; 3])>,
}
