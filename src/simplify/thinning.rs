//! Thinning: what is far below the target's resolution goes first, and cheaply.
//!
//! Most vertices of a dense mesh only ever vanish. As long as there are several times the target's triangles, a vertex is
//! merged into the neighbour where its own memoryless quadric is least (a half-edge collapse). Nothing is solved, nobody
//! moves, and no quadric is kept up to date: those of the sweep are made of what is left.
//!
//! Sweeps along the Morton curve take what costs less than a threshold, which is a quantile of the costs at some vertices.

use std::ops::Range;

use super::collapse::splice_slots;
use super::lanes::{Lanes, Lanes3, WIDTH, equal_bits, replace};
use super::legality;
use super::quadric::{QuadricLanes, Vec3, larger, smaller};
use super::topology::{NONE, Vertex};
use super::vertex_kind::VertexKind;
use super::{Collapse, Layout, PlacementRule, Simplifier, Stage, StopReason, limit_of, prepare};
use crate::mesh::Mesh;

/// Fewest and most triangles at a vertex that vanishes.
const LEAST_RING: usize = 4;
const MOST_RING: usize = 2 * WIDTH;

/// The same as a number. More would not fit a first block; and the rounder the fans, the better the surface.
const MOST: f32 = MOST_RING as f32;

/// Triangles of a vertex that has too many, or is none that may vanish.
const OTHER: f32 = 1024.0;

/// A vertex whose every neighbour would get too many triangles waits for so many times the threshold.
const BLOCKED: f32 = 4.0;

/// Fewest triangles that are left, so that small targets are the sweep's: 3,000 take it two milliseconds.
const LEAST_GOAL: usize = 3000;

/// Where so large a share of the triangles would be left anyway, a run without a fit is thinned down to its target.
const WHOLLY_FROM: f64 = 0.7;

/// Costs that the threshold is a quantile of.
const SAMPLES: usize = 1024;

/// Share of the vertices that are below the threshold of a sweep, but for the last.
const SHARE: f32 = 0.7;

/// When less than this share of the vertices is to go, just as many are visited as that takes, all over the mesh.
const LAST_SHARE: f32 = 0.125;

/// A threshold that this share of the vertices is below takes about three quarters of them away.
const LAST_QUANTILE: f32 = 0.6;

/// What is added to the diagonal of a quadric, by its trace: on a plane the shortest edge goes.
const REGULARISATION: f32 = 1e-6;

/// How many merges are recorded together.
const BATCH: usize = 1024;

/// Where thinning stands.
#[derive(Debug, Default)]
pub(super) struct Thinning {
    /// Triangles that are to be left.
    goal: usize,
    /// The next in the list of those that may go.
    next: usize,
    /// How many vertices the last sweep took away.
    removed: usize,
    /// How many it was to be about.
    hoped: usize,
    /// Merges that are not recorded yet: which vertex into which, and the squared error there.
    merges: Vec<(u32, u32, f32)>,
    /// By vertex its position, and how many triangles there are if they are few and go around it; 0 if it is gone.
    stars: Vec<Lanes>,
    /// Squared errors.
    errors: Vec<f32>,
    /// Every how many of the list are visited in this sweep.
    stride: usize,
}

/// A vertex with its ring, which is followed by its first neighbour up to the eighth.
struct Star {
    ring: [u32; MOST_RING],
    length: usize,
    /// The neighbours from the vertex.
    offsets: [Lanes3; 2],
    /// Area vectors of the triangles behind them.
    areas: [Lanes3; 2],
    /// How many triangles the neighbours have.
    triangles: [Lanes; 2],
}

/// Where a vertex would go.
struct Choice {
    /// Slot of the neighbour.
    slot: usize,
    cost: f32,
    /// Sum of the areas around.
    weight: f32,
}

