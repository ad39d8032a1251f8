//! The attribute error: how far the values that are interpolated over a vertex's triangles are from
//! one linear function.
//!
//! Hoppe (1999) adds to the quadric of Garland & Heckbert (1997), for each attribute, the squared
//! deviation (s − s₀ − g·d)² from the linear function on each triangle, and keeps one quadric for
//! each wedge. Here it is memoryless as the rest: the linear functions of the current one-ring all
//! pass through the wedge's own value, so that of a wedge only Σ area · g gᵀ, Σ area · g and its
//! value are left. With the value eliminated two parts remain:
//!
//! - a 3×3 matrix for each vertex, Σ area · (g − ḡ)(g − ḡ)ᵀ over each wedge's triangles: what no
//!   single linear function can follow when the vertex moves;
//! - for the wedges u, v that an edge merges, H (s_u + ḡ_u·d_u − s_v − ḡ_v·d_v)² with
//!   H = A_u A_v / (A_u + A_v): what the two linear functions disagree in at the merged position.
//!
//! The merged wedge gets their mean there, weighted by area. Nothing is added for an attribute that
//! is linear over the surface, however steep: a texture laid flat on a plane costs nothing.

use super::attribute_layout::Layout;
use super::lanes::{Lanes, Lanes3, WIDTH};
use super::quadric::{Quadric, QuadricLanes, Vec3};
use super::topology::{Corner, Form, NONE, Topology};
use crate::mesh::Mesh;
use crate::mesh::weld::NO_VERTEX;

