//! Placement: where the merged vertex of an edge goes, and what that costs.
//!
//! The solved position minimises the sum of both ends' quadrics about the edge's midpoint, then
//! moves along A⁻¹g until the enclosed volume is kept (Lindstrom & Turk 1998, section 3.2).
//! `A + λ tr(A) I` makes every system solvable: in flat or straight surroundings the solution
//! slides towards the midpoint instead of running away. The edges of a vertex are solved four at
//! a time.

use super::attributes::Mismatch;
use super::lanes::{Lanes, Lanes3};
use super::quadric::{QuadricLanes, Vec3};

/// λ. On six models at 10, 2 and 0.5 % the root-mean-square error was 0.417, 0.420 and 0.439 of
/// the reference for 1e-6, 1e-8 and 1e-3. Below about 1e-6 the rounding of `f32` takes over.
const REGULARISATION: f32 = 2e-6;

/// How far from the midpoint, in half edges squared, a solved position may be: two edges.
const REACH: f32 = 16.0;

/// κ of [`stiffened`].
const TIP_STIFFNESS: f32 = 4.0;

/// A position for a merged vertex and its cost.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placement {
    pub(super) position: Vec3,
    /// Squared distance times area.
    pub(super) cost: f32,
}

/// Four placements side by side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placements {
    pub(super) position: Lanes3,
    pub(super) cost: Lanes,
}

impl Placements {
    /// No edge at all.
    pub(super) fn none() -> Self {
        Self { position: Lanes3::splat(Vec3::ZERO), cost: Lanes::splat(f32::INFINITY) }
    }

    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Placement {
        let Lanes3 { x, y, z } = self.position;
        let at = |lanes: Lanes| lanes.to_array()[lane];
        Placement { position: Vec3 { x: at(x), y: at(y), z: at(z) }, cost: at(self.cost) }
    }

    pub(super) fn scale_cost(&mut self, lane: usize, factor: f32) {
        let mut costs = self.cost.to_array();
        costs[lane] *= factor;
        self.cost = Lanes::new(costs);
    }

    pub(super) fn set(&mut self, lane: usize, placement: Placement) {
        let Vec3 { x, y, z } = placement.position;
        for (lanes, value) in [
            (&mut self.position.x, x),
            (&mut self.position.y, y),
            (&mut self.position.z, z),
            (&mut self.cost, placement.cost),
        ] {
            let mut values = lanes.to_array();
            values[lane] = value;
            *lanes = Lanes::new(values);
        }
    }
}

/// The best free position of each of the edges from `u` (quadric `qu`) to the `v` (`qv`):
/// minimises (x+h)ᵀAᵤ(x+h) + (x−h)ᵀAᵥ(x−h) subject to the volume constraint, with x relative to
/// the edge's midpoint and h half the edge. `a` and `b` are better [`stiffened`] if they are of
/// planes alone.
#[inline(always)]
pub(super) fn solve(u: Lanes3, a: &QuadricLanes, v: Lanes3, b: &QuadricLanes) -> Placements {
    solve_with(u, a, v, b, &())
}

/// What a cost has beside the quadrics of the two ends: xᵀ M x + 2 r·x + c, with x relative to the
/// midpoint. Nothing at all, `()`, costs nothing.
pub(super) trait Beside {
    /// Adds M.
    fn add_matrix(&self, to: [Lanes; 6]) -> [Lanes; 6];
    /// `right` less r.
    fn pull(&self, right: Lanes3) -> Lanes3;
    /// `cost` and all three terms at `x`, which may take from it.
    fn add_cost(&self, cost: Lanes, x: Lanes3) -> Lanes;
}

impl Beside for () {
    #[inline(always)]
    fn add_matrix(&self, to: [Lanes; 6]) -> [Lanes; 6] {
        to
    }
    #[inline(always)]
    fn pull(&self, right: Lanes3) -> Lanes3 {
        right
    }
    #[inline(always)]
    fn add_cost(&self, cost: Lanes, _: Lanes3) -> Lanes {
        cost
    }
}

