//! The edges at a vertex: where each may be merged, and what that costs.

use super::PlacementRule;
use super::attributes::AttributeField;
use super::lanes::{Lanes, Lanes3, WIDTH};
use super::placement::{self, Placement, Placements};
use super::polylines::Polylines;
use super::quadric::{Packed, QuadricLanes, Vec3};
use super::topology::{Form, NONE, Topology};
use super::vertex_kind::{self, Freedom, VertexKind};

/// The edges at one vertex, in parallel arrays padded to whole lanes.
#[derive(Debug, Default)]
pub(super) struct Edges {
    /// The neighbour and freedom of each; empty if they are the vertex's ring and all free.
    listed: Vec<(u32, Freedom)>,
    vertex: u32,
    /// Four edges each; the lanes behind the last edge cost infinitely much.
    placements: Vec<Placements>,
    /// Neighbours whose merged position is to be solved.
    solved: Vec<u32>,
    near: Near,
}

/// A manifold vertex and its short closed ring of manifold vertices: positions and stiffened quadrics, four side by side.
#[derive(Debug)]
struct Near {
    own: (Lanes3, QuadricLanes),
    ring: [(Lanes3, QuadricLanes); 2],
}

impl Default for Near {
    fn default() -> Self {
        let none = (Lanes3::splat(Vec3::ZERO), QuadricLanes::zero());
        Self { own: none, ring: [none; 2] }
    }
}

/// Longest ring that is held near.
pub(super) const NEAR_RING: usize = 2 * WIDTH;

/// One edge that may be collapsed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) neighbour: u32,
    pub(super) freedom: Freedom,
    pub(super) placement: Placement,
}

impl Edges {
    /// Finds every edge at `v` that the kinds allow, at its best placement.
    #[inline(never)]
    pub(super) fn gather(
        &mut self,
        topology: &Topology,
        polylines: &Polylines,
        attributes: Option<&AttributeField>,
        rule: PlacementRule,
        last_resort: bool,
        v: u32,
    ) {
        self.listed.clear();
        self.placements.clear();
        self.vertex = v;
        let own = &topology.vertices[v as usize];
        let ring = topology.ring(v);
        let free = rule == PlacementRule::Optimal
            && own.kind == VertexKind::Manifold
            && own.form() != Form::Parts
            && ring.iter().all(|&w| topology.vertices[w as usize].kind == VertexKind::Manifold);
        if free {
            // The usual case, without a look at each pair of kinds.
            self.solve(topology, attributes, v, ring);
        } else {
            self.gather_by_kind(topology, polylines, attributes, rule, last_resort, v);
        }
    }

    /// Takes up a vertex and its ring for [`Edges::cheapest_triangle`] and [`Edges::solve_near`]; false if they are not
    /// usual: manifold all of them, and the ring closed and of four to eight.
    #[inline(always)]
    pub(super) fn approach(&mut self, topology: &Topology, v: u32) -> bool {
        let own = &topology.vertices[v as usize];
        let ring = topology.ring(v);
        if own.form() != Form::Closed || !(WIDTH..=NEAR_RING).contains(&ring.len()) || topology.is_hub(v) {
            return false;
        }
        let mut usual = own.kind == VertexKind::Manifold;
        for &w in ring {
            usual &= topology.vertices[w as usize].kind == VertexKind::Manifold;
        }
        if !usual {
            return false;
        }
        let packed = |k: usize| &topology.vertices[ring[if k < ring.len() { k } else { 0 }] as usize].packed;
        let (first, quadric) = QuadricLanes::gather([packed(0), packed(1), packed(2), packed(3)]);
        self.near.ring[0] = (first, placement::stiffened(&quadric));
        self.near.ring[1] = self.near.ring[0];
        if ring.len() > WIDTH {
            let (second, quadric) = QuadricLanes::gather([packed(4), packed(5), packed(6), packed(7)]);
            self.near.ring[1] = (second, placement::stiffened(&quadric));
        }
        let quadric = QuadricLanes::splat(&own.quadric());
        self.near.own = (Lanes3::splat(own.position()), placement::stiffened(&quadric));
        self.listed.clear();
        self.placements.clear();
        self.vertex = v;
        true
    }

