//! One edge collapse: looked at whole, then refused or done.
//!
//! Two vertices with closed rings, which is nearly always the case, are merged by splicing the
//! rings: every vertex around them is read once and written once. All other pairs go through
//! lists of triangles, which bear any soup.

use super::attribute_update::Spliced;
use super::lanes::{Lanes, Lanes3, WIDTH};
use super::legality::{self, Refusal};
use super::placement::Placement;
use super::polylines::Polylines;
use super::quadric::{Quadric, QuadricLanes, Vec3, smaller};
use super::topology::{Corner, Form, RingBuilder, Topology, Vertex};
use super::vertex_kind::VertexKind;
use super::{PlacementRule, Simplifier};

/// Longest merged ring that is spliced in place.
const CAPACITY: usize = 64;

/// Buffers that live as long as the run, so that the loop allocates nothing.
#[derive(Debug)]
pub(super) struct Patch {
    /// The merged ring, repeated from its beginning for whole lanes.
    pub(super) ring: [u32; CAPACITY + WIDTH],
    /// Positions of the merged ring.
    around: [Lanes3; CAPACITY / WIDTH + 1],
    /// By triangle: its quadric after the collapse less that before.
    differences: [[Lanes; 3]; CAPACITY + WIDTH],
    pub(super) wedges: Vec<u32>,
    /// Wedges `(from, into)` that the last collapse merged.
    pub(super) merges: Vec<(u32, u32)>,
    corners_from: Vec<Corner>,
    corners_into: Vec<Corner>,
    /// How many edges of more than two triangles a loose merge makes beyond those that it removes.
    new_sheet_edges: i64,
    changes: Vec<Change>,
    neighbours: Vec<u32>,
    pub(super) builder: RingBuilder,
    /// First wedge of each wedge set.
    pub(super) set_starts: Vec<u32>,
    marks: Vec<u32>,
    epoch: u32,
}

impl Default for Patch {
    fn default() -> Self {
        let none = [Lanes::splat(0.0); 3];
        Self {
            ring: [0; CAPACITY + WIDTH],
            around: [Lanes3::splat(Vec3::ZERO); CAPACITY / WIDTH + 1],
            differences: [none; CAPACITY + WIDTH],
            wedges: Vec::new(),
            merges: Vec::new(),
            corners_from: Vec::new(),
            corners_into: Vec::new(),
            new_sheet_edges: 0,
            changes: Vec::new(),
            neighbours: Vec::new(),
            builder: RingBuilder::default(),
            set_starts: Vec::new(),
            marks: Vec::new(),
            epoch: 0,
        }
    }
}

/// A triangle that stays, seen from the end of the edge it belongs to.
#[derive(Debug, Clone, Copy)]
struct Change {
    vertex: u32,
    corner: Corner,
    difference: [Lanes; 3],
}

impl Simplifier {
    /// Collapses the edge if it is legal: `from` vanishes, `into` moves to the placement.
    #[inline(always)]
    pub(super) fn try_collapse(&mut self, from: u32, into: u32, placement: Placement) -> Result<(), Refusal> {
        let error_squared = self.admit(from, into, placement)?;
        let (a, b) = (&self.topology.vertices[from as usize], &self.topology.vertices[into as usize]);
        let (kind_from, kind_into) = (a.kind, b.kind);
        let spliced = a.form() == Form::Closed
            && b.form() == Form::Closed
            && a.ring_length() + b.ring_length() <= CAPACITY
            && kind_from < VertexKind::Corner;
        let (old_from, old_into, length_from) = (a.position(), b.position(), a.ring_length());
        let quadric =
            if spliced { self.splice(from, into, placement)? } else { self.merge_any(from, into, placement)? };
        self.settle_at(into, placement.position, &quadric, error_squared);
        if kind_from > VertexKind::Manifold || kind_into > VertexKind::Manifold {
            self.update_lines((from, old_from), (into, old_into));
        }
        self.follow_attributes(spliced.then(|| length_from - 2), (from, old_from), (into, old_into));
        Ok(())
    }

