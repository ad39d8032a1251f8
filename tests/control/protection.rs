//! Weights send the collapses elsewhere; locks keep vertices where they are.

use std::collections::BTreeSet;

use decimesh::ErrorCode;
use decimesh::mesh::Mesh;
use decimesh::simplify::{Preset, Simplifier, SimplifyOptions, simplify};

use super::{at_end, to};
use crate::support::surfaces::tangle;
use crate::support::{self, fingerprint, plate, torus, tube_with_seam};

/// Vertices of the mesh with x above 0.
fn right(mesh: &Mesh) -> usize {
    mesh.positions.iter().filter(|p| p[0] > 0.0).count()
}

fn with_weights(mesh: &Mesh, weight: f32, options: SimplifyOptions) -> SimplifyOptions {
    let weights = mesh.positions.iter().map(|p| if p[0] > 0.0 { weight } else { 0.0 }).collect();
    SimplifyOptions { weights, ..options }
}

#[test]
fn what_weighs_more_keeps_more_vertices() {
    let mesh = torus(60, 30, 0.05);
    for every_level in [false, true] {
        let options = SimplifyOptions { every_level, ..to(600) };
        let kept = |weight: f32| {
            let sequence = simplify(&mesh, &with_weights(&mesh, weight, options.clone())).unwrap();
            right(&at_end(&mesh, &sequence))
        };
        let (plain, some, much) = (kept(0.0), kept(30.0), kept(1e9));
        assert!(plain < 200, "{plain} of 300");
        assert!(some > plain + 20 && much >= some, "{plain}, {some}, {much}");
    }
}

#[test]
fn weights_of_nothing_change_nothing() {
    let mesh = torus(60, 30, 0.05);
    let plain = simplify(&mesh, &to(300)).unwrap();
    assert_eq!(simplify(&mesh, &with_weights(&mesh, 0.0, to(300))).unwrap(), plain);
    let unlocked = SimplifyOptions { locked: vec![false; mesh.positions.len()], ..to(300) };
    assert_eq!(simplify(&mesh, &unlocked).unwrap(), plain);
}

#[test]
fn the_same_weight_everywhere_costs_no_error() {
    // Other thresholds, so that the order is not quite the same; but the estimate is of the surface.
    let mesh = torus(60, 30, 0.05);
    let error = |weights: Vec<f32>| {
        let sequence = simplify(&mesh, &SimplifyOptions { weights, ..to(300) }).unwrap();
        sequence.collapses.last().unwrap().error
    };
    let (plain, weighted) = (error(vec![]), error(vec![63.0; mesh.positions.len()]));
    assert!((weighted / plain - 1.0).abs() < 0.2, "{plain}, {weighted}");
}

#[test]
fn a_lock_keeps_vertices_bit_by_bit() {
    let mut fixtures: Vec<(&str, Mesh)> = support::all().into_iter().map(|(name, mesh, _)| (name, mesh)).collect();
    fixtures.push(("tangle", tangle(2000)));
    fixtures.push(("tube", tube_with_seam(24, 30)));
    for (name, mesh) in fixtures {
        let used: BTreeSet<u32> =
            mesh.triangles.iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]).flatten().copied().collect();
        let locked: Vec<bool> = (0..mesh.positions.len() as u32).map(|v| v % 7 == 3 && used.contains(&v)).collect();
        for preset in [Preset::Fast, Preset::Best] {
            let options = SimplifyOptions { locked: locked.clone(), preset, prune: true, ..to(0) };
            let sequence = simplify(&mesh, &options).unwrap();
            support::check_sequence(name, &sequence);
            let result = at_end(&mesh, &sequence);
            let places: BTreeSet<[u32; 3]> = result.positions.iter().map(|p| p.map(|c| (c + 0.0).to_bits())).collect();
            for (v, p) in mesh.positions.iter().enumerate().filter(|(v, _)| locked[*v]) {
                assert!(
                    places.contains(&p.map(|c| (c + 0.0).to_bits())),
                    "{name}: vertex {v} is not at {p:?} any more"
                );
            }
        }
    }
}

#[test]
fn a_lock_does_not_hold_the_rest() {
    let mesh = plate(40, 0.3);
    let mut locked = vec![false; mesh.positions.len()];
    locked[41 * 20 + 20] = true;
    let result = at_end(&mesh, &simplify(&mesh, &SimplifyOptions { locked, ..to(0) }).unwrap());
    assert!(result.triangles.len() <= 12, "{} triangles are left", result.triangles.len());
}

#[test]
fn everything_locked_is_left_alone() {
    let mesh = torus(20, 10, 0.05);
    let sequence = simplify(&mesh, &SimplifyOptions { locked: vec![true; 200], ..to(0) }).unwrap();
    assert_eq!(sequence.blockers.locked, 600);
    assert_eq!(fingerprint(&at_end(&mesh, &sequence)), fingerprint(&mesh));
}

#[test]
fn wrong_weights_and_locks_are_typed_errors() {
    let mesh = torus(20, 10, 0.05);
    let refused = |options: SimplifyOptions| {
        let error = Simplifier::new(&mesh, &options).unwrap_err();
        (error.code(), error.place().to_owned())
    };
    let mut weights = vec![0.0; 200];
    assert_eq!(
        refused(SimplifyOptions { weights: vec![1.0; 199], ..to(1) }),
        (ErrorCode::InvalidArgument, "weights".into())
    );
    assert_eq!(
        refused(SimplifyOptions { locked: vec![true; 201], ..to(1) }),
        (ErrorCode::InvalidArgument, "locked".into())
    );
    weights[7] = -1.0;
    assert_eq!(
        refused(SimplifyOptions { weights: weights.clone(), ..to(1) }),
        (ErrorCode::InvalidArgument, "weights[7]".into())
    );
    weights[7] = f32::NAN;
    assert_eq!(refused(SimplifyOptions { weights, ..to(1) }), (ErrorCode::NotFinite, "weights[7]".into()));
}
