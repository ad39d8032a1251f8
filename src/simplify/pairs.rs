//! Pairs: vertices of separate components that lie near each other, and merge as if an edge joined them.
//!
//! Garland & Heckbert (1997, section 3.2) contract pairs of vertices that no edge joins if they are nearer than a
//! threshold. Here the pairs are found once, by a grid, between different components of one part; each then stands among
//! the edges of its vertices, at its cost. The result is connected, and no manifold where that happened.

use super::Simplifier;
use super::placement::Placement;
use super::quadric::{Vec3, smaller};
use super::topology::{NONE, Topology};
use super::vertex_kind::VertexKind;

/// Pairs of a vertex, the nearest ones.
const MOST: usize = 4;

/// Vertices of other components that are looked at for each, so that a distance as large as the model ends.
const MOST_LOOKED_AT: usize = 512;

/// For each vertex the others it may merge with; empty if pairs are not wanted.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    others: Vec<Vec<u32>>,
}

impl Pairs {
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.others.is_empty()
    }

    /// `from` went into `into`, which has the pairs of both.
    pub(super) fn merge(&mut self, from: u32, into: u32) {
        if let Some(list) = self.others.get_mut(from as usize) {
            let list = std::mem::take(list);
            if let Some(own) = self.others.get_mut(into as usize) {
                own.extend(list);
            }
        }
    }

    /// The living vertices that are paired with `v` and not joined to it by an edge.
    pub(super) fn of(&mut self, topology: &mut Topology, v: u32) -> Vec<u32> {
        let Some(list) = self.others.get_mut(v as usize) else { return Vec::new() };
        for w in list.iter_mut() {
            *w = topology.living(*w);
        }
        list.sort_unstable();
        list.dedup();
        list.retain(|&w| w != v && topology.vertices[w as usize].ring_length() > 0 && !topology.ring(v).contains(&w));
        list.clone()
    }
}

impl Simplifier {
    /// Finds the pairs nearer than `distance` in engine units, and lets their costs count for the first keys.
    #[inline(never)]
    pub(super) fn find_pairs(&mut self, distance: f32) {
        let component = components(&self.topology);
        let grid = Grid::new(&self.topology, &self.part_of_vertex, &component, distance);
        let mut others = vec![Vec::new(); component.len()];
        for v in (0..component.len() as u32).filter(|&v| self.topology.vertices[v as usize].ring_length() > 0) {
            let near = grid.near(&self.topology, self.part_of_vertex[v as usize], component[v as usize], v);
            for &(_, w) in &near {
                let ends = [v, w].map(|v| &self.topology.vertices[v as usize]);
                let between = ends[1].position() - ends[0].position();
                let cost = smaller(ends[0].quadric().error_at(between), ends[1].quadric().error_at(between * -1.0));
                for end in [v, w] {
                    let key = &mut self.keys[end as usize];
                    *key = smaller(*key, cost);
                }
                others[v as usize].push(w);
                others[w as usize].push(v);
            }
        }
        self.pairs = Pairs { others };
    }

    /// Merges two vertices that no edge joins.
    pub(super) fn try_pair(&mut self, from: u32, into: u32, placement: Placement) -> Result<(), super::Refusal> {
        self.pairing = true;
        let result = self.try_merge(from, into, placement);
        self.pairing = false;
        if result.is_ok() {
            let merged = &mut self.topology.vertices[into as usize];
            if merged.kind != VertexKind::Locked {
                merged.kind = VertexKind::NonManifold;
            }
        }
        result
    }
}

/// The component of each vertex, named by one of its vertices.
fn components(topology: &Topology) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..topology.vertices.len() as u32).collect();
    let root = |parent: &mut [u32], mut v: u32| {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    };
    for v in 0..parent.len() as u32 {
        for &w in topology.ring(v).iter().filter(|&&w| w != NONE) {
            let (a, b) = (root(&mut parent, v), root(&mut parent, w));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    (0..parent.len() as u32).map(|v| root(&mut parent, v)).collect()
}

/// Vertices by the cell they lie in, of the side of the distance; within a cell by component.
struct Grid {
    /// (part and cell, component, vertex)
    entries: Vec<((u16, [i32; 3]), u32, u32)>,
    distance: f32,
}

impl Grid {
    fn new(topology: &Topology, parts: &[u16], component: &[u32], distance: f32) -> Self {
        let mut entries: Vec<_> = (0..component.len() as u32)
            .filter(|&v| topology.vertices[v as usize].ring_length() > 0)
            .map(|v| {
                let cell = cell(topology.vertices[v as usize].position(), distance);
                ((parts[v as usize], cell), component[v as usize], v)
            })
            .collect();
        entries.sort_unstable();
        Self { entries, distance }
    }

    /// The nearest vertices of other components with their squared distances; each pair is found from its first vertex.
    fn near(&self, topology: &Topology, part: u16, component: u32, v: u32) -> Vec<(u32, u32)> {
        let position = topology.vertices[v as usize].position();
        let [x, y, z] = cell(position, self.distance);
        let (mut found, mut looked_at) = (Vec::new(), 0);
        for offset in 0..27 {
            let (dx, dy, dz) = (offset % 3 - 1, offset / 3 % 3 - 1, offset / 9 - 1);
            let key = (part, [x.saturating_add(dx), y.saturating_add(dy), z.saturating_add(dz)]);
            let mut at = self.entries.partition_point(|e| e.0 < key);
            while let Some(&(cell, other, w)) = self.entries.get(at)
                && cell == key
                && looked_at < MOST_LOOKED_AT
            {
                if other == component {
                    at += self.entries[at..].partition_point(|e| (e.0, e.1) <= (key, component));
                    continue;
                }
                looked_at += 1;
                at += 1;
                let squared = (topology.vertices[w as usize].position() - position).length_squared();
                if squared <= self.distance * self.distance {
                    found.push((squared.to_bits(), w));
                }
            }
        }
        found.sort_unstable();
        found.truncate(MOST);
        found
    }
}

fn cell(p: Vec3, side: f32) -> [i32; 3] {
    [p.x, p.y, p.z].map(|c| (c / side).floor() as i32)
}
