//! Extreme and unlucky numbers: the unit of length, the distance from the origin, the ends of what `f32` can hold.

use decimesh::mesh::Mesh;
use decimesh::simplify::simplify;

use super::{at_end, reach, run, to};
use crate::support::surfaces::moved;
use crate::support::validity::{self, Validity};
use crate::support::{plate, torus};

/// 2³⁰, 2⁻³⁰ and the like lose nothing in `f32`.
const POWERS: [f32; 6] = [2.0, 1024.0, 1_073_741_824.0, 0.5, 1.0 / 1024.0, 1.0 / 1_073_741_824.0];

fn scaled(mesh: &Mesh, factor: f32) -> Mesh {
    moved(mesh.clone(), |p| p.map(|c| c * factor))
}

/// Volume of a closed surface, by signed tetrahedra.
fn volume(mesh: &Mesh) -> f64 {
    let signed = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize].map(f64::from));
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
    };
    mesh.triangles.iter().map(signed).sum()
}

#[test]
fn a_power_of_two_changes_no_collapse() {
    for (name, mesh) in [("torus", torus(48, 24, 0.05)), ("bumpy plate", plate(30, 0.3))] {
        let plain = simplify(&mesh, &to(100)).unwrap();
        for factor in POWERS {
            let sequence = simplify(&scaled(&mesh, factor), &to(100)).unwrap();
            assert_eq!(sequence.collapses.len(), plain.collapses.len(), "{name} × {factor}");
            for (i, (a, b)) in plain.collapses.iter().zip(&sequence.collapses).enumerate() {
                assert_eq!((a.from, a.into), (b.from, b.into), "{name} × {factor}: collapse {i}");
                assert_eq!(a.position.map(|c| c * factor), b.position, "{name} × {factor}: collapse {i}");
                assert_eq!(a.error * factor, b.error, "{name} × {factor}: collapse {i}");
            }
        }
    }
}

#[test]
fn a_thousandfold_changes_nothing_to_speak_of() {
    // Every coordinate is rounded anew, so that ties may go the other way.
    let mesh = torus(48, 24, 0.05);
    let plain = reach("torus", &mesh, 0.1);
    for factor in [1e3_f32, 1e-3, 3.0, 0.1] {
        let result = reach("scaled torus", &scaled(&mesh, factor), 0.1);
        assert!(result.triangles.len().abs_diff(plain.triangles.len()) <= 1, "× {factor}");
        let ratio = volume(&result) / f64::from(factor).powi(3) / volume(&plain);
        assert!((ratio - 1.0).abs() < 5e-3, "× {factor}: volume ratio {ratio}");
    }
}

#[test]
fn a_shift_by_a_power_of_two_times_the_extent_changes_nothing_to_speak_of() {
    let mesh = torus(48, 24, 0.05);
    let plain = reach("torus", &mesh, 0.1);
    for offset in [64.0_f32, -1024.0] {
        let result = reach("shifted torus", &moved(mesh.clone(), |p| p.map(|c| c + offset)), 0.1);
        let back = moved(result, |p| p.map(|c| c - offset));
        let ratio = volume(&back) / volume(&plain);
        assert!((ratio - 1.0).abs() < 0.02, "{offset}: volume ratio {ratio}");
    }
}

#[test]
fn coordinates_from_1e_minus_30_to_1e30() {
    let mesh = torus(40, 20, 0.05);
    let plain = volume(&reach("torus", &mesh, 0.1));
    for exponent in [-30, -20, -10, 10, 20, 30] {
        let factor = 10_f64.powi(exponent) as f32;
        let input = scaled(&mesh, factor);
        let result = reach("torus", &input, 0.1);
        assert!(result.positions.iter().flatten().all(|c| c.is_finite()), "1e{exponent}");
        let unit = moved(result, |p| p.map(|c| (f64::from(c) / f64::from(factor)) as f32));
        assert!(Validity::of(&unit).is_closed_manifold(), "1e{exponent}: {:?}", Validity::of(&unit));
        let ratio = volume(&unit) / plain;
        assert!((ratio - 1.0).abs() < 5e-3, "1e{exponent}: volume ratio {ratio}");
    }
}

#[test]
fn the_largest_and_the_least_numbers_are_no_trap() {
    let mesh = torus(24, 12, 0.05);
    // Subnormals; all of the range, where a difference of two coordinates is infinite in f32.
    for factor in [1e-40_f32, f32::MIN_POSITIVE, f32::MAX / 1.5] {
        let input = scaled(&mesh, factor);
        assert!(input.positions.iter().flatten().all(|c| c.is_finite()), "the test's own input");
        let (result, _) = run(&input, &to(100));
        assert!(result.validate().is_ok(), "× {factor:e}");
        assert!(!result.triangles.is_empty(), "× {factor:e}");
    }
}

#[test]
fn scales_of_sixty_decades_in_one_mesh() {
    // One torus in ten thousand million light years, one in an atom, and the distance between.
    let (large, small) = (scaled(&torus(24, 12, 0.05), 1e30), scaled(&torus(24, 12, 0.05), 1e-30));
    let mesh = crate::support::surfaces::together(&[large, small]);
    let sequence = simplify(&mesh, &to(0)).unwrap();
    let result = at_end(&mesh, &sequence);
    assert!(result.validate().is_ok());
    assert!(!result.triangles.is_empty());
    assert!(sequence.collapses.iter().all(|c| c.error.is_finite()));
    assert!(sequence.collapses.windows(2).all(|w| w[0].error <= w[1].error));
}

#[test]
fn everything_in_one_line_or_one_place_is_no_trap() {
    for (name, flat) in [("line", [1.0, 0.0, 0.0]), ("point", [0.0; 3]), ("plane", [1.0, 1.0, 0.0])] {
        let mesh = moved(torus(16, 8, 0.05), |p| std::array::from_fn(|k| p[k] * flat[k]));
        let (result, _) = run(&mesh, &to(0));
        assert!(result.validate().is_ok(), "{name}");
        assert_eq!(Validity::of(&result).repeated_corners, 0, "{name}");
    }
}

#[test]
fn a_very_thin_plate_stays_sound() {
    for thin in [1e-3_f32, 1e-6, 1e-9] {
        let mesh = moved(torus(40, 20, 0.02), |p| [p[0], p[1], p[2] * thin]);
        validity::check("thin torus", &mesh, &reach("thin torus", &mesh, 0.2));
    }
}
