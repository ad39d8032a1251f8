//! A segment of the history: the mesh at its first level, and what happens to each vertex after that.
//!
//! Where the history says *when*, a segment says *whom*: for each wedge how long it lasts and what
//! it merges into, for each vertex its positions one after the other. All are in the order of the
//! original mesh, so extracting a level reads a few arrays from one end to the other and does not
//! jump about as the collapses do.
//!
//! Times are numbers of collapses since the segment's first level. Wedges, vertices and triangles
//! are numbered within the segment, in the order of the original.

use std::ops::Range;
use std::sync::Arc;

use super::LevelMesh;
use super::blend::{Blends, gather, put};
use super::history::{climb, end_of_triangle};
use super::versions::Moves;
use crate::collapse_sequence::CollapseSequence;
use crate::mesh::weld::NO_VERTEX;
use crate::mesh::{Attribute, Group, Mesh, WedgeSet};

/// After every collapse.
pub(super) const NEVER: u32 = u32::MAX;

/// The levels after `first` collapses and up to `length` more.
#[derive(Debug)]
pub(super) struct Segment {
    pub(super) first: usize,
    pub(super) length: usize,
    /// The mesh at the first level; nothing for the segment that begins with the original itself.
    pub(super) snapshot: Option<Snapshot>,
    /// The time until which each wedge is in use; 0 if it never is. See [`Segment::finish`].
    pub(super) lasts: Vec<u32>,
    /// The wedge that each merges into then, or itself.
    pub(super) goes_into: Vec<u32>,
    pub(super) moves: Moves<[f32; 3]>,
    /// What only a mesh has some of whose vertices have several wedges.
    pub(super) seams: Option<Seams>,
    /// The attributes of wedges that change.
    pub(super) blends: Blends,
}

/// A mesh at the first level of a segment, with names for what it is made of.
#[derive(Debug)]
pub(super) struct Snapshot {
    pub(super) level: Arc<LevelMesh>,
    /// Vertex of each wedge, numbered in the segment; empty if each vertex has one wedge.
    pub(super) vertex_of_wedge: Vec<u32>,
    /// Names of the vertices as in the history, rising; empty if each vertex has one wedge.
    pub(super) vertices: Vec<u32>,
    /// Position of each vertex; empty if each vertex has one wedge.
    pub(super) positions: Vec<[f32; 3]>,
}

#[derive(Debug)]
pub(super) struct Seams {
    /// Time and successor of each vertex.
    pub(super) vertex_lasts: Vec<u32>,
    pub(super) vertex_goes_into: Vec<u32>,
    /// The time until which each triangle is there.
    pub(super) triangle_lasts: Vec<u32>,
}

/// What a segment is made from.
pub(super) struct Source<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) sequence: &'a CollapseSequence,
    /// Each vertex has one wedge.
    pub(super) plain: bool,
}

/// Whether each vertex has one wedge.
pub(super) fn is_plain(sequence: &CollapseSequence) -> bool {
    sequence.vertex_of_wedge.iter().zip(0..).all(|(&v, w)| v == w || v == NO_VERTEX)
}

impl Segment {
    /// Cuts the time of each wedge, until now that of its merge, where its last triangle goes earlier.
    fn find_last_uses(&mut self, source: &Source<'_>) {
        let mut last_uses = vec![0; self.lasts.len()];
        self.find_last_uses_in(source, 0..self.state(source.mesh).triangles.len(), &mut last_uses);
        self.lasts = last_uses;
    }

