//! The measured deviation: cases with a known answer, properties, and an independent meter's figures.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

mod support;

use decimesh::ErrorCode;
use decimesh::deviation::{AttributeDeviation, Deviation, DeviationMeter, DeviationOptions, measure};
use decimesh::lod::{self, Level};
use decimesh::mesh::{Attribute, Blend, Group, Mesh, Part, WedgeSet};
use decimesh::simplify::{SimplifyOptions, simplify};
use proptest::prelude::*;

fn with(sample_count: usize) -> DeviationOptions {
    DeviationOptions { sample_count, vertex_distances: true, simplified_map: true }
}

fn between(original: &Mesh, simplified: &Mesh) -> Deviation {
    measure(original, simplified, &with(20_000)).unwrap()
}

fn moved(mesh: &Mesh, change: impl Fn([f32; 3]) -> [f32; 3]) -> Mesh {
    let mut mesh = mesh.clone();
    mesh.positions.iter_mut().for_each(|p| *p = change(*p));
    mesh
}

fn near(got: f64, expected: f64, share: f64) -> bool {
    (got - expected).abs() <= share * expected.abs()
}

/// The unit sphere's octahedron, each triangle divided `times` times and its corners put on the sphere.
fn sphere(times: u32, radius: f64) -> Mesh {
    let axis = |k: usize, sign: f64| [0, 1, 2].map(|i| if i == k { sign } else { 0.0 });
    let mut triangles: Vec<[[f64; 3]; 3]> = Vec::new();
    for (x, y, z) in [(1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (-1.0, 1.0, -1.0), (1.0, -1.0, -1.0)] {
        triangles.push([axis(0, x), axis(1, y), axis(2, z)]);
        triangles.push([axis(0, -x), axis(2, -z), axis(1, -y)]);
    }
    let middle = |a: [f64; 3], b: [f64; 3]| {
        let sum = [0, 1, 2].map(|k| a[k] + b[k]);
        let length = sum.iter().map(|c| c * c).sum::<f64>().sqrt();
        sum.map(|c| c / length)
    };
    for _ in 0..times {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions: Vec<[f32; 3]> = triangles.iter().flatten().map(|p| p.map(|c| (c * radius) as f32)).collect();
    let indices = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::from_arrays(positions, indices, vec![])
}

/// Very small triangles at these places, and one between them.
fn specks_and_a_triangle(places: [[f32; 3]; 3]) -> (Mesh, Mesh) {
    let speck = |p: [f32; 3]| [p, [p[0] + 1e-4, p[1], p[2]], [p[0], p[1] + 1e-4, p[2]]];
    let positions = places.into_iter().flat_map(speck).collect();
    let specks = Mesh::from_arrays(positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]], vec![]);
    (specks, Mesh::from_arrays(places.to_vec(), vec![[0, 1, 2]], vec![]))
}

