//! The attributes while the mesh shrinks: values of merged wedges, gradients of the triangles that
//! a collapse changes.
//!
//! Where each vertex around a collapse has one wedge, which is the usual case, the triangles before
//! and after are looked at once and their differences added to the vertices around. Other vertices
//! are taken up afresh from all their triangles.

use super::attributes::{AttributeField, value_at};
use super::lanes::Lanes;
use super::quadric::{Vec3, larger, smaller};
use super::topology::{NONE, Topology};

/// A triangle thinner than this share of its length has the gradient of one that is as thick.
const THINNEST: f32 = 1e-5;

/// A neighbour of several wedges and more triangles than this is not taken up afresh: a few of them
/// have changed, and it would be each time that one of its many neighbours does.
const LONGEST_RING: usize = 256;

/// A collapse whose two ends had closed rings, done in the topology and not yet in the attributes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spliced<'a> {
    /// The merged ring: triangles of `from` up to slot `split`, then those of `into`.
    pub(super) ring: &'a [u32],
    pub(super) split: usize,
}

/// An end of a collapsed edge, and where it was.
pub(super) type End = (u32, Vec3);

/// Rows before those of the components in what a triangle adds: area and Σ area · g gᵀ.
const HEAD: usize = 2;

impl AttributeField {
    /// Gradients and matrix of `v` from its triangles as they are.
    pub(super) fn refresh(&mut self, topology: &Topology, v: u32) {
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.corners.clear();
        scratch.gradients.clear();
        scratch.triangles.clear();
        topology.corners(v, &mut scratch.corners);
        let at = |w: u32| topology.vertices[w as usize].position();
        let only = self.only_record[v as usize];
        for c in &scratch.corners {
            let record = if only == NONE { self.record(v, c.wedge) } else { only };
            let next = self.record_at(topology, c.next, c.previous, v);
            let previous = self.record_at(topology, c.previous, v, c.next);
            let (area, l1, l2) = hat_gradients(at(c.next) - at(v), at(c.previous) - at(v));
            scratch.triangles.push((record, area, scratch.gradients.len()));
            let [own, next, previous] = [record, next, previous].map(|r| self.rows_of(r));
            for ((own, next), previous) in own.iter().zip(next).zip(previous) {
                let s = own.lane::<0>();
                scratch.gradients.push(l1 * (next.lane::<0>() - s) + l2 * (previous.lane::<0>() - s));
            }
        }
        scratch.triangles.sort_unstable_by_key(|t| t.0);
        let mut matrix = [0.0_f32; 6];
        for wedge in scratch.triangles.chunk_by(|a, b| a.0 == b.0) {
            let record = wedge[0].0 as usize;
            let area: f32 = wedge.iter().map(|t| t.1).sum();
            self.areas[record] = area;
            let inverse = if area > 0.0 { 1.0 / area } else { 0.0 };
            for k in 0..self.layout.components {
                let mean = wedge.iter().fold(Vec3::ZERO, |sum, t| sum + scratch.gradients[t.2 + k] * (t.1 * inverse));
                set_gradient(&mut self.rows[record * self.layout.components + k], mean);
                for t in wedge {
                    let g = scratch.gradients[t.2 + k] - mean;
                    let h = g * t.1;
                    let outer = [g.x * h.x, g.x * h.y, g.x * h.z, g.y * h.y, g.y * h.z, g.z * h.z];
                    matrix.iter_mut().zip(outer).for_each(|(sum, term)| *sum += term);
                }
            }
        }
        let [xx, xy, xz, yy, yz, zz] = matrix;
        self.stiffness[v as usize] = [Lanes::new([xx, xy, xz, yy]), Lanes::new([yz, zz, 0.0, 0.0])];
        self.scratch = scratch;
    }

    /// Follows a collapse that the topology has done: `from` is gone, `into` is where it is now.
    /// `merges` are the wedges that became one. Without `solve` the wedges of `into` keep their values.
    pub(super) fn follow(
        &mut self,
        topology: &Topology,
        spliced: Option<Spliced<'_>>,
        merges: &[(u32, u32)],
        (from, into): (End, End),
        solve: bool,
    ) {
        let plain = [(from.0, into.0)];
        let merges = if self.is_plain() { &plain[..] } else { merges };
        let single = |v: u32| self.only_record[v as usize] != NONE;
        if let (Some(spliced), true) = (spliced, single(from.0) && single(into.0)) {
            self.follow_spliced(topology, spliced, merges, (from, into), solve);
            return;
        }
        if solve {
            self.merge(topology, merges, (from, into));
        }
        let ring = topology.ring(into.0);
        let short = |v: u32| topology.vertices[v as usize].ring_length() <= LONGEST_RING;
        let near = ring.iter().copied().filter(|&v| v != NONE && short(v));
        let around = || [into.0].into_iter().chain(near.clone());
        around().for_each(|v| self.count_wedges(topology, v));
        around().for_each(|v| self.refresh(topology, v));
    }