impl Beside for Mismatch {
    #[inline(always)]
    fn add_matrix(&self, [xx, xy, xz, yy, yz, zz]: [Lanes; 6]) -> [Lanes; 6] {
        let m = &self.matrix;
        [xx + m.xx, xy + m.xy, xz + m.xz, yy + m.yy, yz + m.yz, zz + m.zz]
    }
    #[inline(always)]
    fn pull(&self, right: Lanes3) -> Lanes3 {
        right - self.linear
    }
    #[inline(always)]
    fn add_cost(&self, cost: Lanes, x: Lanes3) -> Lanes {
        let twice = self.linear + self.linear;
        cost + (x.dot(self.matrix.apply(x)) + twice.dot(x) + self.constant)
    }
}

/// As [`solve`], with more to the cost.
#[inline(always)]
pub(super) fn solve_with(u: Lanes3, a: &QuadricLanes, v: Lanes3, b: &QuadricLanes, beside: &impl Beside) -> Placements {
    let h = (v - u).scale(Lanes::splat(0.5));
    let (gu, gv) = (a.g, b.g);
    let r = (a.xx + b.xx + a.yy + b.yy + a.zz + b.zz) * Lanes::splat(REGULARISATION);
    let sum = beside.add_matrix([a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz]);
    let right = beside.pull(b.apply(h) - a.apply(h));
    let x = minimum(sum, r, right, (gu + gv, (gv - gu).dot(h)), h.dot(h) * Lanes::splat(REACH));
    let (from_u, from_v) = (x + h, x - h);
    let cost = beside.add_cost(from_u.dot(a.apply(from_u)) + from_v.dot(b.apply(from_v)), x);
    Placements { position: u + from_u, cost: cost.max(Lanes::splat(0.0)) }
}

/// As [`solve`] for the three corners of each of four triangles, about their centroids.
#[inline(always)]
pub(super) fn solve_three(p: [Lanes3; 3], q: [&QuadricLanes; 3]) -> Placements {
    let centre = (p[0] + p[1] + p[2]).scale(Lanes::splat(1.0 / 3.0));
    let d = p.map(|p| p - centre);
    let all = |of: fn(&QuadricLanes) -> Lanes| of(q[0]) + of(q[1]) + of(q[2]);
    let sum = [all(|q| q.xx), all(|q| q.xy), all(|q| q.xz), all(|q| q.yy), all(|q| q.yz), all(|q| q.zz)];
    let r = (sum[0] + sum[3] + sum[5]) * Lanes::splat(REGULARISATION);
    let right = q[0].apply(d[0]) + q[1].apply(d[1]) + q[2].apply(d[2]);
    let volume = q[0].g.dot(d[0]) + q[1].g.dot(d[1]) + q[2].g.dot(d[2]);
    let reach = d[0].dot(d[0]).max(d[1].dot(d[1])).max(d[2].dot(d[2])) * Lanes::splat(REACH);
    let x = minimum(sum, r, right, (q[0].g + q[1].g + q[2].g, volume), reach);
    let [from_0, from_1, from_2] = d.map(|d| x - d);
    let cost = from_0.dot(q[0].apply(from_0)) + from_1.dot(q[1].apply(from_1)) + from_2.dot(q[2].apply(from_2));
    Placements { position: centre + x, cost: cost.max(Lanes::splat(0.0)) }
}

/// The least of xᵀ S x − 2 right·x with S = `sum` + `r` I, then moved along S⁻¹g until g·x is the volume's term. No farther
/// from 0 than the root of `limit`.
#[inline(always)]
fn minimum(
    [xx, xy, xz, yy, yz, zz]: [Lanes; 6],
    r: Lanes,
    right: Lanes3,
    (g, volume): (Lanes3, Lanes),
    limit: Lanes,
) -> Lanes3 {
    // S = L D Lᵀ. Its true pivots are at least r; rounding may not push them below.
    let least = r * Lanes::splat(0.5);
    let one = Lanes::splat(1.0);
    let inverse_d1 = one / (xx + r);
    let (l21, l31) = (xy * inverse_d1, xz * inverse_d1);
    let inverse_d2 = one / (yy + r - l21 * xy).max(least);
    let m32 = yz - l31 * xy;
    let l32 = m32 * inverse_d2;
    let inverse_d3 = one / (zz + r - l31 * xz - l32 * m32).max(least);
    let solve = |w: Lanes3| {
        let y = w.y - l21 * w.x;
        let z = (w.z - l31 * w.x - l32 * y) * inverse_d3;
        let y = y * inverse_d2 - l32 * z;
        Lanes3 { x: w.x * inverse_d1 - l21 * y - l31 * z, y, z }
    };
    let free = solve(right);
    let along = solve(g);
    // Without any curvature this is NaN and the selection below falls back.
    let kept = free + along.scale((volume - g.dot(free)) / g.dot(along));
    let zero = Lanes::splat(0.0);
    let none = Lanes3 { x: zero, y: zero, z: zero };
    let free = Lanes3::select(free.dot(free).at_most(limit), free, none);
    Lanes3::select(kept.dot(kept).at_most(limit), kept, free)
}

