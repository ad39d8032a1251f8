//! The bytes that a run takes at its peak, counted by the allocator, against the estimate made before it starts.
//!
//! In a program of its own, with one test, so that nothing else allocates.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may stop at the first surprise")]
#![allow(clippy::print_stdout, reason = "the figures are what one wants to know")]

mod support;

use decimesh::ErrorCode;
use decimesh::mesh::Mesh;
use decimesh::simplify::{Preset, Simplifier, SimplifyOptions, estimate_bytes, simplify};
use peak_alloc::PeakAlloc;
use support::surfaces::{sphere, unindexed};
use support::{plate, torus, tube_with_seam};

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Bytes at the peak of a run, beyond those that are there before it.
fn peak(mesh: &Mesh, options: &SimplifyOptions) -> u64 {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let sequence = simplify(mesh, options).unwrap();
    let peak = ALLOCATOR.peak_usage() - before;
    assert!(!sequence.collapses.is_empty());
    peak as u64
}

#[test]
fn the_estimate_bounds_the_peak_and_is_not_far_above() {
    let tenth =
        |mesh: &Mesh| SimplifyOptions { target_triangle_count: mesh.triangles.len() / 10, ..Default::default() };
    let shared = [
        ("noisy torus of 500,000 vertices", torus(1000, 500, 0.05), 1.5),
        ("plate", plate(300, 0.3), 1.5),
        ("sphere", sphere(400, 200), 1.5),
        // How many vertices it has is not known before the weld.
        ("loose sphere", unindexed(&sphere(400, 200)), 2.0),
        ("tube with a seam", tube_with_seam(200, 300), 1.9),
    ];
    for (name, mesh, most) in shared {
        for preset in [Preset::Fast, Preset::Balanced, Preset::Best] {
            for every_level in [false, true] {
                // The large one takes long.
                if mesh.positions.len() > 400_000 && (preset == Preset::Fast || every_level && preset == Preset::Best) {
                    continue;
                }
                let target = if every_level { 0 } else { mesh.triangles.len() / 10 };
                let options = SimplifyOptions {
                    preset,
                    every_level,
                    target_triangle_count: target,
                    ..SimplifyOptions::default()
                };
                let (estimate, peak) = (estimate_bytes(&mesh, &options), peak(&mesh, &options));
                let ratio = estimate as f64 / peak as f64;
                let per_vertex = peak as f64 / mesh.positions.len() as f64;
                println!(
                    "{name}, {preset:?}, every level {every_level}: {per_vertex:.0} bytes a vertex, estimate {ratio:.2} times that"
                );
                assert!((1.0..=most).contains(&ratio), "{name}: {estimate} estimated, {peak} at the peak");
                if name.starts_with("noisy torus") {
                    assert!(per_vertex <= 200.0, "{per_vertex} bytes a vertex");
                }
            }
        }
    }

    // Above the limit nothing is begun.
    let mesh = torus(100, 50, 0.05);
    let options = SimplifyOptions { memory_limit: estimate_bytes(&mesh, &tenth(&mesh)), ..tenth(&mesh) };
    assert!(Simplifier::new(&mesh, &options).is_ok());
    let error = Simplifier::new(&mesh, &SimplifyOptions { memory_limit: 1_000_000, ..options }).unwrap_err();
    assert_eq!((error.code(), error.place()), (ErrorCode::TooLarge, "mesh"));
    assert!(error.message().contains("5000 vertices and 10000 triangles takes about 2 MB"), "{error}");
}
