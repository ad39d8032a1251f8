//! Connectivity of the mesh while it shrinks: the ordered one-ring of every vertex.
//!
//! A ring lists the neighbours of a vertex in the order of its triangles: the triangle after slot
//! `i` is (vertex, ring[i], ring[i + 1]). Rings lie in blocks of 8, 16, 32 … slots in one pool, so
//! that most fit half a cache line and a merged ring mostly fits the block of one of its ends. There
//! are no triangles and no half-edges: a collapse reads two rings, writes one, and changes one
//! entry in each ring around it.
//!
//! A vertex with hundreds of neighbours, a *hub*, would make that one entry a long search. Rings in
//! large blocks are left as they are when a neighbour vanishes, and brought up to date when they are
//! next read ([`Topology::refresh`]).

use super::lanes::{Lanes, equal_bits, replace};
use super::quadric::{Packed, Quadric, Vec3};
use super::vertex_kind::VertexKind;

/// No vertex; separates the chains of a ring in parts.
pub(super) const NONE: u32 = u32::MAX;

/// How a ring lies in its slots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Form {
    /// One cycle: the last slot is followed by the first. Every neighbour occurs once.
    Closed,
    /// One chain: there is no triangle after the last slot. Every neighbour occurs once.
    Open,
    /// Several chains with [`NONE`] between them, or a neighbour that occurs more than once.
    Parts,
}

/// All that an evaluation needs of a vertex, in one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Vertex {
    /// Position and quadric.
    pub(super) packed: Packed,
    ring_start: u32,
    ring_length: u32,
    /// Estimated squared deviation here, in engine units.
    pub(super) error_squared: f32,
    pub(super) kind: VertexKind,
    form: Form,
    /// Logarithm to base 2 of the number of slots in the block.
    block: u8,
    /// No longer where the original was.
    pub(super) moved: bool,
}

const _: () = assert!(size_of::<Vertex>() == 64);

impl Vertex {
    #[inline(always)]
    pub(super) fn position(&self) -> Vec3 {
        self.packed.position()
    }

    #[inline(always)]
    pub(super) fn quadric(&self) -> Quadric {
        self.packed.quadric()
    }

    #[inline(always)]
    pub(super) fn form(&self) -> Form {
        self.form
    }

    #[inline(always)]
    pub(super) fn ring_length(&self) -> usize {
        self.ring_length as usize
    }
}

/// A triangle seen from one of its vertices: (vertex, next, previous) keep its winding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) next: u32,
    pub(super) previous: u32,
    /// The vertex's wedge in this triangle; 0 if there are none.
    pub(super) wedge: u32,
}

/// Smallest block: 8 slots.
const LEAST_BLOCK: u8 = 3;

/// Logarithm of the block size from which on a vertex is a hub.
const HUB_BLOCK: u8 = 9;

/// Vertices and their rings.
#[derive(Debug, Default)]
pub(super) struct Topology {
    pub(super) vertices: Vec<Vertex>,
    slots: Vec<u32>,
    /// For each slot the vertex's wedge in the triangle after it; empty when every vertex has one.
    wedges: Vec<u32>,
    has_wedges: bool,
    /// Free blocks by the logarithm of their size.
    free: Vec<Vec<u32>>,
    /// The vertex that each was merged into; itself while it lives.
    merged_into: Vec<u32>,
    pub(super) live_triangle_count: usize,
}

impl Topology {
    /// Vertices without rings; see [`Topology::replace_ring`]. About `long` slots are for rings of more than eight.
    pub(super) fn new(
        positions: impl ExactSizeIterator<Item = Vec3>,
        has_wedges: bool,
        triangles: usize,
        long: usize,
    ) -> Self {
        let count = positions.len();
        let vertices = positions
            .zip(0_u32..)
            .map(|(position, v)| Vertex {
                packed: Packed::at(position),
                ring_start: v << LEAST_BLOCK,
                ring_length: 0,
                error_squared: 0.0,
                kind: VertexKind::Manifold,
                form: Form::Closed,
                block: LEAST_BLOCK,
                moved: false,
            })
            .collect();
        // A block for each vertex, and room for the few vertices with more than eight neighbours, now and later.
        let mut slots = Vec::with_capacity((count << LEAST_BLOCK) + long + 2 * count + 64);
        slots.resize(count << LEAST_BLOCK, NONE);
        let mut wedges = Vec::with_capacity(if has_wedges { slots.capacity() } else { 0 });
        wedges.resize(if has_wedges { slots.len() } else { 0 }, 0);
        let merged_into = (0..count as u32).collect();
        let free = vec![Vec::new(); 33];
        Self { vertices, slots, wedges, has_wedges, free, merged_into, live_triangle_count: triangles }
    }

