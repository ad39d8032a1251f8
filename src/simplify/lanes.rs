//! Four `f32` at once: one register where WebAssembly has SIMD, a plain array elsewhere.
//!
//! Both give the same result bit for bit: only operations that IEEE 754 defines exactly, no
//! estimates and nothing fused. No `unsafe`: the array becomes SIMD where the compiler sees it
//! (SSE, NEON), and WebAssembly's intrinsics on registers are safe functions. They are here
//! because the compiler left half of the array version scalar there.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

use super::quadric::Vec3;

/// Number of lanes.
pub(crate) const WIDTH: usize = 4;

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod register {
    use super::WIDTH;
    use core::arch::wasm32 as simd;

    /// Four independent numbers.
    #[derive(Debug, Clone, Copy)]
    #[repr(transparent)]
    pub(crate) struct Lanes(simd::v128);

    /// For each lane all ones or all zeros.
    #[derive(Debug, Clone, Copy)]
    pub(crate) struct Mask(pub(super) simd::v128);

    impl Lanes {
        #[inline(always)]
        pub(crate) fn new([a, b, c, d]: [f32; WIDTH]) -> Self {
            Self(simd::f32x4(a, b, c, d))
        }

        #[inline(always)]
        pub(crate) fn splat(value: f32) -> Self {
            Self(simd::f32x4_splat(value))
        }

        #[inline(always)]
        pub(crate) fn lane<const K: usize>(self) -> f32 {
            simd::f32x4_extract_lane::<K>(self.0)
        }

        /// The 4×4 transposition: lane `k` of all four side by side.
        #[inline(always)]
        pub(crate) fn transpose([a, b, c, d]: [Self; WIDTH]) -> [Self; WIDTH] {
            let low = |a: Self, b: Self| simd::i32x4_shuffle::<0, 4, 1, 5>(a.0, b.0);
            let high = |a: Self, b: Self| simd::i32x4_shuffle::<2, 6, 3, 7>(a.0, b.0);
            let (ab, cd, ab_high, cd_high) = (low(a, b), low(c, d), high(a, b), high(c, d));
            [
                Self(simd::i64x2_shuffle::<0, 2>(ab, cd)),
                Self(simd::i64x2_shuffle::<1, 3>(ab, cd)),
                Self(simd::i64x2_shuffle::<0, 2>(ab_high, cd_high)),
                Self(simd::i64x2_shuffle::<1, 3>(ab_high, cd_high)),
            ]
        }

        /// Lanes 1 to 3, then lane 0 of `next`.
        #[inline(always)]
        pub(crate) fn followed_by(self, next: Self) -> Self {
            Self(simd::i32x4_shuffle::<1, 2, 3, 4>(self.0, next.0))
        }

        #[inline(always)]
        pub(crate) fn sqrt(self) -> Self {
            Self(simd::f32x4_sqrt(self.0))
        }

        /// Where `self` ≤ `o`; not where either is NaN.
        #[inline(always)]
        pub(crate) fn at_most(self, o: Self) -> Mask {
            Mask(simd::f32x4_le(self.0, o.0))
        }

        #[inline(always)]
        pub(crate) fn select(mask: Mask, then: Self, other: Self) -> Self {
            Self(simd::v128_bitselect(then.0, other.0, mask.0))
        }

        #[inline(always)]
        pub(super) fn add(self, o: Self) -> Self {
            Self(simd::f32x4_add(self.0, o.0))
        }

        #[inline(always)]
        pub(super) fn sub(self, o: Self) -> Self {
            Self(simd::f32x4_sub(self.0, o.0))
        }

        #[inline(always)]
        pub(super) fn mul(self, o: Self) -> Self {
            Self(simd::f32x4_mul(self.0, o.0))
        }

        #[inline(always)]
        pub(super) fn div(self, o: Self) -> Self {
            Self(simd::f32x4_div(self.0, o.0))
        }
    }

    /// Bit `k` says whether slot `k` is `value`.
    #[inline(always)]
    pub(crate) fn equal_bits(slots: &[u32; 2 * WIDTH], value: u32) -> u32 {
        let [low, high] = in_registers(slots);
        let value = simd::u32x4_splat(value);
        let low = simd::i32x4_bitmask(simd::i32x4_eq(low, value));
        let high = simd::i32x4_bitmask(simd::i32x4_eq(high, value));
        u32::from(low) | (u32::from(high) << WIDTH)
    }

    /// Every `old` is `new` from now on.
    #[inline(always)]
    pub(crate) fn replace(slots: &mut [u32; 2 * WIDTH], old: u32, new: u32) {
        let (old, new) = (simd::u32x4_splat(old), simd::u32x4_splat(new));
        let [low, high] = in_registers(slots).map(|four| simd::v128_bitselect(new, four, simd::i32x4_eq(four, old)));
        let pairs = [
            simd::u64x2_extract_lane::<0>(low),
            simd::u64x2_extract_lane::<1>(low),
            simd::u64x2_extract_lane::<0>(high),
            simd::u64x2_extract_lane::<1>(high),
        ];
        for (slots, pair) in slots.as_chunks_mut::<2>().0.iter_mut().zip(pairs) {
            *slots = [pair as u32, (pair >> 32) as u32];
        }
    }

    /// In pairs, because the compiler loads these at once, and four single slots one by one.
    #[inline(always)]
    fn in_registers([a, b, c, d, e, f, g, h]: &[u32; 2 * WIDTH]) -> [simd::v128; 2] {
        let pair = |a: &u32, b: &u32| u64::from(*a) | (u64::from(*b) << 32);
        [simd::u64x2(pair(a, b), pair(c, d)), simd::u64x2(pair(e, f), pair(g, h))]
    }

    impl Mask {
        #[inline(always)]
        pub(crate) fn all(self) -> bool {
            simd::i32x4_all_true(self.0)
        }

        /// Bit `k` says what lane `k` does.
        #[inline(always)]
        pub(crate) fn bits(self) -> u32 {
            u32::from(simd::i32x4_bitmask(self.0))
        }

        #[inline(always)]
        pub(super) fn and(self, o: Self) -> Self {
            Self(simd::v128_and(self.0, o.0))
        }

        #[inline(always)]
        pub(super) fn or(self, o: Self) -> Self {
            Self(simd::v128_or(self.0, o.0))
        }

        #[inline(always)]
        pub(super) fn inverted(self) -> Self {
            Self(simd::v128_not(self.0))
        }
    }
}