    /// As [`Simplifier::try_collapse`] for two vertices that no edge joins.
    #[inline(never)]
    pub(super) fn try_merge(&mut self, from: u32, into: u32, placement: Placement) -> Result<(), Refusal> {
        let error_squared = self.admit(from, into, placement)?;
        let [old_from, old_into] = [from, into].map(|v| self.topology.vertices[v as usize].position());
        let quadric = self.merge_any(from, into, placement)?;
        self.settle_at(into, placement.position, &quadric, error_squared);
        self.update_lines((from, old_from), (into, old_into));
        self.follow_attributes(None, (from, old_from), (into, old_into));
        Ok(())
    }

    #[inline(always)]
    pub(super) fn settle_at(&mut self, v: u32, position: Vec3, quadric: &Quadric, error_squared: f32) {
        let vertex = &mut self.topology.vertices[v as usize];
        vertex.moved |= vertex.position() != position;
        vertex.packed.set_quadric(quadric);
        vertex.packed.set_position(position);
        vertex.error_squared = error_squared;
    }

    /// What can be said before the rings are looked at. Returns the squared error that the merged vertex has.
    #[inline(always)]
    fn admit(&mut self, from: u32, into: u32, placement: Placement) -> Result<f32, Refusal> {
        let Placement { position, cost } = placement;
        // The error is that of the surface, however dear it was made.
        let cost = if self.protection.is_empty() { cost } else { cost / self.protection.factor(from, into) };
        let length = |v: u32| self.topology.vertices[v as usize].ring_length();
        if length(from) + length(into) > legality::MAX_FAN {
            return Err(Refusal::Topology);
        }
        for v in [from, into] {
            self.topology.refresh(v, &mut self.patch.builder);
        }
        let (a, b) = (&self.topology.vertices[from as usize], &self.topology.vertices[into as usize]);
        if a.kind > VertexKind::Manifold
            && !self.pairing
            && !polyline_stays_open(&self.polylines, &self.topology, from, into)
        {
            return Err(Refusal::Lines);
        }
        let weight = a.quadric().trace() + b.quadric().trace();
        let cost = match &self.attributes {
            // What attributes add is no deviation.
            Some(_) => {
                let end = |v: &Vertex| v.quadric().error_at(position - v.position());
                smaller(end(a) + end(b), cost)
            }
            None => cost,
        };
        let step = if weight > 0.0 { cost / weight } else { 0.0 };
        let error_squared = if a.error_squared > b.error_squared { a.error_squared } else { b.error_squared } + step;
        if error_squared > self.max_error_squared { Err(Refusal::Error) } else { Ok(error_squared) }
    }

    /// Gives attributes what follows from a collapse that is done.
    #[inline(always)]
    fn follow_attributes(&mut self, split: Option<usize>, from: (u32, Vec3), into: (u32, Vec3)) {
        let Some(attributes) = &mut self.attributes else { return };
        let Patch { ring, merges, around, .. } = &*self.patch;
        let spliced = split.map(|split| {
            let ring = &ring[..self.topology.vertices[into.0 as usize].ring_length()];
            Spliced { ring, split, around }
        });
        let solve = self.options.placement == PlacementRule::Optimal;
        attributes.follow(&self.topology, spliced, merges, (from, into), solve);
    }

    /// As [`Simplifier::try_collapse`], without doing it.
    pub(super) fn inspect(&mut self, from: u32, into: u32, placement: Placement) -> Result<(), Refusal> {
        let cost = placement.cost * self.protection.factor(from, into);
        self.admit(from, into, Placement { cost, ..placement })?;
        self.inspect_any(from, into, placement).map(|_| ())
    }