    fn follow_spliced(
        &mut self,
        topology: &Topology,
        Spliced { ring, split }: Spliced<'_>,
        merges: &[(u32, u32)],
        (from, into): (End, End),
        solve: bool,
    ) {
        let (stride, length) = (HEAD + self.layout.components, ring.len());
        let mut differences = std::mem::take(&mut self.scratch.differences);
        differences.clear();
        // One for each triangle around, two for those that are gone, one for the sum.
        differences.resize((length + 3) * stride, Lanes::splat(0.0));
        let [of_from, of_into] = [from.0, into.0].map(|v| self.only_record[v as usize]);
        let at = |v: u32| topology.vertices[v as usize].position();
        let after = |i: usize| ring[if i + 1 == length { 0 } else { i + 1 }];
        let records = |field: &Self, i: usize| {
            let (a, b) = (ring[i], after(i));
            (field.record_at(topology, a, b, into.0), field.record_at(topology, b, into.0, a))
        };
        for (i, difference) in differences.chunks_exact_mut(stride).take(length).enumerate() {
            let (a, b) = records(self, i);
            let (origin, record) = if i < split { (from.1, of_from) } else { (into.1, of_into) };
            self.add_triangle(difference, -1.0, (at(ring[i]) - origin, at(after(i)) - origin), [record, a, b]);
        }
        for (k, &third) in [ring[0], ring[split]].iter().enumerate() {
            let third_record = self.only_record[third as usize];
            if third_record != NONE {
                let difference = &mut differences[(length + k) * stride..][..stride];
                let edges = (from.1 - into.1, at(third) - into.1);
                self.add_triangle(difference, -1.0, edges, [of_into, of_from, third_record]);
            }
        }
        if solve {
            self.merge(topology, merges, (from, into));
        }
        let now = at(into.0);
        let (around, rest) = differences.split_at_mut(length * stride);
        let (gone, sum) = rest.split_at_mut(2 * stride);
        for (i, difference) in around.chunks_exact_mut(stride).enumerate() {
            let (a, b) = records(self, i);
            let edges = (at(ring[i]) - now, at(after(i)) - now);
            self.add_triangle(difference, 1.0, edges, [of_into, a, b]);
            self.add_triangle(sum, 1.0, edges, [of_into, a, b]);
        }
        self.areas[of_into as usize] = 0.0;
        self.stiffness[into.0 as usize] = [Lanes::splat(0.0); 2];
        self.add(into.0, of_into, sum);
        for (i, &v) in ring.iter().enumerate() {
            let record = self.only_record[v as usize];
            if record == NONE {
                if topology.vertices[v as usize].ring_length() <= LONGEST_RING {
                    self.count_wedges(topology, v);
                    self.refresh(topology, v);
                }
                continue;
            }
            let before = if i == 0 { length - 1 } else { i - 1 };
            sum.copy_from_slice(&around[i * stride..][..stride]);
            let removed = if i == 0 {
                &gone[..stride]
            } else if i == split {
                &gone[stride..]
            } else {
                &[]
            };
            for part in [&around[before * stride..][..stride], removed] {
                sum.iter_mut().zip(part).for_each(|(sum, &row)| *sum = *sum + row);
            }
            self.add(v, record, sum);
        }
        self.scratch.differences = differences;
    }

    /// Adds what a triangle gives to each of its corners' sums, `sign` times.
    #[inline(always)]
    fn add_triangle(&self, sum: &mut [Lanes], sign: f32, (e1, e2): (Vec3, Vec3), records: [u32; 3]) {
        let (area, l1, l2) = hat_gradients(e1, e2);
        let area = sign * area;
        let [own, next, previous] = records.map(|r| self.rows_of(r));
        let row = |l: Vec3| Lanes::new([0.0, l.x, l.y, l.z]) * Lanes::splat(area);
        let (row1, row2) = (row(l1), row(l2));
        let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
        let (head, rows) = sum.split_at_mut(HEAD);
        for (((own, next), previous), sum) in own.iter().zip(next).zip(previous).zip(rows) {
            let s = own.lane::<0>();
            let (a, b) = (next.lane::<0>() - s, previous.lane::<0>() - s);
            (aa, ab, bb) = (aa + a * a, ab + a * b, bb + b * b);
            *sum = *sum + row1 * Lanes::splat(a) + row2 * Lanes::splat(b);
        }
        // Σ g gᵀ with g = a l₁ + b l₂.
        let (p, q) = ((l1 * aa + l2 * ab) * area, (l1 * ab + l2 * bb) * area);
        head[0] = head[0]
            + Lanes::new([
                p.x * l1.x + q.x * l2.x,
                p.x * l1.y + q.x * l2.y,
                p.x * l1.z + q.x * l2.z,
                p.y * l1.y + q.y * l2.y,
            ]);
        head[1] = head[1] + Lanes::new([p.y * l1.z + q.y * l2.z, p.z * l1.z + q.z * l2.z, area, 0.0]);
    }