#[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
mod register {
    use super::WIDTH;

    /// Four independent numbers.
    #[derive(Debug, Clone, Copy)]
    #[repr(align(16))]
    pub(crate) struct Lanes([f32; WIDTH]);

    /// For each lane all ones or all zeros.
    #[derive(Debug, Clone, Copy)]
    pub(crate) struct Mask([u32; WIDTH]);

    impl Lanes {
        #[inline(always)]
        pub(crate) fn new(lanes: [f32; WIDTH]) -> Self {
            Self(lanes)
        }

        #[inline(always)]
        pub(crate) fn splat(value: f32) -> Self {
            Self([value; WIDTH])
        }

        #[inline(always)]
        pub(crate) fn lane<const K: usize>(self) -> f32 {
            self.0[K]
        }

        /// The 4×4 transposition: lane `k` of all four side by side.
        #[inline(always)]
        pub(crate) fn transpose([a, b, c, d]: [Self; WIDTH]) -> [Self; WIDTH] {
            let column = |k: usize| Self([a.0[k], b.0[k], c.0[k], d.0[k]]);
            [column(0), column(1), column(2), column(3)]
        }

        /// Lanes 1 to 3, then lane 0 of `next`.
        #[inline(always)]
        pub(crate) fn followed_by(self, next: Self) -> Self {
            Self([self.0[1], self.0[2], self.0[3], next.0[0]])
        }

        #[inline(always)]
        pub(crate) fn sqrt(self) -> Self {
            let a = self.0;
            Self([a[0].sqrt(), a[1].sqrt(), a[2].sqrt(), a[3].sqrt()])
        }

        /// Where `self` ≤ `o`; not where either is NaN.
        #[inline(always)]
        pub(crate) fn at_most(self, o: Self) -> Mask {
            let mask = |k: usize| u32::from(self.0[k] <= o.0[k]).wrapping_neg();
            Mask([mask(0), mask(1), mask(2), mask(3)])
        }

        /// By bit masks, which the compiler keeps in one register; branches it would take apart.
        #[inline(always)]
        pub(crate) fn select(mask: Mask, then: Self, other: Self) -> Self {
            let pick =
                |k: usize| f32::from_bits((then.0[k].to_bits() & mask.0[k]) | (other.0[k].to_bits() & !mask.0[k]));
            Self([pick(0), pick(1), pick(2), pick(3)])
        }

        #[inline(always)]
        pub(super) fn add(self, o: Self) -> Self {
            let (a, b) = (self.0, o.0);
            Self([a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]])
        }

