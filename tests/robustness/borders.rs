//! A locked border stays edge by edge; a free one keeps its number of loops.

use decimesh::mesh::Mesh;
use decimesh::simplify::SimplifyOptions;

use super::run;
use crate::support::surfaces::{cone, moebius};
use crate::support::validity::{self, Validity};
use crate::support::{plate, torus, tube_with_seam};

/// Half a noisy torus: two border loops that are not flat.
fn half_torus() -> Mesh {
    let whole = torus(40, 20, 0.05);
    let kept = whole.triangles.iter().copied().filter(|t| t.iter().all(|&v| v / 20 <= 20)).collect();
    Mesh::from_arrays(whole.positions, kept, vec![])
}

fn open_meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("flat plate", plate(20, 0.0)),
        ("bumpy plate", plate(24, 0.3)),
        ("half torus", half_torus()),
        ("tube with a seam", tube_with_seam(24, 30)),
        ("cone", cone(60, false)),
        ("Moebius strip", moebius(60, 8)),
    ]
}

#[test]
fn a_locked_border_keeps_every_edge() {
    for (name, mesh) in open_meshes() {
        let before = validity::border(&mesh);
        assert!(!before.is_empty(), "{name}");
        for share in [0.5, 0.2, 0.0] {
            let target = (mesh.triangles.len() as f64 * share) as usize;
            let options = SimplifyOptions { lock_border: true, target_triangle_count: target, ..Default::default() };
            let (result, _) = run(&mesh, &options);
            assert_eq!(validity::border(&result), before, "{name} at {share}: the border has changed");
            validity::check(name, &mesh, &result);
        }
    }
}

#[test]
fn a_locked_border_does_not_hold_the_inside() {
    let mesh = plate(40, 0.3);
    let options = SimplifyOptions { lock_border: true, ..Default::default() };
    let (result, _) = run(&mesh, &options);
    // A polygon of n corners has n - 2 triangles at least.
    let least = Validity::of(&mesh).border_edges - 2;
    assert!(result.triangles.len() <= 2 * least, "{} triangles, {least} are possible", result.triangles.len());
}

#[test]
fn a_free_border_keeps_its_topology() {
    for (name, mesh) in open_meshes() {
        let before = Validity::of(&mesh);
        for share in [0.5, 0.2, 0.1] {
            let (result, _) = run(&mesh, &super::to((mesh.triangles.len() as f64 * share) as usize));
            validity::check(name, &mesh, &result);
            let after = Validity::of(&result);
            assert_eq!(after.euler, before.euler, "{name} at {share}");
            assert_eq!(after.components, before.components, "{name} at {share}");
            assert_eq!(after.non_manifold_vertices, 0, "{name} at {share}");
        }
    }
}
