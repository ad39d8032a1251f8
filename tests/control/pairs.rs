//! Separate parts that nearly touch merge within a distance, and only then.

use decimesh::ErrorCode;
use decimesh::mesh::Mesh;
use decimesh::simplify::{Preset, Simplifier, SimplifyOptions, simplify};

use super::{at_end, to};
use crate::support::surfaces::{cubes, moved, sphere, together};
use crate::support::validity::Validity;
use crate::support::{check_sequence, plate};

const GAP: f32 = 0.02;

/// Two cubes of 8 × 8 × 8, their faces apart by the gap.
fn two_cubes() -> Mesh {
    let cube = cubes([8, 8, 8], |x, y, z| [x, y, z].iter().all(|c| (0..8).contains(c)));
    let other = moved(cube.clone(), |p| [p[0] + 8.0 + GAP, p[1], p[2]]);
    together(&[cube, other])
}

fn within(distance: f32, count: usize) -> SimplifyOptions {
    SimplifyOptions { merge_distance: distance, ..to(count) }
}

#[test]
fn two_cubes_that_nearly_touch_become_one() {
    let mesh = two_cubes();
    for count in [200, 60] {
        let sequence = simplify(&mesh, &within(2.0 * GAP, count)).unwrap();
        let result = at_end(&mesh, &sequence);
        result.validate().unwrap();
        let after = Validity::of(&result);
        assert_eq!((after.components, after.repeated_corners, after.duplicate_faces), (1, 0, 0), "{after:?}");
        assert!(after.triangles <= count, "{after:?}");
    }
    // The outline is that of both. Sixty triangles fitted to it may bulge beyond it, so without the fit.
    let unfitted = SimplifyOptions { preset: Preset::Fast, ..within(2.0 * GAP, 60) };
    let result = at_end(&mesh, &simplify(&mesh, &unfitted).unwrap());
    let most = result.positions.iter().map(|p| p[0]).fold(0.0, f32::max);
    assert!((most - 16.0 - GAP).abs() < 0.1, "{most}");
}

#[test]
fn what_is_further_apart_stays_apart() {
    let mesh = two_cubes();
    let apart = at_end(&mesh, &simplify(&mesh, &within(0.5 * GAP, 60)).unwrap());
    assert_eq!(Validity::of(&apart).components, 2);
    assert!(Validity::of(&apart).is_closed_manifold());
}

#[test]
fn a_distance_of_nothing_changes_nothing() {
    for mesh in [two_cubes(), plate(20, 0.3)] {
        assert_eq!(simplify(&mesh, &within(0.0, 60)).unwrap(), simplify(&mesh, &to(60)).unwrap());
    }
}

#[test]
fn the_error_holds_for_pairs_too() {
    let mesh = two_cubes();
    let options = SimplifyOptions { max_error: GAP / 10.0, ..within(2.0 * GAP, 0) };
    let result = at_end(&mesh, &simplify(&mesh, &options).unwrap());
    assert_eq!(Validity::of(&result).components, 2);
}

#[test]
fn a_distance_larger_than_the_model_ends() {
    let many: Vec<Mesh> = (0..6).map(|i| moved(sphere(20, 10), |p| [p[0] + 2.1 * i as f32, p[1], p[2]])).collect();
    let mesh = together(&many);
    for every_level in [false, true] {
        let options = SimplifyOptions { every_level, ..within(1e6, 40) };
        let result = at_end(&mesh, &simplify(&mesh, &options).unwrap());
        result.validate().unwrap();
        assert!(result.triangles.len() <= 40, "{}", result.triangles.len());
        assert_eq!(Validity::of(&result).repeated_corners, 0);
    }
    // Without pairs the record is as strict as ever.
    check_sequence("spheres", &simplify(&mesh, &to(40)).unwrap());
}

#[test]
fn a_wrong_distance_is_a_typed_error() {
    for distance in [-1.0, f32::NAN, f32::INFINITY] {
        let error = Simplifier::new(&two_cubes(), &within(distance, 60)).unwrap_err();
        assert_eq!((error.code(), error.place()), (ErrorCode::InvalidArgument, "mergeDistance"));
    }
}
