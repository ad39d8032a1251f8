//! A segment of the history: the mesh at its first level, and what happens to each vertex after that.
//!
//! Where the history says *when*, a segment says *whom*: for each wedge how long it lasts and what
//! it merges into, for each vertex its positions one after the other. All are in the order of the
//! original mesh, so extracting a level reads a few arrays from one end to the other and does not
//! jump about as the collapses do.
//!
//! Times are numbers of collapses since the segment's first level. Wedges, vertices and triangles
//! are numbered within the segment, in the order of the original.

use super::LevelMesh;
use super::blend::{Blending, WedgeAttributes, blends};
use super::history::{History, Successors, climb, end_of_triangle};
use super::versions::Versions;
use crate::collapse_sequence::{CollapseSequence, SolvedValues};
use crate::mesh::weld::NO_VERTEX;
use crate::mesh::{Group, Mesh, WedgeSet};

/// After every collapse.
pub(super) const NEVER: u32 = u32::MAX;

/// The levels after `first` collapses and up to `length` more.
#[derive(Debug)]
pub(super) struct Segment {
    first: usize,
    length: usize,
    /// The mesh at the first level; nothing for the segment that begins with the original itself.
    snapshot: Option<Snapshot>,
    /// The time until which each wedge is in use; 0 if it never is. See [`Segment::finish`].
    lasts: Vec<u32>,
    /// The wedge that each merges into then, or itself.
    goes_into: Vec<u32>,
    versions: Versions,
    /// What only a mesh has some of whose vertices have several wedges.
    seams: Option<Seams>,
    /// Merges that change attributes, in order.
    blends: Vec<Blending>,
}

/// A mesh at the first level of a segment, with names for what it is made of.
#[derive(Debug)]
pub(super) struct Snapshot {
    pub(super) level: LevelMesh,
    /// Vertex of each wedge, numbered in the segment; empty if each vertex has one wedge.
    vertex_of_wedge: Vec<u32>,
    /// Names of the vertices as in the history, rising; empty if each vertex has one wedge.
    vertices: Vec<u32>,
    /// Position of each vertex; empty if each vertex has one wedge.
    positions: Vec<[f32; 3]>,
}

#[derive(Debug)]
struct Seams {
    /// Time and successor of each vertex.
    vertex_lasts: Vec<u32>,
    vertex_goes_into: Vec<u32>,
    /// The time until which each triangle is there.
    triangle_lasts: Vec<u32>,
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
    /// The segment of `length` collapses after `first`, from the mesh there, which is the original
    /// if no `snapshot` is given. `numbers` is room for a table.
    pub(super) fn new(
        source: &Source<'_>,
        history: &History,
        (first, length): (usize, usize),
        snapshot: Option<Snapshot>,
        numbers: &mut Vec<u32>,
    ) -> Self {
        let Source { mesh, sequence, plain } = *source;
        let state = snapshot.as_ref().map_or(mesh, |s| &s.level.mesh);
        let names: Vec<u32>;
        let wedge_names = match &snapshot {
            Some(s) => s.level.wedge_map.as_slice(),
            None => {
                names = (0..mesh.positions.len() as u32).collect();
                &names
            }
        };
        let (vertex_names, at_first) = match &snapshot {
            Some(s) if !plain => (s.vertices.as_slice(), s.positions.as_slice()),
            _ => (wedge_names, state.positions.as_slice()),
        };
        let part = |successors: &Successors, names: &[u32], numbers: &mut Vec<u32>| {
            successors.part(names.iter().copied(), first, length, numbers)
        };
        let (vertex_lasts, vertex_goes_into) = part(&history.vertices, vertex_names, numbers);
        let versions = history.versions.part(vertex_names.iter().copied(), first, length);
        let merged = (!plain).then(|| part(&history.wedges, wedge_names, numbers));

        let has_attributes = state.wedge_sets.iter().any(|set| !set.attributes.is_empty());
        let blends = if has_attributes {
            blends(source, first, length, at_first, (vertex_names, wedge_names))
        } else {
            Vec::new()
        };

        let mut segment = match merged {
            None => {
                let (goes_into, seams) = (vertex_goes_into, None);
                Self { first, length, lasts: vertex_lasts, goes_into, versions, seams, blends, snapshot }
            }
            Some((lasts, goes_into)) => {
                let seams = Seams { vertex_lasts, vertex_goes_into, triangle_lasts: Vec::new() };
                Self { first, length, lasts, goes_into, versions, seams: Some(seams), blends, snapshot }
            }
        };
        if !plain {
            segment.find_last_uses(source);
        } else if segment.snapshot.is_none() {
            for (lasts, &vertex) in segment.lasts.iter_mut().zip(&sequence.vertex_of_wedge) {
                *lasts = if vertex == NO_VERTEX { 0 } else { *lasts };
            }
        }
        segment
    }

