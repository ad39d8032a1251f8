//! Meshes that are no manifolds: the result is no worse than the input, and nothing stops far above the target.

use decimesh::mesh::Mesh;
use decimesh::simplify::SimplifyOptions;

use super::{reach, run, to};
use crate::support::surfaces::{cubes, moebius, moved, sphere, together, unindexed};
use crate::support::validity::{self, Validity};
use crate::support::{self, Noise, plate, torus};

/// The mesh with triangles in another order or more of them, its one group adjusted.
fn with_triangles(mesh: &Mesh, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::from_arrays(mesh.positions.clone(), triangles, vec![])
}

/// Runs to the shares and checks each result; the last share must be reached.
fn check_down_to(name: &str, mesh: &Mesh, share: f64) {
    for part in [0.5, 0.25] {
        let (result, _) = run(mesh, &to((mesh.triangles.len() as f64 * part) as usize));
        validity::check(name, mesh, &result);
    }
    validity::check(name, mesh, &reach(name, mesh, share));
    let (result, _) = run(mesh, &SimplifyOptions::default());
    validity::check(name, mesh, &result);
    assert!(!result.triangles.is_empty(), "{name}: nothing is left");
}

#[test]
fn three_pages_of_a_book_keep_their_spine() {
    let mesh = support::book(20);
    assert_eq!(Validity::of(&mesh).non_manifold_edges, 20);
    check_down_to("book", &mesh, 0.1);
}

#[test]
fn two_blocks_that_share_an_edge_stay_two_blocks() {
    // Four triangles at each of the eight edges where they touch.
    let within = |c: i32, size: i32| (0..size).contains(&c);
    let mesh = cubes([16, 16, 8], |x, y, z| within(x, 16) && within(y, 16) && within(z, 8) && (x < 8) == (y < 8));
    let before = Validity::of(&mesh);
    assert_eq!((before.non_manifold_edges, before.border_edges), (8, 0));
    check_down_to("blocks", &mesh, 0.1);
    assert_eq!(Validity::of(&reach("blocks", &mesh, 0.1)).border_edges, 0, "opened");
}

#[test]
fn surfaces_that_touch_in_a_vertex_stay_sound() {
    // The south pole of one sphere is the north pole of the other.
    let (upper, lower) = (sphere(32, 16), moved(sphere(32, 16), |p| [p[0], p[1], p[2] - 2.0]));
    let mesh = together(&[upper, lower]);
    assert_eq!(Validity::of(&mesh).non_manifold_vertices, 1);
    check_down_to("touching spheres", &mesh, 0.1);

    // Two plates that meet in a corner only.
    let mesh = together(&[plate(16, 0.1), moved(plate(16, 0.1), |p| [p[0] - 16.0, p[1] - 16.0, p[2]])]);
    check_down_to("touching plates", &mesh, 0.1);
}

/// A torus of 1,600 triangles, and some of them once more.
fn torus_with(again: impl Fn(&[[u32; 3]]) -> Vec<[u32; 3]>) -> Mesh {
    let once = torus(40, 20, 0.02);
    let triangles = [once.triangles.as_slice(), &again(&once.triangles)].concat();
    with_triangles(&once, triangles)
}

#[test]
fn a_few_doubled_faces_do_not_hold_the_rest() {
    let mesh = torus_with(|t| t.iter().step_by(50).copied().collect());
    validity::check("32 faces twice", &mesh, &reach("32 faces twice", &mesh, 0.25));
}

#[test]
fn a_few_doubled_faces_do_not_stop_the_run() {
    check_down_to("32 faces twice", &torus_with(|t| t.iter().step_by(50).copied().collect()), 0.1);
}

#[test]
fn a_surface_that_is_there_twice_does_not_stop_the_run() {
    check_down_to("every face twice", &torus_with(<[_]>::to_vec), 0.1);
}

#[test]
fn a_surface_with_a_back_side_does_not_stop_the_run() {
    check_down_to("both sides", &torus_with(|t| t.iter().map(|&[a, b, c]| [a, c, b]).collect()), 0.1);
}

