//! The nearest triangle of a set: a tree of boxes, four to a node, with no pointers in it.
//!
//! The triangles are put in an order in which every aligned block of 4ᵏ of them is compact, by
//! splitting at multiples of a power of two along the longest axis; then node *i* of a level has
//! the nodes 4*i* to 4*i* + 3 of the level below as its children, and a query needs a stack of
//! three entries a level. The four boxes of a node are tested at once in lanes of `f32`, with
//! bounds that never exceed the exact distance; triangles are tested exactly, in `f64`. So the
//! smallest distance does not depend on where a query starts, and is the same everywhere.

use super::triangle::{Point, distance_squared, wide};
use crate::simplify::lanes::Lanes;

/// The boxes of four nodes, or of four triangles, by axis; an absent one is inside out.
#[derive(Debug, Clone, Copy)]
struct Quad {
    low: [Lanes; 3],
    high: [Lanes; 3],
}

/// The boxes of a node while they are found.
struct Boxes {
    low: [[f32; 4]; 3],
    high: [[f32; 4]; 3],
}

const EMPTY: Boxes = Boxes { low: [[f32::INFINITY; 4]; 3], high: [[f32::NEG_INFINITY; 4]; 3] };

impl Boxes {
    fn quad(&self) -> Quad {
        Quad { low: self.low.map(Lanes::new), high: self.high.map(Lanes::new) }
    }
}

/// Enough for any number of triangles that a `u32` can count: 4¹⁶.
const MOST_LEVELS: usize = 16;

/// Triangles whose blocks are split in one step: far more than the step itself costs, and far
/// less than can be noticed.
const AT_ONCE: usize = 1024;

/// How far a bound computed in `f32` may be above the exact one: half a dozen roundings.
const ROUNDING: f64 = 1.0 + 1.0 / (1 << 20) as f64;

/// A tree over the triangles of one surface.
#[derive(Debug, Default)]
pub(super) struct Bvh {
    corners: Vec<[[f32; 3]; 3]>,
    /// All levels, the lowest (boxes of triangles) first.
    quads: Vec<Quad>,
    /// Index in `quads` of each level's first node.
    level_starts: Vec<usize>,
    /// Box units in a local unit: the power of two that brings every coordinate below 1.
    unit: f64,
}

/// The nearest triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    /// Squared local units.
    pub(super) distance_squared: f64,
    /// Index in the tree's order: the hint for a query nearby.
    pub(super) triangle: u32,
    /// How many nodes were looked at.
    pub(super) nodes: u32,
}

/// The order of the triangles while it is found, in steps.
#[derive(Debug)]
pub(super) struct Ordering {
    items: Vec<Item>,
    /// Blocks of this many are being split in two.
    span: usize,
    next: usize,
}

#[derive(Debug, Clone, Copy)]
struct Item {
    /// Three times the centroid, in units in which that cannot overflow.
    centre: [f32; 3],
    triangle: u32,
}

impl Ordering {
    pub(super) fn new(corners: &[[[f32; 3]; 3]]) -> Self {
        let items = corners.iter().enumerate().map(|(t, [a, b, c])| {
            let centre = [0, 1, 2].map(|k| a[k] * 0.25 + b[k] * 0.25 + c[k] * 0.25);
            Item { centre, triangle: t as u32 }
        });
        Self { items: items.collect(), span: corners.len().next_power_of_two(), next: 0 }
    }

    /// Splits the next blocks, a few at once when they are small; returns how many triangles they
    /// had, 0 when all is done.
    pub(super) fn step(&mut self) -> usize {
        let mut handled = 0;
        while self.span > 1 && handled < AT_ONCE {
            let start = self.next;
            if start >= self.items.len() {
                self.span /= 2;
                self.next = 0;
                continue;
            }
            self.next = start + self.span;
            let end = self.next.min(self.items.len());
            let block = &mut self.items[start..end];
            if block.len() > self.span / 2 {
                let axis = longest_axis(block);
                // The triangle's number makes the order a total one, and so the same everywhere.
                block.select_nth_unstable_by(self.span / 2, |a, b| {
                    a.centre[axis].total_cmp(&b.centre[axis]).then(a.triangle.cmp(&b.triangle))
                });
                handled += end - start;
            }
        }
        handled
    }

    /// The triangles' numbers in their new order.
    pub(super) fn order(&self) -> impl Iterator<Item = usize> {
        self.items.iter().map(|item| item.triangle as usize)
    }
}

fn longest_axis(items: &[Item]) -> usize {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for item in items {
        for k in 0..3 {
            low[k] = low[k].min(item.centre[k]);
            high[k] = high[k].max(item.centre[k]);
        }
    }
    let extent = |k: usize| high[k] - low[k];
    let longer = if extent(1) > extent(0) { 1 } else { 0 };
    if extent(2) > extent(longer) { 2 } else { longer }
}