    /// The last use of each wedge by these of the triangles, and until when those are there.
    pub(super) fn find_last_uses_in(&mut self, source: &Source<'_>, range: Range<usize>, last_uses: &mut [u32]) {
        let mut triangle_lasts = self.seams.as_mut().map(|seams| std::mem::take(&mut seams.triangle_lasts));
        let state = self.state(source.mesh);
        let (vertex_lasts, vertex_goes_into) = match &self.seams {
            Some(seams) => (&seams.vertex_lasts, &seams.vertex_goes_into),
            None => (&self.lasts, &self.goes_into),
        };
        let vertex_of = |w: u32| match (&self.seams, &self.snapshot) {
            (None, _) => w,
            (_, Some(s)) => s.vertex_of_wedge[w as usize],
            (_, None) => source.sequence.vertex_of_wedge[w as usize],
        };
        for t in &state.triangles[range] {
            let end = end_of_triangle(t.map(vertex_of), vertex_lasts, vertex_goes_into);
            if let Some(lasts) = &mut triangle_lasts {
                lasts.push(end);
            }
            for &corner in t {
                let (mut w, mut since) = (corner as usize, 0);
                while since < end {
                    since = self.lasts[w].min(end);
                    last_uses[w] = last_uses[w].max(since);
                    w = self.goes_into[w] as usize;
                }
            }
        }
        if let (Some(seams), Some(lasts)) = (&mut self.seams, triangle_lasts) {
            seams.triangle_lasts = lasts;
        }
    }

    /// Number of collapses before the first level.
    pub(super) fn first(&self) -> usize {
        self.first
    }

    /// Number of collapses before its last level.
    pub(super) fn end(&self) -> usize {
        self.first + self.length
    }

    /// Bytes on the heap.
    pub(super) fn byte_count(&self) -> usize {
        let words = |list: &[u32]| size_of_val(list);
        let mut bytes = words(&self.lasts) + words(&self.goes_into) + self.moves.byte_count();
        bytes += self.blends.byte_count();
        if let Some(seams) = &self.seams {
            bytes += words(&seams.vertex_lasts) + words(&seams.vertex_goes_into) + words(&seams.triangle_lasts);
        }
        if let Some(Snapshot { level, vertex_of_wedge, vertices, positions }) = &self.snapshot {
            bytes += words(&level.wedge_map) + words(vertex_of_wedge) + words(vertices);
            bytes += size_of_val(positions.as_slice());
            bytes += size_of_val(level.mesh.positions.as_slice()) + size_of_val(level.mesh.triangles.as_slice());
            let sets = level.mesh.wedge_sets.iter().flat_map(|set| &set.attributes);
            bytes += sets.map(|attribute| size_of_val(attribute.values.as_slice())).sum::<usize>();
        }
        bytes
    }

    /// The level after `count` collapses in all, which must be in the segment.
    pub(super) fn extract(&self, source: &Source<'_>, count: usize) -> Arc<LevelMesh> {
        let Source { mesh, sequence, .. } = *source;
        let time = (count - self.first).min(self.length) as u32;
        let state = self.state(mesh);
        if let (0, Some(snapshot)) = (time, &self.snapshot) {
            return Arc::clone(&snapshot.level);
        }
        let (local, new_index) = self.living(time);
        let mut out = Mesh { parts: mesh.parts.clone(), ..Mesh::default() };
        let left = sequence.triangle_counts.after(count);
        out.triangles = vec![[0; 3]; left];
        let mut end = 0;
        for group in &state.groups {
            let start = end;
            end = self.triangles(state, group, time, &new_index, &mut out.triangles, start);
            out.groups.push(Group { triangles: start..end, wedge_set: group.wedge_set });
        }
        out.triangles.truncate(end);

        let original: Vec<u32> = match &self.snapshot {
            Some(s) => local.iter().map(|&w| s.level.wedge_map[w as usize]).collect(),
            None => Vec::new(),
        };
        out.positions = self.positions(source, &local, &new_index, time);
        let mut start = 0;
        for set in &state.wedge_sets {
            let end = start + local[start..].partition_point(|&w| (w as usize) < set.wedges.end);
            let attributes = compact(set, &local[start..end]);
            out.wedge_sets.push(WedgeSet { wedges: start..end, part: set.part, attributes });
            start = end;
        }
        self.blends.at(time, |wedge, values| self.put_values(wedge, values, time, &new_index, &mut out));
        drop(new_index);
        let error = count.checked_sub(1).map_or(0.0, |last| sequence.collapses[last].error);
        let wedge_map = if self.snapshot.is_some() { original } else { local };
        Arc::new(LevelMesh { mesh: out, wedge_map, error })
    }

