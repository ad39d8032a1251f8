//! Triangles without order: whatever comes, the result is sound, and the run says truly why it stopped.

use decimesh::collapse_sequence::StopReason;
use decimesh::lod::{self, Level};
use decimesh::mesh::Mesh;
use decimesh::simplify::{PlacementRule, SimplifyOptions, simplify};
use proptest::prelude::*;

use super::{reach, run, to};
use crate::support::surfaces::{confetti, moved, sphere, tangle, together};
use crate::support::validity::{self, Validity};

#[test]
fn loose_triangles_reach_a_tenth_if_parts_may_vanish() {
    let mesh = confetti(20_000);
    let options = SimplifyOptions { prune: true, ..to(2_000) };
    let (result, reason) = run(&mesh, &options);
    assert_eq!((result.triangles.len(), reason), (2_000, StopReason::Target));
    validity::check("confetti", &mesh, &result);
    // Never the last one.
    let (result, _) = run(&mesh, &SimplifyOptions { prune: true, ..to(0) });
    assert_eq!(result.triangles.len(), 1);
}

#[test]
fn small_parts_vanish_within_the_error_and_large_ones_stay() {
    let small = |x: f32| moved(sphere(10, 6), |p| [p[0] * 0.01 + x, p[1] * 0.01, p[2] * 0.01 + 3.0]);
    let mesh = together(&[sphere(40, 20), small(0.0), small(1.0)]);
    let components = |prune| {
        let options = SimplifyOptions { prune, max_error: 0.1, ..SimplifyOptions::default() };
        let (result, _) = run(&mesh, &options);
        assert!(Validity::of(&result).is_closed_manifold());
        Validity::of(&result).components
    };
    assert_eq!((components(false), components(true)), (3, 1));
}

#[test]
fn loose_triangles_end_and_stay_sound() {
    for n in [1, 2, 1000, 20_000] {
        let mesh = confetti(n);
        let (result, _) = run(&mesh, &to(n as usize / 10));
        validity::check("confetti", &mesh, &result);
        assert!(!result.triangles.is_empty());
    }
}

#[test]
#[ignore = "merges that would put a triangle upon another are refused: 43,506 of 199,808 triangles are left"]
fn a_tangle_reaches_a_tenth() {
    let mesh = tangle(199_808);
    assert!(Validity::of(&mesh).non_manifold_edges > 10_000);
    let result = reach("tangle", &mesh, 0.1);
    validity::check("tangle", &mesh, &result);
}

#[test]
fn a_tangle_reaches_a_quarter() {
    let mesh = tangle(20_000);
    let result = reach("tangle", &mesh, 0.25);
    validity::check("tangle", &mesh, &result);
}

#[test]
fn a_tangle_ends_and_stays_sound() {
    for n in [10, 1000, 20_000] {
        let mesh = tangle(n);
        let (result, _) = run(&mesh, &to(n as usize / 10));
        validity::check("tangle", &mesh, &result);
        assert!(!result.triangles.is_empty());
    }
}

/// Positions on a small grid, so that many coincide and many triangles have no area.
fn soups() -> impl Strategy<Value = Mesh> {
    let points = prop::collection::vec(prop::array::uniform3(-3i8..4), 3..32);
    let picks = prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 0..90);
    (points, picks).prop_map(|(points, picks)| {
        let positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(f32::from)).collect();
        let triangles = picks.iter().map(|t| t.map(|i| i.index(positions.len()) as u32)).collect();
        Mesh::from_arrays(positions, triangles, vec![])
    })
}

/// Any finite coordinates at all.
fn wild_soups() -> impl Strategy<Value = Mesh> {
    use prop::num::f32::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    let points = prop::collection::vec(prop::array::uniform3(POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO), 3..32);
    let picks = prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 0..60);
    (points, picks).prop_map(|(positions, picks)| {
        let triangles = picks.iter().map(|t| t.map(|i| i.index(positions.len()) as u32)).collect();
        Mesh::from_arrays(positions, triangles, vec![])
    })
}

#[allow(clippy::needless_update, reason = "a new option keeps its default here")]
fn options() -> impl Strategy<Value = SimplifyOptions> {
    (0usize..60, prop_oneof![Just(f32::INFINITY), 0.0f32..4.0], any::<bool>(), any::<bool>()).prop_map(
        |(target_triangle_count, max_error, lock_border, subset)| SimplifyOptions {
            target_triangle_count,
            max_error,
            lock_border,
            placement: if subset { PlacementRule::Subset } else { PlacementRule::Optimal },
            ..SimplifyOptions::default()
        },
    )
}

/// What holds for every input: see the messages.
fn check_any(mesh: &Mesh, options: &SimplifyOptions) -> Result<(), TestCaseError> {
    let sequence = simplify(mesh, options).unwrap();
    let target = options.target_triangle_count;
    for level in [Level::Full, Level::Triangles(target), Level::Triangles(0), Level::Error(options.max_error)] {
        let result = lod::extract(mesh, &sequence, level).mesh;
        prop_assert!(result.validate().is_ok(), "{:?} at {level:?}", result.validate());
        prop_assert_eq!(Validity::of(&result).repeated_corners, 0, "repeated corners at {:?}", level);
        prop_assert!(result.triangles.len() <= mesh.triangles.len());
    }
    let (before, after) =
        (Validity::of(mesh), Validity::of(&lod::extract(mesh, &sequence, Level::Triangles(target)).mesh));
    prop_assert!(after.duplicate_faces <= before.duplicate_faces, "new duplicate faces: {after:?} from {before:?}");
    prop_assert!(
        after.non_manifold_edges <= before.non_manifold_edges,
        "new non-manifold edges: {after:?} from {before:?}"
    );
    prop_assert!(
        after.triangles <= target || sequence.stop_reason != StopReason::Target,
        "{} triangles are not the target of {target}",
        after.triangles
    );
    if before.triangles > before.repeated_corners {
        prop_assert!(after.triangles > 0, "nothing is left");
    }
    let errors: Vec<f32> = sequence.collapses.iter().map(|c| c.error).collect();
    prop_assert!(errors.iter().all(|&e| e <= options.max_error), "error {:?} above the limit", errors.last());
    prop_assert!(errors.windows(2).all(|w| w[0] <= w[1]), "the error falls");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_soup_gives_a_sound_result(mesh in soups(), options in options()) {
        check_any(&mesh, &options)?;
    }

    #[test]
    fn any_finite_numbers_give_a_sound_result(mesh in wild_soups(), options in options()) {
        let sequence = simplify(&mesh, &options).unwrap();
        let result = lod::extract(&mesh, &sequence, Level::Triangles(options.target_triangle_count)).mesh;
        prop_assert!(result.validate().is_ok(), "{:?}", result.validate());
        prop_assert_eq!(Validity::of(&result).repeated_corners, 0);
        prop_assert!(sequence.collapses.iter().all(|c| !c.error.is_nan()), "an error is not a number");
    }
}