#[test]
fn the_maximum_is_found_between_the_samples() {
    // The farthest from all corners is the circumcentre: here (1, 0.75), if it is inside.
    let (specks, triangle) = specks_and_a_triangle([[0.0; 3], [2.0, 0.0, 0.0], [1.0, 2.0, 0.0]]);
    for sample_count in [1, 10, 100, 1000] {
        let deviation = measure(&triangle, &specks, &with(sample_count)).unwrap();
        let side = deviation.original_to_simplified;
        assert!(near(side.max, 1.25, 2e-3), "{sample_count} samples: {}", side.max);
        assert_eq!(deviation.max, side.max);
        let marked = deviation.simplified_surroundings.iter().fold(0.0_f32, |max, d| max.max(*d));
        assert!(near(f64::from(marked), side.max, 1e-6), "the map has it too: {marked}");
    }
    // An obtuse one's circumcentre is outside: the farthest place is on the longest edge, as far
    // from its end as from the corner between the others.
    let (specks, triangle) = specks_and_a_triangle([[0.0; 3], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    let deviation = measure(&triangle, &specks, &with(100)).unwrap();
    assert!(near(deviation.original_to_simplified.max, 3.0 - 4.0 / 3.0, 2e-3), "{}", deviation.max);
}

#[test]
fn a_mesh_is_at_no_distance_from_itself() {
    for (name, mesh, _) in support::all() {
        let deviation = between(&mesh, &mesh);
        assert_eq!((deviation.max, deviation.mean, deviation.rms), (0.0, 0.0, 0.0), "{name}");
        assert!(deviation.original_to_simplified.samples >= 20_000, "{name}");
        assert!(near(deviation.diagonal, mesh.diagonal(), 1e-12), "{name}");
        assert!(deviation.vertex_distances.iter().all(|&d| d == 0.0), "{name}");
    }
}

#[test]
fn parallel_planes_are_their_distance_apart_everywhere() {
    let plate = support::plate(10, 0.0);
    let raised = moved(&plate, |[x, y, z]| [x, y, z + 0.75]);
    let deviation = between(&plate, &raised);
    for side in [deviation.original_to_simplified, deviation.simplified_to_original] {
        for value in [side.max, side.mean, side.rms] {
            assert!(near(value, 0.75, 1e-12), "{side:?}");
        }
    }
    assert_eq!((deviation.max, deviation.mean), (0.75, 0.75));
    assert!(deviation.vertex_distances.iter().all(|&d| d == 0.75));
}

#[test]
fn a_tilted_plane_has_the_mean_and_rms_of_a_ramp() {
    // One 10 × 10 square against itself turned up about one side: distances to the tilted plane go
    // linearly from 0 to 10 sin α.
    let flat = support::plate(10, 0.0);
    let (sine, cosine) = (0.28_f32, 0.96_f32);
    let tilted = moved(&flat, |[x, y, _]| [x * cosine, y, x * sine]);
    let lost = measure(&tilted, &flat, &with(100_000)).unwrap().original_to_simplified;
    let height = 10.0 * 0.28;
    assert!(near(lost.max, height, 1e-6), "{lost:?}");
    assert!(near(lost.mean, height / 2.0, 1e-3), "{lost:?}");
    assert!(near(lost.rms, height / 3.0_f64.sqrt(), 1e-3), "{lost:?}");
}

#[test]
fn concentric_spheres_are_the_difference_of_their_radii_apart() {
    let deviation = between(&sphere(5, 1.0), &sphere(5, 1.1));
    assert!(near(deviation.mean, 0.1, 2e-3), "{deviation:?}");
    assert!(near(deviation.rms, 0.1, 2e-3), "{deviation:?}");
    assert!(near(deviation.max, 0.1, 2e-2), "{deviation:?}");
}

#[test]
fn a_coarse_sphere_is_measured_both_ways() {
    // An octahedron in its sphere: the middle of a face is 1 - 1/√3 inside.
    let deviation = between(&sphere(6, 1.0), &sphere(0, 1.0));
    let sagitta = 1.0 - 1.0 / 3.0_f64.sqrt();
    assert!(near(deviation.original_to_simplified.max, sagitta, 2e-3), "{deviation:?}");
    assert!(near(deviation.simplified_to_original.max, sagitta, 2e-3), "{deviation:?}");
    assert_eq!(deviation.max, deviation.original_to_simplified.max.max(deviation.simplified_to_original.max));
    let (a, b) = (deviation.original_to_simplified, deviation.simplified_to_original);
    assert!(near(deviation.mean, (a.mean + b.mean) / 2.0, 1e-12));
    assert!(near(deviation.rms, ((a.rms * a.rms + b.rms * b.rms) / 2.0).sqrt(), 1e-12));
}

#[test]
fn a_missing_triangle_is_seen_from_the_side_that_has_it() {
    let whole = support::plate(8, 0.0);
    let mut holed = whole.clone();
    // The quad at (3, 3): two triangles of area 1/2 each.
    holed.triangles.retain(|t| t != &[30, 31, 40] && t != &[30, 40, 39]);
    holed.groups[0].triangles = 0..holed.triangles.len();
    let deviation = measure(&whole, &holed, &with(100_000)).unwrap();
    let (lost, made_up) = (deviation.original_to_simplified, deviation.simplified_to_original);
    assert!(near(lost.max, 0.5, 1e-2), "the middle of the hole is half a unit from its rim: {lost:?}");
    // The mean distance from the rim within a unit square is 1/6, over one square of 64.
    assert!(near(lost.mean, 1.0 / 6.0 / 64.0, 1e-2), "{lost:?}");
    assert_eq!(made_up.max, 0.0, "{made_up:?}");
    assert_eq!(deviation.max, lost.max);
}

#[test]
fn the_maximum_is_found_at_a_vertex_and_on_an_edge_however_few_the_samples() {
    // A spike whose area is nothing beside the plate's, and a roof whose ridge is the farthest.
    let plate = support::plate(40, 0.0);
    let mut spiked = plate.clone();
    spiked.positions[20 * 41 + 20][2] = 3.0;
    let options = DeviationOptions { sample_count: 10, vertex_distances: false, ..DeviationOptions::default() };
    assert_eq!(measure(&spiked, &plate, &options).unwrap().max, 3.0);
    let roof = Mesh::from_arrays(
        vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [4.0, -3.0, 0.0], [4.0, 3.0, 0.0]],
        vec![[0, 2, 1], [0, 1, 3]],
        vec![],
    );
    let ridge_gone = Mesh::from_arrays(roof.positions.clone(), vec![[2, 1, 3], [2, 3, 0]], vec![]);
    let rhombus = measure(&roof, &ridge_gone, &with(1000)).unwrap();
    assert!(rhombus.max < 1e-6, "both cover the same rhombus: {rhombus:?}");
    let lifted = moved(&ridge_gone, |[x, y, z]| [x, y, z + if y == 0.0 { 0.0 } else { 3.0 }]);
    let deviation = measure(&roof, &lifted, &with(1000)).unwrap();
    assert!(near(deviation.simplified_to_original.max, 3.0, 1e-12), "{deviation:?}");
}

#[test]
fn vertices_get_their_own_distance() {
    let plate = support::plate(10, 0.0);
    let bumpy = support::plate(10, 0.4);
    let deviation = between(&bumpy, &plate);
    for (p, &d) in bumpy.positions.iter().zip(&deviation.vertex_distances) {
        assert_eq!(p[2].abs(), d, "{p:?}");
    }
    let mut loose = plate.clone();
    loose.positions.push([100.0; 3]);
    loose.wedge_sets[0].wedges.end += 1;
    assert_eq!(between(&loose, &bumpy).vertex_distances[121], 0.0, "a wedge without a triangle");
    let none = measure(&bumpy, &plate, &DeviationOptions::default()).unwrap();
    assert!(none.vertex_distances.is_empty());
}

#[test]
fn the_result_depends_neither_on_the_steps_nor_on_how_often_it_is_asked() {
    let mesh = support::torus(40, 20, 0.05);
    let sequence = simplify(&mesh, &SimplifyOptions::default()).unwrap();
    let level = lod::extract(&mesh, &sequence, Level::Triangles(200)).mesh;
    let whole = between(&mesh, &level);
    for work in [1, 7, 1000, usize::MAX] {
        let mut meter = DeviationMeter::new(&mesh, &level, &with(20_000)).unwrap();
        let mut last = 0.0;
        let mut steps = 0;
        loop {
            let progress = meter.step(work);
            assert!((last..=1.0).contains(&progress.fraction), "progress goes from {last} to {}", progress.fraction);
            assert_eq!(progress.done, progress.fraction == 1.0);
            last = progress.fraction;
            steps += 1;
            if progress.done {
                break;
            }
        }
        assert!(work > 1000 || steps >= 40, "{steps} steps of {work}");
        assert_eq!(meter.finish(), whole);
    }
    let unfinished = DeviationMeter::new(&mesh, &level, &with(20_000)).unwrap();
    assert_eq!(unfinished.finish(), whole);
}

#[test]
fn more_samples_change_little() {
    let mesh = support::torus(40, 20, 0.05);
    let sequence = simplify(&mesh, &SimplifyOptions::default()).unwrap();
    let level = lod::extract(&mesh, &sequence, Level::Triangles(200)).mesh;
    let [few, many] = [40_000, 400_000].map(|n| measure(&mesh, &level, &with(n)).unwrap());
    assert!(near(few.mean, many.mean, 2e-3), "{} {}", few.mean, many.mean);
    assert!(near(few.rms, many.rms, 2e-3), "{} {}", few.rms, many.rms);
    assert!(near(few.max, many.max, 5e-2), "{} {}", few.max, many.max);
}

#[test]
fn the_unit_of_length_does_not_matter() {
    let mesh = support::torus(40, 20, 0.05);
    let sequence = simplify(&mesh, &SimplifyOptions::default()).unwrap();
    let level = lod::extract(&mesh, &sequence, Level::Triangles(200)).mesh;
    let plain = between(&mesh, &level);
    for scale in [1e-30_f32, 1e-3, 1e30] {
        let scaled = between(&moved(&mesh, |p| p.map(|c| c * scale)), &moved(&level, |p| p.map(|c| c * scale)));
        let unit = f64::from(scale);
        for (got, expected) in [(scaled.max, plain.max), (scaled.mean, plain.mean), (scaled.rms, plain.rms)] {
            assert!(near(got / unit, expected, 1e-3), "scale {scale}: {} for {expected}", got / unit);
        }
    }
}

/// Two meshes side by side as two parts of one.
fn two_parts(first: &Mesh, second: &Mesh, scales: [f32; 2]) -> Mesh {
    let mut both = first.clone();
    let (wedges, triangles) = (first.positions.len(), first.triangles.len());
    both.positions.extend(&second.positions);
    both.triangles.extend(second.triangles.iter().map(|t| t.map(|w| w + wedges as u32)));
    both.groups.push(Group { triangles: triangles..both.triangles.len(), wedge_set: 1 });
    both.wedge_sets.push(WedgeSet { wedges: wedges..both.positions.len(), part: 1, attributes: vec![] });
    both.parts = scales.map(|scale| Part { scale }).to_vec();
    both
}

#[test]
fn parts_are_measured_apart_and_weighed_by_world_area() {
    let plate = support::plate(4, 0.0);
    let raised = |by: f32| moved(&plate, move |[x, y, z]| [x, y, z + by]);
    // The second part is raised by 1/2 in its own space; it stands on the first in space, which
    // must not matter; in the world it is three times as large, so nine times the area.
    let original = two_parts(&plate, &plate, [1.0, 3.0]);
    let simplified = two_parts(&raised(0.25), &raised(0.5), [1.0, 3.0]);
    let deviation = between(&original, &simplified);
    assert!(near(deviation.max, 1.5, 1e-12), "{deviation:?}");
    assert!(near(deviation.mean, 0.1 * 0.25 + 0.9 * 1.5, 1e-3), "{deviation:?}");
    assert!(near(deviation.rms, (0.1 * 0.25_f64.powi(2) + 0.9 * 1.5_f64.powi(2)).sqrt(), 1e-3), "{deviation:?}");
    assert_eq!(deviation.vertex_distances[0], 0.25);
    assert_eq!(deviation.vertex_distances[25], 1.5);
}

#[test]
fn a_part_that_is_gone_counts_with_its_diagonal() {
    let plate = support::plate(3, 0.0);
    let both = two_parts(&plate, &plate, [1.0, 1.0]);
    let mut one = both.clone();
    one.triangles.truncate(plate.triangles.len());
    let end = one.triangles.len();
    one.groups[1].triangles = end..end;
    let deviation = between(&both, &one);
    let diagonal = 18.0_f64.sqrt();
    assert!(near(deviation.max, diagonal, 1e-12), "{deviation:?}");
    assert!(near(deviation.original_to_simplified.mean, diagonal / 2.0, 1e-9), "half of the area: {deviation:?}");
    assert_eq!(deviation.simplified_to_original.max, 0.0);
    assert_eq!(deviation.vertex_distances[0], 0.0);
    assert_eq!(deviation.vertex_distances[16], diagonal as f32);
}

#[test]
fn empty_and_degenerate_meshes_are_values() {
    let empty = Mesh::from_arrays(vec![], vec![], vec![]);
    let line = Mesh::from_arrays(vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2], [0, 0, 1], [2, 2, 2]], vec![]);
    let plate = support::plate(2, 0.0);
    for nothing in [&empty, &line] {
        assert_eq!(between(nothing, &empty).max, 0.0);
        let gone = between(&plate, nothing);
        assert!(near(gone.mean, 8.0_f64.sqrt(), 1e-12) && near(gone.max, 8.0_f64.sqrt(), 1e-12), "{gone:?}");
        assert!(near(between(nothing, &plate).mean, 8.0_f64.sqrt(), 1e-12));
    }
    // Triangles without an area change nothing.
    let mut spoilt = plate.clone();
    spoilt.triangles.extend([[0, 0, 1], [0, 1, 2]]);
    spoilt.groups[0].triangles.end += 2;
    assert_eq!(between(&spoilt, &plate).max, 0.0);
}

