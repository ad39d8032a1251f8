//! Polylines: the graph of borders, seams and non-manifold edges, along which its vertices merge.
//!
//! Nearly all of its vertices have two neighbours in it, which lie in one array; the others have
//! lists.

use super::LINE_WEIGHT;
use super::quadric::{Quadric, Vec3};
use super::topology::{NONE, Topology};

/// The neighbours of every vertex along its lines.
#[derive(Debug, Default)]
pub(super) struct Polylines {
    /// By vertex, once there is a line at all: two neighbours, or the number of a list and
    /// [`NONE`], or twice [`NONE`].
    pairs: Vec<[u32; 2]>,
    lists: Vec<Vec<u32>>,
    scratch: Vec<u32>,
}

impl Polylines {
    /// The neighbours of `v` along its lines, each once.
    #[inline(always)]
    pub(super) fn of(&self, v: u32) -> &[u32] {
        match self.pairs.get(v as usize) {
            Some([list, NONE]) => self.lists.get(*list as usize).map_or(&[], Vec::as_slice),
            Some(pair) => pair,
            None => &[],
        }
    }

    /// Gives `v`, one of `vertices` vertices, its neighbours.
    pub(super) fn set(&mut self, v: u32, neighbours: &[u32], vertices: usize) {
        if self.pairs.is_empty() {
            if neighbours.is_empty() {
                return;
            }
            self.pairs.resize(vertices, [NONE; 2]);
        }
        let pair = &mut self.pairs[v as usize];
        if let &[a, b] = neighbours {
            *pair = [a, b];
        } else if let [list, NONE] = *pair
            && let Some(list) = self.lists.get_mut(list as usize)
        {
            list.clear();
            list.extend_from_slice(neighbours);
        } else {
            *pair = [if neighbours.is_empty() { NONE } else { self.lists.len() as u32 }, NONE];
            if !neighbours.is_empty() {
                self.lists.push(neighbours.to_vec());
            }
        }
    }

    /// `into` takes the place of `from`, and the quadrics of the lines' other ends change with it.
    /// `into` has moved from `old_into` to where it is now. Other ends that have fewer lines now
    /// are appended to `shortened`.
    pub(super) fn merge(
        &mut self,
        topology: &mut Topology,
        (from, old_from): (u32, Vec3),
        (into, old_into): (u32, Vec3),
        shortened: &mut Vec<u32>,
    ) {
        let now = topology.vertices[into as usize].position();
        let vertices = topology.vertices.len();
        let mut lines = std::mem::take(&mut self.scratch);
        lines.clear();
        lines.extend(self.of(into).iter().filter(|&&w| w != from));
        let own = lines.len();
        for &w in &lines {
            move_line(topology, w, Some(old_into), Some(now));
        }
        for i in 0..self.of(from).len() {
            let w = self.of(from)[i];
            if w == into {
                continue;
            }
            if lines[..own].contains(&w) {
                // Two lines of `w` have become one.
                move_line(topology, w, Some(old_from), None);
                let rest: Vec<u32> = self.of(w).iter().copied().filter(|&x| x != from).collect();
                self.set(w, &rest, vertices);
                shortened.push(w);
            } else {
                move_line(topology, w, Some(old_from), Some(now));
                self.rename(w, from, into);
                lines.push(w);
            }
        }
        self.set(into, &lines, vertices);
        self.scratch = lines;
    }

    fn rename(&mut self, v: u32, old: u32, new: u32) {
        let neighbours = match &mut self.pairs[v as usize] {
            [list, NONE] => self.lists.get_mut(*list as usize).map_or(&mut [][..], Vec::as_mut_slice),
            pair => pair,
        };
        for neighbour in neighbours {
            if *neighbour == old {
                *neighbour = new;
            }
        }
    }

    /// The quadric of the lines at `v`.
    pub(super) fn quadric(&self, topology: &Topology, v: u32) -> Quadric {
        let at = topology.vertices[v as usize].position();
        let line = |&w: &u32| Quadric::of_line(topology.vertices[w as usize].position() - at, LINE_WEIGHT);
        self.of(v).iter().map(line).fold(Quadric::default(), |sum, line| sum + line)
    }
}

/// A line of `v` ended in `old` and ends in `new`.
fn move_line(topology: &mut Topology, v: u32, old: Option<Vec3>, new: Option<Vec3>) {
    let at = topology.vertices[v as usize].position();
    let line = |end: Option<Vec3>| end.map_or(Quadric::default(), |end| Quadric::of_line(end - at, LINE_WEIGHT));
    topology.add(v, &(line(new) - line(old)).packed());
}
