//! Preparation of a run: from the mesh as it is stored to vertices with rings, kinds and quadrics.
//!
//! All of it is linear, and in the order of the Morton curve wherever memory allows.

use std::ops::Range;

use super::lanes::{Lanes, Lanes3, WIDTH, equal_bits};
use super::polylines::Polylines;
use super::quadric::{Quadric, QuadricLanes, Vec3, smaller};
use super::space::Space;
use super::topology::{Corner, Form, NONE, RingBuilder, Topology};
use super::vertex_kind;
use crate::mesh::Mesh;
use crate::mesh::chart;
use crate::mesh::weld::{self, NO_VERTEX, Weld};

/// What is needed while a run is prepared and no longer.
#[derive(Debug, Default)]
pub(super) struct Preparation {
    weld: Weld,
    /// Vertices of each triangle that has three, by lowest vertex.
    triangles: Vec<[u32; 3]>,
    /// Their wedges; empty when every vertex has one wedge.
    wedges: Vec<[u32; 3]>,
    /// Their groups; empty when there is one.
    groups: Vec<u32>,
    /// Chart of each wedge; empty as `wedges`.
    charts: Vec<u32>,
    /// Triangles at each vertex: `fans[starts[v]..starts[v + 1]]`.
    fans: Vec<u32>,
    starts: Vec<u32>,
    corners: Vec<Corner>,
    ring: RingBuilder,
    lines: Vec<u32>,
}

/// What the weld finds that a run keeps.
pub(super) struct Welded {
    pub(super) spaces: Vec<Space>,
    pub(super) part_of_vertex: Vec<u16>,
    pub(super) wedge_of_vertex: Vec<u32>,
    /// The vertex of each wedge, named by its wedge; [`NO_VERTEX`] where unused.
    pub(super) vertex_of_wedge: Vec<u32>,
}

impl Preparation {
    /// Finds the vertices and the space of each part.
    pub(super) fn weld(&mut self, mesh: &Mesh) -> Welded {
        self.weld = weld::weld(mesh);
        let weld = &self.weld;
        let mut part_of_wedge = vec![0_u16; if mesh.parts.len() > 1 { mesh.positions.len() } else { 0 }];
        if !part_of_wedge.is_empty() {
            for set in &mesh.wedge_sets {
                part_of_wedge[set.wedges.clone()].fill(set.part as u16);
            }
        }
        let part_of = |w: u32| part_of_wedge.get(w as usize).copied().unwrap_or(0);
        let diagonal = mesh.diagonal_of(weld.wedge_of_vertex.iter().map(|&w| (w, part_of(w).into())));
        Welded {
            spaces: Space::of_parts(mesh, if diagonal > 0.0 { diagonal } else { 1.0 }, |w| {
                weld.vertex_of_wedge[w] != NO_VERTEX
            }),
            part_of_vertex: weld.wedge_of_vertex.iter().map(|&w| part_of(w)).collect(),
            wedge_of_vertex: weld.wedge_of_vertex.clone(),
            vertex_of_wedge: weld
                .vertex_of_wedge
                .iter()
                .map(|&v| if v == NO_VERTEX { NO_VERTEX } else { weld.wedge_of_vertex[v as usize] })
                .collect(),
        }
    }

