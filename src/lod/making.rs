//! A segment while it is made, one table after the other, so that making it can be spread over time.

use std::borrow::Cow;

use super::blend::{BlendRun, Blends};
use super::history::History;
use super::segment::{Seams, Segment, Snapshot, Source};
use super::versions::Moves;
use crate::mesh::weld::NO_VERTEX;

/// Entries of a table that are made in the time of one blend of attributes, roughly.
const ENTRIES_OF_BLEND: usize = 30;

/// Entries of a table that are made while the last uses of a triangle's wedges are found, roughly.
const ENTRIES_OF_TRIANGLE: usize = 5;

/// A [`Segment`] some of whose tables are still empty.
#[derive(Debug)]
pub(super) struct Making {
    segment: Segment,
    next: Table,
}

/// The tables in the order in which they are made.
#[derive(Debug)]
enum Table {
    Vertices,
    Wedges,
    Moves,
    Blends,
    Blending(BlendRun),
    /// Of the triangles up to this one.
    LastUses(usize, Vec<u32>),
    None,
}

impl Making {
    /// The segment of `length` collapses after `first`, from the mesh there, which is the original
    /// if no `snapshot` is given.
    pub(super) fn new((first, length): (usize, usize), snapshot: Option<Snapshot>) -> Self {
        let segment = Segment {
            first,
            length,
            snapshot,
            lasts: Vec::new(),
            goes_into: Vec::new(),
            moves: Moves::default(),
            seams: None,
            blends: Blends::default(),
        };
        Self { segment, next: Table::Vertices }
    }

    /// The segment as [`Making::new`] says, at once.
    pub(super) fn whole(source: &Source<'_>, history: &History, range: (usize, usize)) -> Segment {
        let mut making = Self::new(range, None);
        while !making.is_done() {
            making.step(source, history, &mut Vec::new(), usize::MAX);
        }
        making.segment
    }

    pub(super) fn is_done(&self) -> bool {
        matches!(self.next, Table::None)
    }

    pub(super) fn take(self) -> Segment {
        self.segment
    }

    /// Makes the next table; of one that takes long, as much as about `work` entries. Returns how
    /// many that were. `numbers` is room for a table.
    pub(super) fn step(
        &mut self,
        source: &Source<'_>,
        history: &History,
        numbers: &mut Vec<u32>,
        work: usize,
    ) -> usize {
        let Source { mesh, plain, .. } = *source;
        let segment = &mut self.segment;
        let (first, length) = (segment.first, segment.length);
        match &mut self.next {
            Table::Vertices => {
                let names = vertex_names(segment, source).into_owned();
                let (lasts, goes_into) = history.vertices.part(names.iter().copied(), first, length, numbers);
                if plain {
                    (segment.lasts, segment.goes_into) = (lasts, goes_into);
                } else {
                    segment.seams =
                        Some(Seams { vertex_lasts: lasts, vertex_goes_into: goes_into, triangle_lasts: Vec::new() });
                }
                self.next = Table::Moves;
                names.len()
            }
            Table::Moves => {
                let lasts = segment.seams.as_ref().map_or(&segment.lasts, |seams| &seams.vertex_lasts);
                let names = vertex_names(segment, source);
                let moves = history.versions.part(names.iter().copied(), lasts, first, length);
                let count = names.len();
                segment.moves = moves;
                self.next = if plain { Table::Blends } else { Table::Wedges };
                count
            }
            Table::Wedges => {
                let names = wedge_names(segment, source).into_owned();
                (segment.lasts, segment.goes_into) = history.wedges.part(names.iter().copied(), first, length, numbers);
                self.next = Table::Blends;
                names.len()
            }
            Table::Blends => {
                let state = segment.state(mesh);
                let names = (&*vertex_names(segment, source), &*wedge_names(segment, source));
                let run = BlendRun::new(source, state, (first, length), segment.first_positions(mesh), names);
                self.next = match run {
                    Some(run) => Table::Blending(run),
                    None => after_blends(segment, source),
                };
                length
            }
            Table::Blending(run) => {
                // What one takes is a matter of memory and many attributes, not of one entry.
                if run.step(&source.sequence.solved, work / ENTRIES_OF_BLEND + 1)
                    && let Table::Blending(run) = std::mem::replace(&mut self.next, Table::None)
                {
                    segment.blends = run.finish(segment.lasts.len());
                    self.next = after_blends(segment, source);
                }
                work.min(length.saturating_mul(ENTRIES_OF_BLEND))
            }
            Table::LastUses(start, last_uses) => {
                let all = segment.state(mesh).triangles.len();
                let range = *start..all.min(start.saturating_add(work / ENTRIES_OF_TRIANGLE + 1));
                *start = range.end;
                let count = range.len() * ENTRIES_OF_TRIANGLE;
                segment.find_last_uses_in(source, range, last_uses);
                if *start == all {
                    segment.lasts = std::mem::take(last_uses);
                    self.next = Table::None;
                }
                count
            }
            Table::None => 0,
        }
    }
}

fn after_blends(segment: &mut Segment, source: &Source<'_>) -> Table {
    if !source.plain {
        return Table::LastUses(0, vec![0; segment.lasts.len()]);
    }
    if segment.snapshot.is_none() {
        for (lasts, &vertex) in segment.lasts.iter_mut().zip(&source.sequence.vertex_of_wedge) {
            *lasts = if vertex == NO_VERTEX { 0 } else { *lasts };
        }
    }
    Table::None
}

fn wedge_names<'a>(segment: &'a Segment, source: &Source<'_>) -> Cow<'a, [u32]> {
    match &segment.snapshot {
        Some(s) => Cow::Borrowed(&s.level.wedge_map),
        None => Cow::Owned((0..source.mesh.positions.len() as u32).collect()),
    }
}

fn vertex_names<'a>(segment: &'a Segment, source: &Source<'_>) -> Cow<'a, [u32]> {
    match &segment.snapshot {
        Some(s) if !source.plain => Cow::Borrowed(&s.vertices),
        _ => wedge_names(segment, source),
    }
}
