//! What the caller controls beside the target: why a run ended, weights, locks, memory, merging of parts.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may stop at the first surprise")]

mod support;

mod control {
    mod blockers;
    mod pairs;
    mod protection;

    use decimesh::collapse_sequence::CollapseSequence;
    use decimesh::lod::{self, Level};
    use decimesh::mesh::Mesh;
    use decimesh::simplify::SimplifyOptions;

    /// Options that stop at `count` triangles.
    fn to(count: usize) -> SimplifyOptions {
        SimplifyOptions { target_triangle_count: count, ..SimplifyOptions::default() }
    }

    /// The last level of the record.
    fn at_end(mesh: &Mesh, sequence: &CollapseSequence) -> Mesh {
        lod::extract(mesh, sequence, Level::Triangles(0)).mesh
    }
}