    /// Merges two closed rings. Returns the quadric of the merged vertex.
    #[inline(always)]
    fn splice(&mut self, from: u32, into: u32, placement: Placement) -> Result<Quadric, Refusal> {
        let Self { topology, patch, .. } = self;
        let (Some(i), Some(j)) = (topology.slot_of(into, from), topology.slot_of(from, into)) else {
            return Err(Refusal::Topology);
        };
        let (ring_from, ring_into) = (topology.ring(from), topology.ring(into));
        if ring_from.len() < 3 || ring_into.len() < 3 || ring_from.len() + ring_into.len() < 7 {
            return Err(Refusal::Topology);
        }
        // Triangles of `from` first: (a, …, b), then those of `into`: (b, …, a).
        let split = ring_from.len() - 2;
        let length = split + ring_into.len() - 2;
        splice_slots(ring_from, j, split, &mut patch.ring);
        splice_slots(ring_into, i, ring_into.len() - 2, &mut patch.ring[split..]);
        let ring = &mut patch.ring;
        for k in 0..WIDTH {
            ring[length + k] = ring[k];
        }
        // The link condition: the two ends see just `a` and `b` together.
        let mut common = ring[0] == ring[split];
        for &x in &ring[1..split] {
            for &y in &ring[split + 1..length] {
                common |= x == y;
            }
        }
        if common {
            return Err(Refusal::Topology);
        }
        let (at_from, at_into) =
            (topology.vertices[from as usize].position(), topology.vertices[into as usize].position());
        let quadric = patch.look_at(topology, &[(split, at_from), (length, at_into)], length, placement.position)?;

        // From here on the collapse is done.
        let (a, b) = (patch.ring[0], patch.ring[split]);
        let removed = removed_planes(
            &topology.vertices[a as usize].position(),
            &topology.vertices[b as usize].position(),
            at_from,
            at_into,
        );
        patch.merges.clear();
        if topology.has_wedges() {
            patch.splice_wedges(topology, (from, j), (into, i));
        }
        patch.spread_differences(topology, length);
        topology.add(a, &removed[0]);
        topology.add(b, &removed[1]);
        for &v in &patch.ring[1..split] {
            topology.rename(v, from, into);
        }
        topology.close_up(a, from, into, &mut patch.builder);
        topology.close_up(b, from, into, &mut patch.builder);
        let ring = &patch.ring[..length];
        topology.set_ring(into, from, Form::Closed, ring, &patch.wedges);
        topology.live_triangle_count -= 2;
        self.record.rank(from, into, ring, placement.cost);
        Ok(quadric)
    }

    /// Whether there may be no surface at the edge, and nothing is left to do where there is one.
    fn is_loose(&self, from: u32, into: u32) -> bool {
        self.pairing
            || self.last_resort
                && [from, into].iter().any(|&v| self.topology.vertices[v as usize].kind == VertexKind::NonManifold)
    }

    /// Looks whether any two vertices that share a triangle may merge, and leaves in the patch what that takes.
    /// Returns the quadric of the merged vertex.
    fn inspect_any(&mut self, from: u32, into: u32, placement: Placement) -> Result<Quadric, Refusal> {
        let loose = self.is_loose(from, into);
        let Self { topology, patch, spare_sheet_edges, pairing, .. } = self;
        let Patch {
            corners_from,
            corners_into,
            changes,
            builder,
            marks,
            epoch,
            merges,
            set_starts,
            new_sheet_edges,
            ..
        } = &mut **patch;
        corners_from.clear();
        corners_into.clear();
        topology.corners(from, corners_from);
        topology.corners(into, corners_into);
        marks.resize(topology.vertices.len(), 0);
        let kinds = [from, into].map(|v| topology.vertices[v as usize].kind);
        if loose {
            let spare = if *pairing { Some(i64::MAX) } else { *spare_sheet_edges };
            *new_sheet_edges = legality::check_soup((from, corners_from), (into, corners_into), spare)?;
        } else {
            legality::check_link(marks, epoch, (from, corners_from), (into, corners_into))?;
        }
        // A locked vertex does not vanish with the last of its triangles.
        for c in corners_from.iter().filter(|c| c.next == into || c.previous == into) {
            let third = if c.next == into { c.previous } else { c.next };
            if topology.vertices[third as usize].kind == VertexKind::Locked {
                let gone = |o: &&Corner| [o.next, o.previous] == [into, third] || [o.next, o.previous] == [third, into];
                let gone = corners_from.iter().filter(gone).count();
                if topology.triangles_at(third) <= gone {
                    return Err(Refusal::Lines);
                }
            }
        }
        merges.clear();
        pair_wedges(merges, set_starts, (from, corners_from), (into, corners_into));
        if kinds[0] >= VertexKind::Corner && kinds[0] != VertexKind::Locked {
            // A seam that ends in `from` would have to go on in one of its sides.
            let torn = |m: &(u32, u32)| merges.iter().any(|o| o.0 == m.0 && o.1 != m.1);
            if merges.iter().any(torn) {
                return Err(Refusal::Lines);
            }
        }
        let mut all = std::mem::take(merges);
        for merge in all.drain(..) {
            if merges.iter().all(|m| m.0 != merge.0) {
                merges.push(merge);
            }
        }
        changes.clear();
        for (v, other, corners) in [(from, into, &*corners_from), (into, from, &*corners_into)] {
            for &corner in corners.iter().filter(|c| c.next != other && c.previous != other) {
                changes.push(Change { vertex: v, corner, difference: [Lanes::splat(0.0); 3] });
            }
        }
        if kinds == [VertexKind::Corner; 2] {
            // Two corners on borders, joined by a seam: what hangs together there alone stays whole.
            corners_into.retain(|c| c.next != from && c.previous != from);
            let stays = |c: &&Corner| c.next != into && c.previous != into;
            corners_into.extend(corners_from.iter().filter(stays));
            let form = builder.build(corners_into);
            if form == Form::Parts {
                return Err(Refusal::Lines);
            }
        }
        look_any(topology, changes, placement.position)
    }

