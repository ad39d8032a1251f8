//! The attribute error: how far the values that are interpolated over a vertex's triangles are from
//! one linear function.
//!
//! Hoppe (1999) adds to the quadric of Garland & Heckbert (1997), for each attribute, the squared
//! deviation (s − s₀ − g·d)² from the linear function on each triangle, and keeps one quadric for
//! each wedge. Here it is memoryless as the rest: the linear functions of the current one-ring all
//! pass through the wedge's own value, so that of a wedge only A = Σ area, G = Σ area · g, one for
//! each attribute, S = Σ area · g gᵀ and its values are left: sums, to which a triangle is added and
//! from which it is taken. With the merged value eliminated, an edge whose wedges u, v merge costs,
//! d_u and d_v away from where they are,
//!
//! d_uᵀ S_u d_u + d_vᵀ S_v d_v + Σ (2 σ G_v·d_v + A_v σ² − (A_v σ + G_u·d_u + G_v·d_v)² / (A_u + A_v))
//!
//! with σ = s_v − s_u and the sum over all attributes. Other wedges at the two vertices get the value
//! that is best for them: S − Σ G Gᵀ / A is what no single linear function can follow when they move.
//! The merged wedge gets the mean of both functions there, weighted by area. Nothing is added for an
//! attribute that is linear over the surface, however steep: a texture laid flat on a plane costs nothing.

use super::attribute_layout::Layout;
use super::lanes::{Lanes, Lanes3, WIDTH};
use super::quadric::{Quadric, QuadricLanes, Vec3};
use super::topology::{Corner, Form, NONE, Topology};
use crate::mesh::Mesh;
use crate::mesh::weld::NO_VERTEX;

/// Rows of a block before those of the components.
pub(super) const HEAD: usize = 2;

/// Values of all wedges and the sums over their triangles, in units of engine space, areas doubled as those of quadrics.
#[derive(Debug, Default)]
pub(super) struct AttributeField {
    pub(super) layout: Layout,
    /// A block for each record. S as xx xy xz yy | yz zz, then A; for a vertex of several wedges, in the block of the
    /// vertex's number, S − Σ G Gᵀ / A of all of them instead. Then by component the value, and G.
    pub(super) blocks: Vec<Lanes>,
    /// By vertex: the record of its only wedge, or [`NONE`].
    pub(super) only_record: Vec<u32>,
    /// The record of each wedge; empty if every vertex has one, whose record has the vertex's number.
    record_of_wedge: Vec<u32>,
    pub(super) scratch: Scratch,
}

/// Buffers that live as long as the run.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub(super) corners: Vec<Corner>,
    /// The records of a vertex.
    pub(super) records: Vec<u32>,
    /// See `attribute_update`.
    pub(super) sums: Vec<Lanes>,
    pub(super) values: Vec<f32>,
    pub(super) merged: Vec<f32>,
}

/// The attributes' part of the cost of four edges that is not in the vertices' matrices:
/// xᵀ M x + 2 r·x + c about the midpoint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mismatch {
    pub(super) matrix: QuadricLanes,
    pub(super) linear: Lanes3,
    pub(super) constant: Lanes,
}