    /// Cuts the time of each wedge, until now that of its merge, where its last triangle goes earlier.
    fn find_last_uses(&mut self, source: &Source<'_>) {
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
        let mut triangle_lasts = Vec::with_capacity(if self.seams.is_some() { state.triangles.len() } else { 0 });
        let mut last_uses = vec![0_u32; self.lasts.len()];
        for t in &state.triangles {
            let end = end_of_triangle(t.map(vertex_of), vertex_lasts, vertex_goes_into);
            if self.seams.is_some() {
                triangle_lasts.push(end);
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
        self.lasts = last_uses;
        if let Some(seams) = &mut self.seams {
            seams.triangle_lasts = triangle_lasts;
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
        let mut bytes = words(&self.lasts) + words(&self.goes_into) + self.versions.byte_count();
        bytes += size_of_val(self.blends.as_slice());
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
    pub(super) fn extract(&self, source: &Source<'_>, count: usize) -> LevelMesh {
        let Source { mesh, sequence, .. } = *source;
        let time = (count - self.first).min(self.length) as u32;
        let state = self.state(mesh);
        if let (0, Some(snapshot)) = (time, &self.snapshot) {
            return snapshot.level.clone();
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
        drop(new_index);

        let original: Vec<u32> = match &self.snapshot {
            Some(s) => local.iter().map(|&w| s.level.wedge_map[w as usize]).collect(),
            None => Vec::new(),
        };
        out.positions = self.positions(mesh, source, &local, time);
        let attributes = self.attributes(state, &sequence.solved, time);
        let mut start = 0;
        for (s, set) in state.wedge_sets.iter().enumerate() {
            let end = start + local[start..].partition_point(|&w| (w as usize) < set.wedges.end);
            out.wedge_sets.push(WedgeSet {
                wedges: start..end,
                part: set.part,
                attributes: attributes.as_ref().map_or_else(Vec::new, |a| a.compact(s, &local[start..end])),
            });
            start = end;
        }
        let error = count.checked_sub(1).map_or(0.0, |last| sequence.collapses[last].error);
        LevelMesh { mesh: out, wedge_map: if self.snapshot.is_some() { original } else { local }, error }
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
            for (v, number) in number.iter_mut().enumerate().filter(|(_, number)| **number == 0) {
                *number = vertices.len() as u32;
                vertices.push(self.snapshot.as_ref().map_or(v as u32, |s| s.vertices[v]));
                positions.push(self.position(source.mesh, v, time));
            }
            vertex_of_wedge = at_end.into_iter().map(|v| number[v as usize]).collect();
        }
        Snapshot { level, vertex_of_wedge, vertices, positions }
    }

    fn state<'a>(&'a self, mesh: &'a Mesh) -> &'a Mesh {
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

    fn position(&self, mesh: &Mesh, vertex: usize, time: u32) -> [f32; 3] {
        let at_first = match &self.snapshot {
            Some(s) if !s.positions.is_empty() => &s.positions,
            Some(s) => &s.level.mesh.positions,
            None => &mesh.positions,
        };
        self.versions.at(vertex, time).unwrap_or(at_first[vertex])
    }

    fn positions(&self, mesh: &Mesh, source: &Source<'_>, wedges: &[u32], time: u32) -> Vec<[f32; 3]> {
        let Some(seams) = &self.seams else {
            return wedges.iter().map(|&w| self.position(mesh, w as usize, time)).collect();
        };
        let original = |w: u32| self.snapshot.as_ref().map_or(w, |s| s.level.wedge_map[w as usize]);
        wedges
            .iter()
            .map(|&w| {
                let position = self.position(mesh, self.vertex_at(seams, source, w, time) as usize, time);
                // A wedge that did not move keeps its own bits: the sign of a zero may differ
                // between the wedges of a vertex.
                let before = mesh.positions[original(w) as usize];
                if before == position { before } else { position }
            })
            .collect()
    }

    fn attributes(&self, state: &Mesh, solved: &SolvedValues, time: u32) -> Option<WedgeAttributes> {
        if state.wedge_sets.iter().all(|set| set.attributes.is_empty()) {
            return None;
        }
        let sets = state.wedge_sets.iter().map(|set| (set.wedges.start, set.attributes.as_slice()));
        let mut attributes = WedgeAttributes::new(sets);
        for b in self.blends.iter().take_while(|b| b.time <= time) {
            attributes.blend(b.from, b.into, b.parameter);
            attributes.replace(b.into, solved.of(b.solved as usize), &solved.layouts);
        }
        Some(attributes)
    }
}

/// Whether some triangle has each wedge.
fn all_in_use(mesh: &Mesh) -> bool {
    let mut in_use = vec![false; mesh.positions.len()];
    for &w in mesh.triangles.as_flattened() {
        in_use[w as usize] = true;
    }
    in_use.into_iter().all(|used| used)
}