    /// Merges any two vertices that share a triangle.
    #[inline(never)]
    fn merge_any(&mut self, from: u32, into: u32, placement: Placement) -> Result<Quadric, Refusal> {
        let quadric = self.inspect_any(from, into, placement)?;

        // From here on the collapse is done.
        let loose = self.is_loose(from, into);
        if let (true, Some(spare)) = (loose, &mut self.spare_sheet_edges) {
            *spare -= self.patch.new_sheet_edges;
        }
        let Self { topology, patch, .. } = self;
        let Patch { corners_from, corners_into, changes, neighbours, builder, merges, wedges, .. } = &mut **patch;
        let at_from = topology.vertices[from as usize].position();
        let mut gone = 0;
        for c in corners_from.iter().filter(|c| c.next == into || c.previous == into) {
            let third = if c.next == into { c.previous } else { c.next };
            let plane = Quadric::of_triangle(topology.area_vector(at_from, c.next, c.previous));
            topology.add(third, &(Quadric::default() - plane).packed());
            gone += 1;
        }
        neighbours.clear();
        for change in changes.iter_mut() {
            topology.add(change.corner.next, &change.difference);
            topology.add(change.corner.previous, &change.difference);
            neighbours.extend([change.corner.next, change.corner.previous]);
            if let Some(merge) = merges.iter().find(|m| m.0 == change.corner.wedge && change.vertex == from) {
                change.corner.wedge = merge.1;
            }
        }
        neighbours.extend(corners_from.iter().flat_map(|c| [c.next, c.previous]));
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours.retain(|&v| v != into && v != from);
        let mut third = std::mem::take(wedges);
        third.clear();
        third.extend(
            corners_from
                .iter()
                .filter(|c| c.next == into || c.previous == into)
                .map(|c| if c.next == into { c.previous } else { c.next }),
        );
        for &v in neighbours.iter() {
            if loose {
                topology.rename_any(v, from, into, builder);
            } else if third.contains(&v) {
                topology.close_up(v, from, into, builder);
            } else {
                topology.rename(v, from, into);
            }
        }
        *wedges = third;
        corners_into.clear();
        corners_into.extend(changes.iter().map(|c| c.corner));
        let form = builder.build(corners_into);
        topology.set_ring(into, from, form, &builder.ring, &builder.wedges);
        topology.live_triangle_count -= gone;
        self.record.rank(from, into, neighbours, placement.cost);
        Ok(quadric)
    }

    /// Takes `from` out of its lines, and gives the vertices there the kinds that they are now.
    fn update_lines(&mut self, from: (u32, Vec3), into: (u32, Vec3)) {
        let Self { topology, polylines, patch, .. } = self;
        let (was, is) = (topology.vertices[from.0 as usize].kind, &mut topology.vertices[into.0 as usize].kind);
        *is = was.max(*is);
        if was > VertexKind::Manifold {
            patch.neighbours.clear();
            polylines.merge(topology, from, into, &mut patch.neighbours);
            for &v in [into.0].iter().chain(&patch.neighbours) {
                let count = polylines.of(v).len();
                let vertex = &mut topology.vertices[v as usize];
                vertex.kind = kind_after(vertex.kind, vertex.form(), count);
            }
        }
        let lines = polylines.quadric(topology, into.0).packed();
        topology.add(into.0, &lines);
    }
}