impl Simplifier {
    /// How many triangles thinning leaves; none if this run is not thinned. Only where positions are all there is, and
    /// only the end matters.
    pub(super) fn thinning_goal(&self, mesh: &Mesh) -> Option<usize> {
        let (options, tuning, count) = (&self.options, self.tuning(), self.initial_triangle_count);
        let target = options.target_triangle_count;
        let plain = !self.topology.has_wedges()
            && !options.every_level
            && !options.prune
            && options.max_error == f32::INFINITY
            && options.merge_distance == 0.0
            && options.placement == PlacementRule::Optimal
            && options.weights.is_empty();
        if !plain || tuning.thin_above == 0.0 || target == 0 {
            return None;
        }
        let wanted = target as f64 * f64::from(tuning.thin_above);
        let wholly = tuning.fit_rounds == 0 && wanted > WHOLLY_FROM * count as f64;
        let goal = if wholly { target } else { wanted as usize }.max(LEAST_GOAL);
        // What attributes say is the sweep's business.
        (goal < count && Layout::new(mesh, &options.attribute_weights, |_| 1.0).is_none()).then_some(goal)
    }

    /// Takes up the rings.
    pub(super) fn begin_thinning(&mut self, goal: usize) {
        let topology = &self.topology;
        let star = |(v, vertex): (u32, &Vertex)| {
            let Vec3 { x, y, z } = vertex.position();
            let is_plain = vertex.kind == VertexKind::Manifold && topology.is_short(v);
            Lanes::new([x, y, z, if is_plain { vertex.ring_length() as f32 } else { OTHER }])
        };
        let stars = (0..).zip(&topology.vertices).map(star).collect();
        self.thinning =
            Thinning { goal, next: self.live.len(), stars, errors: vec![0.0; self.live.len()], ..Thinning::default() };
        self.keys.fill(0.0);
    }

    /// Leaves what is left to the sweep, if there is more than the target.
    pub(super) fn end_thinning(&mut self) {
        let Thinning { stars, errors, .. } = std::mem::take(&mut self.thinning);
        for (v, (row, error)) in stars.iter().zip(errors).enumerate() {
            let triangles = row.lane::<3>();
            if triangles <= MOST {
                self.topology.settle_short(v, triangles as u32, error);
            }
        }
        if self.topology.live_triangle_count <= self.options.target_triangle_count {
            self.stop_reason = StopReason::Target;
            self.stage = Stage::Done;
            return;
        }
        self.threshold = 0.0;
        self.keys.fill(f32::INFINITY);
        let vertices = &self.topology.vertices;
        self.live.clear();
        self.live.extend((0..vertices.len() as u32).filter(|&v| vertices[v as usize].ring_length() > 0));
        self.stage = Stage::Quadrics(0);
    }

    /// Quadrics and first keys of what lives in the range.
    pub(super) fn take_quadrics(&mut self, range: Range<usize>) {
        let Self { topology, polylines, keys, patch, .. } = self;
        let mut corners = Vec::new();
        for v in range {
            if topology.vertices[v].ring_length() > 0 {
                topology.refresh(v as u32, &mut patch.builder);
                corners.clear();
                topology.corners(v as u32, &mut corners);
                prepare::take_quadric(topology, polylines, keys, v as u32, &corners);
            }
        }
    }

    /// Does about `work` units; true when it is done.
    pub(super) fn thin(&mut self, mesh: &Mesh, work: usize) -> bool {
        let mut left = work;
        let mut done = false;
        while left > 0 && !done {
            if self.topology.live_triangle_count <= self.thinning.goal {
                done = true;
            } else if self.thinning.next < self.live.len() {
                let v = self.live[self.thinning.next];
                self.thinning.next += self.thinning.stride;
                if self.keys[v as usize] <= self.threshold {
                    left -= 1;
                    self.visit_star(v);
                    if self.thinning.merges.len() == BATCH {
                        self.record_merges(mesh);
                    }
                }
            } else {
                left = left.saturating_sub(1 + self.live.len() / 16);
                done = !self.begin_thinning_sweep();
            }
        }
        self.record_merges(mesh);
        done
    }