impl Bvh {
    /// A tree over `corners`, which are in the order that [`Ordering`] found. `reach` is the
    /// largest magnitude of any coordinate of these triangles or of the points that will be asked.
    pub(super) fn new(corners: Vec<[[f32; 3]; 3]>, reach: f32) -> Self {
        let unit = power_of_two_above(reach).recip();
        let mut quads: Vec<Quad> = Vec::with_capacity(corners.len() / 3 + MOST_LEVELS);
        let mut level_starts = vec![0];
        for four in corners.chunks(4) {
            let mut boxes = EMPTY;
            for (lane, triangle) in four.iter().enumerate() {
                for p in triangle {
                    for (k, &c) in p.iter().enumerate() {
                        let c = (f64::from(c) * unit) as f32;
                        boxes.low[k][lane] = boxes.low[k][lane].min(c);
                        boxes.high[k][lane] = boxes.high[k][lane].max(c);
                    }
                }
            }
            quads.push(boxes.quad());
        }
        let mut below = 0;
        while quads.len() - below > 1 {
            let end = quads.len();
            level_starts.push(end);
            for first in (below..end).step_by(4) {
                let mut boxes = EMPTY;
                for (lane, child) in quads[first..end.min(first + 4)].iter().enumerate() {
                    for k in 0..3 {
                        boxes.low[k][lane] = child.low[k].to_array().into_iter().fold(f32::INFINITY, f32::min);
                        boxes.high[k][lane] = child.high[k].to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
                    }
                }
                quads.push(boxes.quad());
            }
            below = end;
        }
        Self { corners, quads, level_starts, unit }
    }

    pub(super) fn corners(&self) -> &[[[f32; 3]; 3]] {
        &self.corners
    }

    /// The triangle nearest to `point`, of those at the same distance any one. `hint` is where the
    /// search starts: the answer to a point nearby makes it short. The tree must not be empty.
    pub(super) fn nearest(&self, point: Point, hint: u32) -> Nearest {
        let mut best = Nearest {
            distance_squared: distance_squared(point, &self.corners[hint as usize]),
            triangle: hint,
            nodes: 0,
        };
        let probe = Probe::new(point, self.unit);
        let mut limit = probe.limit(best.distance_squared);
        let mut stack = [(0.0_f32, 0_u8, 0_u32); 3 * MOST_LEVELS + 1];
        stack[0] = (0.0, self.level_starts.len() as u8 - 1, 0);
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (bound, level, node) = stack[depth];
            if bound > limit {
                continue;
            }
            best.nodes += 1;
            let bounds = probe.bounds(&self.quads[self.level_starts[level as usize] + node as usize]);
            let near = bounds.at_most(Lanes::splat(limit)).bits();
            let bounds = bounds.to_array();
            if level == 0 {
                for (lane, &bound) in bounds.iter().enumerate() {
                    if near & (1 << lane) == 0 || bound > limit {
                        continue;
                    }
                    let triangle = 4 * node + lane as u32;
                    let squared = distance_squared(point, &self.corners[triangle as usize]);
                    if squared < best.distance_squared {
                        (best.distance_squared, best.triangle) = (squared, triangle);
                        limit = probe.limit(squared);
                    }
                }
                continue;
            }
            // The nearest on top: what it finds rules the others out.
            let first = depth;
            for (lane, &bound) in bounds.iter().enumerate() {
                if near & (1 << lane) == 0 {
                    continue;
                }
                let mut at = depth;
                while at > first && stack[at - 1].0 < bound {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = (bound, level - 1, 4 * node + lane as u32);
                depth += 1;
            }
        }
        best
    }
}

/// A query point in box units.
struct Probe {
    at: [f32; 3],
    /// More than what rounding may have moved the point or a box.
    margin: f32,
    squared_unit: f64,
}

impl Probe {
    #[inline(always)]
    fn new(point: Point, unit: f64) -> Self {
        let at = point.map(|c| (c * unit) as f32);
        let reach = at[0].abs().max(at[1].abs()).max(at[2].abs());
        Self { at, margin: reach / (1 << 22) as f32 + f32::MIN_POSITIVE, squared_unit: unit * unit }
    }

    /// Boxes whose bound is above this hold nothing nearer.
    #[inline(always)]
    fn limit(&self, distance_squared: f64) -> f32 {
        (distance_squared * self.squared_unit * ROUNDING) as f32 + f32::MIN_POSITIVE
    }