        #[inline(always)]
        pub(super) fn sub(self, o: Self) -> Self {
            let (a, b) = (self.0, o.0);
            Self([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]])
        }

        #[inline(always)]
        pub(super) fn mul(self, o: Self) -> Self {
            let (a, b) = (self.0, o.0);
            Self([a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]])
        }

        #[inline(always)]
        pub(super) fn div(self, o: Self) -> Self {
            let (a, b) = (self.0, o.0);
            Self([a[0] / b[0], a[1] / b[1], a[2] / b[2], a[3] / b[3]])
        }
    }

    /// Bit `k` says whether slot `k` is `value`.
    #[inline(always)]
    pub(crate) fn equal_bits(slots: &[u32; 2 * WIDTH], value: u32) -> u32 {
        let mut bits = 0;
        for (k, &slot) in slots.iter().enumerate() {
            bits |= u32::from(slot == value) << k;
        }
        bits
    }

    /// Every `old` is `new` from now on.
    #[inline(always)]
    pub(crate) fn replace(slots: &mut [u32; 2 * WIDTH], old: u32, new: u32) {
        for slot in slots {
            *slot = if *slot == old { new } else { *slot };
        }
    }

    impl Mask {
        #[inline(always)]
        pub(crate) fn all(self) -> bool {
            self.0[0] & self.0[1] & self.0[2] & self.0[3] != 0
        }

        /// Bit `k` says what lane `k` does.
        #[inline(always)]
        pub(crate) fn bits(self) -> u32 {
            let [a, b, c, d] = self.0;
            (a & 1) | (b & 2) | (c & 4) | (d & 8)
        }

        #[inline(always)]
        pub(super) fn and(self, o: Self) -> Self {
            let (a, b) = (self.0, o.0);
            Self([a[0] & b[0], a[1] & b[1], a[2] & b[2], a[3] & b[3]])
        }

        #[inline(always)]
        pub(super) fn or(self, o: Self) -> Self {
            let (a, b) = (self.0, o.0);
            Self([a[0] | b[0], a[1] | b[1], a[2] | b[2], a[3] | b[3]])
        }

        #[inline(always)]
        pub(super) fn inverted(self) -> Self {
            Self(self.0.map(|lane| !lane))
        }
    }
}

pub(crate) use register::{Lanes, Mask, equal_bits, replace};

impl Lanes {
    pub(crate) const INDEX: [f32; WIDTH] = [0.0, 1.0, 2.0, 3.0];

    #[inline(always)]
    pub(crate) fn to_array(self) -> [f32; WIDTH] {
        [self.lane::<0>(), self.lane::<1>(), self.lane::<2>(), self.lane::<3>()]
    }

    #[inline(always)]
    pub(crate) fn max(self, o: Self) -> Self {
        Self::select(o.at_most(self), self, o)
    }

    /// 0 outside the mask.
    #[inline(always)]
    pub(crate) fn masked(self, mask: Mask) -> Self {
        Self::select(mask, self, Self::splat(0.0))
    }
}

macro_rules! operator {
    ($type:ident: $($trait:ident, $method:ident;)*) => {
        $(impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                register::$type::$method(self, o)
            }
        })*
    };
}
operator!(Lanes: Add, add; Sub, sub; Mul, mul; Div, div;);

impl BitAnd for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        self.and(o)
    }
}

impl BitOr for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        self.or(o)
    }
}

impl Not for Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        self.inverted()
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
        Self { x: Lanes::new(v.map(|v| v.x)), y: Lanes::new(v.map(|v| v.y)), z: Lanes::new(v.map(|v| v.z)) }
    }

    /// The same vector four times.
    #[inline(always)]
    pub(super) fn splat(v: Vec3) -> Self {
        Self { x: Lanes::splat(v.x), y: Lanes::splat(v.y), z: Lanes::splat(v.z) }
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

    #[inline(always)]
    pub(super) fn select(mask: Mask, then: Self, other: Self) -> Self {
        Self {
            x: Lanes::select(mask, then.x, other.x),
            y: Lanes::select(mask, then.y, other.y),
            z: Lanes::select(mask, then.z, other.z),
        }
    }

    /// As [`Lanes::followed_by`].
    #[inline(always)]
    pub(super) fn followed_by(self, next: Self) -> Self {
        Self { x: self.x.followed_by(next.x), y: self.y.followed_by(next.y), z: self.z.followed_by(next.z) }
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
