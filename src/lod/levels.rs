//! All levels of one history, each in time linear in its own size.
//!
//! The history is cut where the triangles have become two thirds, and the mesh is kept at each cut.
//! A level is extracted from the last cut before it, which has at most half more triangles; the
//! kept meshes together are about twice as large as the original.

use std::sync::Arc;

use super::history::History;
use super::making::Making;
use super::segment::{Segment, Source, is_plain};
use super::{Level, LevelMesh, collapse_count};
use crate::collapse_sequence::CollapseSequence;
use crate::mesh::Mesh;

/// The share of a segment's triangles at which the next one begins.
const CUT: (usize, usize) = (2, 3);

/// Entries of a table of vertices that are made in the time of reading a collapse, roughly: those jump about in memory.
const ENTRIES_OF_COLLAPSE: usize = 3;

/// Below this many triangles no more cuts are made.
const SMALLEST: usize = 256;

/// An index of a [`CollapseSequence`] for any number of levels. Its size on the heap is about three and a half
/// times that of the mesh; it is made from the mesh and the sequence that every call is given again.
#[derive(Debug, Default)]
pub struct Levels {
    segments: Vec<Segment>,
    /// Each vertex has one wedge.
    plain: bool,
    stage: Stage,
}

/// What there is beside the segments until all are there.
#[derive(Debug, Default)]
enum Stage {
    #[default]
    New,
    /// Reading the collapses.
    Reading(History),
    /// Making the next segment, with room for a table.
    Making(Box<(History, Vec<u32>, Making)>),
    Done,
}

impl Levels {
    /// The whole index, in `O(n)`.
    #[must_use]
    pub fn new(mesh: &Mesh, sequence: &CollapseSequence) -> Self {
        let mut levels = Self::default();
        levels.step(mesh, sequence, usize::MAX);
        levels
    }

    /// Does about `work` units, of which a mesh has some ten for each vertex. A step may be longer: it makes at least one
    /// table of the vertices of a segment. Returns the share that is done, exactly 1 when all is.
    pub fn step(&mut self, mesh: &Mesh, sequence: &CollapseSequence, work: usize) -> f32 {
        let mut left = work.max(1);
        while left > 0 && !self.is_done() {
            left = left.saturating_sub(self.advance(mesh, sequence, left).max(1));
        }
        let all = sequence.collapses.len().max(1) as f32;
        match &self.stage {
            Stage::New => 0.0,
            Stage::Reading(history) => 0.3 * history.fraction(),
            // A segment takes time in proportion to its triangles.
            Stage::Making(..) => 0.3 + 0.69 * self.segments.last().map_or(0.0, |last| last.end() as f32 / all),
            Stage::Done => 1.0,
        }
    }

    /// Whether all levels are extracted by the index.
    #[must_use]
    pub fn is_done(&self) -> bool {
        matches!(self.stage, Stage::Done)
    }

    /// One step of at most about `work` units. Returns how many they were.
    fn advance(&mut self, mesh: &Mesh, sequence: &CollapseSequence, work: usize) -> usize {
        let all = sequence.collapses.len();
        let source = Source { mesh, sequence, plain: self.plain };
        match std::mem::take(&mut self.stage) {
            Stage::New => {
                self.plain = is_plain(sequence);
                self.stage = Stage::Reading(History::new(&Source { mesh, sequence, plain: self.plain }, all));
                mesh.positions.len()
            }
            Stage::Reading(mut history) => {
                self.stage = match history.step(&source, work / ENTRIES_OF_COLLAPSE + 1) {
                    true => Stage::Reading(history),
                    false => {
                        let making = Making::new(range_after(sequence, 0), None);
                        Stage::Making(Box::new((history, Vec::new(), making)))
                    }
                };
                work.min(all.saturating_mul(ENTRIES_OF_COLLAPSE))
            }
            Stage::Making(mut parts) if !parts.2.is_done() => {
                let (history, numbers, making) = &mut *parts;
                let done = making.step(&source, history, numbers, work);
                self.stage = Stage::Making(parts);
                done
            }
            Stage::Making(parts) => {
                let (history, numbers, making) = *parts;
                let mut segment = making.take();
                let next = segment.finish(&source);
                let (end, done) = (segment.end(), next.level.mesh.triangles.len());
                self.segments.push(segment);
                self.stage = if end == all {
                    Stage::Done
                } else {
                    let making = Making::new(range_after(sequence, end), Some(next));
                    Stage::Making(Box::new((history, numbers, making)))
                };
                done
            }
            Stage::Done => {
                self.stage = Stage::Done;
                0
            }
        }
    }

    /// The level, as [`super::extract`] gives it; one at a cut is handed out and not made. `mesh` and
    /// `sequence` are those the index was made from.
    #[must_use]
    pub fn extract(&self, mesh: &Mesh, sequence: &CollapseSequence, level: Level) -> Arc<LevelMesh> {
        let count = collapse_count(sequence, level);
        let source = Source { mesh, sequence, plain: self.plain };
        match self.segments.partition_point(|segment| segment.first() <= count).checked_sub(1) {
            Some(at) if count <= self.segments[at].end() => self.segments[at].extract(&source, count),
            _ => Arc::new(super::extract(mesh, sequence, level)),
        }
    }

    /// Bytes on the heap, without what is needed only until all is done.
    #[must_use]
    pub fn byte_count(&self) -> usize {
        self.segments.iter().map(Segment::byte_count).sum()
    }
}

/// The first collapse and the length of the segment that begins after `first`.
fn range_after(sequence: &CollapseSequence, first: usize) -> (usize, usize) {
    let triangles = sequence.triangle_counts.after(first);
    let end = if triangles <= SMALLEST {
        sequence.collapses.len()
    } else {
        sequence.triangle_counts.collapses_to(triangles * CUT.0 / CUT.1).max(first)
    };
    (first, end - first)
}