impl AttributeField {
    /// The values of all wedges; gradients and matrices follow by `refresh`.
    pub(super) fn new(
        mesh: &Mesh,
        layout: Layout,
        topology: &Topology,
        (vertex_of_wedge, wedge_of_vertex): (&[u32], &[u32]),
    ) -> Self {
        let vertices = topology.vertices.len();
        let mut record_of_wedge = Vec::new();
        let mut wedges: Vec<u32> = wedge_of_vertex.to_vec();
        if topology.has_wedges() {
            record_of_wedge = vec![NONE; mesh.positions.len()];
            for (v, &w) in (0..).zip(wedge_of_vertex) {
                record_of_wedge[w as usize] = v;
            }
            for (&named, w) in vertex_of_wedge.iter().zip(0_u32..) {
                if named != NO_VERTEX && named != w {
                    record_of_wedge[w as usize] = wedges.len() as u32;
                    wedges.push(w);
                }
            }
        }
        let stride = HEAD + layout.components;
        let mut blocks = vec![Lanes::splat(0.0); wedges.len() * stride];
        let mut at = 0;
        for (&w, block) in wedges.iter().zip(blocks.chunks_exact_mut(stride)) {
            let w = w as usize;
            if !mesh.wedge_sets[at].wedges.contains(&w) {
                at = mesh.wedge_sets.partition_point(|s| s.wedges.end <= w);
            }
            let set = &mesh.wedge_sets[at];
            for p in &layout.sets[at] {
                let attribute = &set.attributes[p.attribute];
                let first = (w - set.wedges.start) * attribute.components;
                for (row, value) in block[HEAD + p.start..][..p.length].iter_mut().zip(&attribute.values[first..]) {
                    *row = Lanes::new([value * p.weight, 0.0, 0.0, 0.0]);
                }
            }
        }
        let mut field = Self {
            layout,
            blocks,
            only_record: (0..vertices as u32).collect(),
            record_of_wedge,
            scratch: Scratch::default(),
        };
        for v in 0..vertices as u32 {
            field.count_wedges(topology, v);
        }
        field
    }

    /// Whether every vertex has one wedge, and has had from the beginning.
    pub(super) fn is_plain(&self) -> bool {
        self.record_of_wedge.is_empty()
    }

    /// The record of wedge `wedge` of `v`.
    pub(super) fn record(&self, v: u32, wedge: u32) -> u32 {
        self.record_of_wedge.get(wedge as usize).copied().unwrap_or(v)
    }

    /// Notes whether all triangles at `v` have the same wedge there.
    pub(super) fn count_wedges(&mut self, topology: &Topology, v: u32) {
        if !self.is_plain() {
            let mut corners = std::mem::take(&mut self.scratch.corners);
            corners.clear();
            topology.corners(v, &mut corners);
            self.only_record[v as usize] = match corners.split_first() {
                Some((first, rest)) if rest.iter().all(|c| c.wedge == first.wedge) => self.record(v, first.wedge),
                _ => NONE,
            };
            self.scratch.corners = corners;
        }
    }

    /// The record of `w` in the triangle (w, next, previous).
    #[inline(always)]
    pub(super) fn record_at(&self, topology: &Topology, w: u32, next: u32, previous: u32) -> u32 {
        let only = self.only_record[w as usize];
        if only != NONE { only } else { self.search_record(topology, w, next, previous) }
    }

    #[inline(never)]
    fn search_record(&self, topology: &Topology, w: u32, next: u32, previous: u32) -> u32 {
        let (ring, wedges) = (topology.ring(w), topology.ring_wedges(w));
        let after = |i: usize| ring[if i + 1 == ring.len() { 0 } else { i + 1 }];
        let slot = (0..ring.len()).find(|&i| ring[i] == next && after(i) == previous);
        wedges.get(slot.unwrap_or(0)).map_or(w, |&wedge| self.record(w, wedge))
    }

    /// Lanes from one block to the next.
    #[inline(always)]
    pub(super) fn stride(&self) -> usize {
        HEAD + self.layout.components
    }

    #[inline(always)]
    pub(super) fn block(&self, record: u32) -> &[Lanes] {
        let stride = self.stride();
        &self.blocks[record as usize * stride..][..stride]
    }

    #[inline(always)]
    pub(super) fn area(&self, record: u32) -> f32 {
        self.blocks[record as usize * self.stride() + 1].lane::<2>()
    }

    /// What no linear function of its wedges can follow when the vertex moves.
    #[inline(never)]
    fn stiffness(&self, v: u32) -> Quadric {
        let only = self.only_record[v as usize];
        let block = self.block(if only == NONE { v } else { only });
        let [[xx, xy, xz, yy], [yz, zz, ..]] = [block[0].to_array(), block[1].to_array()];
        let mut matrix = Quadric { xx, xy, xz, yy, yz, zz, g: Vec3::ZERO };
        if only != NONE {
            matrix -= self.followed(only);
        }
        matrix
    }

