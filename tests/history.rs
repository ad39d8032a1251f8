//! The history: every way to a level gives what replaying it from the start gives, bit for bit.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

mod support;

use decimesh::collapse_sequence::{CollapseSequence, TriangleCounts, WedgeMerges};
use decimesh::lod::{self, Level, LevelMesh, Levels};
use decimesh::mesh::{Attribute, Blend, Group, Mesh, Part, WedgeSet};
use decimesh::simplify::{PlacementRule, Preset, SimplifyOptions, simplify};
use proptest::prelude::*;
use support::Noise;

/// Everything in a level, as bits: the sign of a zero counts.
fn bits(level: &LevelMesh) -> (Vec<u32>, Vec<usize>, Vec<String>) {
    let LevelMesh { mesh, wedge_map, error } = level;
    let mut words: Vec<u32> = mesh.positions.as_flattened().iter().map(|c| c.to_bits()).collect();
    words.extend(mesh.triangles.as_flattened());
    words.extend(wedge_map);
    words.push(error.to_bits());
    let mut ranges = Vec::new();
    let mut names = Vec::new();
    for group in &mesh.groups {
        ranges.extend([group.triangles.start, group.triangles.end, group.wedge_set]);
    }
    for set in &mesh.wedge_sets {
        ranges.extend([set.wedges.start, set.wedges.end, set.part, set.attributes.len()]);
        for attribute in &set.attributes {
            names.push(format!("{} {} {:?}", attribute.name, attribute.components, attribute.blend));
            words.extend(attribute.values.iter().map(|v| v.to_bits()));
        }
    }
    ranges.push(mesh.parts.len());
    (words, ranges, names)
}

/// Compares every level of small histories, and many of larger ones.
fn check(name: &str, mesh: &Mesh, sequence: &CollapseSequence) {
    let all = sequence.collapses.len();
    // In one go, and in the smallest steps.
    let mut levels = Levels::new(mesh, sequence);
    if all % 2 == 1 {
        levels = Levels::default();
        while levels.step(mesh, sequence, 1) < 1.0 {}
    }
    assert!(levels.is_done());
    for count in (0..=all).filter(|count| all < 300 || count % 97 == 0 || *count == all) {
        let level = match count {
            0 => Level::Full,
            _ => Level::Triangles(sequence.triangle_counts.after(count)),
        };
        let expected = bits(&support::replay::extract(mesh, sequence, level));
        assert!(bits(&levels.extract(mesh, sequence, level)) == expected, "{name}: by index, {count} of {all}");
        assert!(bits(&lod::extract(mesh, sequence, level)) == expected, "{name}: once, {count} of {all}");
    }
}

fn options() -> Vec<SimplifyOptions> {
    let every_level = SimplifyOptions { every_level: true, ..SimplifyOptions::default() };
    let fitted = SimplifyOptions { target_triangle_count: 60, preset: Preset::Best, ..SimplifyOptions::default() };
    let subset = SimplifyOptions { placement: PlacementRule::Subset, ..every_level.clone() };
    vec![every_level, fitted, subset]
}

/// Every kind of attribute, with values that differ everywhere.
fn attributes(wedges: usize, seed: u64) -> Vec<Attribute> {
    let mut noise = Noise(seed);
    let mut values = |n: usize| -> Vec<f32> { (0..n * wedges).map(|_| noise.next()).collect() };
    let mut list = vec![
        Attribute { name: "TEXCOORD_0".into(), components: 2, values: values(2), blend: Blend::Linear },
        Attribute { name: "NORMAL".into(), components: 3, values: values(3), blend: Blend::Direction },
        Attribute { name: "TANGENT".into(), components: 4, values: values(4), blend: Blend::Tangent },
        Attribute { name: "_ID".into(), components: 1, values: values(1), blend: Blend::Nearest },
    ];
    let joints = values(4).iter().map(|v| (v * 5.0).abs().floor()).collect();
    let weights = values(4).iter().map(|v| v.abs()).collect();
    list.push(Attribute { name: "JOINTS_0".into(), components: 4, values: joints, blend: Blend::Joints });
    list.push(Attribute { name: "WEIGHTS_0".into(), components: 4, values: weights, blend: Blend::Weights });
    list
}