    #[inline(always)]
    pub(super) fn has_wedges(&self) -> bool {
        self.has_wedges
    }

    #[inline(always)]
    pub(super) fn ring(&self, v: u32) -> &[u32] {
        let vertex = &self.vertices[v as usize];
        let start = vertex.ring_start as usize;
        &self.slots[start..start + vertex.ring_length as usize]
    }

    /// Whether `v` has a closed ring of at most eight in the block it was made with.
    pub(super) fn is_short(&self, v: u32) -> bool {
        let vertex = &self.vertices[v as usize];
        let own = vertex.block == LEAST_BLOCK && vertex.ring_start == v << LEAST_BLOCK;
        own && vertex.form == Form::Closed && (3..=8).contains(&vertex.ring_length)
    }

    /// The block that `v` was made with.
    #[inline(always)]
    pub(super) fn first_block(&mut self, v: u32) -> Option<&mut [u32; 8]> {
        self.slots.get_mut((v as usize) << LEAST_BLOCK..)?.first_chunk_mut()
    }

    /// Of a short ring that was changed in its block: its length, 0 if the vertex is gone, and the error there.
    pub(super) fn settle_short(&mut self, v: usize, length: u32, error_squared: f32) {
        let vertex = &mut self.vertices[v];
        (vertex.ring_length, vertex.error_squared) = (length, error_squared);
        if length == 0 {
            self.free[usize::from(LEAST_BLOCK)].push(vertex.ring_start);
        }
    }

    /// Vertex `v` went into another.
    #[inline(always)]
    pub(super) fn note_merge(&mut self, v: u32, into: u32) {
        self.merged_into[v as usize] = into;
    }

    /// The wedges that go with [`Topology::ring`].
    #[inline(always)]
    pub(super) fn ring_wedges(&self, v: u32) -> &[u32] {
        let vertex = &self.vertices[v as usize];
        let start = vertex.ring_start as usize;
        &self.wedges[start..start + vertex.ring_length as usize]
    }

    /// Where `neighbour` is in the ring of `v`, which has it once.
    #[inline(always)]
    pub(super) fn slot_of(&self, v: u32, neighbour: u32) -> Option<usize> {
        let vertex = &self.vertices[v as usize];
        let start = vertex.ring_start as usize;
        let length = vertex.ring_length as usize;
        if vertex.block == LEAST_BLOCK {
            // Eight comparisons and no branch: where a search would end cannot be predicted. What is
            // behind the ring's end may be equal, but comes later.
            let found =
                equal_bits(self.slots.get(start..start + 8)?.first_chunk()?, neighbour).trailing_zeros() as usize;
            (found < length).then_some(found)
        } else {
            self.slots[start..start + length].iter().position(|&r| r == neighbour)
        }
    }

    /// Appends the triangles at `v`.
    pub(super) fn corners(&self, v: u32, corners: &mut Vec<Corner>) {
        let vertex = &self.vertices[v as usize];
        let ring = self.ring(v);
        let start = vertex.ring_start as usize;
        let wedge = |i: usize| if self.has_wedges { self.wedges[start + i] } else { 0 };
        for i in 1..ring.len() {
            if ring[i - 1] != NONE && ring[i] != NONE {
                corners.push(Corner { next: ring[i - 1], previous: ring[i], wedge: wedge(i - 1) });
            }
        }
        if let (Form::Closed, [first, .., last]) = (vertex.form, ring) {
            corners.push(Corner { next: *last, previous: *first, wedge: wedge(ring.len() - 1) });
        }
    }

    /// How many triangles there are at `v`.
    pub(super) fn triangles_at(&self, v: u32) -> usize {
        let ring = self.ring(v);
        let chained = ring.windows(2).filter(|pair| pair[0] != NONE && pair[1] != NONE).count();
        chained + usize::from(self.vertices[v as usize].form == Form::Closed && ring.len() > 1)
    }

