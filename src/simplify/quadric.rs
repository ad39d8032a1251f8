//! The memoryless quadric: squared distance to the planes of a vertex's current one-ring.
//!
//! Lindstrom & Turk (1998) recompute the quadric of Garland & Heckbert (1997) from the mesh as it
//! stands instead of accumulating it. Every plane of the one-ring passes through the vertex, so
//! relative to the vertex `b` and `c` vanish and only the symmetric 3×3 matrix `A` is left:
//! Q(v + d) = dᵀ A d, with A = Σ area · n nᵀ. Being relative to its own vertex it keeps its
//! precision far from the origin, in `f32`.

use std::ops::{Add, AddAssign, Mul, Sub, SubAssign};

use super::lanes::{Lanes, Lanes3};

/// The larger of two numbers that are not NaN. `f32::max` heeds NaN, and WebAssembly's own
/// instruction does so differently, so that it becomes a call; this is one comparison.
#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers that are not NaN; see [`larger`].
#[inline(always)]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// A vector of three `f32`; just the operators the simplifier needs.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Vec3 {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) z: f32,
}

impl Vec3 {
    pub(super) const ZERO: Self = Self { x: 0.0, y: 0.0, z: 0.0 };

    #[inline(always)]
    pub(super) fn dot(self, o: Self) -> f32 {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    #[inline(always)]
    pub(super) fn cross(self, o: Self) -> Self {
        Self { x: self.y * o.z - self.z * o.y, y: self.z * o.x - self.x * o.z, z: self.x * o.y - self.y * o.x }
    }

    #[inline(always)]
    pub(super) fn length_squared(self) -> f32 {
        self.dot(self)
    }
}

impl Add for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl AddAssign for Vec3 {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

impl SubAssign for Vec3 {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl Mul<f32> for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f32) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}

/// A symmetric 3×3 matrix `A`, and the area vector sum `g` of the same one-ring.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Quadric {
    pub(super) xx: f32,
    pub(super) xy: f32,
    pub(super) xz: f32,
    pub(super) yy: f32,
    pub(super) yz: f32,
    pub(super) zz: f32,
    /// Σ of the triangles' area vectors: moving the vertex by d changes the enclosed volume by
    /// g·d (up to a constant factor).
    pub(super) g: Vec3,
}

impl Quadric {
    /// The plane of a triangle with area vector `n` (cross product of two edges), weighted by
    /// its area.
    #[inline(always)]
    pub(super) fn of_triangle(n: Vec3) -> Self {
        let length = n.length_squared().sqrt();
        let s = if length > 0.0 { 1.0 / length } else { 0.0 };
        let m = n * s;
        Self { xx: m.x * n.x, xy: m.x * n.y, xz: m.x * n.z, yy: m.y * n.y, yz: m.y * n.z, zz: m.z * n.z, g: n }
    }

    /// Squared distance to the line along `e`, times |e|² · `weight`: holds borders and seams.
    #[inline(always)]
    pub(super) fn of_line(e: Vec3, weight: f32) -> Self {
        let l = e.length_squared();
        Self {
            xx: (l - e.x * e.x) * weight,
            xy: -e.x * e.y * weight,
            xz: -e.x * e.z * weight,
            yy: (l - e.y * e.y) * weight,
            yz: -e.y * e.z * weight,
            zz: (l - e.z * e.z) * weight,
            g: Vec3::ZERO,
        }
    }

    /// A·d.
    #[inline(always)]
    pub(super) fn apply(&self, d: Vec3) -> Vec3 {
        Vec3 {
            x: self.xx * d.x + self.xy * d.y + self.xz * d.z,
            y: self.xy * d.x + self.yy * d.y + self.yz * d.z,
            z: self.xz * d.x + self.yz * d.y + self.zz * d.z,
        }
    }

    /// dᵀ A d: squared distance times area at the offset `d` from the vertex; never negative.
    #[inline(always)]
    pub(super) fn error_at(&self, d: Vec3) -> f32 {
        larger(d.dot(self.apply(d)), 0.0)
    }

    /// The sum of the weights: the trace of a sum of w·n nᵀ.
    #[inline(always)]
    pub(super) fn trace(&self) -> f32 {
        self.xx + self.yy + self.zz
    }
}

impl Add for Quadric {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            xx: self.xx + o.xx,
            xy: self.xy + o.xy,
            xz: self.xz + o.xz,
            yy: self.yy + o.yy,
            yz: self.yz + o.yz,
            zz: self.zz + o.zz,
            g: self.g + o.g,
        }
    }
}

impl AddAssign for Quadric {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Quadric {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self {
            xx: self.xx - o.xx,
            xy: self.xy - o.xy,
            xz: self.xz - o.xz,
            yy: self.yy - o.yy,
            yz: self.yz - o.yz,
            zz: self.zz - o.zz,
            g: self.g - o.g,
        }
    }
}

impl SubAssign for Quadric {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

/// Four quadrics side by side.
#[derive(Debug, Clone, Copy)]
pub(super) struct QuadricLanes {
    pub(super) xx: Lanes,
    pub(super) xy: Lanes,
    pub(super) xz: Lanes,
    pub(super) yy: Lanes,
    pub(super) yz: Lanes,
    pub(super) zz: Lanes,
    pub(super) g: Lanes3,
}

impl QuadricLanes {
    pub(super) fn zero() -> Self {
        let zero = Lanes::splat(0.0);
        let g = Lanes3 { x: zero, y: zero, z: zero };
        Self { xx: zero, xy: zero, xz: zero, yy: zero, yz: zero, zz: zero, g }
    }

    /// As [`Quadric::of_triangle`], for four.
    #[inline(always)]
    pub(super) fn of_triangles(n: Lanes3) -> Self {
        let length = n.dot(n).sqrt();
        // A triangle of no area has no weight: 0 · (1 / tiny) and not 0 / 0.
        let m = n.scale(Lanes::splat(1.0) / length.max(Lanes::splat(f32::MIN_POSITIVE)));
        Self { xx: m.x * n.x, xy: m.x * n.y, xz: m.x * n.z, yy: m.y * n.y, yz: m.y * n.z, zz: m.z * n.z, g: n }
    }

    /// One of the four.
    #[inline(always)]
    pub(super) fn lane(&self, k: usize) -> Quadric {
        Quadric {
            xx: self.xx.0[k],
            xy: self.xy.0[k],
            xz: self.xz.0[k],
            yy: self.yy.0[k],
            yz: self.yz.0[k],
            zz: self.zz.0[k],
            g: Vec3 { x: self.g.x.0[k], y: self.g.y.0[k], z: self.g.z.0[k] },
        }
    }

    /// Adds `weight` times `o`, per lane.
    #[inline(always)]
    pub(super) fn add_weighted(&mut self, o: &Self, weight: Lanes) {
        self.xx = self.xx + o.xx * weight;
        self.xy = self.xy + o.xy * weight;
        self.xz = self.xz + o.xz * weight;
        self.yy = self.yy + o.yy * weight;
        self.yz = self.yz + o.yz * weight;
        self.zz = self.zz + o.zz * weight;
        self.g = self.g + o.g.scale(weight);
    }

    #[inline(always)]
    pub(super) fn minus(&self, o: &Self) -> Self {
        Self {
            xx: self.xx - o.xx,
            xy: self.xy - o.xy,
            xz: self.xz - o.xz,
            yy: self.yy - o.yy,
            yz: self.yz - o.yz,
            zz: self.zz - o.zz,
            g: self.g - o.g,
        }
    }
}
