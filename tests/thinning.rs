//! Thinning by half-edges before the sweep: what it may take away, and what it must leave as it was.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

mod support;

use std::collections::BTreeSet;

use decimesh::collapse_sequence::{CollapseSequence, StopReason};
use decimesh::lod::{self, Level};
use decimesh::mesh::Mesh;
use decimesh::simplify::{Preset, Simplifier, SimplifyOptions, simplify};
use support::surfaces::{cubes, moebius, sphere, tangle, together};
use support::validity;

/// To so many triangles with the preset that thins most.
fn fast(count: usize) -> SimplifyOptions {
    SimplifyOptions { target_triangle_count: count, preset: Preset::Fast, ..SimplifyOptions::default() }
}

fn level(mesh: &Mesh, sequence: &CollapseSequence, count: usize) -> Mesh {
    lod::extract(mesh, sequence, Level::Triangles(count)).mesh
}

fn places(mesh: &Mesh) -> BTreeSet<[u32; 3]> {
    mesh.positions.iter().map(|p| p.map(|c| (c + 0.0).to_bits())).collect()
}

#[test]
fn a_half_is_reached_by_half_edges_alone() {
    let mesh = support::torus(120, 60, 0.05);
    let target = mesh.triangles.len() / 2;
    let sequence = simplify(&mesh, &fast(target)).unwrap();
    assert_eq!(sequence.stop_reason, StopReason::Target);
    let half = level(&mesh, &sequence, target);
    assert_eq!(half.triangles.len(), target);
    assert!(places(&half).is_subset(&places(&mesh)), "nobody moves");
    let balanced = simplify(&mesh, &SimplifyOptions { preset: Preset::Balanced, ..fast(target) }).unwrap();
    assert!(!places(&level(&mesh, &balanced, target)).is_subset(&places(&mesh)), "another preset solves");
}

#[test]
fn closed_surfaces_keep_their_topology_at_every_level() {
    let surfaces = [
        ("noisy torus", support::torus(120, 60, 0.05)),
        ("smooth torus", support::torus(120, 60, 0.0)),
        ("sphere", sphere(120, 60)),
        (
            "cube with a tunnel",
            cubes([16; 3], |x, y, z| {
                let within = [x, y, z].iter().all(|c| (0..16).contains(c));
                within && !((6..10).contains(&x) && (6..10).contains(&y))
            }),
        ),
    ];
    for (name, mesh) in surfaces {
        for share in [2, 8, 40] {
            let sequence = simplify(&mesh, &fast(mesh.triangles.len() / share)).unwrap();
            support::check_all_levels(name, &mesh, &sequence, true);
            let last = level(&mesh, &sequence, mesh.triangles.len() / share);
            validity::check_closed(name, &mesh, &last);
        }
    }
}

#[test]
fn a_border_stays_as_it_is_while_thinning() {
    let mesh = support::plate(60, 0.3);
    let target = mesh.triangles.len() / 2;
    let half = level(&mesh, &simplify(&mesh, &fast(target)).unwrap(), target);
    assert_eq!(half.triangles.len(), target);
    assert_eq!(validity::border(&half), validity::border(&mesh));
}

#[test]
fn locked_vertices_stay() {
    let mut mesh = support::torus(120, 60, 0.02);
    mesh.positions.push([9.0; 3]);
    mesh.wedge_sets[0].wedges.end += 1;
    let locked: Vec<bool> = (0..mesh.positions.len()).map(|w| w % 7 == 0).collect();
    let kept: BTreeSet<_> = mesh
        .positions
        .iter()
        .enumerate()
        .filter(|(w, _)| w % 7 == 0 && *w + 1 < locked.len())
        .map(|(_, p)| *p)
        .map(|p| p.map(|c| (c + 0.0).to_bits()))
        .collect();
    for share in [2, 4] {
        let target = mesh.triangles.len() / share;
        let sequence = simplify(&mesh, &SimplifyOptions { locked: locked.clone(), ..fast(target) }).unwrap();
        assert!(kept.is_subset(&places(&level(&mesh, &sequence, target))), "1 of {share}");
    }
}

#[test]
fn what_is_no_surface_stays_as_sound_as_it_was() {
    let torus = support::torus(60, 40, 0.05);
    for (name, other) in [
        ("tangle", tangle(40)),
        ("book", support::book(10)),
        ("soup", support::soup(50)),
        ("Möbius strip", moebius(60, 8)),
    ] {
        let mesh = together(&[torus.clone(), other]);
        for share in [2, 6, 20] {
            let target = mesh.triangles.len() / share;
            let sequence = simplify(&mesh, &fast(target)).unwrap();
            support::check_sequence(name, &sequence);
            validity::check(name, &mesh, &level(&mesh, &sequence, target));
        }
    }
}

#[test]
fn steps_of_any_size_give_the_same_sequence_and_progress_never_falls() {
    let mesh = support::torus(100, 50, 0.05);
    for target in [mesh.triangles.len() / 2, 400] {
        for preset in [Preset::Fast, Preset::Balanced] {
            let options = SimplifyOptions { preset, ..fast(target) };
            let whole = simplify(&mesh, &options).unwrap();
            for work in [1, 23, 5000] {
                assert_eq!(support::simplify_in_steps(&mesh, &options, work), whole);
            }
        }
    }
}

#[test]
fn a_run_stopped_while_thinning_gives_a_sound_mesh_with_what_was_done() {
    let mesh = support::torus(100, 50, 0.05);
    let mut counts = BTreeSet::new();
    for steps in (0..120).step_by(7) {
        let mut run = Simplifier::new(&mesh, &fast(1000)).unwrap();
        for _ in 0..steps {
            run.step(&mesh, 200);
        }
        run.stop(&mesh);
        let result = level(&mesh, &run.finish(), 0);
        validity::check_closed("stopped", &mesh, &result);
        counts.insert(result.triangles.len());
    }
    assert!(counts.len() > 8, "{counts:?}");
}

/// Whoever asks for a limit of the error, for parts to vanish, for original positions or for every level gets the sweep.
#[test]
fn other_runs_are_not_thinned() {
    let mesh = support::torus(100, 50, 0.05);
    let target = mesh.triangles.len() / 2;
    let options = [
        SimplifyOptions { max_error: 1e3, ..fast(target) },
        SimplifyOptions { prune: true, ..fast(target) },
        SimplifyOptions { every_level: true, ..fast(target) },
        SimplifyOptions { weights: vec![0.5; mesh.positions.len()], ..fast(target) },
        SimplifyOptions { preset: Preset::Best, ..fast(target) },
    ];
    for options in options {
        let half = level(&mesh, &simplify(&mesh, &options).unwrap(), target);
        assert!(!places(&half).is_subset(&places(&mesh)), "{options:?}");
    }
}