    /// Gives `v` a ring, in its own block if it fits, else in that of `spare`, else in another.
    /// Vertex `spare` is gone and its block is free afterwards.
    pub(super) fn set_ring(&mut self, v: u32, spare: u32, form: Form, ring: &[u32], wedges: &[u32]) {
        let (own, other) = (self.vertices[v as usize], self.vertices[spare as usize]);
        let size = |block: u8| 1_usize << block;
        let (mut start, mut block) = (own.ring_start, own.block);
        if ring.len() <= size(own.block) {
            self.free[usize::from(other.block)].push(other.ring_start);
        } else {
            self.free[usize::from(own.block)].push(own.ring_start);
            (start, block) = (other.ring_start, other.block);
            if ring.len() > size(other.block) {
                self.free[usize::from(other.block)].push(other.ring_start);
                (start, block) = self.allocate(ring.len());
            }
        }
        self.merged_into[spare as usize] = v;
        let spare = &mut self.vertices[spare as usize];
        (spare.ring_length, spare.block) = (0, LEAST_BLOCK);
        self.write(v, start, block, form, ring, wedges);
    }

    /// Vertex `v` is gone, merged into `into`, and its block is free.
    #[inline(always)]
    pub(super) fn vanish(&mut self, v: u32, into: u32) {
        let vertex = &mut self.vertices[v as usize];
        self.free[usize::from(vertex.block)].push(vertex.ring_start);
        (vertex.ring_length, vertex.block) = (0, LEAST_BLOCK);
        self.merged_into[v as usize] = into;
    }

    /// Whether the ring of `v` may name vertices that are gone; see [`Topology::refresh`].
    #[inline(always)]
    pub(super) fn is_hub(&self, v: u32) -> bool {
        self.vertices[v as usize].block >= HUB_BLOCK
    }

    /// Gives `v` another ring.
    #[inline(always)]
    pub(super) fn replace_ring(&mut self, v: u32, form: Form, ring: &[u32], wedges: &[u32]) {
        let own = self.vertices[v as usize];
        let (mut start, mut block) = (own.ring_start, own.block);
        let size = 1_usize << block;
        if ring.len() > size || (block >= HUB_BLOCK && ring.len() < size / 4) {
            self.free[usize::from(block)].push(start);
            (start, block) = self.allocate(ring.len());
        }
        self.write(v, start, block, form, ring, wedges);
    }

    /// As [`Topology::replace_ring`] for a closed ring of at most eight in a first block.
    #[inline(always)]
    pub(super) fn set_short_ring(&mut self, v: u32, ring: &[u32; 8], length: usize) {
        let vertex = &mut self.vertices[v as usize];
        vertex.ring_length = length as u32;
        let start = vertex.ring_start as usize;
        if let Some(block) = self.slots.get_mut(start..start + 8) {
            block.copy_from_slice(ring);
        }
    }

    #[cold]
    fn allocate(&mut self, length: usize) -> (u32, u8) {
        let block = (usize::BITS - length.saturating_sub(1).leading_zeros()).max(u32::from(LEAST_BLOCK)) as u8;
        let start = self.free[usize::from(block)].pop().unwrap_or_else(|| {
            let start = self.slots.len();
            grow(&mut self.slots, 1 << block, NONE);
            if self.has_wedges {
                grow(&mut self.wedges, 1 << block, 0);
            }
            start as u32
        });
        (start, block)
    }

    #[inline(always)]
    fn write(&mut self, v: u32, start: u32, block: u8, form: Form, ring: &[u32], wedges: &[u32]) {
        let vertex = &mut self.vertices[v as usize];
        (vertex.ring_start, vertex.block) = (start, block);
        (vertex.ring_length, vertex.form) = (ring.len() as u32, form);
        let start = start as usize;
        copy(&mut self.slots, start, block, ring);
        if self.has_wedges {
            copy(&mut self.wedges, start, block, wedges);
        }
    }

