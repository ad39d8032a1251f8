//! What is sound and what is not about a mesh: edges, vertex fans, duplicates, degenerates, borders, Euler number.
//!
//! Everything is by position: wedges at the same place are one vertex, as a viewer sees it.

use std::collections::{BTreeMap, BTreeSet};

use decimesh::mesh::Mesh;

/// Twice the area, as a share of the squared diagonal, at and below which a triangle counts as degenerate.
/// The independent meter of the benches uses the same.
const DEGENERATE_AREA: f64 = 1e-14;

/// Two corners at positions, in the direction from the smaller to the larger.
pub type Edge = [[u32; 3]; 2];

/// The counts of one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Validity {
    /// Positions that a triangle uses.
    pub vertices: usize,
    /// Pairs of positions.
    pub edges: usize,
    /// All, degenerate ones too.
    pub triangles: usize,
    /// Edges of one triangle.
    pub border_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges of two triangles that run the same way along it.
    pub inconsistent_edges: usize,
    /// Vertices whose triangles are not one fan, open or closed, though all their edges are manifold.
    pub non_manifold_vertices: usize,
    /// Triangles on the same three positions as an earlier one.
    pub duplicate_faces: usize,
    /// Triangles with two corners at one position.
    pub repeated_corners: usize,
    /// Triangles without area (those with repeated corners too).
    pub degenerate: usize,
    /// Sets of triangles connected through positions.
    pub components: usize,
    /// V − E + F.
    pub euler: i64,
    /// Of all border edges, in units of the positions.
    pub border_length: f64,
}

impl Validity {
    /// Counts everything.
    pub fn of(mesh: &Mesh) -> Self {
        let faces = Faces::of(mesh);
        let edges = faces.edges();
        let used: BTreeSet<u32> = faces.corners.iter().flatten().copied().collect();
        let mut seen = BTreeSet::new();
        let duplicate_faces = faces
            .corners
            .iter()
            .filter(|corners| {
                let mut sorted = **corners;
                sorted.sort_unstable();
                !seen.insert(sorted)
            })
            .count();
        let border: Vec<(u32, u32)> = edges.iter().filter(|(_, e)| e.faces.len() == 1).map(|(&ends, _)| ends).collect();
        Self {
            vertices: used.len(),
            edges: edges.len(),
            triangles: faces.corners.len(),
            border_edges: border.len(),
            non_manifold_edges: edges.values().filter(|e| e.faces.len() > 2).count(),
            inconsistent_edges: edges.values().filter(|e| e.faces.len() == 2 && e.forward != 1).count(),
            non_manifold_vertices: faces.non_manifold_vertices(&edges),
            duplicate_faces,
            repeated_corners: faces.corners.iter().filter(|&&[a, b, c]| a == b || b == c || c == a).count(),
            degenerate: faces.degenerate(),
            components: faces.components(),
            euler: used.len() as i64 - edges.len() as i64 + faces.corners.len() as i64,
            border_length: border.iter().map(|&(a, b)| faces.length(a, b)).sum(),
        }
    }

    /// Every edge has two triangles and every vertex one fan.
    pub fn is_closed_manifold(&self) -> bool {
        self.border_edges == 0 && self.non_manifold_edges == 0 && self.non_manifold_vertices == 0
    }
}

/// The border edges by the bits of their ends' positions.
pub fn border(mesh: &Mesh) -> BTreeSet<Edge> {
    let faces = Faces::of(mesh);
    let edges = faces.edges();
    let bits = |v: u32| faces.positions[v as usize].map(|c| (c + 0.0).to_bits());
    edges
        .iter()
        .filter(|(_, e)| e.faces.len() == 1)
        .map(|(&(a, b), _)| {
            let mut ends = [bits(a), bits(b)];
            ends.sort_unstable();
            ends
        })
        .collect()
}

/// Panics with `name` unless `mesh`, the result from `original`, is at least as sound as that: indices in range,
/// finite, no degenerate triangle, no new non-manifold edge or duplicate face, no triangle more.
pub fn check(name: &str, original: &Mesh, mesh: &Mesh) {
    mesh.validate().unwrap_or_else(|e| panic!("{name}: {e}"));
    let (before, after) = (Validity::of(original), Validity::of(mesh));
    assert!(after.triangles <= before.triangles, "{name}: {} triangles out of {}", after.triangles, before.triangles);
    assert_eq!(after.repeated_corners, 0, "{name}: triangles with a repeated corner");
    assert!(after.degenerate <= before.degenerate, "{name}: {} degenerate triangles", after.degenerate);
    assert!(
        after.non_manifold_edges <= before.non_manifold_edges,
        "{name}: {} non-manifold edges, {} before",
        after.non_manifold_edges,
        before.non_manifold_edges
    );
    assert!(after.duplicate_faces <= before.duplicate_faces, "{name}: {} duplicate faces", after.duplicate_faces);
}

