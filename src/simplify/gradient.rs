//! Gradients of attributes over triangles, four triangles at a time.
//!
//! What is linear over a triangle is the values at its corners times hat functions, whose gradients are at a right angle to
//! the opposite edges: with N = e × f for the edges e and f from the first corner, those of the other two are f × N / N²
//! and N × e / N². The sum over all attributes of g gᵀ (Hoppe 1999, the matrix of the attributes' quadric) then needs
//! nothing of each but three products of its values.

use super::attributes::HEAD;
use super::lanes::{Lanes, Lanes3, Mask, WIDTH};
use super::quadric::QuadricLanes;

/// A triangle thinner than this share of its length has the gradient of one that is as thick.
const THINNEST: f32 = 1e-5;

/// Of four triangles (0, next, previous): twice the areas, and the gradients of the functions that are 1 at one of the two
/// and 0 at the other corners, plain and weighted by area.
pub(super) struct Hats {
    pub(super) area: Lanes,
    next: Lanes3,
    previous: Lanes3,
    pub(super) weighted_next: Lanes3,
    pub(super) weighted_previous: Lanes3,
}

/// For four triangles the sums over all components of a², a b and b², where a and b are what the two corners' values are
/// above the first's.
pub(super) struct Products {
    aa: Lanes,
    ab: Lanes,
    bb: Lanes,
}

impl Default for Products {
    #[inline(always)]
    fn default() -> Self {
        let zero = Lanes::splat(0.0);
        Self { aa: zero, ab: zero, bb: zero }
    }
}

impl Products {
    #[inline(always)]
    pub(super) fn add(&mut self, a: Lanes, b: Lanes) {
        (self.aa, self.ab, self.bb) = (self.aa + a * a, self.ab + a * b, self.bb + b * b);
    }
}

impl Hats {
    /// Those outside the mask have no area.
    #[inline(never)]
    pub(super) fn of(next: Lanes3, previous: Lanes3, counts: Mask) -> Self {
        let n = next.cross(previous);
        let squared = n.dot(n);
        let floor = (next.dot(next) + previous.dot(previous)) * Lanes::splat(THINNEST);
        let inverse = Lanes::splat(1.0) / (squared + floor * floor).max(Lanes::splat(f32::MIN_POSITIVE));
        let area = squared.sqrt().masked(counts);
        let (of_next, of_previous) = (previous.cross(n).scale(inverse), n.cross(next).scale(inverse));
        Self {
            area,
            next: of_next,
            previous: of_previous,
            weighted_next: of_next.scale(area),
            weighted_previous: of_previous.scale(area),
        }
    }

    /// Area · g of a component.
    #[inline(always)]
    pub(super) fn gradient(&self, products: &mut Products, a: Lanes, b: Lanes) -> Lanes3 {
        products.add(a, b);
        self.weighted_next.scale(a) + self.weighted_previous.scale(b)
    }

    /// Σ area · g gᵀ over all components: g is a times the one plus b times the other.
    #[inline(never)]
    pub(super) fn outer(&self, &Products { aa, ab, bb }: &Products) -> QuadricLanes {
        let p = self.weighted_next.scale(aa) + self.weighted_previous.scale(ab);
        let q = self.weighted_next.scale(ab) + self.weighted_previous.scale(bb);
        let (n, l) = (self.next, self.previous);
        QuadricLanes {
            xx: p.x * n.x + q.x * l.x,
            xy: p.x * n.y + q.x * l.y,
            xz: p.x * n.z + q.x * l.z,
            yy: p.y * n.y + q.y * l.y,
            yz: p.y * n.z + q.y * l.z,
            zz: p.z * n.z + q.z * l.z,
            ..QuadricLanes::zero()
        }
    }
}

/// The first two rows of the blocks of four triangles.
#[inline(always)]
pub(super) fn head_of(q: &QuadricLanes, area: Lanes) -> [[Lanes; WIDTH]; HEAD] {
    [Lanes::transpose([q.xx, q.xy, q.xz, q.yy]), Lanes::transpose([q.yz, q.zz, area, Lanes::splat(0.0)])]
}

#[cfg(test)]
mod tests {
    use super::super::quadric::Vec3;
    use super::{Hats, Lanes, Lanes3, Mask, Products};

    fn vec3(x: f32, y: f32, z: f32) -> Vec3 {
        Vec3 { x, y, z }
    }

    fn everywhere() -> Mask {
        Lanes::splat(0.0).at_most(Lanes::splat(0.0))
    }

    #[test]
    fn a_linear_function_in_the_plane_has_its_own_gradient() {
        let (e, f, g) = (vec3(2.0, 0.0, 1.0), vec3(0.5, 0.0, 3.0), vec3(-4.0, 0.0, 7.0));
        let hats = Hats::of(Lanes3::splat(e), Lanes3::splat(f), everywhere());
        let area = hats.area.lane::<0>();
        assert!((area - 5.5).abs() < 1e-5, "twice the area: {area}");
        let mut products = Products::default();
        let found = hats.gradient(&mut products, Lanes::splat(e.dot(g)), Lanes::splat(f.dot(g)));
        let outer = hats.outer(&products);
        let found = [found.x, found.y, found.z, outer.xx, outer.xz, outer.zz].map(|lanes| lanes.lane::<0>() / area);
        for (found, expected) in found.into_iter().zip([-4.0, 0.0, 7.0, 16.0, -28.0, 49.0]) {
            assert!((found - expected).abs() < 1e-4, "{found} for {expected}");
        }
    }

    #[test]
    fn a_needle_has_a_finite_gradient() {
        for f in [vec3(1.0, 0.0, 0.0), vec3(1.0, 1e-20, 0.0), Vec3::ZERO] {
            let hats = Hats::of(Lanes3::splat(vec3(1.0, 0.0, 0.0)), Lanes3::splat(f), everywhere());
            let mut products = Products::default();
            let found = hats.gradient(&mut products, Lanes::splat(1.0), Lanes::splat(-1.0));
            let outer = hats.outer(&products);
            for lanes in [found.x, found.y, found.z, outer.xx, outer.yy, outer.zz] {
                let value = lanes.lane::<0>();
                assert!(value.abs() <= 1e-4, "{f:?}: {value}");
            }
        }
    }

    #[test]
    fn what_does_not_count_has_no_area() {
        let nowhere = Lanes::splat(1.0).at_most(Lanes::splat(0.0));
        let [e, f] = [vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0)].map(Lanes3::splat);
        let hats = Hats::of(e, f, nowhere);
        let found = hats.gradient(&mut Products::default(), Lanes::splat(1.0), Lanes::splat(2.0));
        assert_eq!([hats.area, found.x, found.y].map(|lanes| lanes.lane::<0>()), [0.0; 3]);
    }
}