    /// Many together, because that is quicker than each where it is done.
    fn record_merges(&mut self, mesh: &Mesh) {
        let mut left = self.topology.live_triangle_count + 2 * self.thinning.merges.len();
        for &(from, into, error_squared) in &self.thinning.merges {
            let space = self.spaces[usize::from(self.part_of_vertex[into as usize])];
            let wedge = self.wedge_of_vertex[into as usize];
            left -= 2;
            let collapse = Collapse {
                from: self.wedge_of_vertex[from as usize],
                into: wedge,
                position: mesh.positions[wedge as usize],
                error: (f64::from(error_squared).sqrt() * space.world_per_engine) as f32,
            };
            self.record.push(collapse, left);
        }
        self.thinning.merges.clear();
    }

    /// The next threshold; false if there is no more to be had.
    fn begin_thinning_sweep(&mut self) -> bool {
        let Self { live, keys, .. } = self;
        live.retain(|&v| keys[v as usize] < f32::INFINITY);
        let count = self.live.len();
        if self.thinning.removed * 8 < self.thinning.hoped {
            return false;
        }
        let stride = (count / SAMPLES).max(8);
        // Below this threshold nothing is: the vertices only get their keys, unless they may not go just now.
        self.threshold = -1.0;
        let mut costs = Vec::with_capacity(count / stride + 1);
        for at in (0..count).step_by(stride) {
            let v = self.live[at];
            self.keys[v as usize] = -1.0;
            self.visit_star(v);
            costs.extend(Some(self.keys[v as usize]).filter(|cost| (0.0..f32::INFINITY).contains(cost)));
        }
        if costs.is_empty() {
            return false;
        }
        let missing = (self.topology.live_triangle_count - self.thinning.goal).div_ceil(2);
        let left = missing as f32 / count as f32;
        let share = if left < LAST_SHARE {
            self.thinning.stride = (count / (2 * missing + 16)).max(1);
            LAST_QUANTILE
        } else {
            self.thinning.stride = 1;
            smaller(SHARE, left * 1.15)
        };
        self.threshold = limit_of(costs.iter().copied(), (costs.len() as f32 * share) as usize + 1);
        self.thinning.removed = 0;
        self.thinning.hoped = missing.min((share * count as f32) as usize);
        self.thinning.next = 0;
        true
    }

    /// The vertex and what is around it, if it may go.
    #[inline(always)]
    fn star(&mut self, v: u32) -> Option<Star> {
        let Self { topology, thinning, .. } = self;
        let stars = &thinning.stars;
        let [x, y, z, triangles] = stars[v as usize].to_array();
        let length = triangles as usize;
        if !(LEAST_RING..=MOST_RING).contains(&length) {
            return None;
        }
        let mut ring = *topology.first_block(v)?;
        let first = ring[0];
        for (slot, w) in ring.iter_mut().enumerate().skip(LEAST_RING) {
            *w = if slot < length { *w } else { first };
        }
        let own = Lanes3::splat(Vec3 { x, y, z });
        let around = |four: [u32; WIDTH]| {
            let [x, y, z, triangles] = Lanes::transpose(four.map(|w| stars[w as usize]));
            (Lanes3 { x, y, z } - own, triangles)
        };
        let [a, b, c, d, e, f, g, h] = ring;
        let ((low, at_low), (high, at_high)) = (around([a, b, c, d]), around([e, f, g, h]));
        let areas = [low.cross(low.followed_by(high)), high.cross(high.followed_by(low))];
        Some(Star { ring, length, offsets: [low, high], areas, triangles: [at_low, at_high] })
    }