fn with_attributes(mut mesh: Mesh) -> Mesh {
    for (seed, set) in mesh.wedge_sets.iter_mut().enumerate() {
        set.attributes = attributes(set.wedges.len(), seed as u64 + 1);
    }
    mesh
}

/// Two parts of two sets and groups each, one group empty, unused wedges and degenerate triangles
/// between, and zeros of both signs.
fn assembly() -> Mesh {
    let tube = support::tube_with_seam(24, 30);
    let torus = support::torus(24, 16, 0.05);
    let mut mesh = Mesh { parts: vec![Part { scale: 1.0 }, Part { scale: 3.0 }], ..Mesh::default() };
    for (piece, part) in [(&tube, 0), (&torus, 0), (&torus, 1), (&tube, 1)] {
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(piece.positions.iter().map(|p| p.map(|c| if c.abs() < 1e-6 { -0.0 } else { c })));
        mesh.positions.push([0.25; 3]);
        let wedge_set = mesh.wedge_sets.len();
        let wedges = base as usize..mesh.positions.len();
        mesh.wedge_sets.push(WedgeSet { wedges, part, attributes: vec![] });
        let half = piece.triangles.len() / 2;
        for triangles in [&piece.triangles[..half], &piece.triangles[half..], &[]] {
            let start = mesh.triangles.len();
            mesh.triangles.extend(triangles.iter().map(|t| t.map(|w| w + base)));
            if !triangles.is_empty() {
                mesh.triangles.push([base, base + 1, base]);
            }
            mesh.groups.push(Group { triangles: start..mesh.triangles.len(), wedge_set });
        }
    }
    mesh.validate().unwrap();
    mesh
}

#[test]
fn every_fixture_at_every_level_is_what_the_replay_gives() {
    for (name, mesh, _) in support::all() {
        for options in options() {
            check(name, &mesh, &simplify(&mesh, &options).unwrap());
            let mesh = with_attributes(mesh.clone());
            check(name, &mesh, &simplify(&mesh, &options).unwrap());
        }
    }
}

#[test]
fn parts_groups_and_unused_wedges_stay_in_order() {
    for mesh in [assembly(), with_attributes(assembly())] {
        for options in options() {
            check("assembly", &mesh, &simplify(&mesh, &options).unwrap());
        }
    }
}

/// Large enough for several cuts.
#[test]
fn pieces_that_lose_their_last_triangle_are_gone_from_every_later_level() {
    let mut loose = support::torus(48, 24, 0.05);
    let mut noise = Noise(5);
    for _ in 0..400 {
        let base = loose.positions.len() as u32;
        let at = [noise.next() * 3.0, noise.next() * 3.0, noise.next() * 3.0];
        loose.positions.extend([at, [at[0] + 0.01, at[1], at[2]], [at[0], at[1] + 0.01, at[2]], [at[0], at[1], 9.0]]);
        loose.triangles.extend([[base, base + 1, base + 2], [base, base, base + 3]]);
    }
    let mut tangle = support::torus(24, 16, 0.05);
    for _ in 0..1500 {
        let n = tangle.positions.len() as f32;
        tangle.triangles.push([0; 3].map(|_: u32| (noise.next().abs() * n) as u32 % n as u32));
    }
    for mesh in [loose, tangle] {
        let mesh = Mesh::from_arrays(mesh.positions, mesh.triangles, vec![]);
        for options in options() {
            check("plain", &mesh, &simplify(&mesh, &options).unwrap());
            let mesh = with_attributes(mesh.clone());
            check("with attributes", &mesh, &simplify(&mesh, &options).unwrap());
        }
    }
}

#[test]
fn the_level_at_full_count_is_the_input() {
    let mesh = with_attributes(support::torus(48, 24, 0.05));
    let sequence = simplify(&mesh, &options()[0]).unwrap();
    let full = Levels::new(&mesh, &sequence).extract(&mesh, &sequence, Level::Full);
    assert_eq!(full.mesh, mesh);
    assert!(lod::is_whole(&mesh, &sequence));
    // One wedge that no triangle uses, one triangle that is none.
    let mut more = support::torus(48, 24, 0.05);
    more.positions.push([0.0; 3]);
    more.wedge_sets[0].wedges.end += 1;
    assert!(!lod::is_whole(&more, &simplify(&more, &options()[0]).unwrap()));
    let mut more = support::torus(48, 24, 0.05);
    more.triangles.push([0, 0, 1]);
    more.groups[0].triangles.end += 1;
    assert!(!lod::is_whole(&more, &simplify(&more, &options()[0]).unwrap()));
    assert!(full.wedge_map.iter().copied().eq(0..mesh.positions.len() as u32));
    assert!(full.error == 0.0);
}

