//! The simplifier: exact small cases, known traps, and the properties on every fixture.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

mod support;

use decimesh::ErrorCode;
use decimesh::collapse_sequence::StopReason;
use decimesh::lod::{self, Level};
use decimesh::mesh::Mesh;
use decimesh::simplify::{PlacementRule, Simplifier, SimplifyOptions, simplify};
use proptest::prelude::*;

fn to(count: usize) -> SimplifyOptions {
    SimplifyOptions { target_triangle_count: count, ..SimplifyOptions::default() }
}

fn level(mesh: &Mesh, options: &SimplifyOptions) -> Mesh {
    let sequence = simplify(mesh, options).unwrap();
    lod::extract(mesh, &sequence, Level::Triangles(options.target_triangle_count)).mesh
}

#[test]
fn every_fixture_keeps_its_properties_at_every_level() {
    for (name, mesh, closed) in support::all() {
        let sequence = simplify(&mesh, &SimplifyOptions::default()).unwrap();
        support::check_all_levels(name, &mesh, &sequence, closed);
    }
}

#[test]
fn a_target_is_met_and_not_undershot_by_more_than_one_collapse() {
    let mesh = support::torus(40, 20, 0.05);
    for target in [1000, 333, 64] {
        let sequence = simplify(&mesh, &to(target)).unwrap();
        assert_eq!(sequence.stop_reason, StopReason::Target);
        let reached = sequence.triangle_counts.after(sequence.collapses.len());
        assert!(reached <= target && reached + 2 > target, "{reached} for {target}");
    }
}

#[test]
fn a_tetrahedron_asked_for_nothing_stays() {
    let sequence = simplify(&support::tetrahedron(), &to(0)).unwrap();
    assert!(sequence.collapses.is_empty());
    assert_eq!(sequence.stop_reason, StopReason::Constraints);
}

#[test]
fn a_single_triangle_and_an_empty_mesh_are_left_alone() {
    let one = Mesh::from_arrays(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]], vec![]);
    assert_eq!(level(&one, &to(0)).triangles.len(), 1);
    let none = Mesh::from_arrays(vec![], vec![], vec![]);
    assert_eq!(level(&none, &to(0)).triangles.len(), 0);
}

#[test]
fn a_flat_plate_far_from_the_origin_becomes_a_few_triangles() {
    let mut mesh = support::plate(150, 0.0);
    for p in &mut mesh.positions {
        *p = [p[0], p[1], 900.0];
    }
    let options = SimplifyOptions { max_error: 1e-4, ..SimplifyOptions::default() };
    let sequence = simplify(&mesh, &options).unwrap();
    let reached = sequence.triangle_counts.after(sequence.collapses.len());
    assert!(reached <= 20, "{reached} of 45,000 are left");
    let result = lod::extract(&mesh, &sequence, Level::Triangles(0)).mesh;
    assert!(result.positions.iter().all(|p| (p[2] - 900.0).abs() < 1e-3));
}

#[test]
fn the_error_limit_is_kept_and_named() {
    let mesh = support::torus(60, 30, 0.0);
    let limit = mesh.diagonal() as f32 * 1e-3;
    let sequence = simplify(&mesh, &SimplifyOptions { max_error: limit, ..SimplifyOptions::default() }).unwrap();
    assert_eq!(sequence.stop_reason, StopReason::Error);
    assert!(sequence.collapses.last().unwrap().error <= limit);
    assert!(!sequence.collapses.is_empty());
}

#[test]
fn a_locked_border_does_not_move() {
    let mesh = support::plate(20, 0.2);
    let on_border = |p: &[f32; 3]| p[0] == 0.0 || p[1] == 0.0 || p[0] == 20.0 || p[1] == 20.0;
    let options = SimplifyOptions { lock_border: true, ..SimplifyOptions::default() };
    let result = level(&mesh, &options);
    assert_eq!(result.positions.iter().filter(|p| on_border(p)).count(), 80);
    assert!(result.triangles.len() < 120, "{}", result.triangles.len());
}

#[test]
fn an_open_border_keeps_its_outline() {
    let mesh = support::plate(20, 0.0);
    let result = level(&mesh, &to(2));
    let area: f32 = result
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| result.positions[v as usize]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        })
        .sum();
    assert!((area - 400.0).abs() < 1.0, "area {area} of 400");
}

#[test]
fn subset_placement_uses_only_original_positions() {
    let mesh = support::torus(40, 20, 0.05);
    let options = SimplifyOptions { placement: PlacementRule::Subset, ..to(200) };
    let sequence = simplify(&mesh, &options).unwrap();
    let result = lod::extract(&mesh, &sequence, Level::Triangles(200));
    assert!(result.mesh.triangles.len() <= 200);
    for (p, &w) in result.mesh.positions.iter().zip(&result.wedge_map) {
        assert_eq!(p, &mesh.positions[w as usize]);
    }
}

#[test]
fn a_seam_does_not_tear_and_its_texture_stays_straight() {
    let mesh = support::tube_with_seam(24, 30);
    let result = level(&mesh, &to(200));
    assert!(result.triangles.len() <= 200);
    let uv = &result.wedge_sets[0].attributes[1].values;
    let mut on_seam = 0;
    for (p, uv) in result.positions.iter().zip(uv.chunks(2)) {
        // The height is linear in v, and the seam's wedges are at u = 0 or 1 just on its line.
        assert!((p[2] / 3.0 - uv[1]).abs() < 0.02, "v {} at height {}", uv[1], p[2]);
        if uv[0] < 1e-5 || uv[0] > 1.0 - 1e-5 {
            on_seam += 1;
            assert!(p[1].abs() < 0.05 && p[0] > 0.9, "seam wedge at {p:?}");
        } else {
            let angle = p[1].atan2(p[0]).rem_euclid(std::f32::consts::TAU) / std::f32::consts::TAU;
            assert!((angle - uv[0]).abs() < 0.04, "u {} at angle {angle}", uv[0]);
        }
    }
    assert!(on_seam >= 4 && on_seam % 2 == 0, "both sides of the seam: {on_seam}");
    assert_eq!(support::shape(&result).border_edges, support::shape(&result).border_edges.min(60), "no tear");
}

