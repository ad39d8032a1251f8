//! The record of a run while it is made, and its order at the end.
//!
//! A collapse depends only on what happened in its ring before. Its *rank* is its cost, or the
//! highest rank in its ring if that is higher, so the record may be put in the order of the ranks
//! afterwards: the coarse, spatial order of the sweeps leaves no trace, and every level is as good
//! as if it had been the target.

use crate::collapse_sequence::{
    Blockers, Collapse, CollapseSequence, SolvedValues, StopReason, TriangleCounts, WedgeMerges,
};

/// Collapses in the order they are done.
#[derive(Debug, Default)]
pub(super) struct Record {
    collapses: Vec<Collapse>,
    /// Triangles left after each collapse.
    triangle_counts: TriangleCounts,
    wedge_merges: WedgeMerges,
    /// Values of the merged wedges, if they are solved for.
    pub(super) solved: SolvedValues,
    /// Rank of each collapse, and of the last one at each vertex; empty when only the end matters.
    ranks: Vec<f32>,
    rank_at: Vec<f32>,
}

impl Record {
    /// For up to `collapses` entries of a mesh of so many `triangles`; with ranks of `vertices` if
    /// every level matters.
    pub(super) fn new(triangles: usize, collapses: usize, vertices: usize, every_level: bool) -> Self {
        Self {
            collapses: Vec::with_capacity(collapses),
            triangle_counts: TriangleCounts::new(triangles),
            ranks: Vec::with_capacity(if every_level { collapses } else { 0 }),
            rank_at: vec![0.0; if every_level { vertices } else { 0 }],
            ..Self::default()
        }
    }

    /// Ranks the collapse of `from` into `into` with `ring` around them, of the given cost.
    #[inline(always)]
    pub(super) fn rank(&mut self, from: u32, into: u32, ring: &[u32], cost: f32) {
        if self.rank_at.is_empty() {
            return;
        }
        let mut rank = cost;
        for &v in ring.iter().chain(&[from, into]) {
            let at = self.rank_at[v as usize];
            rank = if at > rank { at } else { rank };
        }
        self.rank_at[into as usize] = rank;
        self.ranks.push(rank);
    }

    #[inline(always)]
    pub(super) fn push(&mut self, collapse: Collapse, triangles_left: usize) {
        self.collapses.push(collapse);
        self.triangle_counts.push(triangles_left);
    }

    /// The wedge merges of the collapse just pushed.
    pub(super) fn push_merges(&mut self, merges: &[(u32, u32)]) {
        if let Some(last) = self.collapses.last() {
            self.wedge_merges.push(self.collapses.len() - 1, (last.from, last.into), merges);
        }
    }

    /// The finished sequence: in order of rank if there are ranks, errors as a running maximum.
    pub(super) fn finish(
        self,
        (vertex_of_wedge, duplicates): (Vec<u32>, Vec<(u32, u32)>),
        initial_triangle_count: usize,
        (stop_reason, blockers): (StopReason, Blockers),
        fitted: Vec<(u32, [f32; 3])>,
    ) -> CollapseSequence {
        let mut sequence = CollapseSequence {
            collapses: self.collapses,
            triangle_counts: self.triangle_counts,
            wedge_merges: self.wedge_merges,
            vertex_of_wedge,
            duplicates,
            initial_triangle_count,
            stop_reason,
            blockers,
            fitted,
            solved: self.solved,
        };
        if !self.rank_at.is_empty() {
            let mut order: Vec<(u32, u32)> = self.ranks.iter().zip(0..).map(|(rank, i)| (rank.to_bits(), i)).collect();
            order.sort_unstable();
            reorder(&mut sequence, order.into_iter().map(|(_, i)| i as usize));
        }
        sequence.collapses.shrink_to_fit();
        let mut worst = 0.0_f32;
        for collapse in &mut sequence.collapses {
            worst = worst.max(collapse.error);
            collapse.error = worst;
        }
        sequence
    }
}

fn reorder(sequence: &mut CollapseSequence, order: impl Iterator<Item = usize>) {
    let mut left = sequence.initial_triangle_count;
    let mut collapses = Vec::with_capacity(sequence.collapses.len());
    let mut counts = TriangleCounts::new(left);
    let mut merges = WedgeMerges::default();
    let mut values = Vec::with_capacity(sequence.solved.values.len());
    for i in order {
        let collapse = sequence.collapses[i];
        if let Some(unusual) = sequence.wedge_merges.unusual(i) {
            merges.push(collapses.len(), (collapse.from, collapse.into), unusual);
        }
        let components = sequence.solved.components;
        let [first, end] = [i, i + 1].map(|i| sequence.wedge_merges.count_before(i) * components);
        values.extend_from_slice(&sequence.solved.values[first..end]);
        left -= sequence.triangle_counts.after(i) - sequence.triangle_counts.after(i + 1);
        collapses.push(collapse);
        counts.push(left);
    }
    sequence.collapses = collapses;
    sequence.triangle_counts = counts;
    sequence.wedge_merges = merges;
    sequence.solved.values = values;
}