    /// The mesh after the segment's last collapse, to begin the next one with.
    ///
    /// Where each vertex has one wedge, a vertex that merges is in use until then, so only one that
    /// stays can be without a triangle before; at the end is seen whether any is, which is rare.
    pub(super) fn finish(&mut self, source: &Source<'_>) -> Snapshot {
        let mut level = self.extract(source, self.end());
        if source.plain && !all_in_use(&level.mesh) {
            self.find_last_uses(source);
            level = self.extract(source, self.end());
        }
        let (mut vertex_of_wedge, mut vertices, mut positions) = (Vec::new(), Vec::new(), Vec::new());
        if let Some(seams) = &self.seams {
            let time = self.length as u32;
            let (local, _) = self.living(time);
            let at_end: Vec<u32> = local.iter().map(|&w| self.vertex_at(seams, source, w, time)).collect();
            let mut number = vec![NO_VERTEX; seams.vertex_lasts.len()];
            for &v in &at_end {
                number[v as usize] = 0;
            }
            let at_time = self.vertex_positions(source.mesh, time);
            for (v, number) in number.iter_mut().enumerate().filter(|(_, number)| **number == 0) {
                *number = vertices.len() as u32;
                vertices.push(self.snapshot.as_ref().map_or(v as u32, |s| s.vertices[v]));
                positions.push(at_time[v]);
            }
            vertex_of_wedge = at_end.into_iter().map(|v| number[v as usize]).collect();
        }
        Snapshot { level, vertex_of_wedge, vertices, positions }
    }

    pub(super) fn state<'a>(&'a self, mesh: &'a Mesh) -> &'a Mesh {
        self.snapshot.as_ref().map_or(mesh, |s| &s.level.mesh)
    }

    /// The wedges in use, and for each wedge of the segment the place of its ancestor among them.
    fn living(&self, time: u32) -> (Vec<u32>, Vec<u32>) {
        // Each wedge is written to the end of both lists and counts in one: no branch.
        let (mut living, mut gone) = (vec![0; self.lasts.len()], vec![0; self.lasts.len()]);
        let (mut alive, mut dead) = (0, 0);
        let mut new_index = Vec::with_capacity(self.lasts.len());
        for (w, &lasts) in self.lasts.iter().enumerate() {
            living[alive] = w as u32;
            gone[dead] = w as u32;
            new_index.push(alive as u32);
            let lives = usize::from(lasts > time);
            alive += lives;
            dead += 1 - lives;
        }
        for &w in &gone[..dead] {
            new_index[w as usize] = new_index[climb(w, time, &self.lasts, &self.goes_into) as usize];
        }
        living.truncate(alive);
        (living, new_index)
    }

    /// Writes the group's living triangles to `out` from `start` on. Returns their end.
    fn triangles(
        &self,
        state: &Mesh,
        group: &Group,
        time: u32,
        new_index: &[u32],
        out: &mut [[u32; 3]],
        start: usize,
    ) -> usize {
        let mut end = start;
        let mut put = |triangle: [u32; 3], lives: bool| {
            // Written whether it lives or not, and the place taken only if it does: no branch.
            if let Some(slot) = out.get_mut(end) {
                *slot = triangle;
                end += usize::from(lives);
            }
        };
        let triangles = &state.triangles[group.triangles.clone()];
        let moved = |t: &[u32; 3]| t.map(|w| new_index[w as usize]);
        match &self.seams {
            None => {
                for t in triangles {
                    let [a, b, c] = moved(t);
                    put([a, b, c], (a != b) & (b != c) & (c != a));
                }
            }
            Some(seams) => {
                for (t, &lasts) in triangles.iter().zip(&seams.triangle_lasts[group.triangles.clone()]) {
                    put(moved(t), lasts > time);
                }
            }
        }
        end
    }