/// The quadric, and the squared distance to its vertex as far as the vertex is a tip.
///
/// The planes around the tip of a thorn or at the rim of a thin sheet all run nearly along it, so
/// that they hardly tell when it is cut off, and a memoryless quadric never learns. But their area
/// vectors cancel: with s = 1 − |Σ area vectors| / Σ areas, which is 0 on a plane, 0.3 on a right
/// angle's crease and near 1 at a tip, κ s⁸ Σ areas · |d|² is added. On six models at five targets
/// the maximum fell from 0.764 of the reference's to 0.718 and the root-mean-square error from
/// 0.416 to 0.412; s⁴ and s² also stiffen creases, which costs more than it saves.
#[inline(always)]
pub(super) fn stiffened(q: &QuadricLanes) -> QuadricLanes {
    let (zero, one) = (Lanes::splat(0.0), Lanes::splat(1.0));
    let areas = q.xx + q.yy + q.zz;
    let s = (one - q.g.dot(q.g).sqrt() / areas.max(Lanes::splat(f32::MIN_POSITIVE))).max(zero);
    let s2 = s * s;
    let s4 = s2 * s2;
    let stiffness = areas * s4 * s4 * Lanes::splat(TIP_STIFFNESS);
    QuadricLanes { xx: q.xx + stiffness, yy: q.yy + stiffness, zz: q.zz + stiffness, ..*q }
}

#[cfg(test)]
mod tests {
    use super::super::quadric::Quadric;
    use super::*;

    fn solve(u: Vec3, qu: &Quadric, v: Vec3, qv: &Quadric) -> Placement {
        let found =
            super::solve(Lanes3::splat(u), &QuadricLanes::splat(qu), Lanes3::splat(v), &QuadricLanes::splat(qv));
        let Lanes3 { x, y, z } = found.position;
        Placement {
            position: Vec3 { x: x.lane::<0>(), y: y.lane::<1>(), z: z.lane::<2>() },
            cost: found.cost.lane::<3>(),
        }
    }

    fn v(x: f32, y: f32, z: f32) -> Vec3 {
        Vec3 { x, y, z }
    }

    #[test]
    fn a_corner_of_three_planes_is_found() {
        // u sees the planes x = 1 and y = 0, v the plane z = 2: they meet in (1, 0, 2).
        let (u, w) = (v(1.0, 0.0, 0.0), v(2.0, 1.0, 2.0));
        let qu = Quadric::of_triangle(v(1.0, 0.0, 0.0)) + Quadric::of_triangle(v(0.0, 1.0, 0.0));
        let qv = Quadric::of_triangle(v(0.0, 0.0, 1.0));
        let found = solve(u, &qu, w, &qv);
        assert!((found.position - v(1.0, 0.0, 2.0)).length_squared() < 1e-4, "{found:?}");
        assert!(found.cost < 1e-3);
    }

    #[test]
    fn in_a_plane_the_midpoint_is_taken() {
        let q = Quadric::of_triangle(v(0.0, 0.0, 1.0));
        let found = solve(v(0.0, 0.0, 5.0), &q, v(2.0, 0.0, 5.0), &q);
        assert!((found.position - v(1.0, 0.0, 5.0)).length_squared() < 1e-10, "{found:?}");
    }
}