#[test]
fn the_result_does_not_depend_on_the_unit_of_length() {
    let mesh = support::torus(40, 20, 0.05);
    let small = level(&mesh, &to(200));
    for scale in [1e-30_f32, 1e-3, 1024.0, 1e30] {
        let mut scaled = mesh.clone();
        scaled.positions.iter_mut().flatten().for_each(|c| *c *= scale);
        let result = level(&scaled, &to(200));
        assert!(result.triangles.len() <= 200, "scale {scale}");
        let extent = |m: &Mesh| m.positions.iter().flatten().fold(0.0_f32, |a, &b| a.max(b.abs()));
        let ratio = extent(&result) / scale / extent(&small);
        assert!((ratio - 1.0).abs() < 0.05, "scale {scale}: extent ratio {ratio}");
    }
}

#[test]
fn steps_of_any_size_give_the_same_sequence() {
    let mesh = support::torus(48, 24, 0.05);
    let whole = simplify(&mesh, &to(100)).unwrap();
    for work in [1, 17, 1000] {
        assert_eq!(support::simplify_in_steps(&mesh, &to(100), work), whole);
    }
}

#[test]
fn a_run_ended_early_can_still_be_read() {
    let mesh = support::torus(48, 24, 0.05);
    let mut run = Simplifier::new(&mesh, &to(0)).unwrap();
    for _ in 0..200 {
        run.step(&mesh, 20);
    }
    support::check_all_levels("ended early", &mesh, &run.finish(), true);
}

#[test]
fn bad_meshes_and_options_are_typed_errors() {
    let code = |mesh: &Mesh, options: &SimplifyOptions| Simplifier::new(mesh, options).unwrap_err();
    let mut mesh = support::tetrahedron();
    mesh.triangles[1][2] = 4;
    assert_eq!(code(&mesh, &to(1)).code(), ErrorCode::OutOfRange);
    assert_eq!(code(&mesh, &to(1)).place(), "triangles[1]");
    let mut mesh = support::tetrahedron();
    mesh.positions[2][1] = f32::NAN;
    assert_eq!(code(&mesh, &to(1)).code(), ErrorCode::NotFinite);
    assert_eq!(code(&mesh, &to(1)).place(), "positions[2]");
    let options = SimplifyOptions { max_error: -1.0, ..to(1) };
    assert_eq!(code(&support::tetrahedron(), &options).code(), ErrorCode::InvalidArgument);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any soup of indices over few positions: duplicates, degenerates, non-manifold, whatever.
    #[test]
    fn any_soup_simplifies_to_a_sound_mesh(
        points in prop::collection::vec(prop::array::uniform3(-3i8..4), 3..24),
        picks in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..60),
        target in 0usize..40,
    ) {
        let positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(f32::from)).collect();
        let triangles: Vec<[u32; 3]> = picks.iter().map(|t| t.map(|i| i.index(positions.len()) as u32)).collect();
        let mesh = Mesh::from_arrays(positions, triangles, vec![]);
        let sequence = simplify(&mesh, &to(target)).unwrap();
        support::check_sequence("soup", &sequence);
        let level = lod::extract(&mesh, &sequence, Level::Triangles(target));
        prop_assert!(level.mesh.validate().is_ok());
        prop_assert!(level.mesh.triangles.len() <= mesh.triangles.len());
        for t in &level.mesh.triangles {
            let [a, b, c] = t.map(|w| level.mesh.positions[w as usize]);
            prop_assert!(a != b && b != c && c != a);
        }
    }

    /// Noisy closed surfaces of any size stay closed, of the same genus, at every level.
    #[test]
    fn closed_surfaces_stay_closed(around in 5u32..24, across in 5u32..16, bump in 0.0f32..0.1) {
        let mesh = support::torus(around, across, bump);
        let sequence = simplify(&mesh, &SimplifyOptions::default()).unwrap();
        support::check_all_levels("torus", &mesh, &sequence, true);
    }
}

#[test]
fn the_result_is_the_one_that_the_browser_test_expects() {
    let mesh = support::plate(24, 0.3);
    let sequence = simplify(&mesh, &SimplifyOptions::default()).unwrap();
    let level = lod::extract(&mesh, &sequence, Level::Triangles(100));
    assert_eq!(support::fingerprint(&level.mesh), support::BUMPY_PLATE_AT_100);
}

#[test]
fn a_run_stopped_at_any_step_gives_a_sound_mesh_with_what_was_done() {
    let mesh = support::torus(48, 24, 0.05);
    let mut counts = Vec::new();
    for steps in 0..40 {
        let mut run = Simplifier::new(&mesh, &to(100)).unwrap();
        for _ in 0..steps {
            run.step(&mesh, 200);
        }
        run.stop(&mesh);
        let sequence = run.finish();
        let result = lod::extract(&mesh, &sequence, Level::Triangles(0)).mesh;
        result.validate().unwrap();
        counts.push(result.triangles.len());
    }
    assert_eq!(counts[0], mesh.triangles.len(), "nothing done, nothing lost");
    assert!(counts.is_sorted_by(|a, b| a >= b), "{counts:?}");
    assert!(counts[39] <= 100, "{counts:?}");
}