    /// After [`Edges::approach`]: of the triangles at the vertex, the slot of the one whose three corners become one at the
    /// least cost.
    #[inline(always)]
    pub(super) fn cheapest_triangle(&self, length: usize) -> (usize, Placement) {
        let Near { own: (at, quadric), ring } = &self.near;
        let mut last = Lanes::splat(length as f32 - 0.5);
        let (mut best, mut found) = (0, Placement { position: Vec3::ZERO, cost: f32::INFINITY });
        for k in 0..length.div_ceil(WIDTH) {
            // Behind the last lane comes slot 0, also if the second four are the first ones again.
            let ((p, q), (next_p, next_q)) = (&ring[k], &ring[1 - k]);
            let four = [*at, *p, p.followed_by(*next_p)];
            let mut placements = placement::solve_three(four, [quadric, q, &q.followed_by(next_q)]);
            let counts = Lanes::new(Lanes::INDEX).at_most(last);
            placements.cost = Lanes::select(counts, placements.cost, Lanes::splat(f32::INFINITY));
            last = last - Lanes::splat(WIDTH as f32);
            let (mut lane, mut least) = (WIDTH, found.cost);
            for (index, cost) in placements.cost.to_array().into_iter().enumerate() {
                (lane, least) = if cost < least { (index, cost) } else { (lane, least) };
            }
            if lane < WIDTH {
                (best, found) = (k * WIDTH + lane, placements.get(lane));
            }
        }
        (best, found)
    }

    /// After [`Edges::approach`]: the edges at the vertex, as [`Edges::gather`].
    #[inline(always)]
    pub(super) fn solve_near(&mut self, length: usize) {
        let Near { own: (at, quadric), ring } = &self.near;
        let mut last = Lanes::splat(length as f32 - 0.5);
        for (p, q) in &ring[..length.div_ceil(WIDTH)] {
            let mut found = placement::solve(*at, quadric, *p, q);
            let counts = Lanes::new(Lanes::INDEX).at_most(last);
            found.cost = Lanes::select(counts, found.cost, Lanes::splat(f32::INFINITY));
            last = last - Lanes::splat(WIDTH as f32);
            self.placements.push(found);
        }
    }

    fn gather_by_kind(
        &mut self,
        topology: &Topology,
        polylines: &Polylines,
        attributes: Option<&AttributeField>,
        rule: PlacementRule,
        last_resort: bool,
        v: u32,
    ) {
        let own = &topology.vertices[v as usize];
        let optimal = rule == PlacementRule::Optimal;
        let mut solved = std::mem::take(&mut self.solved);
        solved.clear();
        let ring = topology.ring(v);
        let simple = own.form() != Form::Parts;
        for (i, &w) in ring.iter().enumerate() {
            if w == NONE || (!simple && ring[..i].contains(&w)) {
                continue;
            }
            let other = &topology.vertices[w as usize];
            let freedom = vertex_kind::freedom(own.kind, other.kind, last_resort, || polylines.of(v).contains(&w));
            let beside = |p: Vec3| attributes.map_or(0.0, |a| a.cost_at(topology, v, w, p));
            let at_own = || Placement {
                position: own.position(),
                cost: other.quadric().error_at(own.position() - other.position()) + beside(own.position()),
            };
            let at_other = || Placement {
                position: other.position(),
                cost: own.quadric().error_at(other.position() - own.position()) + beside(other.position()),
            };
            let (freedom, placement) = match freedom {
                Freedom::Forbidden => continue,
                Freedom::AtEither => {
                    // Both, because one of them may be refused.
                    self.push(w, Freedom::AtFirst, at_own());
                    (Freedom::AtSecond, at_other())
                }
                Freedom::Anywhere if optimal => {
                    solved.push(w);
                    continue;
                }
                Freedom::AtFirst => (freedom, at_own()),
                Freedom::AtSecond => (freedom, at_other()),
                Freedom::Anywhere => {
                    let (first, second) = (at_own(), at_other());
                    if first.cost <= second.cost { (Freedom::AtFirst, first) } else { (Freedom::AtSecond, second) }
                }
            };
            self.push(w, freedom, placement);
        }
        // Whole lanes before those that are solved.
        while !self.listed.len().is_multiple_of(WIDTH) {
            self.listed.push((NONE, Freedom::Forbidden));
        }
        self.listed.extend(solved.iter().map(|&w| (w, Freedom::Anywhere)));
        self.solve(topology, attributes, v, &solved);
        self.solved = solved;
    }