    /// In the ring of `v`, every `old` is `new` from now on.
    #[inline(always)]
    pub(super) fn rename(&mut self, v: u32, old: u32, new: u32) {
        let vertex = &self.vertices[v as usize];
        if vertex.block >= HUB_BLOCK {
            return;
        }
        let start = vertex.ring_start as usize;
        // The whole block, eight slots at once: where a search would end cannot be predicted, and
        // what is behind the ring's end does not matter.
        for slots in self.slots[start..start + (1 << vertex.block)].as_chunks_mut::<8>().0 {
            replace(slots, old, new);
        }
    }

    /// The triangle of `v`, `from` and `into` vanishes, and `from` is `into` in the ring of `v`.
    #[inline(always)]
    pub(super) fn close_up(&mut self, v: u32, from: u32, into: u32, builder: &mut RingBuilder) {
        let vertex = &self.vertices[v as usize];
        if vertex.form == Form::Parts || vertex.block >= HUB_BLOCK {
            if vertex.block < HUB_BLOCK {
                self.rebuild(v, builder, |w| if w == from { into } else { w });
            }
            return;
        }
        let (Some(at_from), Some(at_into)) = (self.slot_of(v, from), self.slot_of(v, into)) else { return };
        let vertex = &mut self.vertices[v as usize];
        let (start, length) = (vertex.ring_start as usize, vertex.ring_length as usize);
        // The slot before the triangle goes: its wedge is the triangle's.
        let after_from = if at_from + 1 == length { 0 } else { at_from + 1 };
        let gone = if after_from == at_into {
            at_from
        } else {
            self.slots[start + at_from] = into;
            at_into
        };
        // A chain of one neighbour has no triangle left.
        vertex.ring_length = if vertex.form == Form::Open && length == 2 { 0 } else { vertex.ring_length - 1 };
        if vertex.block == LEAST_BLOCK {
            // Of the whole block, in registers: a call of `memmove` takes longer.
            if let Some(slots) = self.slots[start..start + 8].first_chunk_mut::<8>() {
                let old = *slots;
                *slots = std::array::from_fn(|k| if k < gone { old[k] } else { old[(k + 1) & 7] });
            }
        } else {
            self.slots.copy_within(start + gone + 1..start + length, start + gone);
        }
        if self.has_wedges {
            self.wedges.copy_within(start + gone + 1..start + length, start + gone);
        }
    }

    /// In the ring of `v`, which may have both, `from` is `into` from now on; triangles of the three
    /// are gone.
    pub(super) fn rename_any(&mut self, v: u32, from: u32, into: u32, builder: &mut RingBuilder) {
        if self.vertices[v as usize].block < HUB_BLOCK {
            self.rebuild(v, builder, |w| if w == from { into } else { w });
        }
    }

    /// The vertex that lives where `v` was.
    pub(super) fn living(&mut self, v: u32) -> u32 {
        root(&mut self.merged_into, v)
    }

    /// Brings the ring of a hub up to date.
    #[inline(always)]
    pub(super) fn refresh(&mut self, v: u32, builder: &mut RingBuilder) {
        if self.vertices[v as usize].block >= HUB_BLOCK {
            let mut merged_into = std::mem::take(&mut self.merged_into);
            self.rebuild(v, builder, |w| root(&mut merged_into, w));
            self.merged_into = merged_into;
        }
    }

    /// Brings every hub's ring up to date, for good, and returns the vertex that lives now where each vertex was.
    pub(super) fn settle(&mut self, builder: &mut RingBuilder) -> Vec<u32> {
        for v in 0..self.vertices.len() as u32 {
            root(&mut self.merged_into, v);
            self.refresh(v, builder);
        }
        std::mem::take(&mut self.merged_into)
    }

    /// Renames the neighbours of `v`; triangles of which two are the same now are gone.
    #[inline(never)]
    fn rebuild(&mut self, v: u32, builder: &mut RingBuilder, mut name: impl FnMut(u32) -> u32) {
        let mut corners = std::mem::take(&mut builder.corners);
        corners.clear();
        self.corners(v, &mut corners);
        for corner in &mut corners {
            (corner.next, corner.previous) = (name(corner.next), name(corner.previous));
        }
        corners.retain(|c| c.next != c.previous);
        let form = builder.build(&corners);
        builder.corners = corners;
        self.replace_ring(v, form, &builder.ring, &builder.wedges);
    }