/// Values and mean gradients of all wedges, in units of engine space.
#[derive(Debug, Default)]
pub(super) struct AttributeField {
    pub(super) layout: Layout,
    /// By record and component: the value, and the mean gradient ḡ.
    pub(super) rows: Vec<Lanes>,
    /// By record: Σ areas of the wedge's triangles, doubled as those of quadrics.
    pub(super) areas: Vec<f32>,
    /// By vertex the 3×3 matrix: xx xy xz yy | yz zz – –.
    pub(super) stiffness: Vec<[Lanes; 2]>,
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
    /// By triangle and component.
    pub(super) gradients: Vec<Vec3>,
    /// Record, area, and where its gradients begin, of each triangle.
    pub(super) triangles: Vec<(u32, f32, usize)>,
    /// By triangle: see `attribute_update`.
    pub(super) differences: Vec<Lanes>,
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
        let mut rows = vec![Lanes::splat(0.0); wedges.len() * layout.components];
        let mut at = 0;
        for (&w, rows) in wedges.iter().zip(rows.chunks_exact_mut(layout.components)) {
            let w = w as usize;
            if !mesh.wedge_sets[at].wedges.contains(&w) {
                at = mesh.wedge_sets.partition_point(|s| s.wedges.end <= w);
            }
            let set = &mesh.wedge_sets[at];
            for p in &layout.sets[at] {
                let attribute = &set.attributes[p.attribute];
                let first = (w - set.wedges.start) * attribute.components;
                for (row, value) in rows[p.start..p.start + p.length].iter_mut().zip(&attribute.values[first..]) {
                    *row = Lanes::new([value * p.weight, 0.0, 0.0, 0.0]);
                }
            }
        }
        let mut field = Self {
            layout,
            rows,
            areas: vec![0.0; wedges.len()],
            stiffness: vec![[Lanes::splat(0.0); 2]; vertices],
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

    #[inline(always)]
    pub(super) fn rows_of(&self, record: u32) -> &[Lanes] {
        let first = record as usize * self.layout.components;
        &self.rows[first..first + self.layout.components]
    }

    /// The 3×3 matrices of four vertices.
    #[inline(always)]
    pub(super) fn matrices(&self, four: [u32; WIDTH]) -> QuadricLanes {
        let rows = four.map(|v| self.stiffness[v as usize]);
        let [xx, xy, xz, yy] = Lanes::transpose(rows.map(|r| r[0]));
        let [yz, zz, ..] = Lanes::transpose(rows.map(|r| r[1]));
        QuadricLanes { xx, xy, xz, yy, yz, zz, ..QuadricLanes::zero() }
    }

    fn matrix(&self, v: u32) -> Quadric {
        let [[xx, xy, xz, yy], [yz, zz, ..]] = self.stiffness[v as usize].map(Lanes::to_array);
        Quadric { xx, xy, xz, yy, yz, zz, g: Vec3::ZERO }
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

    /// What the wedges of the edges from `u` to four others disagree in; `h` is half of each edge.
    #[inline(always)]
    pub(super) fn mismatch(&self, topology: &Topology, u: u32, four: [u32; WIDTH], h: Lanes3) -> Mismatch {
        let mut sum =
            Mismatch { matrix: QuadricLanes::zero(), linear: Lanes3::splat(Vec3::ZERO), constant: Lanes::splat(0.0) };
        let own = self.only_record[u as usize];
        let others = four.map(|v| self.only_record[v as usize]);
        if own != NONE && !others.contains(&NONE) {
            self.add_mismatch([own; WIDTH], others, [true; WIDTH], h, &mut sum);
        } else {
            let pairs = four.map(|v| self.pairs(topology, u, v));
            for side in 0..2 {
                if pairs.iter().any(|p| p[side].is_some()) {
                    let counts = pairs.map(|p| p[side].is_some());
                    let of = pairs.map(|p| p[side].unwrap_or((0, 0)));
                    self.add_mismatch(of.map(|p| p.0), of.map(|p| p.1), counts, h, &mut sum);
                }
            }
        }
        sum
    }

    #[inline(always)]
    fn add_mismatch(
        &self,
        of_u: [u32; WIDTH],
        of_v: [u32; WIDTH],
        counts: [bool; WIDTH],
        h: Lanes3,
        sum: &mut Mismatch,
    ) {
        let area = |r: u32| self.areas[r as usize];
        let harmonic = Lanes::new(std::array::from_fn(|k| {
            let (a, b) = (area(of_u[k]), area(of_v[k]));
            if counts[k] && a + b > 0.0 { a * b / (a + b) } else { 0.0 }
        }));
        let (of_u, of_v) = (of_u.map(|r| self.rows_of(r)), of_v.map(|r| self.rows_of(r)));
        for k in 0..self.layout.components {
            let [su, x, y, z] = Lanes::transpose(of_u.map(|rows| rows[k]));
            let gu = Lanes3 { x, y, z };
            let [sv, x, y, z] = Lanes::transpose(of_v.map(|rows| rows[k]));
            let gv = Lanes3 { x, y, z };
            let constant = su - sv + (gu + gv).dot(h);
            let e = gu - gv;
            let weighted = e.scale(harmonic);
            let m = &mut sum.matrix;
            m.xx = m.xx + weighted.x * e.x;
            m.xy = m.xy + weighted.x * e.y;
            m.xz = m.xz + weighted.x * e.z;
            m.yy = m.yy + weighted.y * e.y;
            m.yz = m.yz + weighted.y * e.z;
            m.zz = m.zz + weighted.z * e.z;
            sum.linear = sum.linear + weighted.scale(constant);
            sum.constant = sum.constant + harmonic * constant * constant;
        }
    }

    /// The attributes' part of the cost of merging `u` and `v` at `p`.
    pub(super) fn cost_at(&self, topology: &Topology, u: u32, v: u32, p: Vec3) -> f32 {
        let [du, dv] = [u, v].map(|end| p - topology.vertices[end as usize].position());
        let mut cost = self.matrix(u).error_at(du) + self.matrix(v).error_at(dv);
        for (a, b) in self.pairs(topology, u, v).into_iter().flatten() {
            let (wa, wb) = (self.areas[a as usize], self.areas[b as usize]);
            let harmonic = if wa + wb > 0.0 { wa * wb / (wa + wb) } else { 0.0 };
            for (&row_a, &row_b) in self.rows_of(a).iter().zip(self.rows_of(b)) {
                let miss = value_at(row_a, du) - value_at(row_b, dv);
                cost += harmonic * miss * miss;
            }
        }
        cost
    }
}

/// s + ḡ·d.
#[inline(always)]
pub(super) fn value_at(row: Lanes, d: Vec3) -> f32 {
    let [s, x, y, z] = row.to_array();
    s + x * d.x + y * d.y + z * d.z
}
