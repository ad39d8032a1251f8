//! The maximum between the samples: from the farthest of them to where the distance is largest.
//!
//! A sampled maximum is a lower bound, and low where the distance peaks on a small spot: on a crease
//! that a triangle cuts off, or half-way between two sheets. Such a spot is near samples that are
//! far away, because the distance of a point cannot change faster than the point moves. Those
//! samples are kept; from each the steepest of eight steps in the plane of its triangle is taken as
//! long as one leads farther away, then half the step is tried (pattern search, Hooke & Jeeves 1961).

use std::f64::consts::FRAC_1_SQRT_2;

use super::bvh::{Bvh, Nearest};
use super::triangle::{Point, along, closest_weights, length, point_at, tangents};

/// Samples in a row on one triangle, which are near each other, of which the farthest stands for all.
const GROUP: u32 = 32;

/// What a sample's distance has to be of the maximum to be kept. A quarter finds nothing more.
const NEAR_MAXIMUM: f64 = 0.5;

/// Candidates of one side at most.
const MOST_CANDIDATES: usize = 1024;

/// A climb ends where not even so many of its steps, straight away from the other surface, would
/// lead beyond the maximum: shorter ones follow.
const STEPS_AHEAD: f64 = 3.0;

/// … or its step is less than this part of the maximum.
const LEAST_STEP: f64 = 1.0 / 512.0;

/// … or so many places were looked at.
const MOST_PLACES: u32 = 400;

/// A place has to be farther than the last by this factor, squared, or rounding alone would lead on
/// over a plane at one distance.
const FARTHER: f64 = 1.0 + 1.0 / (1 << 30) as f64;

/// The steps' directions, in the plane.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-1.0, 0.0],
    [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, -1.0],
    [FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
];

/// A sample to climb from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    /// World units.
    pub(super) distance: f64,
    pub(super) part: usize,
    /// The sample's own triangle, in the order of its surface.
    pub(super) triangle: u32,
    /// The nearest one of the other surface.
    pub(super) nearest: u32,
    /// Local space of the part.
    pub(super) point: Point,
}

/// The farthest samples of one side.
#[derive(Debug, Default)]
pub(super) struct Farthest {
    kept: Vec<Candidate>,
    group: Option<Candidate>,
    in_group: u32,
}

impl Farthest {
    /// Takes a sample in. `max` is the largest distance so far, this one's included.
    pub(super) fn offer(&mut self, sample: Candidate, max: f64) {
        match &mut self.group {
            Some(group) if (group.part, group.triangle) == (sample.part, sample.triangle) && self.in_group < GROUP => {
                self.in_group += 1;
                if sample.distance > group.distance {
                    *group = sample;
                }
            }
            group => {
                self.in_group = 1;
                if let Some(last) = group.replace(sample) {
                    self.keep(last, max);
                }
            }
        }
    }

    fn keep(&mut self, candidate: Candidate, max: f64) {
        if candidate.distance > 0.0 && candidate.distance >= max * NEAR_MAXIMUM {
            self.kept.push(candidate);
            if self.kept.len() == 2 * MOST_CANDIDATES {
                self.thin();
            }
        }
    }

    /// Drops all but the farthest; the rest is in the order of distance then.
    fn thin(&mut self) {
        let mut order: Vec<(u32, u32)> =
            self.kept.iter().zip(0..).map(|(candidate, i)| ((candidate.distance as f32).to_bits(), i)).collect();
        order.sort_unstable();
        let least = order.len().saturating_sub(MOST_CANDIDATES);
        self.kept = order[least..].iter().map(|&(_, i)| self.kept[i as usize]).collect();
    }

    /// The candidates for the maximum that all samples led to, the nearest to the other surface first.
    pub(super) fn finish(mut self, max: f64) -> Vec<Candidate> {
        if let Some(last) = self.group.take() {
            self.keep(last, max);
        }
        self.thin();
        self.kept.retain(|candidate| candidate.distance >= max * NEAR_MAXIMUM);
        self.kept
    }
}

