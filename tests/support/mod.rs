//! Meshes made by hand or by formula, and the properties that every result must have. Shared by
//! the native tests and the ones that run in the browser.
#![allow(dead_code, reason = "each test binary uses its share")]
#![allow(unreachable_pub, clippy::panic, clippy::unwrap_used, reason = "a test may stop at the first surprise")]

pub mod replay;
pub mod surfaces;
pub mod validity;

use std::collections::{BTreeMap, BTreeSet};

use decimesh::collapse_sequence::CollapseSequence;
use decimesh::deviation::{Deviation, DeviationOptions, SideDeviation, measure};
use decimesh::lod::{self, Level, LevelMesh};
use decimesh::mesh::{Attribute, Blend, Mesh};
use decimesh::simplify::{Simplifier, SimplifyOptions};

/// A seeded generator (Steele, Lea & Flood 2014, SplitMix64) for meshes with noise.
pub struct Noise(pub u64);

impl Noise {
    /// Uniform in -1..1.
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    }
}

pub fn tetrahedron() -> Mesh {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Mesh::from_arrays(positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], vec![])
}

/// A flat or bumpy plate of n × n quads in z = 0, split along one diagonal.
pub fn plate(n: u32, bump: f32) -> Mesh {
    let mut noise = Noise(7);
    let mut positions = Vec::new();
    for y in 0..=n {
        for x in 0..=n {
            positions.push([x as f32, y as f32, if bump > 0.0 { noise.next() * bump } else { 0.0 }]);
        }
    }
    let mut triangles = Vec::new();
    for y in 0..n {
        for x in 0..n {
            let a = y * (n + 1) + x;
            triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
        }
    }
    Mesh::from_arrays(positions, triangles, vec![])
}

/// A closed torus of `around` × `across` quads, with noise in the radius.
pub fn torus(around: u32, across: u32, bump: f32) -> Mesh {
    let mut noise = Noise(11);
    let mut positions = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let u = i as f32 / around as f32 * std::f32::consts::TAU;
            let v = j as f32 / across as f32 * std::f32::consts::TAU;
            let r = 0.4 + bump * noise.next();
            positions.push([(1.0 + r * v.cos()) * u.cos(), (1.0 + r * v.cos()) * u.sin(), r * v.sin()]);
        }
    }
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::from_arrays(positions, triangles, vec![])
}

/// A tube whose texture runs around once: one seam along it, wedges doubled there; with normals.
pub fn tube_with_seam(around: u32, along: u32) -> Mesh {
    let (mut positions, mut uv, mut normals) = (Vec::new(), Vec::new(), Vec::new());
    for j in 0..=along {
        for i in 0..=around {
            let angle = (i % around) as f32 / around as f32 * std::f32::consts::TAU;
            positions.push([angle.cos(), angle.sin(), j as f32 / along as f32 * 3.0]);
            uv.extend([i as f32 / around as f32, j as f32 / along as f32]);
            normals.extend([angle.cos(), angle.sin(), 0.0]);
        }
    }
    let mut triangles = Vec::new();
    for j in 0..along {
        for i in 0..around {
            let a = j * (around + 1) + i;
            triangles.extend([[a, a + 1, a + around + 2], [a, a + around + 2, a + around + 1]]);
        }
    }
    let attributes = vec![
        Attribute { name: "NORMAL".into(), components: 3, values: normals, blend: Blend::Direction },
        Attribute { name: "TEXCOORD_0".into(), components: 2, values: uv, blend: Blend::Linear },
    ];
    Mesh::from_arrays(positions, triangles, attributes)
}

/// `n` triangles that share no vertex, at random.
pub fn soup(n: u32) -> Mesh {
    let mut noise = Noise(3);
    let positions: Vec<[f32; 3]> = (0..3 * n).map(|_| [noise.next(), noise.next(), noise.next()]).collect();
    let triangles = (0..n).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::from_arrays(positions, triangles, vec![])
}

