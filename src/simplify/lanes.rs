//! Four `f32` at once, in plain arrays that the compiler turns into one SIMD register.
//!
//! No intrinsics and no `unsafe`: with simd128 or SSE the operators below become single
//! instructions, without them they are four scalar ones with the same result bit for bit.

use std::ops::{Add, Div, Mul, Sub};

use super::quadric::Vec3;

/// Number of lanes.
pub(super) const WIDTH: usize = 4;

/// Four independent numbers.
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub(super) struct Lanes(pub(super) [f32; WIDTH]);

impl Lanes {
    #[inline(always)]
    pub(super) fn splat(value: f32) -> Self {
        Self([value; WIDTH])
    }

    #[inline(always)]
    pub(super) fn max(self, o: Self) -> Self {
        o.select_within(self, self, o)
    }

    /// Per lane: `then` where `self` ≤ `limit`, `other` where it is larger or NaN. By bit masks,
    /// which the compiler keeps in one register; branches it would take apart.
    #[inline(always)]
    pub(super) fn select_within(self, limit: Self, then: Self, other: Self) -> Self {
        let masks = self.at_most(limit);
        let pick = |k: usize| f32::from_bits((then.0[k].to_bits() & masks[k]) | (other.0[k].to_bits() & !masks[k]));
        Self([pick(0), pick(1), pick(2), pick(3)])
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                let (a, b) = (self.0, o.0);
                Self([a[0] $op b[0], a[1] $op b[1], a[2] $op b[2], a[3] $op b[3]])
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Lanes {
    /// Per lane.
    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        let a = self.0;
        Self([a[0].sqrt(), a[1].sqrt(), a[2].sqrt(), a[3].sqrt()])
    }

    /// Per lane: all ones where `self` ≤ `o`, zero where it is larger or NaN.
    #[inline(always)]
    pub(super) fn at_most(self, o: Self) -> [u32; WIDTH] {
        let mask = |k: usize| u32::from(self.0[k] <= o.0[k]).wrapping_neg();
        [mask(0), mask(1), mask(2), mask(3)]
    }
}

/// Four vectors of three.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lanes3 {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    pub(super) z: Lanes,
}

impl Lanes3 {
    /// Four vectors side by side.
    #[inline(always)]
    pub(super) fn gather(v: [Vec3; WIDTH]) -> Self {
        Self { x: Lanes(v.map(|v| v.x)), y: Lanes(v.map(|v| v.y)), z: Lanes(v.map(|v| v.z)) }
    }

    #[inline(always)]
    pub(super) fn cross(self, o: Self) -> Self {
        Self { x: self.y * o.z - self.z * o.y, y: self.z * o.x - self.x * o.z, z: self.x * o.y - self.y * o.x }
    }

    #[inline(always)]
    pub(super) fn dot(self, o: Self) -> Lanes {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    #[inline(always)]
    pub(super) fn scale(self, s: Lanes) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }

    /// As [`Lanes::select_within`], per lane for all three coordinates.
    #[inline(always)]
    pub(super) fn select_within(value: Lanes, limit: Lanes, then: Self, other: Self) -> Self {
        Self {
            x: value.select_within(limit, then.x, other.x),
            y: value.select_within(limit, then.y, other.y),
            z: value.select_within(limit, then.z, other.z),
        }
    }
}

impl Add for Lanes3 {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl Sub for Lanes3 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}