/// Where a climb ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    pub(super) point: Point,
    pub(super) nearest: Nearest,
    /// How many places were looked at on the way, and nodes of the tree for them.
    pub(super) places: u32,
    pub(super) nodes: u32,
}

/// Climbs from a candidate on its triangle, which has an area. `step` is the first step and `max` the
/// largest distance known, both in local units.
pub(super) fn climb(from: &Candidate, corners: &[[f32; 3]; 3], other: &Bvh, step: f64, max: f64) -> Peak {
    let [u, v] = tangents(corners);
    let nearest = nearest_of(other, from.point, from.nearest);
    let mut peak = Peak { point: from.point, nearest, places: 1, nodes: nearest.nodes };
    // Few samples may be farther apart than the triangle is long.
    let longest = (0..3).map(|k| length(corners[k], corners[(k + 1) % 3])).fold(0.0, f64::max);
    let mut step = step.min(longest);
    while step > max * LEAST_STEP
        && peak.places < MOST_PLACES
        && peak.nearest.distance_squared.sqrt() + STEPS_AHEAD * step > max
    {
        let start = peak;
        for [s, t] in DIRECTIONS {
            let moved = along(along(start.point, u, s * step), v, t * step);
            let point = point_at(corners, closest_weights(moved, corners));
            let nearest = nearest_of(other, point, peak.nearest.triangle);
            peak.places += 1;
            peak.nodes += nearest.nodes;
            if nearest.distance_squared > peak.nearest.distance_squared * FARTHER {
                (peak.point, peak.nearest) = (point, nearest);
            }
        }
        if peak.nearest.distance_squared == start.nearest.distance_squared {
            step *= 0.5;
        }
    }
    peak
}

/// A call, so that the long loop of the query is there once for all climbs.
#[inline(never)]
fn nearest_of(other: &Bvh, point: Point, hint: u32) -> Nearest {
    other.nearest(point, hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(distance: f64, triangle: u32) -> Candidate {
        Candidate { distance, part: 0, triangle, nearest: 0, point: [distance, 0.0, 0.0] }
    }

    fn kept(samples: impl IntoIterator<Item = Candidate>) -> Vec<f64> {
        let (mut farthest, mut max) = (Farthest::default(), 0.0_f64);
        for sample in samples {
            max = max.max(sample.distance);
            farthest.offer(sample, max);
        }
        farthest.finish(max).iter().map(|candidate| candidate.distance).rev().collect()
    }

    #[test]
    fn of_samples_in_a_row_on_a_triangle_the_farthest_is_kept() {
        assert_eq!(kept([sample(3.0, 0), sample(4.0, 0), sample(2.0, 0), sample(3.0, 1)]), [4.0, 3.0]);
        let long = (0..100).map(|k| sample(100.0 + f64::from(k), 0));
        assert_eq!(kept(long), [199.0, 195.0, 163.0, 131.0]);
    }

    #[test]
    fn what_is_far_below_the_maximum_is_dropped_whenever_that_comes() {
        assert_eq!(kept([sample(1.0, 0), sample(3.0, 1), sample(1.4, 2), sample(1.6, 3)]), [3.0, 1.6]);
        assert_eq!(kept([sample(0.0, 0), sample(0.0, 1)]), [0.0; 0]);
    }

    #[test]
    fn many_candidates_are_thinned_to_the_farthest() {
        let distance = |k: u32| 1.0 + f64::from(k.wrapping_mul(0x9e37_79b9) >> 8) / f64::from(1 << 24);
        let all = kept((0..50_000).map(|k| sample(distance(k), k)));
        let mut expected: Vec<f64> = (0..50_000).map(distance).collect();
        expected.sort_by(|a, b| b.total_cmp(a));
        assert!(all.iter().zip(&expected[..MOST_CANDIDATES]).all(|(a, b)| (a - b).abs() < 1e-6));
        assert_eq!(all.len(), MOST_CANDIDATES);
    }
}