#[test]
fn the_index_is_in_proportion_to_the_mesh_and_the_record_to_the_collapses() {
    let mesh = support::torus(200, 100, 0.05);
    let sequence = simplify(&mesh, &options()[0]).unwrap();
    assert!(sequence.record_bytes() <= 24 * sequence.collapses.len(), "{} bytes", sequence.record_bytes());
    let size = size_of_val(mesh.positions.as_slice()) + size_of_val(mesh.triangles.as_slice());
    let index = Levels::new(&mesh, &sequence).byte_count();
    assert!(index < 5 * size, "{index} bytes for a mesh of {size}");
}

#[test]
fn a_level_that_the_index_does_not_reach_yet_is_taken_from_the_history() {
    let mesh = support::torus(48, 24, 0.05);
    let sequence = simplify(&mesh, &options()[0]).unwrap();
    let mut levels = Levels::default();
    let mut fraction = 0.0;
    while fraction < 1.0 {
        for wanted in [2000, 500, 100, 0] {
            let level = levels.extract(&mesh, &sequence, Level::Triangles(wanted));
            assert_eq!(*level, support::replay::extract(&mesh, &sequence, Level::Triangles(wanted)));
        }
        let next = levels.step(&mesh, &sequence, 500);
        assert!(next >= fraction && next <= 1.0, "{fraction}, {next}");
        assert_eq!(levels.is_done(), next == 1.0);
        fraction = next;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Duplicates, degenerates, non-manifold edges, zeros of both signs, wedges that share a vertex.
    #[test]
    fn any_soup_at_every_level_is_what_the_replay_gives(
        points in prop::collection::vec(prop::array::uniform3(-3i8..4), 3..40),
        picks in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..100),
        split in 1usize..100,
        with in any::<bool>(),
        which in 0usize..3,
    ) {
        let mut positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(f32::from)).collect();
        positions.extend(points.iter().map(|p| p.map(|c| if c == 0 { -0.0 } else { f32::from(c) })));
        let triangles: Vec<[u32; 3]> = picks.iter().map(|t| t.map(|i| i.index(positions.len()) as u32)).collect();
        let mut mesh = Mesh::from_arrays(positions, triangles, vec![]);
        let (split, end) = (split.min(mesh.triangles.len()), mesh.triangles.len());
        mesh.groups = vec![Group { triangles: 0..split, wedge_set: 0 }, Group { triangles: split..end, wedge_set: 0 }];
        let mesh = if with { with_attributes(mesh) } else { mesh };
        check("soup", &mesh, &simplify(&mesh, &options()[which]).unwrap());
    }

    /// Counts with any steps, against a plain list.
    #[test]
    fn triangle_counts_are_what_was_pushed(steps in prop::collection::vec(prop_oneof![4 => Just(2usize), 1 => 0usize..5], 0..200)) {
        let initial = steps.iter().sum::<usize>() + 3;
        let mut list = vec![initial];
        let mut counts = TriangleCounts::new(initial);
        for step in steps {
            list.push(list[list.len() - 1] - step);
            counts.push(list[list.len() - 1]);
        }
        prop_assert_eq!(counts.len() + 1, list.len());
        for (count, &left) in list.iter().enumerate() {
            prop_assert_eq!(counts.after(count), left);
        }
        for most in 0..initial + 2 {
            let expected = list.iter().position(|&left| left <= most).unwrap_or(list.len() - 1);
            prop_assert_eq!(counts.collapses_to(most), expected);
        }
    }
}

#[test]
fn only_unusual_wedge_merges_are_kept() {
    let mut merges = WedgeMerges::default();
    merges.push(0, (1, 2), &[(1, 2)]);
    merges.push(1, (3, 4), &[]);
    merges.push(2, (5, 6), &[(5, 6), (7, 8)]);
    assert_eq!(merges.unusual(0), None);
    assert_eq!(merges.unusual(1), Some(&[][..]));
    assert_eq!(merges.unusual(2), Some(&[(5, 6), (7, 8)][..]));
    assert_eq!(merges.unusual(3), None);
}