#[test]
fn degenerate_faces_are_dropped() {
    let sound = torus(40, 20, 0.02);
    let mut triangles = sound.triangles.clone();
    triangles.extend(sound.triangles.iter().step_by(7).map(|&[a, b, _]| [a, b, b]));
    triangles.extend(sound.triangles.iter().step_by(11).map(|&[a, _, _]| [a, a, a]));
    let result = reach("repeated corners", &with_triangles(&sound, triangles), 0.1);
    assert!(Validity::of(&result).is_closed_manifold());
    assert_eq!(Validity::of(&result).degenerate, 0);
}

#[test]
fn faces_without_area_do_not_stop_the_run() {
    // A needle in every seventh edge of each row: a vertex on the edge, split off by a triangle without area.
    let mut mesh = plate(20, 0.0);
    for t in (0..mesh.triangles.len()).step_by(7) {
        let [a, b, c] = mesh.triangles[t];
        let [p, q] = [a, b].map(|v| mesh.positions[v as usize]);
        let middle = mesh.positions.len() as u32;
        mesh.positions.push(std::array::from_fn(|k| (p[k] + q[k]) / 2.0));
        mesh.triangles[t] = [a, middle, c];
        mesh.triangles.extend([[middle, b, c], [a, b, middle]]);
    }
    let mesh = Mesh::from_arrays(mesh.positions, mesh.triangles, vec![]);
    assert!(Validity::of(&mesh).degenerate > 100);
    let result = reach("needles", &mesh, 0.1);
    validity::check("needles", &mesh, &result);
}

#[test]
fn triangles_turned_the_wrong_way_do_not_stop_the_run() {
    let sound = torus(40, 20, 0.02);
    let mut noise = Noise(21);
    let triangles = sound.triangles.iter().map(|&[a, b, c]| if noise.next() < 0.0 { [a, c, b] } else { [a, b, c] });
    let mesh = with_triangles(&sound, triangles.collect());
    assert!(Validity::of(&mesh).inconsistent_edges > 500);
    check_down_to("half turned", &mesh, 0.1);
    validity::check_closed("half turned", &mesh, &reach("half turned", &mesh, 0.1));
}

#[test]
fn a_surface_with_one_side_keeps_its_border_and_euler_number() {
    let mesh = moebius(60, 8);
    let before = Validity::of(&mesh);
    assert_eq!((before.euler, before.non_manifold_edges), (0, 0));
    let result = reach("Moebius strip", &mesh, 0.1);
    validity::check("Moebius strip", &mesh, &result);
    let after = Validity::of(&result);
    assert_eq!((after.euler, after.non_manifold_edges, after.non_manifold_vertices), (0, 0, 0));
}

/// The same torus with `more` vertices that no triangle uses gives the same triangles and positions.
fn check_isolated(more: &[[f32; 3]]) {
    let mesh = torus(40, 20, 0.02);
    let mut with_more = mesh.clone();
    with_more.positions.extend_from_slice(more);
    with_more.wedge_sets[0].wedges = 0..with_more.positions.len();
    let (result, other) = (reach("torus", &mesh, 0.1), reach("with isolated vertices", &with_more, 0.1));
    assert_eq!(result.positions, other.positions);
    assert_eq!(result.triangles, other.triangles);
}

#[test]
fn isolated_vertices_change_nothing() {
    check_isolated(&[[0.5, 0.5, 0.1], torus(40, 20, 0.02).positions[3]]);
}

#[test]
fn isolated_vertices_far_away_change_nothing() {
    check_isolated(&[[1e6, 0.0, 0.0]]);
}

#[test]
fn exact_duplicates_of_vertices_are_welded() {
    let mesh = torus(40, 20, 0.02);
    let loose = unindexed(&mesh);
    assert_eq!(loose.positions.len(), 3 * mesh.triangles.len());
    let result = reach("loose torus", &loose, 0.1);
    validity::check_closed("loose torus", &mesh, &result);
    // The two zeros are one place.
    let mut signed = unindexed(&plate(10, 0.0));
    signed.positions.iter_mut().step_by(2).for_each(|p| p[2] = -0.0);
    assert!(reach("signed zeros", &signed, 0.1).triangles.len() <= 20);
}