    /// Σ G Gᵀ / A: what a linear function can follow.
    #[inline(never)]
    pub(super) fn followed(&self, record: u32) -> Quadric {
        let block = self.block(record);
        let area = block[1].lane::<2>();
        let inverse = if area > 0.0 { 1.0 / area } else { 0.0 };
        let mut matrix = Quadric::default();
        for row in &block[HEAD..] {
            let [_, x, y, z] = row.to_array();
            let [p, q, r] = [x * inverse, y * inverse, z * inverse];
            matrix += Quadric { xx: p * x, xy: p * y, xz: p * z, yy: q * y, yz: q * z, zz: r * z, g: Vec3::ZERO };
        }
        matrix
    }

    /// The records that merge with the edge (u, v): one pair, or two on the two sides of a seam.
    fn pairs(&self, topology: &Topology, u: u32, v: u32) -> [Option<(u32, u32)>; 2] {
        let (a, b) = (self.only_record[u as usize], self.only_record[v as usize]);
        if a != NONE && b != NONE {
            return [Some((a, b)), None];
        }
        let mut found = [None; 2];
        let ring = topology.ring(u);
        let closed = topology.vertices[u as usize].form() == Form::Closed;
        for i in 0..ring.len() {
            let last = i + 1 == ring.len();
            let (next, previous) = (ring[i], ring[if last { 0 } else { i + 1 }]);
            if (last && !closed) || next == NONE || previous == NONE || (next != v && previous != v) {
                continue;
            }
            let other = if next == v { (previous, u) } else { (u, next) };
            let of_u = self.record_at(topology, u, next, previous);
            let pair = Some((of_u, self.record_at(topology, v, other.0, other.1)));
            if found[0].is_none() {
                found[0] = pair;
            } else if found[0] != pair && found[1].is_none() {
                found[1] = pair;
            }
        }
        found
    }

    /// What attributes add to the cost of the edges from `u` to four others, whose halves are `h`: to the quadrics of
    /// `u` and of the others, and beside them.
    #[inline(always)]
    pub(super) fn add_to(
        &self,
        topology: &Topology,
        (u, of_u): (u32, &mut QuadricLanes),
        (four, of_others): ([u32; WIDTH], &mut QuadricLanes),
        h: Lanes3,
    ) -> Mismatch {
        let own = self.only_record[u as usize];
        let others = four.map(|v| self.only_record[v as usize]);
        if own == NONE || others.contains(&NONE) {
            return self.add_pairs_to(topology, (u, of_u), (four, of_others), h);
        }
        let blocks = others.map(|record| self.block(record));
        let block = self.block(own);
        let splat = |k: usize| block[k].to_array().map(Lanes::splat);
        let [xx, xy, xz, yy] = splat(0);
        let [yz, zz, area_u, _] = splat(1);
        of_u.add(&QuadricLanes { xx, xy, xz, yy, yz, zz, ..QuadricLanes::zero() });
        let [xx, xy, xz, yy] = Lanes::transpose(blocks.map(|b| b[0]));
        let [yz, zz, area_v, _] = Lanes::transpose(blocks.map(|b| b[1]));
        of_others.add(&QuadricLanes { xx, xy, xz, yy, yz, zz, ..QuadricLanes::zero() });
        let inverse = Lanes::splat(1.0) / (area_u + area_v).max(Lanes::splat(f32::MIN_POSITIVE));
        let mut sum = Mismatch::none();
        for k in HEAD..block.len() {
            let [su, x, y, z] = splat(k);
            let gu = Lanes3 { x, y, z };
            let [sv, x, y, z] = Lanes::transpose(blocks.map(|b| b[k]));
            let gv = Lanes3 { x, y, z };
            let step = sv - su;
            let both = gu + gv;
            let gv_h = gv.dot(h);
            let weighted = area_v * step;
            let c = weighted + gu.dot(h) - gv_h;
            let share = both.scale(inverse);
            sum.matrix.subtract_outer(share, both);
            sum.linear = sum.linear + gv.scale(step) - share.scale(c);
            sum.constant = sum.constant + step * (weighted - gv_h - gv_h) - c * c * inverse;
        }
        sum
    }

