//! A run that stops above its target says what blocks the edges that are left, each of them once.

use std::collections::BTreeSet;

use decimesh::collapse_sequence::{Blockers, StopReason};
use decimesh::mesh::{Attribute, Blend, Mesh};
use decimesh::simplify::{SimplifyOptions, simplify};

use super::{at_end, to};
use crate::support::{self, plate, tetrahedron, torus, tube_with_seam};

/// Edges between places, so that both sides of a seam count once.
fn edges(mesh: &Mesh) -> usize {
    let place = |v: u32| mesh.positions[v as usize].map(|c| (c + 0.0).to_bits());
    let mut edges = BTreeSet::new();
    for t in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = (place(t[k]), place(t[(k + 1) % 3]));
            edges.insert(if a < b { (a, b) } else { (b, a) });
        }
    }
    edges.len()
}

/// Runs as far as can be, and checks that every edge is counted once.
fn blockers(mesh: &Mesh, options: &SimplifyOptions) -> (Blockers, usize) {
    let sequence = simplify(mesh, options).unwrap();
    assert_ne!(sequence.stop_reason, StopReason::Target);
    let edges = edges(&at_end(mesh, &sequence));
    assert_eq!(sequence.blockers.total(), edges, "{:?}", sequence.blockers);
    (sequence.blockers, edges)
}

#[test]
fn a_tetrahedron_is_held_by_its_topology() {
    assert_eq!(blockers(&tetrahedron(), &to(0)).0, Blockers { topology: 6, ..Blockers::default() });
}

#[test]
fn every_edge_is_counted_once_on_every_fixture() {
    for (name, mesh, _) in support::all() {
        for every_level in [false, true] {
            let (found, edges) = blockers(&mesh, &SimplifyOptions { every_level, ..to(0) });
            assert!(edges > 0, "{name}: {found:?}");
        }
    }
}

#[test]
fn a_locked_border_is_named() {
    let (found, edges) = blockers(&plate(20, 0.3), &SimplifyOptions { lock_border: true, ..to(0) });
    assert!(found.locked >= 80 && found.locked * 2 > edges, "{found:?}");
}

#[test]
fn an_error_limit_is_named() {
    let mesh = torus(40, 20, 0.05);
    let limit = mesh.diagonal() as f32 * 1e-3;
    let (found, edges) = blockers(&mesh, &SimplifyOptions { max_error: limit, ..to(0) });
    assert!(found.error * 2 > edges, "{found:?}");
}

#[test]
fn seams_everywhere_are_named() {
    // A torus in twenty rings of different colours: no ring may vanish, and none can have fewer than three sides.
    let plain = torus(20, 24, 0.0);
    let (mut positions, mut triangles, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for (quad, pair) in (0_u32..).zip(plain.triangles.chunks(2)) {
        let [a, b, c] = pair[0];
        let d = pair[1][2];
        let first = positions.len() as u32;
        positions.extend([a, b, c, d].map(|v| plain.positions[v as usize]));
        triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|k| first + k)));
        values.extend([(quad / 24) as f32; 4]);
    }
    let color = Attribute { name: "COLOR_0".into(), components: 1, values, blend: Blend::Linear };
    let mesh = Mesh::from_arrays(positions, triangles, vec![color]);
    let (found, edges) = blockers(&mesh, &to(0));
    assert!(found.seam >= 120 && found.seam * 2 > edges, "{found:?} of {edges}");
    // One seam is no obstacle to speak of.
    let (found, edges) = blockers(&tube_with_seam(24, 30), &to(0));
    assert!(found.seam + found.corner < edges, "{found:?}");
}

#[test]
fn a_run_that_reaches_its_target_counts_nothing() {
    let sequence = simplify(&torus(40, 20, 0.05), &to(200)).unwrap();
    assert_eq!((sequence.stop_reason, sequence.blockers), (StopReason::Target, Blockers::default()));
}