    /// The vertex that a wedge in use is at.
    fn vertex_at(&self, seams: &Seams, source: &Source<'_>, wedge: u32, time: u32) -> u32 {
        let vertex = match &self.snapshot {
            Some(s) => s.vertex_of_wedge[wedge as usize],
            None => source.sequence.vertex_of_wedge[wedge as usize],
        };
        climb(vertex, time, &seams.vertex_lasts, &seams.vertex_goes_into)
    }

    /// The position of each vertex of the segment at its first level.
    pub(super) fn first_positions<'a>(&'a self, mesh: &'a Mesh) -> &'a [[f32; 3]] {
        match &self.snapshot {
            Some(s) if !s.positions.is_empty() => &s.positions,
            Some(s) => &s.level.mesh.positions,
            None => &mesh.positions,
        }
    }

    fn vertex_positions(&self, mesh: &Mesh, time: u32) -> Vec<[f32; 3]> {
        let mut positions = self.first_positions(mesh).to_vec();
        self.moves.at(time, |vertex, position| positions[vertex] = position);
        positions
    }

    /// Of the `wedges` in use; for each wedge of the segment `new_index` has its place among them.
    fn positions(&self, source: &Source<'_>, wedges: &[u32], new_index: &[u32], time: u32) -> Vec<[f32; 3]> {
        let mesh = source.mesh;
        let Some(seams) = &self.seams else {
            let first = self.first_positions(mesh);
            let mut positions: Vec<[f32; 3]> = wedges.iter().map(|&w| first[w as usize]).collect();
            self.moves.at(time, |vertex, position| {
                // It may have lost its last triangle before.
                if self.lasts[vertex] > time {
                    positions[new_index[vertex] as usize] = position;
                }
            });
            return positions;
        };
        let vertex_positions = self.vertex_positions(mesh, time);
        let original = |w: u32| self.snapshot.as_ref().map_or(w, |s| s.level.wedge_map[w as usize]);
        wedges
            .iter()
            .map(|&w| {
                let position = vertex_positions[self.vertex_at(seams, source, w, time) as usize];
                // A wedge that did not move keeps its own bits: the sign of a zero may differ
                // between the wedges of a vertex.
                let before = mesh.positions[original(w) as usize];
                if before == position { before } else { position }
            })
            .collect()
    }

    /// Gives a wedge, if it is in use, the values of all its attributes.
    fn put_values(&self, wedge: usize, mut values: &[f32], time: u32, new_index: &[u32], out: &mut Mesh) {
        if self.lasts[wedge] <= time {
            return;
        }
        let place = new_index[wedge] as usize;
        let set = out.wedge_sets.partition_point(|set| set.wedges.end <= place);
        let set = &mut out.wedge_sets[set];
        let at = place - set.wedges.start;
        for Attribute { components: n, values: to, .. } in &mut set.attributes {
            put(to, *n, at, values);
            values = &values[*n..];
        }
    }
}

/// The attributes of one set for just these wedges.
fn compact(set: &WedgeSet, wedges: &[u32]) -> Vec<Attribute> {
    let compact = |attribute: &Attribute| {
        let Attribute { ref name, components, ref values, blend } = *attribute;
        let values = gather(values, components, wedges, set.wedges.start);
        Attribute { name: name.clone(), components, values, blend }
    };
    set.attributes.iter().map(compact).collect()
}

/// Whether some triangle has each wedge.
fn all_in_use(mesh: &Mesh) -> bool {
    let mut in_use = vec![false; mesh.positions.len()];
    for &w in mesh.triangles.as_flattened() {
        in_use[w as usize] = true;
    }
    in_use.into_iter().all(|used| used)
}
