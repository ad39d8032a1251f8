//! Contraction of a triangle: its three corners become one vertex at once.
//!
//! What a collapse costs in time is mostly what happens around it: the flip test and the quadrics of the merged ring, and
//! an entry in the ring of each neighbour. Two vertices that go together share that. Where three corners merge for no
//! more error than the sweep's threshold allows an edge (the triangle contraction of Hamann 1994, with the quadrics of this
//! engine), nothing is lost by it: the sweep would have taken those edges one after the other.
//!
//! Only the usual case is contracted: manifold vertices with short closed rings, one wedge each, and no attributes in the
//! cost. Everything else is left to the edges.

use super::Simplifier;
use super::collapse::{Patch, splice_slots};
use super::edges::NEAR_RING;
use super::lanes::{Lanes, Lanes3, WIDTH, equal_bits};
use super::legality::Refusal;
use super::placement::Placement;
use super::quadric::{QuadricLanes, Vec3, larger};
use super::topology::{Form, NONE, Topology};
use crate::mesh::Mesh;

/// Fewest triangles at each corner: with three, a corner has no neighbour of its own.
const LEAST_RING: usize = 4;

impl Simplifier {
    /// Whether triangles may be contracted in this run at all.
    pub(super) fn contracts(&self) -> bool {
        self.near && !self.options.every_level && self.protection.is_empty()
    }

    /// Contracts the triangle if that is legal, and records it as two collapses. The first corner stays, the other two
    /// follow in the order of its ring.
    #[inline(never)]
    pub(super) fn try_contraction(
        &mut self,
        mesh: &Mesh,
        corners: [u32; 3],
        placement: Placement,
    ) -> Result<(), Refusal> {
        let [into, a, b] = corners;
        let topology = &self.topology;
        let vertex = |v: u32| &topology.vertices[v as usize];
        let (at_into, at_a, at_b) = (vertex(into), vertex(a), vertex(b));
        let weight = at_into.quadric().trace() + at_a.quadric().trace() + at_b.quadric().trace();
        let step = if weight > 0.0 { placement.cost / weight } else { 0.0 };
        let worst = larger(at_into.error_squared, larger(at_a.error_squared, at_b.error_squared));
        let error_squared = worst + step;
        if error_squared > self.max_error_squared {
            return Err(Refusal::Error);
        }
        let (at_into, at_a, at_b) = (at_into.position(), at_a.position(), at_b.position());
        // One by one: over arrays of options the compiler does not unroll.
        let ring_of = |v: u32| short_ring(topology, v).ok_or(Refusal::Topology);
        let (of_into, of_a, of_b) = (ring_of(into)?, ring_of(a)?, ring_of(b)?);
        let (mut wedge_into, mut wedge_a, mut wedge_b) = (0, 0, 0);
        if topology.has_wedges() {
            let wedge_of = |v: u32| only_wedge(topology, v).ok_or(Refusal::Topology);
            (wedge_into, wedge_a, wedge_b) = (wedge_of(into)?, wedge_of(a)?, wedge_of(b)?);
        }
        let slot = |v: u32, w: u32| topology.slot_of(v, w).ok_or(Refusal::Topology);
        let (i, j, k) = (slot(into, b)?, slot(a, into)?, slot(b, a)?);

        // Triangles of `into` first: (third of b and into, …, third of into and a), then those of a and of b.
        let Patch { ring, .. } = &mut *self.patch;
        let first = of_into.len() - 3;
        let second = first + of_a.len() - 3;
        let length = second + of_b.len() - 3;
        splice_slots(of_into, i, of_into.len() - 3, ring);
        splice_slots(of_a, j, of_a.len() - 3, &mut ring[first..]);
        splice_slots(of_b, k, of_b.len() - 3, &mut ring[second..]);
        for k in 0..WIDTH {
            ring[length + k] = ring[k];
        }
        // The link condition: around the three there is one ring that touches itself nowhere.
        let mut whole = [NONE; 2 * NEAR_RING];
        whole[..length].copy_from_slice(&ring[..length]);
        let [low, high] = whole.as_chunks::<NEAR_RING>().0 else { return Err(Refusal::Topology) };
        let mut common = 0;
        for &v in &whole[first..length] {
            let same = equal_bits(low, v) | (equal_bits(high, v) << NEAR_RING);
            common |= same & (same - 1);
        }
        if common != 0 {
            return Err(Refusal::Topology);
        }
        let origin_of = [(first, at_into), (second, at_a), (length, at_b)];
        let quadric = self.patch.look_at(&self.topology, &origin_of, length, placement.position)?;

        // From here on the contraction is done.
        let Self { topology, patch, .. } = self;
        let thirds = [patch.ring[0], patch.ring[first], patch.ring[second]];
        let removed = removed_planes(topology, thirds, [[at_b, at_into], [at_into, at_a], [at_a, at_b]]);
        patch.spread_differences(topology, length);
        for (third, plane) in thirds.into_iter().zip(&removed) {
            topology.add(third, plane);
        }
        for &v in &patch.ring[first + 1..second] {
            topology.rename(v, a, into);
        }
        for &v in &patch.ring[second + 1..length] {
            topology.rename(v, b, into);
        }
        topology.close_up(thirds[0], b, into, &mut patch.builder);
        topology.close_up(thirds[1], a, into, &mut patch.builder);
        topology.close_up(thirds[2], b, a, &mut patch.builder);
        topology.rename(thirds[2], a, into);
        patch.wedges.clear();
        if topology.has_wedges() {
            patch.wedges.resize(length, wedge_into);
        }
        topology.vanish(b, into);
        topology.set_ring(into, a, Form::Closed, &patch.ring[..length], &patch.wedges);
        self.settle_at(into, placement.position, &quadric, error_squared);
        for (from, wedge) in [(a, wedge_a), (b, wedge_b)] {
            self.topology.live_triangle_count -= 2;
            self.patch.merges.clear();
            if self.topology.has_wedges() {
                self.patch.merges.push((wedge, wedge_into));
            }
            self.record_collapse(mesh, from, into);
            self.keys[from as usize] = f32::INFINITY;
        }
        Ok(())
    }
}