/// What a vertex is once it has `lines`, if it was `kind`: where seams have run together, a corner
/// may be none any more, and where sheets have, the surface may be one.
fn kind_after(kind: VertexKind, form: Form, lines: usize) -> VertexKind {
    use VertexKind::{Border, Corner, Locked, Manifold, NonManifold, Seam};
    match (kind, form, lines) {
        (Locked | NonManifold, Form::Parts, _) | (Locked, ..) | (Manifold, ..) => kind,
        (Corner | NonManifold, Form::Closed, 0) => Manifold,
        (_, Form::Closed, 2) if kind != Border => Seam,
        (_, Form::Open, 2) if kind != Seam => Border,
        (Border | Seam, _, 2) => kind,
        _ => Corner,
    }
}

impl Patch {
    /// Tests every triangle that stays, and notes the change of its quadric; four at a time. The triangles up to each
    /// slot of `origins` were at the position that goes with it. Returns the quadric of the merged vertex.
    #[inline(never)]
    pub(super) fn look_at(
        &mut self,
        topology: &Topology,
        origins: &[(usize, Vec3)],
        length: usize,
        merged: Vec3,
    ) -> Result<Quadric, Refusal> {
        let batches = length.div_ceil(WIDTH);
        let indices = self.ring.as_chunks::<WIDTH>().0;
        for (at, four) in self.around.iter_mut().zip(&indices[..batches]) {
            let [x, y, z, _] = Lanes::transpose(four.map(|v| topology.vertices[v as usize].packed.0[0]));
            *at = Lanes3 { x, y, z };
        }
        // The last batch is followed by the first vertex, in its next lane or in another batch.
        self.around[batches] = self.around[0];
        let merged = Lanes3::splat(merged);
        let last = Lanes::splat(length as f32 - 0.5);
        let mut sum = QuadricLanes::zero();
        let mut index = Lanes::new(Lanes::INDEX);
        for (pair, differences) in self.around[..=batches].windows(2).zip(self.differences.as_chunks_mut::<WIDTH>().0) {
            let (a, b) = (pair[0], pair[0].followed_by(pair[1]));
            let mut origin = merged;
            for &(end, position) in origins.iter().rev() {
                let within = index.at_most(Lanes::splat(end as f32 - 0.5));
                origin = Lanes3::select(within, Lanes3::splat(position), origin);
            }
            let old = (a - origin).cross(b - origin);
            let (p, q, opposite) = (a - merged, b - merged, b - a);
            let new = p.cross(q);
            let longest = p.dot(p).max(q.dot(q)).max(opposite.dot(opposite));
            let counts = index.at_most(last);
            if !(legality::keep_upright(old, new, longest) | !counts).all() {
                return Err(Refusal::Flip);
            }
            let after = QuadricLanes::of_triangles(new);
            *differences = after.minus(&QuadricLanes::of_triangles(old)).packed();
            sum.add_masked(&after, counts);
            index = index + Lanes::splat(WIDTH as f32);
        }
        Ok(sum.sum())
    }

    /// Adds the changes that [`Patch::look_at`] noted to the vertices of the merged ring, each of which has two of its triangles.
    #[inline(always)]
    pub(super) fn spread_differences(&self, topology: &mut Topology, length: usize) {
        let mut before = self.differences[length - 1];
        for (&v, &after) in self.ring[..length].iter().zip(&self.differences) {
            topology.add(v, &[before[0] + after[0], before[1] + after[1], before[2] + after[2]]);
            before = after;
        }
    }

    /// The wedges of the merged ring, and which wedges merge.
    fn splice_wedges(&mut self, topology: &Topology, (from, j): (u32, usize), (into, i): (u32, usize)) {
        let (own, other) = (topology.ring_wedges(into), topology.ring_wedges(from));
        let before = |at: usize, length: usize| if at == 0 { length - 1 } else { at - 1 };
        for (wedge_from, wedge_into) in [(other[j], own[before(i, own.len())]), (other[before(j, other.len())], own[i])]
        {
            if wedge_from != wedge_into && self.merges.iter().all(|m| m.0 != wedge_from) {
                self.merges.push((wedge_from, wedge_into));
            }
        }
        let split = other.len() - 2;
        self.wedges.clear();
        self.wedges.resize(split + own.len() - 2, 0);
        splice_slots(other, j, split, &mut self.wedges);
        splice_slots(own, i, own.len() - 2, &mut self.wedges[split..]);
        for wedge in &mut self.wedges[..split] {
            if let Some(merge) = self.merges.iter().find(|m| m.0 == *wedge) {
                *wedge = merge.1;
            }
        }
    }
}