/// As [`check`], and the result is a closed manifold of the same Euler number, as `original` must be.
pub fn check_closed(name: &str, original: &Mesh, mesh: &Mesh) {
    check(name, original, mesh);
    let (before, after) = (Validity::of(original), Validity::of(mesh));
    assert!(before.is_closed_manifold(), "{name}: the input is no closed manifold: {before:?}");
    assert!(after.is_closed_manifold(), "{name}: no closed manifold: {after:?}");
    assert_eq!(after.euler, before.euler, "{name}: Euler number");
    assert_eq!(after.components, before.components, "{name}: components");
}

/// The triangles of one edge, and how many of them run from its smaller vertex to its larger.
#[derive(Default)]
struct EdgeFaces {
    faces: Vec<u32>,
    forward: usize,
}

type Edges = BTreeMap<(u32, u32), EdgeFaces>;

struct Faces {
    positions: Vec<[f32; 3]>,
    corners: Vec<[u32; 3]>,
}

impl Faces {
    fn of(mesh: &Mesh) -> Self {
        let mut ids = BTreeMap::new();
        let mut positions = Vec::new();
        let vertex: Vec<u32> = mesh
            .positions
            .iter()
            .map(|p| {
                // The two zeros are one place.
                *ids.entry(p.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
                    positions.push(*p);
                    positions.len() as u32 - 1
                })
            })
            .collect();
        let corners = mesh.triangles.iter().map(|t| t.map(|w| vertex[w as usize])).collect();
        Self { positions, corners }
    }

    fn edges(&self) -> Edges {
        let mut edges = Edges::new();
        for (face, corners) in self.corners.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                if a != b {
                    let edge = edges.entry((a.min(b), a.max(b))).or_default();
                    edge.faces.push(face as u32);
                    edge.forward += usize::from(a < b);
                }
            }
        }
        edges
    }

    fn point(&self, v: u32) -> [f64; 3] {
        self.positions[v as usize].map(f64::from)
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        let (a, b) = (self.point(a), self.point(b));
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    }

    fn degenerate(&self) -> usize {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &v in self.corners.iter().flatten() {
            let p = self.point(v);
            low = std::array::from_fn(|k| low[k].min(p[k]));
            high = std::array::from_fn(|k| high[k].max(p[k]));
        }
        let squared: f64 = (0..3).map(|k| (high[k] - low[k]).max(0.0).powi(2)).sum();
        self.corners.iter().filter(|&&[a, b, c]| self.double_area(a, b, c) <= DEGENERATE_AREA * squared).count()
    }

    fn double_area(&self, a: u32, b: u32, c: u32) -> f64 {
        let [a, b, c] = [a, b, c].map(|v| self.point(v));
        let (u, v): ([f64; 3], [f64; 3]) = (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - a[k]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        cross.iter().map(|c| c * c).sum::<f64>().sqrt()
    }

    /// Vertices where the triangles, joined across manifold edges, fall into more than one piece.
    fn non_manifold_vertices(&self, edges: &Edges) -> usize {
        let mut at: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (face, corners) in self.corners.iter().enumerate() {
            for &v in corners {
                at.entry(v).or_default().push(face as u32);
            }
        }
        let mut on_bad_edge = BTreeSet::new();
        for (&(a, b), _) in edges.iter().filter(|(_, e)| e.faces.len() > 2) {
            on_bad_edge.extend([a, b]);
        }
        let pieces = |v: u32, fan: &[u32]| {
            let mut sets = DisjointSets::new(fan.len());
            let mut across: BTreeMap<u32, usize> = BTreeMap::new();
            for (i, &face) in fan.iter().enumerate() {
                for &other in self.corners[face as usize].iter().filter(|&&other| other != v) {
                    let first = *across.entry(other).or_insert(i);
                    sets.join(first, i);
                }
            }
            sets.count()
        };
        at.iter().filter(|&(&v, fan)| !on_bad_edge.contains(&v) && pieces(v, fan) > 1).count()
    }

    fn components(&self) -> usize {
        let mut sets = DisjointSets::new(self.corners.len());
        let mut first = BTreeMap::new();
        for (face, corners) in self.corners.iter().enumerate() {
            for &v in corners {
                let other = *first.entry(v).or_insert(face);
                sets.join(other, face);
            }
        }
        sets.count()
    }
}

/// Which of some things belong together (union by path halving).
struct DisjointSets(Vec<usize>);

impl DisjointSets {
    fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a] = b;
    }

    fn count(&self) -> usize {
        (0..self.0.len()).filter(|&i| self.0[i] == i).count()
    }
}