    /// As [`AttributeField::add_to`] where vertices have several wedges: A_u A_v / (A_u + A_v) times the squared
    /// difference of both functions, for each pair of wedges that merge, beside what none can follow.
    #[inline(never)]
    fn add_pairs_to(
        &self,
        topology: &Topology,
        (u, of_u): (u32, &mut QuadricLanes),
        (four, of_others): ([u32; WIDTH], &mut QuadricLanes),
        h: Lanes3,
    ) -> Mismatch {
        of_u.add(&QuadricLanes::splat(&self.stiffness(u)));
        of_others.add(&QuadricLanes::of_matrices(four.map(|v| self.stiffness(v))));
        let mut sum = Mismatch::none();
        let pairs = four.map(|v| self.pairs(topology, u, v));
        for side in 0..2 {
            let of = pairs.map(|p| p[side].unwrap_or((0, 0)));
            let areas = of.map(|(a, b)| [self.area(a), self.area(b)]);
            let harmonic: [f32; WIDTH] =
                std::array::from_fn(|k| if pairs[k][side].is_some() { harmonic(areas[k]) } else { 0.0 });
            if harmonic == [0.0; WIDTH] {
                continue;
            }
            let harmonic = Lanes::new(harmonic);
            let inverse = |end: usize| Lanes::new(areas.map(|a| if a[end] > 0.0 { 1.0 / a[end] } else { 0.0 }));
            let (inverse_u, inverse_v) = (inverse(0), inverse(1));
            for k in HEAD..self.stride() {
                let [su, x, y, z] = Lanes::transpose(of.map(|p| self.block(p.0)[k]));
                let gu = Lanes3 { x, y, z }.scale(inverse_u);
                let [sv, x, y, z] = Lanes::transpose(of.map(|p| self.block(p.1)[k]));
                let gv = Lanes3 { x, y, z }.scale(inverse_v);
                let constant = su - sv + (gu + gv).dot(h);
                let e = gv - gu;
                let weighted = e.scale(harmonic);
                sum.matrix.subtract_outer(weighted, gu - gv);
                sum.linear = sum.linear - weighted.scale(constant);
                sum.constant = sum.constant + harmonic * constant * constant;
            }
        }
        sum
    }

    /// The attributes' part of the cost of merging `u` and `v` at `p`.
    pub(super) fn cost_at(&self, topology: &Topology, u: u32, v: u32, p: Vec3) -> f32 {
        let [du, dv] = [u, v].map(|end| p - topology.vertices[end as usize].position());
        let mut cost = self.stiffness(u).error_at(du) + self.stiffness(v).error_at(dv);
        for (a, b) in self.pairs(topology, u, v).into_iter().flatten() {
            let areas = [self.area(a), self.area(b)];
            let inverse = areas.map(|a| if a > 0.0 { 1.0 / a } else { 0.0 });
            for (row_a, row_b) in self.block(a)[HEAD..].iter().zip(&self.block(b)[HEAD..]) {
                let [[sa, ga], [sb, gb]] = [along(*row_a, du), along(*row_b, dv)];
                let miss = sa + ga * inverse[0] - sb - gb * inverse[1];
                cost += harmonic(areas) * miss * miss;
            }
        }
        cost
    }
}

impl Mismatch {
    #[inline(always)]
    fn none() -> Self {
        Self { matrix: QuadricLanes::zero(), linear: Lanes3::splat(Vec3::ZERO), constant: Lanes::splat(0.0) }
    }
}

/// s and G·d.
#[inline(always)]
pub(super) fn along(row: Lanes, d: Vec3) -> [f32; 2] {
    let [s, x, y, z] = row.to_array();
    [s, x * d.x + y * d.y + z * d.z]
}

#[inline(always)]
fn harmonic([a, b]: [f32; 2]) -> f32 {
    if a + b > 0.0 { a * b / (a + b) } else { 0.0 }
}