#[test]
fn wrong_arguments_are_typed_errors() {
    let plate = support::plate(2, 0.0);
    let refused = |a: &Mesh, b: &Mesh, n| {
        let error = measure(a, b, &with(n)).unwrap_err();
        (error.code(), error.place().to_string())
    };
    assert_eq!(refused(&plate, &plate, 0), (ErrorCode::InvalidArgument, "sample_count".into()));
    let two = two_parts(&plate, &plate, [1.0, 1.0]);
    assert_eq!(refused(&plate, &two, 1), (ErrorCode::InvalidArgument, "parts".into()));
    let mut broken = plate.clone();
    broken.positions[3][1] = f32::NAN;
    assert_eq!(refused(&plate, &broken, 1), (ErrorCode::NotFinite, "positions[3]".into()));
    assert_eq!(refused(&broken, &plate, 1), (ErrorCode::NotFinite, "positions[3]".into()));
}

/// The nearest distance of `p`, by going through all triangles and a fine grid of points on each.
fn by_force(p: [f64; 3], mesh: &Mesh) -> f64 {
    let mut best = f64::INFINITY;
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|w| mesh.positions[w as usize].map(f64::from));
        for i in 0..=64 {
            for j in 0..=64 - i {
                let (u, v) = (f64::from(i) / 64.0, f64::from(j) / 64.0);
                let q = [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
                best = best.min((0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>());
            }
        }
    }
    best.sqrt()
}