    /// Adds such sums to a vertex of one wedge.
    #[inline(always)]
    fn add(&mut self, v: u32, record: u32, sum: &[Lanes]) {
        let before = self.areas[record as usize];
        let area = larger(before + sum[1].lane::<2>(), 0.0);
        let inverse = if area > 0.0 { 1.0 / area } else { 0.0 };
        let first = record as usize * self.layout.components;
        let zero = Lanes::splat(0.0);
        let (mut by_x, mut by_y, mut by_z) = (zero, zero, zero);
        let (old_weight, new_weight, inverse) = (Lanes::splat(before), Lanes::splat(area), Lanes::splat(inverse));
        for (row, &added) in self.rows[first..].iter_mut().zip(&sum[HEAD..]) {
            let old = *row;
            let new = (old * old_weight + added) * inverse;
            let (old_weighted, new_weighted) = (old * old_weight, new * new_weight);
            let outer =
                |of: fn(&Lanes) -> f32| old_weighted * Lanes::splat(of(&old)) - new_weighted * Lanes::splat(of(&new));
            by_x = by_x + outer(|l| l.lane::<1>());
            by_y = by_y + outer(|l| l.lane::<2>());
            by_z = by_z + outer(|l| l.lane::<3>());
            let [_, x, y, z] = new.to_array();
            *row = Lanes::new([old.lane::<0>(), x, y, z]);
        }
        self.areas[record as usize] = area;
        let ([_, xx, xy, xz], [_, _, yy, yz], zz) = (by_x.to_array(), by_y.to_array(), by_z.lane::<3>());
        let matrix = &mut self.stiffness[v as usize];
        matrix[0] = matrix[0] + sum[0] + Lanes::new([xx, xy, xz, yy]);
        let [syz, szz, ..] = sum[1].to_array();
        matrix[1] = matrix[1] + Lanes::new([syz + yz, szz + zz, 0.0, 0.0]);
    }

    /// The values of the wedges that merge, at the merged position.
    fn merge(&mut self, topology: &Topology, merges: &[(u32, u32)], (from, into): (End, End)) {
        let now = topology.vertices[into.0 as usize].position();
        let (du, dv) = (now - from.1, now - into.1);
        let components = self.layout.components;
        let mut merged = std::mem::take(&mut self.scratch.merged);
        merged.clear();
        for &(a, b) in merges {
            let (a, b) = (self.record(from.0, a), self.record(into.0, b));
            let (wa, wb) = (self.areas[a as usize], self.areas[b as usize]);
            let share = if wa + wb > 0.0 { wa / (wa + wb) } else { 0.5 };
            let rows = self.rows_of(a).iter().zip(self.rows_of(b));
            merged.extend(rows.map(|(&a, &b)| value_at(a, du) * share + value_at(b, dv) * (1.0 - share)));
        }
        for (&(_, wedge), values) in merges.iter().zip(merged.chunks_exact_mut(components)) {
            if let Some((start, unit)) = self.layout.normal {
                let normal = &mut values[start..start + 3];
                let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
                if length > 0.0 {
                    normal.iter_mut().for_each(|c| *c *= unit / length);
                }
            }
            if let Some((start, length, one)) = self.layout.color {
                values[start..start + length].iter_mut().for_each(|c| *c = smaller(larger(*c, 0.0), one));
            }
            let first = self.record(into.0, wedge) as usize * components;
            for (row, &value) in self.rows[first..].iter_mut().zip(&*values) {
                let [_, x, y, z] = row.to_array();
                *row = Lanes::new([value, x, y, z]);
            }
        }
        self.scratch.merged = merged;
    }

    /// Appends the values of a wedge of `v`, which is of set `set`, in the units of the file.
    pub(super) fn push_values(&self, (v, wedge, set): (u32, u32, usize), out: &mut Vec<f32>) {
        let rows = self.rows_of(self.record(v, wedge));
        let first = out.len();
        out.resize(first + rows.len(), 0.0);
        for p in &self.layout.sets[set] {
            for k in p.start..p.start + p.length {
                out[first + k] = rows[k].lane::<0>() / p.weight;
            }
        }
    }
}

/// Of the triangle (0, e1, e2): twice the area, and the gradients of the functions that are 1 at one
/// of the two and 0 at the other corners.
#[inline(always)]
fn hat_gradients(e1: Vec3, e2: Vec3) -> (f32, Vec3, Vec3) {
    let n = e1.cross(e2);
    let squared = n.length_squared();
    let floor = (e1.length_squared() + e2.length_squared()) * THINNEST;
    let divisor = squared + floor * floor;
    let inverse = if divisor > 0.0 { 1.0 / divisor } else { 0.0 };
    (squared.sqrt(), e2.cross(n) * inverse, n.cross(e1) * inverse)
}

fn set_gradient(row: &mut Lanes, g: Vec3) {
    *row = Lanes::new([row.lane::<0>(), g.x, g.y, g.z]);
}