/// The first of `out` are `count` slots after slot `at`, going around.
#[inline(always)]
pub(super) fn splice_slots(slots: &[u32], at: usize, count: usize, out: &mut [u32]) {
    let mut slot = at;
    for out in &mut out[..count] {
        slot = if slot + 1 == slots.len() { 0 } else { slot + 1 };
        *out = slots[slot];
    }
}

/// Minus the planes of the two triangles at the edge, for their third vertices.
#[inline(always)]
fn removed_planes(a: &Vec3, b: &Vec3, from: Vec3, into: Vec3) -> [[Lanes; 3]; 2] {
    let edge = from - into;
    // The plane's matrix does not know the sense of the area vector, but g does.
    let plane = |n: Vec3| (Quadric::default() - Quadric::of_triangle(n)).packed();
    [plane((*a - into).cross(edge)), plane(edge.cross(*b - into))]
}

/// Which wedges of `from` merge into which of `into`: those of the triangles that vanish. Triangles
/// on the same three vertices are told apart by their winding and their wedge sets.
fn pair_wedges(
    merges: &mut Vec<(u32, u32)>,
    set_starts: &[u32],
    (from, corners_from): (u32, &[Corner]),
    (into, corners_into): (u32, &[Corner]),
) {
    let set = |wedge: u32| set_starts.partition_point(|&start| start <= wedge);
    for c in corners_from.iter().filter(|c| c.next == into || c.previous == into) {
        // The same triangle, seen from `into`.
        let (next, previous) = if c.next == into { (c.previous, from) } else { (from, c.next) };
        let same = |o: &&Corner| o.next == next && o.previous == previous && set(o.wedge) == set(c.wedge);
        if let Some(o) = corners_into.iter().find(same)
            && o.wedge != c.wedge
            && !merges.contains(&(c.wedge, o.wedge))
        {
            merges.push((c.wedge, o.wedge));
        }
    }
}

/// As [`Patch::look_at`], for triangles in any order.
fn look_any(topology: &Topology, changes: &mut [Change], position: Vec3) -> Result<Quadric, Refusal> {
    let mut sum = QuadricLanes::zero();
    let at = |v: u32| topology.vertices[v as usize].position();
    let merged = Lanes3::splat(position);
    for four in changes.chunks_mut(WIDTH) {
        let lane: [&Change; WIDTH] = std::array::from_fn(|k| &four[if k < four.len() { k } else { 0 }]);
        let origin = Lanes3::gather(lane.map(|c| at(c.vertex)));
        let (a, b) =
            (Lanes3::gather(lane.map(|c| at(c.corner.next))), Lanes3::gather(lane.map(|c| at(c.corner.previous))));
        let old = (a - origin).cross(b - origin);
        let (p, q, opposite) = (a - merged, b - merged, b - a);
        let new = p.cross(q);
        let longest = p.dot(p).max(q.dot(q)).max(opposite.dot(opposite));
        // A triangle without an area may become another one, but not one with two corners in one place.
        let zero = Lanes::splat(0.0);
        let together = |now: Lanes3, before: Lanes3| now.dot(now).at_most(zero) & !before.dot(before).at_most(zero);
        let joins = together(p, a - origin) | together(q, b - origin);
        if !(legality::keep_upright(old, new, longest) & !joins).all() {
            return Err(Refusal::Flip);
        }
        let after = QuadricLanes::of_triangles(new);
        let difference = after.minus(&QuadricLanes::of_triangles(old));
        sum.add_masked(&after, Lanes::new(Lanes::INDEX).at_most(Lanes::splat(four.len() as f32 - 0.5)));
        for (change, difference) in four.iter_mut().zip(difference.packed()) {
            change.difference = difference;
        }
    }
    Ok(sum.sum())
}

/// False if the collapse would close a border or seam loop onto itself.
fn polyline_stays_open(polylines: &Polylines, topology: &Topology, from: u32, into: u32) -> bool {
    let kind = |v: u32| topology.vertices[v as usize].kind;
    let (&[a, b], true) = (polylines.of(from), kind(from) < VertexKind::Corner) else { return true };
    if a != into && b != into {
        // A last resort.
        return kind(into) == VertexKind::NonManifold;
    }
    let beyond = if a == into { b } else { a };
    beyond != into && (kind(into) >= VertexKind::Corner || !polylines.of(into).contains(&beyond))
}