/// Three sheets that meet in one edge, each of n × n quads.
pub fn book(n: u32) -> Mesh {
    let sheet = plate(n, 0.05);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for page in 0..3_u32 {
        let angle = page as f32 * 2.0;
        let base = positions.len() as u32;
        // y runs along the spine; the spine itself (x = 0) is the same for every page.
        positions.extend(sheet.positions.iter().map(|p| {
            let (x, z) = (p[0], if p[0] == 0.0 { 0.0 } else { p[2] });
            [x * angle.cos() - z * angle.sin(), p[1], x * angle.sin() + z * angle.cos()]
        }));
        triangles.extend(sheet.triangles.iter().map(|t| t.map(|v| v + base)));
    }
    Mesh::from_arrays(positions, triangles, vec![])
}

/// Every fixture with its name; `closed` says that it is a closed manifold.
pub fn all() -> Vec<(&'static str, Mesh, bool)> {
    vec![
        ("tetrahedron", tetrahedron(), true),
        ("plate", plate(20, 0.0), false),
        ("bumpy plate", plate(24, 0.3), false),
        ("torus", torus(40, 20, 0.0), true),
        ("noisy torus", torus(48, 24, 0.05), true),
        ("tube with seam", tube_with_seam(24, 30), false),
        ("soup", soup(50), false),
        ("book", book(10), false),
    ]
}

/// Vertices of the level by position, so that seams count as one.
fn vertices(mesh: &Mesh) -> Vec<u32> {
    let mut ids = BTreeMap::new();
    mesh.positions
        .iter()
        .map(|p| {
            let next = ids.len() as u32;
            *ids.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(next)
        })
        .collect()
}

/// How a mesh is connected.
#[derive(Debug, PartialEq, Eq)]
pub struct Shape {
    pub border_edges: usize,
    pub non_manifold_edges: usize,
    pub euler: i64,
    pub duplicate_faces: usize,
}

pub fn shape(mesh: &Mesh) -> Shape {
    let vertex = vertices(mesh);
    let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    let (mut faces, mut used, mut duplicate_faces) = (BTreeSet::new(), BTreeSet::new(), 0);
    for t in &mesh.triangles {
        let t = t.map(|w| vertex[w as usize]);
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            *edges.entry((a.min(b), a.max(b))).or_default() += 1;
        }
        used.extend(t);
        let mut sorted = t;
        sorted.sort_unstable();
        duplicate_faces += usize::from(!faces.insert(sorted));
    }
    Shape {
        border_edges: edges.values().filter(|&&n| n == 1).count(),
        non_manifold_edges: edges.values().filter(|&&n| n > 2).count(),
        euler: used.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64,
        duplicate_faces,
    }
}

/// Panics with `name` unless the level is a sound mesh.
pub fn check_level(name: &str, original: &Mesh, level: &LevelMesh, closed: bool) {
    let mesh = &level.mesh;
    mesh.validate().unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!(mesh.groups.len(), original.groups.len(), "{name}: groups");
    assert_eq!(level.wedge_map.len(), mesh.positions.len(), "{name}: wedge map");
    let vertex = vertices(mesh);
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|w| vertex[w as usize]);
        assert!(a != b && b != c && c != a, "{name}: degenerate triangle");
    }
    for set in &mesh.wedge_sets {
        for attribute in &set.attributes {
            if attribute.blend == Blend::Direction {
                for n in attribute.values.chunks(3) {
                    let length = n.iter().map(|c| c * c).sum::<f32>().sqrt();
                    assert!((length - 1.0).abs() < 1e-4, "{name}: normal of length {length}");
                }
            }
        }
    }
    let (before, after) = (shape(original), shape(mesh));
    assert!(after.non_manifold_edges <= before.non_manifold_edges, "{name}: new non-manifold edges");
    assert!(after.duplicate_faces <= before.duplicate_faces, "{name}: new duplicate faces");
    if closed {
        assert_eq!(after.border_edges, 0, "{name}: opened");
        assert_eq!(after.euler, before.euler, "{name}: topology changed");
    }
}

/// The record of a run in steps of so much work, whose progress never falls and ends at 1.
pub fn simplify_in_steps(mesh: &Mesh, options: &SimplifyOptions, work: usize) -> CollapseSequence {
    let mut run = Simplifier::new(mesh, options).unwrap();
    let mut last = -1.0;
    loop {
        let progress = run.step(mesh, work);
        assert!(progress.fraction >= last, "progress falls from {last} to {}", progress.fraction);
        last = progress.fraction;
        if progress.done {
            break;
        }
    }
    assert_eq!(last, 1.0);
    run.finish()
}

