//! Traps: inputs on which simplifiers are known to stop early, to run for ever or to leave nothing.

use decimesh::collapse_sequence::StopReason;

use super::{reach, run, to, within};
use crate::support::surfaces::{cone, moved, sphere, together, unindexed};
use crate::support::validity::{self, Validity};
use crate::support::{plate, tetrahedron};

/// Quads along a side of the plates: 45,000 triangles each.
const PLATE: u32 = 150;

fn unit_plate_at(z: f32) -> decimesh::mesh::Mesh {
    moved(plate(PLATE, 0.0), |p| [p[0] / PLATE as f32, p[1] / PLATE as f32, z])
}

#[test]
fn a_flat_plate_at_height_0_or_900_becomes_a_few_triangles() {
    for z in [0.0, 900.0] {
        let mesh = unit_plate_at(z);
        let (result, _) = run(&mesh, &within(1e-4));
        assert!(result.triangles.len() <= 20, "z = {z}: {} of 45,000 triangles are left", result.triangles.len());
        validity::check("plate", &mesh, &result);
        assert!(result.positions.iter().all(|p| (p[2] - z).abs() < 1e-4), "z = {z}: the plate has moved");
    }
}

#[test]
fn two_flat_plates_far_apart_in_one_mesh_become_a_few_triangles_each() {
    let mesh = together(&[unit_plate_at(0.0), unit_plate_at(900.0)]);
    // 1e-4 of a plate's side, and 1e-4 of the whole model's diagonal.
    for error in [1e-4, 0.09] {
        let (result, _) = run(&mesh, &within(error));
        for z in [0.0_f32, 900.0] {
            let left = result.triangles.iter().filter(|t| (result.positions[t[0] as usize][2] - z).abs() < 1.0).count();
            assert!((1..=20).contains(&left), "error {error}: {left} triangles are left at z = {z}");
        }
        validity::check("plates", &mesh, &result);
    }
}

#[test]
fn a_rotated_plane_a_hundred_extents_away_becomes_ten_triangles() {
    // Turned about x by atan 3/4, then about z by atan 5/12: no coordinate is exact any more.
    let turned = moved(unit_plate_at(0.0), |[x, y, z]| {
        let (y, z) = (y * 0.8 - z * 0.6, y * 0.6 + z * 0.8);
        let (x, y) = (x * 12.0 / 13.0 - y * 5.0 / 13.0, x * 5.0 / 13.0 + y * 12.0 / 13.0);
        [x + 100.0, y + 100.0, z + 100.0]
    });
    let (result, _) = run(&turned, &within(1e-4));
    assert!(result.triangles.len() <= 10, "{} of 45,000 triangles are left", result.triangles.len());
    validity::check("rotated plane", &turned, &result);
}

#[test]
fn no_closed_surface_vanishes() {
    let pair = together(&[tetrahedron(), moved(tetrahedron(), |p| p.map(|c| c + 5.0))]);
    for (name, mesh) in [("tetrahedron", tetrahedron()), ("two", pair), ("sphere", sphere(24, 12))] {
        for options in [to(0), within(1e3), within(f32::MAX)] {
            let (result, _) = run(&mesh, &options);
            assert!(!result.triangles.is_empty(), "{name}: nothing is left");
            validity::check_closed(name, &mesh, &result);
        }
    }
}

#[test]
fn nothing_open_vanishes_either() {
    for (name, mesh) in [("plate", plate(10, 0.0)), ("bumpy plate", plate(10, 0.3)), ("cone", cone(40, false))] {
        let (result, _) = run(&mesh, &to(0));
        assert!(!result.triangles.is_empty(), "{name}: nothing is left");
        validity::check(name, &mesh, &result);
    }
}

#[test]
fn a_sphere_of_199_808_loose_triangles_is_welded_and_reaches_a_tenth() {
    let mesh = unindexed(&sphere(448, 224));
    assert_eq!(mesh.triangles.len(), 199_808);
    let result = reach("loose sphere", &mesh, 0.1);
    validity::check_closed("loose sphere", &mesh, &result);
}

#[test]
fn a_tip_of_a_hundred_thousand_sides_ends() {
    // Each collapse at the tip would walk its whole fan, and that is quadratic if nothing stops it.
    for closed in [false, true] {
        let mesh = cone(100_000, closed);
        let result = reach("cone", &mesh, 0.1);
        if closed {
            validity::check_closed("cone", &mesh, &result);
        } else {
            validity::check("cone", &mesh, &result);
        }
    }
}

#[test]
fn a_flat_plate_becomes_two_triangles_of_the_same_outline() {
    for n in [2, 7, 40] {
        let mesh = plate(n, 0.0);
        let (result, _) = run(&mesh, &within(1e-5 * n as f32));
        assert_eq!(result.triangles.len(), 2, "{n} × {n} quads");
        let length = Validity::of(&result).border_length;
        assert!((length / f64::from(4 * n) - 1.0).abs() < 1e-5, "{n} × {n} quads: border of {length}");
    }
}

#[test]
fn what_changes_nothing_goes_at_an_error_of_nothing() {
    // Two triangles would do; six are a start.
    for n in [7, 40, 150] {
        let (result, _) = run(&plate(n, 0.0), &within(0.0));
        assert!(result.triangles.len() <= 6, "{n} × {n} quads: {} triangles are left", result.triangles.len());
    }
}

#[test]
fn a_flat_plate_with_a_hole_keeps_the_hole() {
    let mut mesh = plate(30, 0.0);
    let in_hole = |v: u32| {
        let (x, y) = (v % 31, v / 31);
        (10..=20).contains(&x) && (10..=20).contains(&y)
    };
    mesh.triangles.retain(|t| !t.iter().all(|&v| in_hole(v)));
    mesh.groups[0].triangles = 0..mesh.triangles.len();
    let (result, reason) = run(&mesh, &within(1e-4));
    assert_eq!(reason, StopReason::Error);
    assert!(result.triangles.len() <= 12, "{} triangles are left", result.triangles.len());
    validity::check("plate with a hole", &mesh, &result);
    assert_eq!(Validity::of(&result).euler, 0);
    let length = Validity::of(&result).border_length;
    assert!((length - 160.0).abs() < 0.01, "border of {length}");
}