/// Pairs whose deviation an independent meter has measured.
fn recorded_pairs() -> [(&'static str, Mesh, Mesh); 4] {
    let mut holed = support::plate(17, 0.0);
    holed.triangles.drain(200..260);
    holed.groups[0].triangles.end -= 60;
    [
        ("noisy torus, smooth one", support::torus(48, 24, 0.05), support::torus(24, 12, 0.0)),
        ("fine sphere, coarse one", sphere(5, 1.0), sphere(2, 1.0)),
        ("tube, its quarter", support::tube_with_seam(24, 30), support::tube_with_seam(8, 5)),
        ("bumpy plate, one with a hole", support::plate(17, 0.3), holed),
    ]
}

/// What the meter said with 4 million samples, in % of the diagonal: mean, rms and maximum from the
/// first to the second and back.
const RECORDED: [[[f64; 3]; 2]; 4] = [
    [[0.432075, 0.532999, 1.80745], [0.38482, 0.474996, 1.60626]],
    [[0.859857, 0.91289, 1.62281], [0.859252, 0.91215, 1.62281]],
    [[1.09247, 1.22142, 1.6387], [1.07977, 1.21001, 1.6387]],
    [[0.593302, 0.875797, 4.33188], [0.415533, 0.497794, 1.23176]],
];

#[test]
fn an_independent_meter_agrees() {
    for ((name, original, simplified), recorded) in recorded_pairs().iter().zip(RECORDED) {
        let deviation = measure(original, simplified, &with(50_000)).unwrap();
        let sides = [deviation.original_to_simplified, deviation.simplified_to_original];
        for (side, expected) in sides.iter().zip(recorded) {
            let [mean, rms, max] = [side.mean, side.rms, side.max].map(|v| 100.0 * v / deviation.diagonal);
            assert!(near(mean, expected[0], 0.005), "{name}: mean {mean}, recorded {}", expected[0]);
            assert!(near(rms, expected[1], 0.005), "{name}: rms {rms}, recorded {}", expected[1]);
            assert!(near(max, expected[2], 0.02), "{name}: maximum {max}, recorded {}", expected[2]);
        }
    }
}

#[test]
fn the_deviation_is_the_one_that_the_browser_test_expects() {
    assert_eq!(support::fingerprint_of(&support::measured_plates()), support::MEASURED_PLATES);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Any soup of triangles against any other: distances at vertices are the true ones, and the
    /// figures keep their order.
    #[test]
    fn any_soup_is_measured_truly(
        a in prop::collection::vec(prop::array::uniform3(-8i8..9), 3..24),
        b in prop::collection::vec(prop::array::uniform3(-8i8..9), 3..18),
    ) {
        let soup = |points: &[[i8; 3]]| {
            let positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(f32::from)).collect();
            let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            Mesh::from_arrays(positions, triangles, vec![])
        };
        let has_area = |mesh: &Mesh, t: &[u32; 3]| {
            let [a, b, c] = t.map(|w| mesh.positions[w as usize]);
            let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
            u[1] * v[2] != u[2] * v[1] || u[2] * v[0] != u[0] * v[2] || u[0] * v[1] != u[1] * v[0]
        };
        let (mut a, mut b) = (soup(&a), soup(&b));
        for mesh in [&mut a, &mut b] {
            let all = mesh.clone();
            mesh.triangles.retain(|t| has_area(&all, t));
            mesh.groups[0].triangles = 0..mesh.triangles.len();
        }
        prop_assume!(!a.triangles.is_empty() && !b.triangles.is_empty());
        let deviation = measure(&a, &b, &with(300)).unwrap();
        for &w in a.triangles.iter().flatten() {
            let (got, truth) =
                (f64::from(deviation.vertex_distances[w as usize]), by_force(a.positions[w as usize].map(f64::from), &b));
            // The grid's points are at most 27 / 64 apart.
            prop_assert!(got <= truth + 1e-6 && got >= truth - 0.43, "{got}, by force {truth}");
            prop_assert!(got <= deviation.original_to_simplified.max * (1.0 + 1e-6));
        }
        for side in [deviation.original_to_simplified, deviation.simplified_to_original] {
            prop_assert!(side.mean <= side.rms * (1.0 + 1e-12) && side.rms <= side.max * (1.0 + 1e-12), "{side:?}");
        }
        let swapped = measure(&b, &a, &with(300)).unwrap();
        prop_assert_eq!(swapped.original_to_simplified, deviation.simplified_to_original);
        prop_assert_eq!((swapped.max, swapped.mean, swapped.rms), (deviation.max, deviation.mean, deviation.rms));
    }

    /// Coordinates of any magnitude, all in one mesh: a result, and a finite one.
    #[test]
    fn any_magnitude_is_finite(
        points in prop::collection::vec(prop::array::uniform3((-1.0f32..1.0, -38i32..38)), 6..30),
    ) {
        let positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(|(m, e)| m * 10.0_f32.powi(e))).collect();
        let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect::<Vec<_>>();
        let a = Mesh::from_arrays(positions.clone(), triangles[..1].to_vec(), vec![]);
        let b = Mesh::from_arrays(positions, triangles, vec![]);
        for (a, b) in [(&a, &b), (&b, &a)] {
            let deviation = measure(a, b, &with(100)).unwrap();
            prop_assert!(deviation.max.is_finite() && deviation.mean.is_finite() && deviation.rms.is_finite());
        }
    }
}