    fn push(&mut self, neighbour: u32, freedom: Freedom, placement: Placement) {
        let lane = self.listed.len() % WIDTH;
        if lane == 0 {
            self.placements.push(Placements::none());
        }
        if let Some(last) = self.placements.last_mut() {
            last.set(lane, placement);
        }
        self.listed.push((neighbour, freedom));
    }

    /// Solves the edges from `v` to each of `neighbours`, four at a time.
    #[inline(never)]
    fn solve(&mut self, topology: &Topology, attributes: Option<&AttributeField>, v: u32, neighbours: &[u32]) {
        if let Some(attributes) = attributes {
            self.solve_with(topology, attributes, v, neighbours);
            return;
        }
        let own = &topology.vertices[v as usize];
        // The lines of borders and seams have no area vectors; among them nothing is a tip.
        let planes = own.kind == VertexKind::Manifold;
        let a = QuadricLanes::splat(&own.quadric());
        let a = if planes { placement::stiffened(&a) } else { a };
        let u = Lanes3::splat(own.position());
        let mut last = Lanes::splat(neighbours.len() as f32 - 0.5);
        for four in neighbours.chunks(WIDTH) {
            let others: [&Packed; WIDTH] =
                std::array::from_fn(|k| &topology.vertices[four[if k < four.len() { k } else { 0 }] as usize].packed);
            let (v, b) = QuadricLanes::gather(others);
            let b = if planes { placement::stiffened(&b) } else { b };
            let mut found = placement::solve(u, &a, v, &b);
            let counts = Lanes::new(Lanes::INDEX).at_most(last);
            found.cost = Lanes::select(counts, found.cost, Lanes::splat(f32::INFINITY));
            last = last - Lanes::splat(WIDTH as f32);
            self.placements.push(found);
        }
    }

    /// As [`Edges::solve`], with the attributes in the cost.
    #[inline(never)]
    fn solve_with(&mut self, topology: &Topology, attributes: &AttributeField, v: u32, neighbours: &[u32]) {
        let own = &topology.vertices[v as usize];
        let planes = own.kind == VertexKind::Manifold;
        let a = QuadricLanes::splat(&own.quadric());
        let own_quadric = if planes { placement::stiffened(&a) } else { a };
        let u = Lanes3::splat(own.position());
        let mut last = Lanes::splat(neighbours.len() as f32 - 0.5);
        for four in neighbours.chunks(WIDTH) {
            let others: [u32; WIDTH] = std::array::from_fn(|k| four[if k < four.len() { k } else { 0 }]);
            let (position, b) = QuadricLanes::gather(others.map(|w| &topology.vertices[w as usize].packed));
            let (mut a, mut b) = (own_quadric, if planes { placement::stiffened(&b) } else { b });
            let h = (position - u).scale(Lanes::splat(0.5));
            let mismatch = attributes.add_to(topology, (v, &mut a), (others, &mut b), h);
            let mut found = placement::solve_with(u, &a, position, &b, &mismatch);
            let counts = Lanes::new(Lanes::INDEX).at_most(last);
            found.cost = Lanes::select(counts, found.cost, Lanes::splat(f32::INFINITY));
            last = last - Lanes::splat(WIDTH as f32);
            self.placements.push(found);
        }
    }

