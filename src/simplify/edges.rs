//! The edges at a vertex: where each may be merged, and what that costs.

use super::PlacementRule;
use super::lanes::{Lanes3, WIDTH};
use super::placement::{self, Placement};
use super::polylines::Polylines;
use super::quadric::{Packed, QuadricLanes, Vec3};
use super::topology::{Form, NONE, Topology};
use super::vertex_kind::{self, Freedom, VertexKind};

/// The edges at one vertex, in parallel arrays padded to whole lanes.
#[derive(Debug, Default)]
pub(super) struct Edges {
    neighbours: Vec<u32>,
    freedoms: Vec<Freedom>,
    costs: Vec<f32>,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Neighbours whose merged position is to be solved.
    solved: Vec<u32>,
}

/// One edge that may be collapsed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) neighbour: u32,
    pub(super) freedom: Freedom,
    pub(super) placement: Placement,
}

impl Edges {
    /// Finds every edge at `v` that the kinds allow, at its best placement.
    #[inline(always)]
    pub(super) fn gather(
        &mut self,
        topology: &Topology,
        polylines: &Polylines,
        rule: PlacementRule,
        last_resort: bool,
        v: u32,
    ) {
        for list in [&mut self.costs, &mut self.x, &mut self.y, &mut self.z] {
            list.clear();
        }
        self.neighbours.clear();
        self.freedoms.clear();
        let own = &topology.vertices[v as usize];
        let ring = topology.ring(v);
        let free = rule == PlacementRule::Optimal
            && own.kind == VertexKind::Manifold
            && own.form() != Form::Parts
            && ring.iter().all(|&w| topology.vertices[w as usize].kind == VertexKind::Manifold);
        if free {
            // The usual case, without a look at each pair of kinds.
            solve(topology, v, ring, self);
        } else {
            self.gather_by_kind(topology, polylines, rule, last_resort, v);
        }
    }

    fn gather_by_kind(
        &mut self,
        topology: &Topology,
        polylines: &Polylines,
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
            let at_own = || Placement {
                position: own.position(),
                cost: other.quadric().error_at(own.position() - other.position()),
            };
            let at_other = || Placement {
                position: other.position(),
                cost: own.quadric().error_at(other.position() - own.position()),
            };
            let (freedom, placement) = match freedom {
                Freedom::Forbidden => continue,
                Freedom::AtEither => {
                    // Both, because one of them may be refused.
                    self.push(Edge { neighbour: w, freedom: Freedom::AtFirst, placement: at_own() });
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
            self.push(Edge { neighbour: w, freedom, placement });
        }
        let first = self.neighbours.len();
        solve(topology, v, &solved, self);
        self.costs.truncate(first + solved.len());
        self.solved = solved;
    }

    fn push(&mut self, edge: Edge) {
        self.neighbours.push(edge.neighbour);
        self.freedoms.push(edge.freedom);
        self.costs.push(edge.placement.cost);
        self.x.push(edge.placement.position.x);
        self.y.push(edge.placement.position.y);
        self.z.push(edge.placement.position.z);
    }

    /// The cheapest edge that was not refused; the first of equals.
    #[inline(always)]
    pub(super) fn cheapest(&self) -> Option<(usize, Edge)> {
        let (mut best, mut least) = (0, f32::INFINITY);
        for (i, &cost) in self.costs[..self.neighbours.len()].iter().enumerate() {
            (best, least) = if cost < least { (i, cost) } else { (best, least) };
        }
        (least < f32::INFINITY).then(|| {
            let position = Vec3 { x: self.x[best], y: self.y[best], z: self.z[best] };
            let placement = Placement { position, cost: least };
            (best, Edge { neighbour: self.neighbours[best], freedom: self.freedoms[best], placement })
        })
    }

    /// Takes the edge out of the choice.
    pub(super) fn refuse(&mut self, index: usize) {
        self.costs[index] = f32::INFINITY;
    }
}

/// Appends the edges from `v` to each of `neighbours`, solved four at a time.
#[inline(always)]
fn solve(topology: &Topology, v: u32, neighbours: &[u32], edges: &mut Edges) {
    let own = &topology.vertices[v as usize];
    // The lines of borders and seams have no area vectors; among them nothing is a tip.
    let planes = own.kind == VertexKind::Manifold;
    let a = QuadricLanes::splat(&own.quadric());
    let a = if planes { placement::stiffened(&a) } else { a };
    let u = Lanes3::splat(own.position());
    edges.neighbours.extend_from_slice(neighbours);
    edges.freedoms.resize(edges.neighbours.len(), Freedom::Anywhere);
    for four in neighbours.chunks(WIDTH) {
        let others: [&Packed; WIDTH] =
            std::array::from_fn(|k| &topology.vertices[four[if k < four.len() { k } else { 0 }] as usize].packed);
        let (v, b) = QuadricLanes::gather(others);
        let b = if planes { placement::stiffened(&b) } else { b };
        let found = placement::solve(u, &a, v, &b);
        edges.costs.extend_from_slice(&found.cost.to_array());
        edges.x.extend_from_slice(&found.position.x.to_array());
        edges.y.extend_from_slice(&found.position.y.to_array());
        edges.z.extend_from_slice(&found.position.z.to_array());
    }
}