/// The ring of `v` if it is closed and neither too short nor too long.
#[inline(always)]
fn short_ring(topology: &Topology, v: u32) -> Option<&[u32]> {
    let ring = topology.ring(v);
    let vertex = &topology.vertices[v as usize];
    (vertex.form() == Form::Closed && (LEAST_RING..=NEAR_RING).contains(&ring.len()) && !topology.is_hub(v))
        .then_some(ring)
}

/// The wedge of `v` if it has just one.
#[inline(always)]
fn only_wedge(topology: &Topology, v: u32) -> Option<u32> {
    let (&first, rest) = topology.ring_wedges(v).split_first()?;
    rest.iter().all(|&wedge| wedge == first).then_some(first)
}

/// Minus the planes of the triangles that vanish with an edge each, for their third vertices.
#[inline(always)]
fn removed_planes(topology: &Topology, thirds: [u32; 3], edges: [[Vec3; 2]; 3]) -> [[Lanes; 3]; WIDTH] {
    let [at_0, at_1, at_2] = [0, 1, 2].map(|k: usize| topology.vertices[thirds[k] as usize].position());
    let [[from_0, to_0], [from_1, to_1], [from_2, to_2]] = edges;
    let third = Lanes3::gather([at_0, at_1, at_2, at_0]);
    let from = Lanes3::gather([from_0, from_1, from_2, from_0]);
    let to = Lanes3::gather([to_0, to_1, to_2, to_0]);
    // The vanished triangle is (from, third, to).
    let planes = QuadricLanes::of_triangles((third - from).cross(to - from));
    QuadricLanes::zero().minus(&planes).packed()
}