    /// Area vector (twice the area long) of the triangle (position, next, previous).
    #[inline(always)]
    pub(super) fn area_vector(&self, position: Vec3, next: u32, previous: u32) -> Vec3 {
        let a = self.vertices[next as usize].position() - position;
        let b = self.vertices[previous as usize].position() - position;
        a.cross(b)
    }

    #[inline(always)]
    pub(super) fn add(&mut self, v: u32, difference: &[Lanes; 3]) {
        self.vertices[v as usize].packed.add(difference);
    }
}

/// Lengthens the pool. By an eighth and not by all of it again where there is no room: it is the largest thing there is.
fn grow(pool: &mut Vec<u32>, by: usize, value: u32) {
    if pool.capacity() - pool.len() < by {
        pool.reserve_exact(by.max(pool.len() / 8));
    }
    pool.resize(pool.len() + by, value);
}

/// The living vertex that `v` was merged into, with the path to it halved.
fn root(merged_into: &mut [u32], v: u32) -> u32 {
    let mut at = v;
    loop {
        let next = merged_into[at as usize];
        let after = merged_into[next as usize];
        if next == after {
            merged_into[v as usize] = next;
            return next;
        }
        merged_into[at as usize] = after;
        at = after;
    }
}

/// Copies the values to a block. Short ones in registers: a call of `memcpy` takes longer.
#[inline(always)]
fn copy(slots: &mut [u32], start: usize, block: u8, values: &[u32]) {
    if block == LEAST_BLOCK
        && let Some(to) = slots[start..start + 8].first_chunk_mut::<8>()
    {
        *to = std::array::from_fn(|k| values.get(k).copied().unwrap_or(NONE));
    } else {
        slots[start..start + values.len()].copy_from_slice(values);
    }
}

/// A ring put together from the triangles at a vertex.
#[derive(Debug, Default)]
pub(super) struct RingBuilder {
    pub(super) ring: Vec<u32>,
    pub(super) wedges: Vec<u32>,
    /// Which corner each slot starts; [`NONE`] at the ends of chains.
    pub(super) order: Vec<u32>,
    used: Vec<bool>,
    by_next: Vec<(u32, u32)>,
    /// For each entry of `by_next`, how many of its run are used up.
    taken: Vec<u32>,
    previous: Vec<u32>,
    corners: Vec<Corner>,
}

impl RingBuilder {
    /// Orders `corners`; the result is in `ring`, `wedges` and `order`.
    #[inline(always)]
    pub(super) fn build(&mut self, corners: &[Corner]) -> Form {
        self.ring.clear();
        self.wedges.clear();
        self.order.clear();
        if corners.len() <= 8 && self.build_cycle(corners) {
            return Form::Closed;
        }
        self.ring.clear();
        self.wedges.clear();
        self.order.clear();
        self.build_any(corners)
    }

    /// The usual case: one cycle in which every corner has just one successor.
    #[inline(always)]
    fn build_cycle(&mut self, corners: &[Corner]) -> bool {
        let mut starts = [NONE; 8];
        for (start, corner) in starts.iter_mut().zip(corners) {
            *start = corner.next;
        }
        let mut current = 0;
        for _ in 0..corners.len() {
            let corner = corners[current];
            self.push(corner.next, corner.wedge, current as u32);
            let successors = equal_bits(&starts, corner.previous);
            if successors.count_ones() != 1 {
                return false;
            }
            current = successors.trailing_zeros() as usize;
            if current == 0 {
                break;
            }
        }
        current == 0 && self.ring.len() == corners.len() && corners.len() > 1
    }

    /// Any soup: chains from every corner that none leads to, then what is left. `O(n log n)`.
    fn build_any(&mut self, corners: &[Corner]) -> Form {
        self.used.clear();
        self.used.resize(corners.len(), false);
        self.by_next.clear();
        self.by_next.extend(corners.iter().zip(0..).map(|(c, i)| (c.next, i)));
        self.by_next.sort_unstable();
        self.taken.clear();
        self.taken.resize(corners.len(), 0);
        self.previous.clear();
        self.previous.extend(corners.iter().map(|c| c.previous));
        self.previous.sort_unstable();
        let mut parts = 0;
        let mut closed = false;
        for only_openings in [true, false] {
            for i in 0..corners.len() {
                if self.used[i] || (only_openings && self.previous.binary_search(&corners[i].next).is_ok()) {
                    continue;
                }
                if parts > 0 {
                    self.push(NONE, 0, NONE);
                }
                parts += 1;
                closed = self.follow(corners, i);
            }
        }
        self.by_next.dedup_by_key(|c| c.0);
        self.previous.dedup();
        let simple = self.by_next.len() == corners.len() && self.previous.len() == corners.len() && parts == 1;
        if simple && closed && corners.len() > 1 {
            self.ring.pop();
            self.wedges.pop();
            self.order.pop();
            return Form::Closed;
        }
        if simple { Form::Open } else { Form::Parts }
    }