/// The record itself: errors never fall, counts always do.
pub fn check_sequence(name: &str, sequence: &CollapseSequence) {
    assert!(sequence.collapses.windows(2).all(|w| w[0].error <= w[1].error), "{name}: error falls");
    assert!(
        (0..sequence.collapses.len())
            .all(|i| sequence.triangle_counts.after(i) > sequence.triangle_counts.after(i + 1)),
        "{name}: count does not fall"
    );
    assert_eq!(sequence.collapses.len(), sequence.triangle_counts.len());
    let mut gone = BTreeSet::new();
    for collapse in &sequence.collapses {
        assert!(!gone.contains(&collapse.into), "{name}: into a vertex that is gone");
        assert!(gone.insert(collapse.from), "{name}: a vertex vanishes twice");
    }
}

/// Every property at full detail and at several levels.
pub fn check_all_levels(name: &str, mesh: &Mesh, sequence: &CollapseSequence, closed: bool) {
    check_sequence(name, sequence);
    let full = lod::extract(mesh, sequence, Level::Full);
    assert_eq!(full.mesh.triangles.len(), mesh.triangles.len(), "{name}: full detail");
    for (w, &origin) in full.wedge_map.iter().enumerate() {
        assert_eq!(full.mesh.positions[w], mesh.positions[origin as usize], "{name}: full detail moved");
    }
    for share in [0.9, 0.5, 0.25, 0.1, 0.02, 0.0] {
        let wanted = (mesh.triangles.len() as f64 * share) as usize;
        let level = lod::extract(mesh, sequence, Level::Triangles(wanted));
        let least = sequence.triangle_counts.after(sequence.collapses.len());
        assert!(level.mesh.triangles.len() <= wanted.max(least), "{name}: {} for {wanted}", level.mesh.triangles.len());
        let same = lod::extract(mesh, sequence, Level::Error(level.error));
        assert!(same.mesh.triangles.len() <= level.mesh.triangles.len(), "{name}: level by error");
        check_level(name, mesh, &level, closed);
    }
}

/// A bumpy plate against a flat one of other vertices: no simplifier and no platform's sine in it.
pub fn measured_plates() -> Deviation {
    let (bumpy, mut flat) = (plate(24, 0.3), plate(17, 0.0));
    flat.positions.iter_mut().for_each(|p| *p = [p[0] * 1.375, p[1] * 1.40625, 0.0625]);
    let options = DeviationOptions { sample_count: 20_000, vertex_distances: true, ..DeviationOptions::default() };
    measure(&bumpy, &flat, &options).unwrap()
}

/// FNV-1a over the bits of every figure.
pub fn fingerprint_of(deviation: &Deviation) -> u64 {
    let side = |side: SideDeviation| [side.max, side.mean, side.rms, side.samples as f64];
    let figures = [deviation.max, deviation.mean, deviation.rms, deviation.diagonal]
        .into_iter()
        .chain(side(deviation.original_to_simplified))
        .chain(side(deviation.simplified_to_original))
        .chain(deviation.vertex_distances.iter().map(|&d| d.into()));
    figures.fold(0xcbf2_9ce4_8422_2325, |hash, f| (hash ^ f.to_bits()).wrapping_mul(0x0100_0000_01b3))
}

/// [`measured_plates`]: the same native and in every browser, with and without SIMD. Changes with
/// the sequence of samples, and only then.
pub const MEASURED_PLATES: u64 = 14_496_455_169_911_883_142;

/// FNV-1a over the bits of positions and triangles.
pub fn fingerprint(mesh: &Mesh) -> u64 {
    let words = mesh.positions.iter().flatten().map(|c| c.to_bits()).chain(mesh.triangles.iter().flatten().copied());
    words.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3))
}

/// The bumpy plate at 100 triangles: the same native and in every browser, with and without SIMD.
/// Changes with every change of the algorithm, and only then.
pub const BUMPY_PLATE_AT_100: u64 = 2_533_261_207_611_935_422;
