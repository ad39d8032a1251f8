//! The record of a run while it is made, and its order at the end.
//!
//! A collapse depends only on what happened in its ring before. Its *rank* is its cost, or the
//! highest rank in its ring if that is higher, so the record may be put in the order of the ranks
//! afterwards: the coarse, spatial order of the sweeps leaves no trace, and every level is as good
//! as if it had been the target.

use crate::collapse_sequence::{Collapse, CollapseSequence, StopReason};

/// Collapses in the order they are done.
#[derive(Debug, Default)]
pub(super) struct Record {
    collapses: Vec<Collapse>,
    wedge_merges: Vec<(u32, u32)>,
    wedge_merge_ends: Vec<u32>,
    /// Triangles left after each collapse.
    triangle_counts: Vec<u32>,
    /// Rank of each collapse, and of the last one at each vertex; empty when only the end matters.
    ranks: Vec<f32>,
    rank_at: Vec<f32>,
}

impl Record {
    /// For up to `collapses` entries; with ranks of `vertices` if every level matters.
    pub(super) fn new(collapses: usize, vertices: usize, every_level: bool) -> Self {
        Self {
            collapses: Vec::with_capacity(collapses),
            triangle_counts: Vec::with_capacity(collapses),
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
        self.triangle_counts.push(triangles_left as u32);
    }

    /// The wedge merges of the collapse just pushed.
    pub(super) fn push_merges(&mut self, merges: &[(u32, u32)]) {
        self.wedge_merges.extend_from_slice(merges);
        self.wedge_merge_ends.push(self.wedge_merges.len() as u32);
    }

    /// The finished sequence: in order of rank if there are ranks, errors as a running maximum.
    pub(super) fn finish(
        self,
        vertex_of_wedge: Vec<u32>,
        initial_triangle_count: usize,
        stop_reason: StopReason,
        fitted: Vec<(u32, [f32; 3])>,
    ) -> CollapseSequence {
        let mut sequence = CollapseSequence {
            collapses: self.collapses,
            wedge_merges: self.wedge_merges,
            wedge_merge_ends: self.wedge_merge_ends,
            triangle_counts: self.triangle_counts,
            vertex_of_wedge,
            initial_triangle_count,
            stop_reason,
            fitted,
        };
        if !self.rank_at.is_empty() {
            let mut order: Vec<(u32, u32)> = self.ranks.iter().zip(0..).map(|(rank, i)| (rank.to_bits(), i)).collect();
            order.sort_unstable();
            reorder(&mut sequence, order.into_iter().map(|(_, i)| i as usize));
        }
        let mut worst = 0.0_f32;
        for collapse in &mut sequence.collapses {
            worst = worst.max(collapse.error);
            collapse.error = worst;
        }
        sequence
    }
}

fn reorder(sequence: &mut CollapseSequence, order: impl Iterator<Item = usize>) {
    let mut left = sequence.initial_triangle_count as u32;
    let mut collapses = Vec::with_capacity(sequence.collapses.len());
    let mut counts = Vec::with_capacity(sequence.collapses.len());
    let mut merges = Vec::with_capacity(sequence.wedge_merges.len());
    let mut ends = Vec::with_capacity(sequence.wedge_merge_ends.len());
    for i in order {
        collapses.push(sequence.collapses[i]);
        let before = if i == 0 { sequence.initial_triangle_count as u32 } else { sequence.triangle_counts[i - 1] };
        left -= before - sequence.triangle_counts[i];
        counts.push(left);
        if let Some(&end) = sequence.wedge_merge_ends.get(i) {
            let start = if i == 0 { 0 } else { sequence.wedge_merge_ends[i - 1] };
            merges.extend_from_slice(&sequence.wedge_merges[start as usize..end as usize]);
            ends.push(merges.len() as u32);
        }
    }
    sequence.collapses = collapses;
    sequence.triangle_counts = counts;
    sequence.wedge_merges = merges;
    sequence.wedge_merge_ends = ends;
}