    /// Squared distances from the four boxes, from below; infinite for absent ones.
    #[inline(always)]
    fn bounds(&self, quad: &Quad) -> Lanes {
        let (zero, margin) = (Lanes::splat(0.0), Lanes::splat(self.margin));
        let squared = |k: usize| {
            let at = Lanes::splat(self.at[k]);
            let outside = (quad.low[k] - at).max(at - quad.high[k]) - margin;
            let outside = outside.max(zero);
            outside * outside
        };
        squared(0) + squared(1) + squared(2)
    }
}

/// The smallest power of two above `value`, which is finite and not negative; 1 for 0.
fn power_of_two_above(value: f32) -> f64 {
    if value == 0.0 {
        return 1.0;
    }
    // Every f32, subnormal ones too, is a normal f64.
    let exponent = f64::from(value).to_bits() >> 52;
    f64::from_bits((exponent + 1) << 52)
}

/// Length of the diagonal of the triangles' bounding box, local units; 0 if there are none.
pub(super) fn diagonal(corners: &[[[f32; 3]; 3]]) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &p in corners.iter().flatten() {
        let p = wide(p);
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    (0..3).map(|k| (high[k] - low[k]).max(0.0)).map(|extent| extent * extent).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles of very different sizes, some far away, in a fixed disorder.
    fn soup(count: u32) -> Vec<[[f32; 3]; 3]> {
        let mut state = 1_u32;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state as f32 / u32::MAX as f32
        };
        (0..count)
            .map(|t| {
                let size = if t % 7 == 0 { 0.5 } else { 0.02 };
                let away = if t % 31 == 0 { 100.0 } else { 1.0 };
                let centre = [next() * away, next() * away, next()];
                [(); 3].map(|()| centre.map(|c| c + size * next()))
            })
            .collect()
    }

    fn tree(corners: &[[[f32; 3]; 3]], reach: f32) -> Bvh {
        let mut ordering = Ordering::new(corners);
        while ordering.step() > 0 {}
        Bvh::new(ordering.order().map(|t| corners[t]).collect(), reach)
    }

    #[test]
    fn the_nearest_is_the_one_found_by_force_from_whatever_start() {
        for count in [1, 2, 3, 4, 5, 15, 16, 17, 63, 64, 65, 257, 1000] {
            let corners = soup(count);
            let tree = tree(&corners, 200.0);
            for probe in soup(40).into_iter().flatten() {
                let point = wide(probe);
                let expected = corners.iter().map(|t| distance_squared(point, t)).fold(f64::INFINITY, f64::min);
                for hint in [0, count / 2, count - 1] {
                    let nearest = tree.nearest(point, hint);
                    assert_eq!(nearest.distance_squared, expected, "{count} triangles from {hint}");
                    assert_eq!(distance_squared(point, &tree.corners()[nearest.triangle as usize]), expected);
                }
            }
        }
    }

    #[test]
    fn the_order_has_every_triangle_once_and_a_good_start_saves_work() {
        let corners = soup(5000);
        let mut ordering = Ordering::new(&corners);
        let mut steps = 0;
        while ordering.step() > 0 {
            steps += 1;
        }
        assert!(steps > 13, "{steps} steps: it has to be divided");
        let mut order: Vec<usize> = ordering.order().collect();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..5000));

        let tree = tree(&corners, 200.0);
        let point = wide(tree.corners()[1234][0]);
        let answer = tree.nearest(point, 0);
        let (cold, warm) = (answer.nodes, tree.nearest(point, answer.triangle).nodes);
        assert!(warm <= cold && cold < 300, "{cold} nodes, {warm} from the answer");
    }

    #[test]
    fn a_tree_at_any_magnitude_finds_the_same() {
        let corners = soup(300);
        for exponent in [-126, -60, 0, 60, 118] {
            let unit = 2.0_f32.powi(exponent);
            let scaled: Vec<_> = corners.iter().map(|t| t.map(|p| p.map(|c| c * unit))).collect();
            let (plain, tree) = (tree(&corners, 200.0), tree(&scaled, 200.0 * unit));
            for probe in soup(20).into_iter().flatten() {
                let squared = tree.nearest(wide(probe.map(|c| c * unit)), 0).distance_squared;
                let expected = plain.nearest(wide(probe), 0).distance_squared;
                let got = squared / f64::from(unit) / f64::from(unit);
                // Below 2⁻¹²⁶ an f32 has fewer digits.
                assert!((got - expected).abs() <= 1e-5 * expected + 1e-10, "2^{exponent}: {got}, not {expected}");
            }
        }
    }

    #[test]
    fn the_diagonal_is_that_of_the_box() {
        assert_eq!(diagonal(&[[[1.0, 2.0, 3.0], [4.0, 2.0, 3.0], [1.0, 6.0, 3.0]]]), 5.0);
        assert_eq!(diagonal(&[]), 0.0);
    }
}