    /// The cheapest edge that was not refused; the first of equals.
    #[inline(always)]
    pub(super) fn cheapest(&self, topology: &Topology) -> Option<(usize, Edge)> {
        let (mut best, mut least) = (0, f32::INFINITY);
        let mut index = 0;
        for placements in &self.placements {
            for cost in placements.cost.to_array() {
                (best, least) = if cost < least { (index, cost) } else { (best, least) };
                index += 1;
            }
        }
        (least < f32::INFINITY).then(|| {
            let (neighbour, freedom) = match self.listed.get(best) {
                Some(&listed) => listed,
                None => (topology.ring(self.vertex)[best], Freedom::Anywhere),
            };
            (best, Edge { neighbour, freedom, placement: self.placements[best / WIDTH].get(best % WIDTH) })
        })
    }

    /// Takes the edge out of the choice.
    pub(super) fn refuse(&mut self, index: usize) {
        let refused = Placement { position: Vec3::ZERO, cost: f32::INFINITY };
        self.placements[index / WIDTH].set(index % WIDTH, refused);
    }

    /// As [`Edges::gather`], but slower, and for [`Edges::iter`].
    pub(super) fn list(
        &mut self,
        topology: &Topology,
        polylines: &Polylines,
        attributes: Option<&AttributeField>,
        rule: PlacementRule,
        last_resort: bool,
        v: u32,
    ) {
        self.listed.clear();
        self.placements.clear();
        self.vertex = v;
        self.gather_by_kind(topology, polylines, attributes, rule, last_resort, v);
    }

    /// After [`Edges::list`], adds pairs of the vertex and others that no edge joins, at their midpoint or an end.
    pub(super) fn add_pairs(&mut self, topology: &Topology, rule: PlacementRule, others: &[u32]) {
        let own = &topology.vertices[self.vertex as usize];
        // Whole lanes before them: what is listed so far may end within one.
        while !self.listed.len().is_multiple_of(WIDTH) || self.listed.len() < self.placements.len() * WIDTH {
            self.listed.push((NONE, Freedom::Forbidden));
        }
        for &w in others {
            let other = &topology.vertices[w as usize];
            let at = |position: Vec3| Placement {
                position,
                cost: own.quadric().error_at(position - own.position())
                    + other.quadric().error_at(position - other.position()),
            };
            let (first, second) = (at(own.position()), at(other.position()));
            let middle = at((own.position() + other.position()) * 0.5);
            let (freedom, placement) = if own.kind == VertexKind::Locked && other.kind == VertexKind::Locked {
                continue;
            } else if own.kind > other.kind {
                (Freedom::AtFirst, first)
            } else if own.kind < other.kind {
                (Freedom::AtSecond, second)
            } else if rule == PlacementRule::Optimal && middle.cost <= first.cost && middle.cost <= second.cost {
                (Freedom::Anywhere, middle)
            } else if first.cost <= second.cost {
                (Freedom::AtFirst, first)
            } else {
                (Freedom::AtSecond, second)
            };
            self.push(w, freedom, placement);
        }
    }

    /// Every edge that [`Edges::list`] found.
    pub(super) fn iter(&self) -> impl Iterator<Item = Edge> {
        let real = self.listed.iter().enumerate().filter(|(_, (neighbour, _))| *neighbour != NONE);
        real.filter_map(|(i, &(neighbour, freedom))| {
            let placement = self.placements.get(i / WIDTH)?.get(i % WIDTH);
            Some(Edge { neighbour, freedom, placement })
        })
    }

    /// Multiplies the cost of each edge by the factor of its neighbour.
    #[inline(never)]
    pub(super) fn weigh(&mut self, topology: &Topology, factor: impl Fn(u32) -> f32) {
        let ring = topology.ring(self.vertex);
        let all = self.placements.len() * WIDTH;
        for i in 0..all {
            let neighbour = if self.listed.is_empty() { ring.get(i) } else { self.listed.get(i).map(|(w, _)| w) };
            if let Some(&w) = neighbour.filter(|&&w| w != NONE) {
                self.placements[i / WIDTH].scale_cost(i % WIDTH, factor(w));
            }
        }
    }
}