#[test]
fn the_map_tells_of_each_vertex_and_of_what_is_around_it() {
    let plate = support::plate(8, 0.0);
    let raised = moved(&plate, |[x, y, z]| [x, y, z + 0.5]);
    let map = between(&plate, &raised);
    assert_eq!(map.simplified_distances, vec![0.5; 81]);
    assert_eq!(map.simplified_surroundings, vec![0.5; 81]);
    // A bump in the middle of a plate of which the level has only the corners: they are in their places.
    let mut bumped = plate.clone();
    bumped.positions[4 * 9 + 4][2] = 2.0;
    let corners = [0, 8, 72, 80].map(|w: usize| plate.positions[w]).to_vec();
    let level = Mesh::from_arrays(corners, vec![[0, 1, 3], [0, 3, 2]], vec![]);
    let map = between(&bumped, &level);
    assert_eq!(map.simplified_distances, vec![0.0; 4]);
    let highest = map.simplified_surroundings.iter().copied().fold(0.0, f32::max);
    assert_eq!(f64::from(highest), map.max, "{:?}", map.simplified_surroundings);
    assert!(map.simplified_surroundings.iter().all(|&d| d > 0.0));
    // Two triangles that do not share wedges, but places: the map has no seam.
    let soup: Vec<[f32; 3]> = level.triangles.iter().flatten().map(|&w| level.positions[w as usize]).collect();
    let soup = between(&bumped, &Mesh::from_arrays(soup, vec![[0, 1, 2], [3, 4, 5]], vec![]));
    assert_eq!(soup.simplified_surroundings[0], soup.simplified_surroundings[3]);
    assert_eq!(soup.simplified_surroundings[2], soup.simplified_surroundings[4]);
    let without = measure(&plate, &raised, &DeviationOptions::default()).unwrap();
    assert!(without.simplified_distances.is_empty() && without.simplified_surroundings.is_empty());
}