    /// One chain from corner `first`; true if it comes back to its beginning.
    fn follow(&mut self, corners: &[Corner], first: usize) -> bool {
        let mut current = first;
        loop {
            let corner = corners[current];
            self.used[current] = true;
            self.push(corner.next, corner.wedge, current as u32);
            let run = self.by_next.partition_point(|c| c.0 < corner.previous);
            let mut successor = None;
            while let Some(&(next, i)) = self.by_next.get(run + self.taken.get(run).map_or(0, |&t| t as usize))
                && next == corner.previous
            {
                if !self.used[i as usize] {
                    successor = Some(i as usize);
                    break;
                }
                self.taken[run] += 1;
            }
            let Some(successor) = successor else {
                self.push(corner.previous, 0, NONE);
                return corner.previous == corners[first].next;
            };
            current = successor;
        }
    }

    fn push(&mut self, neighbour: u32, wedge: u32, corner: u32) {
        self.ring.push(neighbour);
        self.wedges.push(wedge);
        self.order.push(corner);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(pairs: &[(u32, u32)]) -> Vec<Corner> {
        pairs.iter().map(|&(next, previous)| Corner { next, previous, wedge: next + 100 }).collect()
    }

    fn built(pairs: &[(u32, u32)]) -> (Form, Vec<u32>) {
        let mut builder = RingBuilder::default();
        let form = builder.build(&corners(pairs));
        (form, builder.ring)
    }

    #[test]
    fn a_cycle_is_closed_in_the_order_of_its_triangles() {
        assert_eq!(built(&[(1, 2), (4, 1), (2, 3), (3, 4)]), (Form::Closed, vec![1, 2, 3, 4]));
    }

    #[test]
    fn a_gap_makes_a_chain_from_its_far_side() {
        assert_eq!(built(&[(2, 3), (1, 2), (3, 4)]), (Form::Open, vec![1, 2, 3, 4]));
        assert_eq!(built(&[(5, 6)]), (Form::Open, vec![5, 6]));
    }

    #[test]
    fn two_fans_and_edges_of_three_triangles_come_in_parts() {
        assert_eq!(built(&[(1, 2), (3, 4)]), (Form::Parts, vec![1, 2, NONE, 3, 4]));
        let (form, ring) = built(&[(1, 2), (2, 1), (3, 4), (4, 3)]);
        assert_eq!((form, ring), (Form::Parts, vec![1, 2, 1, NONE, 3, 4, 3]));
        assert_eq!(built(&[(1, 2), (1, 3), (1, 4)]).0, Form::Parts);
    }

    #[test]
    fn corners_of_a_ring_are_those_it_was_built_from() {
        for pairs in [&[(1, 2), (4, 1), (2, 3), (3, 4)][..], &[(2, 3), (1, 2)], &[(1, 2), (3, 4), (1, 5), (2, 1)]] {
            let mut expected = corners(pairs);
            let mut builder = RingBuilder::default();
            let form = builder.build(&expected);
            let mut topology = Topology::new([Vec3::ZERO; 1].into_iter(), true, pairs.len(), 0);
            topology.replace_ring(0, form, &builder.ring, &builder.wedges);
            let mut found = Vec::new();
            topology.corners(0, &mut found);
            expected.sort_by_key(|c| (c.next, c.previous));
            found.sort_by_key(|c| (c.next, c.previous));
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn many_triangles_on_one_edge_take_no_quadratic_time() {
        let pairs: Vec<(u32, u32)> = (0..200_000).map(|i| (1, i + 2)).chain((0..200_000).map(|i| (i + 2, 1))).collect();
        assert_eq!(built(&pairs).0, Form::Parts);
    }
}