    /// Merges `v` if that costs less than the threshold; otherwise gives it a key.
    #[inline(never)]
    fn visit_star(&mut self, v: u32) {
        let Some(star) = self.star(v) else {
            // A vertex with three triangles may have more some day.
            if !(1.0..=MOST).contains(&self.thinning.stars[v as usize].lane::<3>()) {
                self.keys[v as usize] = f32::INFINITY;
            }
            return;
        };
        let choice = star.choose();
        if choice.cost > self.threshold {
            self.keys[v as usize] = if choice.cost < f32::INFINITY { choice.cost } else { BLOCKED * self.threshold };
        } else if !self.merge_star(v, &star, &choice) {
            self.keys[v as usize] = 2.0 * self.threshold;
        }
    }

    /// Merges `v` into the chosen neighbour if that is legal.
    #[inline(always)]
    fn merge_star(&mut self, v: u32, star: &Star, choice: &Choice) -> bool {
        let Self { topology, patch, keys, thinning, .. } = self;
        let (slot, length) = (choice.slot, star.length);
        let into = star.ring[slot];
        let Some(&mut ring_into) = topology.first_block(into) else { return false };
        let length_into = thinning.stars[into as usize].lane::<3>() as usize;
        let at_v = equal_bits(&ring_into, v).trailing_zeros() as usize;
        if at_v >= length_into {
            return false;
        }
        // The link condition: the two know just the two vertices beside the edge together.
        let mut common = 0;
        for w in ring_into {
            common |= equal_bits(&star.ring, w);
        }
        let (before, after) = star.beside(slot);
        let beside = equal_bits(&star.ring, star.ring[before]) | equal_bits(&star.ring, star.ring[after]);
        if common & !beside != 0 || !star.stays_upright(slot) {
            return false;
        }
        // From here on the merge is done. Neighbours of `v` from behind `into` on, then those of `into` from behind `v` on.
        let split = length - 2;
        let mut merged = [NONE; MOST_RING];
        splice_slots(&star.ring[..length], slot, split, &mut merged);
        splice_slots(&ring_into[..length_into], at_v, length_into - 2, &mut merged[split..]);
        for &w in &merged[1..split] {
            match topology.first_block(w) {
                Some(ring) if thinning.stars[w as usize].lane::<3>() <= MOST => replace(ring, v, into),
                _ => topology.rename(w, v, into),
            }
        }
        for w in [merged[0], merged[split]] {
            let row = &mut thinning.stars[w as usize];
            let triangles = row.lane::<3>();
            match topology.first_block(w) {
                Some(ring) if triangles <= MOST => {
                    let gone = equal_bits(ring, v).trailing_zeros() as usize;
                    let [_, rest @ ..] = *ring;
                    let old = *ring;
                    *ring = std::array::from_fn(|k| {
                        let next = rest.get(k).copied().unwrap_or(NONE);
                        if k < gone { old[k] } else { next }
                    });
                    *row = with_triangles(*row, triangles - 1.0);
                }
                _ => topology.close_up(w, v, into, &mut patch.builder),
            }
        }
        if let Some(ring) = topology.first_block(into) {
            *ring = merged;
        }
        topology.note_merge(v, into);
        topology.live_triangle_count -= 2;
        let row = &mut thinning.stars[into as usize];
        *row = with_triangles(*row, (split + length_into - 2) as f32);
        let row = &mut thinning.stars[v as usize];
        *row = with_triangles(*row, 0.0);
        keys[v as usize] = f32::INFINITY;
        thinning.removed += 1;
        let step = if choice.weight > 0.0 { 0.5 * choice.cost / choice.weight } else { 0.0 };
        let error_squared = larger(thinning.errors[v as usize], thinning.errors[into as usize]) + step;
        thinning.errors[into as usize] = error_squared;
        thinning.merges.push((v, into, error_squared));
        true
    }
}

/// The same place with so many triangles.
#[inline(always)]
fn with_triangles(row: Lanes, triangles: f32) -> Lanes {
    Lanes::new([row.lane::<0>(), row.lane::<1>(), row.lane::<2>(), triangles])
}

