//! The simplifier on what people really have: traps that other simplifiers fell into, broken meshes, extreme numbers.
//!
//! Every test goes through the public surface, and judges the result by `support::validity`, which knows nothing of
//! the engine.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may stop at the first surprise")]

mod support;

mod robustness {
    mod borders;
    mod determinism;
    mod non_manifold;
    mod numbers;
    mod soups;
    mod topology;
    mod traps;

    use decimesh::collapse_sequence::{CollapseSequence, StopReason};
    use decimesh::lod::{self, Level};
    use decimesh::mesh::Mesh;
    use decimesh::simplify::{SimplifyOptions, simplify};

    /// Options that stop at `count` triangles.
    fn to(count: usize) -> SimplifyOptions {
        SimplifyOptions { target_triangle_count: count, ..SimplifyOptions::default() }
    }

    /// Options that stop at an estimated deviation of `error` in units of the mesh.
    fn within(error: f32) -> SimplifyOptions {
        SimplifyOptions { max_error: error, ..SimplifyOptions::default() }
    }

    /// The result at the end of a run, and why it ended.
    fn run(mesh: &Mesh, options: &SimplifyOptions) -> (Mesh, StopReason) {
        let sequence = simplify(mesh, options).unwrap();
        (at_end(mesh, &sequence), sequence.stop_reason)
    }

    /// The last level of the record.
    fn at_end(mesh: &Mesh, sequence: &CollapseSequence) -> Mesh {
        lod::extract(mesh, sequence, Level::Triangles(0)).mesh
    }

    /// The result of a run to `share` of the triangles; panics with `name` unless that is reached.
    fn reach(name: &str, mesh: &Mesh, share: f64) -> Mesh {
        reach_with(name, mesh, SimplifyOptions::default(), share)
    }

    /// As [`reach`], with more options.
    fn reach_with(name: &str, mesh: &Mesh, options: SimplifyOptions, share: f64) -> Mesh {
        let target = (mesh.triangles.len() as f64 * share) as usize;
        let (result, reason) = run(mesh, &SimplifyOptions { target_triangle_count: target, ..options });
        assert!(result.triangles.len() <= target, "{name}: {} triangles for {target}", result.triangles.len());
        assert_eq!(reason, StopReason::Target, "{name}");
        result
    }
}