#[test]
fn attributes_are_compared_at_the_samples() {
    let with = |normal: [f32; 3], shift: f32, color: f32| {
        let mut plate = support::plate(6, 0.0);
        let attribute = |name: &str, components: usize, value: &dyn Fn(&[f32; 3]) -> Vec<f32>| Attribute {
            name: name.into(),
            components,
            values: plate.positions.iter().flat_map(value).collect(),
            blend: Blend::Linear,
        };
        plate.wedge_sets[0].attributes = vec![
            attribute("NORMAL", 3, &|_| normal.to_vec()),
            attribute("TEXCOORD_0", 2, &|p| vec![p[0] / 6.0 + shift, p[1] / 6.0]),
            attribute("COLOR_0", 3, &|p| vec![color * p[0] / 6.0, 0.0, 0.0]),
        ];
        plate
    };
    let plain = with([0.0, 0.0, 1.0], 0.0, 0.0);
    let same = between(&plain, &plain).attributes;
    for found in [same.normal, same.texture, same.color] {
        // On an edge the neighbour may be the nearest: the same value, but for its rounding.
        assert!(found.is_some_and(|f: AttributeDeviation| f.max < 1e-15 && f.rms < 1e-15), "{same:?}");
    }
    let other = between(&plain, &with([0.6, 0.0, 0.8], 0.25, 1.0)).attributes;
    let (normal, texture, color) = (other.normal.unwrap(), other.texture.unwrap(), other.color.unwrap());
    for value in [normal.max, normal.mean, normal.rms] {
        assert!(near(value, 0.6_f64.asin().to_degrees(), 1e-6), "{normal:?}");
    }
    for value in [texture.max, texture.mean, texture.rms] {
        assert!(near(value, 0.25, 1e-6), "{texture:?}");
    }
    // A ramp of colour against none: from 0 to 1.
    assert!(near(color.max, 1.0, 1e-6) && near(color.mean, 0.5, 1e-3), "{color:?}");
    assert!(near(color.rms, (1.0_f64 / 3.0).sqrt(), 1e-3), "{color:?}");
    // What one of them has is nothing to compare.
    let bare = between(&plain, &support::plate(6, 0.0)).attributes;
    assert_eq!((bare.normal, bare.texture, bare.color), (None, None, None));
}
