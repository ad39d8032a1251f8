//! The memoryless quadric: squared distance to the planes of a vertex's current one-ring.
//!
//! Lindstrom & Turk (1998) recompute the quadric of Garland & Heckbert (1997) from the mesh as it
//! stands instead of accumulating it. Every plane of the one-ring passes through the vertex, so
//! relative to the vertex `b` and `c` vanish and only the symmetric 3×3 matrix `A` is left:
//! Q(v + d) = dᵀ A d, with A = Σ area · n nᵀ. Being relative to its own vertex it keeps its
//! precision far from the origin, in `f32`.

use std::ops::{Add, AddAssign, Mul, Sub, SubAssign};

use super::lanes::{Lanes, Lanes3, Mask, WIDTH};

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

/// A vertex's position and quadric in three registers: x y z xx | xy xz yy yz | zz gx gy gz.
#[derive(Debug, Clone, Copy)]
pub(super) struct Packed(pub(super) [Lanes; 3]);

impl Packed {
    /// A position without a quadric.
    pub(super) fn at(p: Vec3) -> Self {
        let zero = Lanes::splat(0.0);
        Self([Lanes::new([p.x, p.y, p.z, 0.0]), zero, zero])
    }

    #[inline(always)]
    pub(super) fn position(&self) -> Vec3 {
        let row = self.0[0];
        Vec3 { x: row.lane::<0>(), y: row.lane::<1>(), z: row.lane::<2>() }
    }

    #[inline(always)]
    pub(super) fn set_position(&mut self, p: Vec3) {
        self.0[0] = Lanes::new([p.x, p.y, p.z, self.0[0].lane::<3>()]);
    }

    #[inline(always)]
    pub(super) fn quadric(&self) -> Quadric {
        let [[_, _, _, xx], [xy, xz, yy, yz], [zz, x, y, z]] = self.0.map(Lanes::to_array);
        Quadric { xx, xy, xz, yy, yz, zz, g: Vec3 { x, y, z } }
    }

    #[inline(always)]
    pub(super) fn set_quadric(&mut self, q: &Quadric) {
        let Vec3 { x, y, z } = self.position();
        self.0 = [
            Lanes::new([x, y, z, q.xx]),
            Lanes::new([q.xy, q.xz, q.yy, q.yz]),
            Lanes::new([q.zz, q.g.x, q.g.y, q.g.z]),
        ];
    }

    /// Adds a difference of quadrics, whose first three lanes are 0.
    #[inline(always)]
    pub(super) fn add(&mut self, difference: &[Lanes; 3]) {
        for (row, &difference) in self.0.iter_mut().zip(difference) {
            *row = *row + difference;
        }
    }
}

impl Quadric {
    /// As a difference for [`Packed::add`].
    #[inline(always)]
    pub(super) fn packed(&self) -> [Lanes; 3] {
        let Self { xx, xy, xz, yy, yz, zz, g } = *self;
        [Lanes::new([0.0, 0.0, 0.0, xx]), Lanes::new([xy, xz, yy, yz]), Lanes::new([zz, g.x, g.y, g.z])]
    }
}