    /// Triangles in the order of their lowest vertex, for the same locality as the vertices.
    /// Returns the wedges that are the same as another of their vertex, which stands for them from
    /// here on.
    pub(super) fn order_triangles(&mut self, mesh: &Mesh, vertex_of_wedge: &[u32]) -> Vec<(u32, u32)> {
        let weld = &self.weld;
        let vertex = |w: u32| weld.vertex_of_wedge[w as usize];
        let proper = |t: &[u32; 3]| {
            let [a, b, c] = t.map(vertex);
            a != b && b != c && c != a
        };
        let lowest = |t: &[u32; 3]| t.map(vertex).into_iter().min().unwrap_or(0) as usize;
        let mut starts = vec![0_u32; weld.wedge_of_vertex.len() + 1];
        for t in mesh.triangles.iter().filter(|t| proper(t)) {
            starts[lowest(t) + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let count = starts.last().copied().unwrap_or(0) as usize;
        let used = weld.vertex_of_wedge.iter().filter(|&&v| v != NO_VERTEX).count();
        let more_wedges = used - weld.wedge_of_vertex.len();
        let duplicates = if more_wedges > 0 { chart::duplicates(mesh, vertex_of_wedge) } else { Vec::new() };
        let several_wedges = more_wedges > duplicates.len();
        let mut kept: Vec<u32> = if several_wedges { (0..mesh.positions.len() as u32).collect() } else { Vec::new() };
        if several_wedges {
            for &(wedge, same) in &duplicates {
                kept[wedge as usize] = same;
            }
        }
        let several_groups = mesh.groups.len() > 1;
        let mut triangles = vec![[0; 3]; count];
        if several_wedges {
            self.wedges = vec![[0; 3]; count];
        }
        if several_groups {
            self.groups = vec![0; count];
        }
        for (g, group) in mesh.groups.iter().enumerate() {
            for t in mesh.triangles[group.triangles.clone()].iter().filter(|t| proper(t)) {
                let start = &mut starts[lowest(t)];
                let slot = *start as usize;
                *start += 1;
                triangles[slot] = t.map(vertex);
                if several_wedges {
                    self.wedges[slot] = t.map(|w| kept[w as usize]);
                }
                if several_groups {
                    self.groups[slot] = g as u32;
                }
            }
        }
        self.triangles = triangles;
        self.weld = Weld::default();
        self.starts = starts;
        if several_wedges {
            self.charts = chart::charts(mesh, vertex_of_wedge);
        }
        duplicates
    }

    /// The triangles at each vertex: counted, summed, filled.
    pub(super) fn build_fans(&mut self) {
        let starts = &mut self.starts;
        starts.fill(0);
        for &v in self.triangles.as_flattened() {
            starts[v as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        self.fans = vec![0; 3 * self.triangles.len()];
        for (t, triangle) in self.triangles.iter().enumerate() {
            for &v in triangle {
                let start = &mut starts[v as usize];
                self.fans[*start as usize] = t as u32;
                *start += 1;
            }
        }
        // Every start has moved to the next one's place.
        for i in (1..starts.len()).rev() {
            starts[i] = starts[i - 1];
        }
        if let Some(first) = starts.first_mut() {
            *first = 0;
        }
    }

    /// Vertices at these positions, without rings yet.
    pub(super) fn topology(&self, positions: impl ExactSizeIterator<Item = Vec3>) -> Topology {
        // A ring has a slot more than triangles if it is open.
        let fans = self.starts.windows(2).map(|pair| (pair[1] - pair[0]) as usize);
        let long = fans.filter(|&fan| fan > 8).map(|fan| (fan + 1).next_power_of_two()).sum();
        Topology::new(positions, !self.wedges.is_empty(), self.triangles.len(), long)
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Rings, kinds, and unless they are to be `bare` quadrics and first keys, of the vertices in the range.
    pub(super) fn build_rings(
        &mut self,
        range: Range<usize>,
        topology: &mut Topology,
        polylines: &mut Polylines,
        keys: &mut [f32],
        (lock_border, bare): (bool, bool),
    ) {
        let Self { triangles, wedges, groups, charts, fans, starts, corners, ring, lines, .. } = self;
        let chart_at = |t: u32, v: u32| {
            let corner = triangles[t as usize].iter().position(|&x| x == v).unwrap_or(0);
            charts[wedges[t as usize][corner] as usize]
        };
        for v in range {
            let fan = &fans[starts[v] as usize..starts[v + 1] as usize];
            let v = v as u32;
            if wedges.is_empty()
                && groups.is_empty()
                && let Some(ring) = short_cycle(triangles, fan, v)
            {
                // The usual case: a manifold vertex with up to eight triangles.
                topology.set_short_ring(v, &ring, fan.len());
                if !bare {
                    take_quadric(topology, polylines, keys, v, &[]);
                }
                continue;
            }
            corners.clear();
            for &t in fan {
                let [a, b, c] = triangles[t as usize];
                let (corner, next, previous) = if a == v {
                    (0, b, c)
                } else if b == v {
                    (1, c, a)
                } else {
                    (2, a, b)
                };
                let wedge = wedges.get(t as usize).map_or(0, |w| w[corner]);
                corners.push(Corner { next, previous, wedge });
            }
            let form = ring.build(corners);
            topology.replace_ring(v, form, &ring.ring, &ring.wedges);
            let is_seam = |i: u32, j: u32, w: u32| {
                let (a, b) = (fan[i as usize], fan[j as usize]);
                (!groups.is_empty() && groups[a as usize] != groups[b as usize])
                    || (!wedges.is_empty() && (chart_at(a, v) != chart_at(b, v) || chart_at(a, w) != chart_at(b, w)))
            };
            let kind = vertex_kind::classify(form, ring, corners, lock_border, is_seam, lines);
            topology.vertices[v as usize].kind = kind;
            if !lines.is_empty() {
                polylines.set(v, lines, topology.vertices.len());
            }
            if !bare {
                take_quadric(topology, polylines, keys, v, corners);
            }
        }
    }
}

/// The quadric and first keys of a vertex that has a ring; its triangles are only looked at if that is not short and closed.
pub(super) fn take_quadric(
    topology: &mut Topology,
    polylines: &Polylines,
    keys: &mut [f32],
    v: u32,
    corners: &[Corner],
) {
    let vertex = &topology.vertices[v as usize];
    let (own, form, ring) = (vertex.position(), vertex.form(), topology.ring(v));
    let around = if ring.len() <= NEAR { Some(Around::of(topology, own, ring)) } else { None };
    let mut quadric = if let (Form::Closed, Some(around)) = (form, &around) {
        around.planes()
    } else {
        let plane = |c: &Corner| Quadric::of_triangle(topology.area_vector(own, c.next, c.previous));
        corners.iter().map(plane).fold(Quadric::default(), |sum, plane| sum + plane)
    };
    if !polylines.of(v).is_empty() {
        quadric += polylines.quadric(topology, v);
    }
    if let (true, Some(around)) = (form != Form::Parts, &around) {
        around.spread_costs(&quadric, v, ring, keys);
    } else {
        for &w in ring.iter().filter(|&&w| w != NONE) {
            let cost = quadric.error_at(topology.vertices[w as usize].position() - own);
            for end in [v, w] {
                keys[end as usize] = smaller(keys[end as usize], cost);
            }
        }
    }
    topology.vertices[v as usize].packed.set_quadric(&quadric);
}

/// The ring of a vertex with three to eight triangles, if they make one cycle.
#[inline(always)]
fn short_cycle(triangles: &[[u32; 3]], fan: &[u32], v: u32) -> Option<[u32; 8]> {
    if !(3..=8).contains(&fan.len()) {
        return None;
    }
    let (mut next, mut previous) = ([NONE; 8], [NONE; 8]);
    for (k, &t) in fan.iter().enumerate() {
        let [a, b, c] = triangles[t as usize];
        // Selections, because which corner it is cannot be predicted.
        next[k] = if a == v {
            b
        } else if b == v {
            c
        } else {
            a
        };
        previous[k] = if a == v {
            c
        } else if b == v {
            a
        } else {
            b
        };
    }
    let mut ring = [NONE; 8];
    let mut current = 0;
    let mut returns = 0;
    for slot in &mut ring[..fan.len()] {
        *slot = next[current];
        let successors = equal_bits(&next, previous[current]);
        if successors.count_ones() != 1 {
            return None;
        }
        current = successors.trailing_zeros() as usize;
        returns += u32::from(current == 0);
    }
    (current == 0 && returns == 1).then_some(ring)
}

/// Longest ring that is prepared four neighbours at a time.
pub(super) const NEAR: usize = 12;

/// The neighbours of a vertex relative to it, in the order of its ring, which then starts again.
pub(super) struct Around {
    offsets: [Lanes3; NEAR / WIDTH + 1],
    length: usize,
}

impl Around {
    #[inline(always)]
    pub(super) fn of(topology: &Topology, own: Vec3, ring: &[u32]) -> Self {
        let mut padded = [0; NEAR + WIDTH];
        for (slot, &w) in padded.iter_mut().zip(ring) {
            *slot = if w == NONE { 0 } else { w };
        }
        for k in 0..WIDTH {
            padded[ring.len() + k] = padded[k];
        }
        let own = Lanes3::splat(own);
        let mut offsets = [own; NEAR / WIDTH + 1];
        let batches = ring.len() / WIDTH + 1;
        for (offsets, four) in offsets[..batches].iter_mut().zip(padded.as_chunks::<WIDTH>().0) {
            let [x, y, z, _] = Lanes::transpose(four.map(|w| topology.vertices[w as usize].packed.0[0]));
            *offsets = Lanes3 { x, y, z } - own;
        }
        Self { offsets, length: ring.len() }
    }

    /// The quadric of the triangles between the vertex and a closed ring.
    #[inline(always)]
    fn planes(&self) -> Quadric {
        let last = Lanes::splat(self.length as f32 - 0.5);
        let mut index = Lanes::new(Lanes::INDEX);
        let mut sum = QuadricLanes::zero();
        for pair in self.offsets.windows(2).take(self.length.div_ceil(WIDTH)) {
            let planes = QuadricLanes::of_triangles(pair[0].cross(pair[0].followed_by(pair[1])));
            sum.add_masked(&planes, index.at_most(last));
            index = index + Lanes::splat(WIDTH as f32);
        }
        sum.sum()
    }

    /// Of the triangles between the vertex and a closed ring whose normals are not against
    /// `normal`, the slot of the one nearest to the point `p` (relative to the vertex), and its
    /// squared distance; infinite if there is none.
    #[inline(always)]
    pub(super) fn nearest_facing(&self, p: Vec3, normal: Vec3) -> (usize, f32) {
        let (zero, one, infinite) = (Lanes::splat(0.0), Lanes::splat(1.0), Lanes::splat(f32::INFINITY));
        let (p, normal) = (Lanes3::splat(p), Lanes3::splat(normal));
        let last = Lanes::splat(self.length as f32 - 0.5);
        let mut index = Lanes::new(Lanes::INDEX);
        let (mut best, mut least) = (0, f32::INFINITY);
        // An edge without length is its end: 0 / tiny.
        let tiny = Lanes::splat(f32::MIN_POSITIVE);
        let along = |at: Lanes3, edge: Lanes3| {
            let t = at.dot(edge) / edge.dot(edge).max(tiny);
            let t = Lanes::select(t.at_most(one), t.max(zero), one);
            let offset = at - edge.scale(t);
            offset.dot(offset)
        };
        for (k, pair) in self.offsets.windows(2).take(self.length.div_ceil(WIDTH)).enumerate() {
            let (b, c) = (pair[0], pair[0].followed_by(pair[1]));
            let n = b.cross(c);
            let squared = n.dot(n);
            let (at_b, at_c) = (p.cross(c).dot(n), b.cross(p).dot(n));
            let inside = zero.at_most(at_b) & zero.at_most(at_c) & (at_b + at_c).at_most(squared);
            let height = p.dot(n);
            let (spoke, rim) = (along(p, b), along(p - b, c - b));
            let outside = Lanes::select(spoke.at_most(rim), spoke, rim);
            let distance = Lanes::select(inside, height * height / squared.max(tiny), outside);
            let facing = !n.dot(normal).at_most(zero) & index.at_most(last);
            let distances = Lanes::select(facing, distance, infinite).to_array();
            for (lane, &distance) in distances.iter().enumerate() {
                (best, least) = if distance < least { (WIDTH * k + lane, distance) } else { (best, least) };
            }
            index = index + Lanes::splat(WIDTH as f32);
        }
        (best, least)
    }

    /// First keys: the cost of merging at the better end, which bounds the solved cost from above.
    /// Nothing is solved, and the error is as with solved keys: the first visit solves, and the
    /// thresholds are coarse. The other direction of each edge is for the turn of its other end.
    #[inline(always)]
    fn spread_costs(&self, quadric: &Quadric, v: u32, ring: &[u32], keys: &mut [f32]) {
        let quadric = QuadricLanes::splat(quadric);
        let mut least = keys[v as usize];
        for (&d, four) in self.offsets.iter().zip(ring.chunks(WIDTH)) {
            let costs = d.dot(quadric.apply(d)).max(Lanes::splat(0.0)).to_array();
            for (&w, cost) in four.iter().zip(costs) {
                least = smaller(least, cost);
                let key = &mut keys[w as usize];
                *key = smaller(*key, cost);
            }
        }
        keys[v as usize] = least;
    }
}
