//! All levels of one history, each in time linear in its own size.
//!
//! The history is cut where the triangles have become half, and the mesh is kept at each cut. A
//! level is extracted from the last cut before it, which has at most twice its triangles; the
//! kept meshes together are no larger than the original.

use super::history::History;
use super::segment::{Segment, Snapshot, Source, is_plain};
use super::{Level, LevelMesh, collapse_count};
use crate::collapse_sequence::CollapseSequence;
use crate::mesh::Mesh;

/// The share of a segment's triangles at which the next one begins.
const CUT: (usize, usize) = (1, 2);

/// Below this many triangles no more cuts are made.
const SMALLEST: usize = 256;

/// An index of a [`CollapseSequence`] for any number of levels. Its size on the heap is about two
/// and a half times that of the mesh; it is made from the mesh and the sequence that every call is given again.
#[derive(Debug, Default)]
pub struct Levels {
    segments: Vec<Segment>,
    /// Where the next segment begins, and what it needs; until all are there.
    next: Option<Snapshot>,
    history: History,
    numbers: Vec<u32>,
    /// Each vertex has one wedge.
    plain: bool,
    done: bool,
}

impl Levels {
    /// The whole index, in `O(n)`.
    #[must_use]
    pub fn new(mesh: &Mesh, sequence: &CollapseSequence) -> Self {
        let mut levels = Self::default();
        while !levels.step(mesh, sequence) {}
        levels
    }

    /// Makes one more segment, each about half the work of the one before; true when all are there.
    pub fn step(&mut self, mesh: &Mesh, sequence: &CollapseSequence) -> bool {
        if self.done {
            return true;
        }
        let all = sequence.collapses.len();
        if self.segments.is_empty() {
            self.plain = is_plain(sequence);
            self.history = History::new(&Source { mesh, sequence, plain: self.plain }, all);
        }
        let source = Source { mesh, sequence, plain: self.plain };
        let first = self.segments.last().map_or(0, Segment::end);
        let triangles = sequence.triangle_counts.after(first);
        let end = if triangles <= SMALLEST {
            all
        } else {
            sequence.triangle_counts.collapses_to(triangles * CUT.0 / CUT.1).max(first)
        };
        let range = (first, end - first);
        let mut segment = Segment::new(&source, &self.history, range, self.next.take(), &mut self.numbers);
        let next = segment.finish(&source);
        self.done = end == all;
        if self.done {
            (self.history, self.numbers) = Default::default();
        } else {
            self.next = Some(next);
        }
        self.segments.push(segment);
        self.done
    }

    /// The level, as [`super::extract`] gives it. `mesh` and `sequence` are those the index was made from.
    #[must_use]
    pub fn extract(&self, mesh: &Mesh, sequence: &CollapseSequence, level: Level) -> LevelMesh {
        let count = collapse_count(sequence, level);
        let source = Source { mesh, sequence, plain: self.plain };
        match self.segments.partition_point(|segment| segment.first() <= count).checked_sub(1) {
            Some(at) if count <= self.segments[at].end() => self.segments[at].extract(&source, count),
            _ => super::extract(mesh, sequence, level),
        }
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn byte_count(&self) -> usize {
        self.segments.iter().map(Segment::byte_count).sum()
    }
}