/// Four vertices or quadrics side by side.
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

    /// Positions and quadrics of four vertices.
    #[inline(always)]
    pub(super) fn gather(v: [&Packed; WIDTH]) -> (Lanes3, Self) {
        let [x, y, z, xx] = Lanes::transpose(v.map(|v| v.0[0]));
        let [xy, xz, yy, yz] = Lanes::transpose(v.map(|v| v.0[1]));
        let [zz, gx, gy, gz] = Lanes::transpose(v.map(|v| v.0[2]));
        (Lanes3 { x, y, z }, Self { xx, xy, xz, yy, yz, zz, g: Lanes3 { x: gx, y: gy, z: gz } })
    }

    /// Lanes 1 to 3, then lane 0 of `next`.
    #[inline(always)]
    pub(super) fn followed_by(&self, next: &Self) -> Self {
        Self {
            xx: self.xx.followed_by(next.xx),
            xy: self.xy.followed_by(next.xy),
            xz: self.xz.followed_by(next.xz),
            yy: self.yy.followed_by(next.yy),
            yz: self.yz.followed_by(next.yz),
            zz: self.zz.followed_by(next.zz),
            g: self.g.followed_by(next.g),
        }
    }

    /// The same quadric four times.
    #[inline(always)]
    pub(super) fn splat(q: &Quadric) -> Self {
        let s = Lanes::splat;
        let g = Lanes3 { x: s(q.g.x), y: s(q.g.y), z: s(q.g.z) };
        Self { xx: s(q.xx), xy: s(q.xy), xz: s(q.xz), yy: s(q.yy), yz: s(q.yz), zz: s(q.zz), g }
    }

    /// The matrices of four quadrics; their area vectors are left out.
    pub(super) fn of_matrices(q: [Quadric; WIDTH]) -> Self {
        let lanes = |of: fn(&Quadric) -> f32| Lanes::new([of(&q[0]), of(&q[1]), of(&q[2]), of(&q[3])]);
        Self {
            xx: lanes(|q| q.xx),
            xy: lanes(|q| q.xy),
            xz: lanes(|q| q.xz),
            yy: lanes(|q| q.yy),
            yz: lanes(|q| q.yz),
            zz: lanes(|q| q.zz),
            ..Self::zero()
        }
    }

    /// As [`Quadric::of_triangle`], for four.
    #[inline(always)]
    pub(super) fn of_triangles(n: Lanes3) -> Self {
        let length = n.dot(n).sqrt();
        // A triangle of no area has no weight: 0 · (1 / tiny) and not 0 / 0.
        let m = n.scale(Lanes::splat(1.0) / length.max(Lanes::splat(f32::MIN_POSITIVE)));
        Self { xx: m.x * n.x, xy: m.x * n.y, xz: m.x * n.z, yy: m.y * n.y, yz: m.y * n.z, zz: m.z * n.z, g: n }
    }

    /// A·d, per lane.
    #[inline(always)]
    pub(super) fn apply(&self, d: Lanes3) -> Lanes3 {
        Lanes3 {
            x: self.xx * d.x + self.xy * d.y + self.xz * d.z,
            y: self.xy * d.x + self.yy * d.y + self.yz * d.z,
            z: self.xz * d.x + self.yz * d.y + self.zz * d.z,
        }
    }

    /// Each of the four as a difference for [`Packed::add`].
    #[inline(always)]
    pub(super) fn packed(&self) -> [[Lanes; 3]; WIDTH] {
        let zero = Lanes::splat(0.0);
        let a = Lanes::transpose([zero, zero, zero, self.xx]);
        let b = Lanes::transpose([self.xy, self.xz, self.yy, self.yz]);
        let c = Lanes::transpose([self.zz, self.g.x, self.g.y, self.g.z]);
        [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]], [a[3], b[3], c[3]]]
    }

    /// Adds `o` inside the mask.
    #[inline(always)]
    pub(super) fn add_masked(&mut self, o: &Self, mask: Mask) {
        self.xx = self.xx + o.xx.masked(mask);
        self.xy = self.xy + o.xy.masked(mask);
        self.xz = self.xz + o.xz.masked(mask);
        self.yy = self.yy + o.yy.masked(mask);
        self.yz = self.yz + o.yz.masked(mask);
        self.zz = self.zz + o.zz.masked(mask);
        self.g = Lanes3 {
            x: self.g.x + o.g.x.masked(mask),
            y: self.g.y + o.g.y.masked(mask),
            z: self.g.z + o.g.z.masked(mask),
        };
    }

    /// Adds the matrix of `o` and not its area vectors.
    #[inline(always)]
    pub(super) fn add(&mut self, o: &Self) {
        self.xx = self.xx + o.xx;
        self.xy = self.xy + o.xy;
        self.xz = self.xz + o.xz;
        self.yy = self.yy + o.yy;
        self.yz = self.yz + o.yz;
        self.zz = self.zz + o.zz;
    }

    /// Subtracts a bᵀ, which is symmetric, from the matrix.
    #[inline(always)]
    pub(super) fn subtract_outer(&mut self, a: Lanes3, b: Lanes3) {
        self.xx = self.xx - a.x * b.x;
        self.xy = self.xy - a.x * b.y;
        self.xz = self.xz - a.x * b.z;
        self.yy = self.yy - a.y * b.y;
        self.yz = self.yz - a.y * b.z;
        self.zz = self.zz - a.z * b.z;
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

    /// The sum over the four lanes.
    #[inline(always)]
    pub(super) fn sum(&self) -> Quadric {
        let [a, b, c, d] = self.packed();
        let row = |k: usize| (a[k] + b[k]) + (c[k] + d[k]);
        Packed([row(0), row(1), row(2)]).quadric()
    }
}