impl Star {
    /// The neighbour that costs least, by the quadric of the triangles.
    #[inline(always)]
    fn choose(&self) -> Choice {
        let (q0, q1) = (QuadricLanes::of_triangles(self.areas[0]), QuadricLanes::of_triangles(self.areas[1]));
        let [a, b, c, d] = Lanes::transpose([q0.xx + q1.xx, q0.xy + q1.xy, q0.xz + q1.xz, q0.yy + q1.yy]);
        let [xx, xy, xz, yy] = ((a + b) + (c + d)).to_array();
        let zero = Lanes::splat(0.0);
        let [a, b, c, d] = Lanes::transpose([q0.yz + q1.yz, q0.zz + q1.zz, zero, zero]);
        let [yz, zz, _, _] = ((a + b) + (c + d)).to_array();
        let weight = xx + yy + zz;
        let ridge = weight * REGULARISATION;
        let s = Lanes::splat;
        let quadric = QuadricLanes {
            xx: s(xx + ridge),
            xy: s(xy),
            xz: s(xz),
            yy: s(yy + ridge),
            yz: s(yz),
            zz: s(zz + ridge),
            g: Lanes3 { x: zero, y: zero, z: zero },
        };
        let room = s(MOST + 4.0 - self.length as f32);
        let cost = |k: usize| {
            let (d, triangles): (Lanes3, Lanes) = (self.offsets[k], self.triangles[k]);
            Lanes::select(triangles.at_most(room), d.dot(quadric.apply(d)), s(f32::INFINITY))
        };
        let (low, high) = (cost(0), cost(1));
        let index = Lanes::new(Lanes::INDEX);
        let lower = low.at_most(high);
        let costs = Lanes::select(lower, low, high).to_array();
        let slots = Lanes::select(lower, index, index + s(WIDTH as f32)).to_array();
        let (mut slot, mut cost) = (slots[0], costs[0]);
        for k in 1..WIDTH {
            (slot, cost) = if costs[k] < cost { (slots[k], costs[k]) } else { (slot, cost) };
        }
        Choice { slot: slot as usize % MOST_RING, cost: larger(cost, 0.0), weight }
    }

    /// The slots before and after.
    #[inline(always)]
    fn beside(&self, slot: usize) -> (usize, usize) {
        let before = if slot == 0 { self.length - 1 } else { slot - 1 };
        let after = if slot + 1 == self.length { 0 } else { slot + 1 };
        (before, after)
    }

    /// Whether no triangle turns over when the vertex goes to the neighbour in `slot`. Two vanish.
    #[inline(always)]
    fn stays_upright(&self, slot: usize) -> bool {
        let [low, high] = self.offsets;
        let lane = |batch: Lanes3, k: usize| {
            let pick = |lanes: Lanes| lanes.to_array()[k % WIDTH];
            Vec3 { x: pick(batch.x), y: pick(batch.y), z: pick(batch.z) }
        };
        let to = Lanes3::splat(lane(if slot < WIDTH { low } else { high }, slot));
        let (before, _) = self.beside(slot);
        let (at, before) = (Lanes::splat(slot as f32), Lanes::splat(before as f32));
        let mut index = Lanes::new(Lanes::INDEX);
        let mut upright = true;
        for (near, far, area) in
            [(low, low.followed_by(high), self.areas[0]), (high, high.followed_by(low), self.areas[1])]
        {
            let (p, q, opposite) = (near - to, far - to, far - near);
            let longest = p.dot(p).max(q.dot(q)).max(opposite.dot(opposite));
            let vanishes = (index.at_most(at) & at.at_most(index)) | (index.at_most(before) & before.at_most(index));
            upright &= (legality::keep_upright(area, p.cross(q), longest) | vanishes).all();
            index = index + Lanes::splat(WIDTH as f32);
        }
        upright
    }
}
