//! Simplification: greedy edge collapse by quadric error, in coarse spatial order.
//!
//! The outline: weld and number the vertices along a Morton curve; build fans; classify the
//! vertices; compute every vertex's memoryless quadric; give every vertex a first key, the least cost
//! of merging along one of its edges at an end. Then raise a threshold by octaves of the cost, and at each sweep the vertices
//! whose key is below it in spatial order: evaluate the vertex's edges afresh, collapse the
//! cheapest legal one, update the quadrics of the ring, go on. Everything is recorded in a
//! [`CollapseSequence`].
//!
//! Garland & Heckbert (1997) gave the quadric, Lindstrom & Turk (1998) the memoryless form and the
//! volume constraint. Sweeping in spatial order and not strictly by cost is as good on the average
//! and several times faster, because memory is touched in order.

mod lanes;
mod legality;
mod placement;
mod quadric;
mod topology;
mod vertex_kind;

use crate::collapse_sequence::{Collapse, CollapseSequence, StopReason};
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;
use crate::mesh::weld::{self, NO_VERTEX, Weld};
use lanes::{Lanes, Lanes3, WIDTH};
use legality::Refusal;
use placement::Placement;
use quadric::{Quadric, QuadricLanes, Vec3};
use topology::{FanTriangle, Topology, Triangle};
use vertex_kind::{Freedom, NONE, Polyline, VertexKind};

/// How strongly the lines of borders and seams hold, against the planes of the surface.
const LINE_WEIGHT: f32 = 1.0;

/// Octaves of the cost from one threshold to the next when there is a target. 1, 2, 3 and 4 gave
/// the same error within 1 %, and 4 takes a third less work than 1: fewer visits are in vain.
const OCTAVES_TO_TARGET: i32 = 4;

/// The same for a run without a target, whose record is to be read at any level. A level in the
/// middle of a wide sweep has a quarter more error than a run to that count; with one octave it
/// has the same.
const OCTAVES_FOR_LEVELS: i32 = 1;

/// How many of a vertex's cheapest edges are tried before it waits for a higher threshold.
const TRIES: usize = 3;

/// Where merged vertices may be put.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PlacementRule {
    /// Wherever the error is least.
    #[default]
    Optimal,
    /// Only at one of the two ends: the result's vertices are a subset of the original's.
    Subset,
}

/// When to stop and what to keep.
#[derive(Debug, Clone, PartialEq)]
pub struct SimplifyOptions {
    /// At most this many triangles; 0 goes as far as the constraints allow. Default 0.
    pub target_triangle_count: usize,
    /// Largest estimated deviation in world units, ≥ 0. Default infinite.
    pub max_error: f32,
    /// Vertices on open borders neither move nor vanish. Default off.
    pub lock_border: bool,
    /// Default optimal.
    pub placement: PlacementRule,
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self {
            target_triangle_count: 0,
            max_error: f32::INFINITY,
            lock_border: false,
            placement: PlacementRule::Optimal,
        }
    }
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// 0 to 1; exactly 1 when done.
    pub fraction: f32,
    /// The sequence is complete.
    pub done: bool,
}

/// Runs to the end. See [`Simplifier`] for a run in bounded steps.
///
/// # Errors
/// Those of [`Simplifier::new`].
pub fn simplify(mesh: &Mesh, options: &SimplifyOptions) -> Result<CollapseSequence, Error> {
    let mut simplifier = Simplifier::new(mesh, options)?;
    while !simplifier.step(mesh, usize::MAX).done {}
    Ok(simplifier.finish())
}

/// Where the preparation of a run stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd)]
enum Stage {
    Weld,
    Triangles,
    Fans,
    Kinds,
    Quadrics,
    Keys(usize),
    Sweep,
    Done,
}

/// One run, advanced by [`Simplifier::step`] so that its owner can look up between the steps.
#[derive(Debug)]
pub struct Simplifier {
    options: SimplifyOptions,
    stage: Stage,
    topology: Topology,
    polylines: Vec<Polyline>,
    /// Wedges of each triangle; empty when every vertex has one wedge.
    triangle_wedges: Vec<[u32; 3]>,
    triangle_groups: Vec<u32>,
    wedge_of_vertex: Vec<u32>,
    /// Only while the run is being prepared.
    weld: Weld,
    /// Engine space of each part: local = centre + engine · unit; and world units per engine unit.
    spaces: Vec<Space>,
    part_of_vertex: Vec<u16>,
    moved: Vec<bool>,
    /// Estimated squared deviation at each vertex, in engine units.
    error_squared: Vec<f32>,
    keys: Vec<f32>,
    threshold: f32,
    ready: Vec<u32>,
    ready_next: usize,
    again: Vec<u32>,
    live: Vec<u32>,
    epoch: u32,
    /// The rank of the last collapse at each vertex, and of each collapse; see `rank`.
    rank_at: Vec<f32>,
    ranks: Vec<f32>,
    max_error_squared: f32,
    blocked_by_error: bool,
    scratch: Scratch,
    sequence: CollapseSequence,
}

/// The space in which a part is simplified: its bounding box's centre at 0, the whole model's
/// diagonal 1 in world units, so that nothing depends on the file's unit of length or origin.
#[derive(Debug, Clone, Copy)]
struct Space {
    centre: [f64; 3],
    local_per_engine: f64,
}

/// Buffers that live as long as the run, so that the loop allocates nothing.
#[derive(Debug, Default)]
struct Scratch {
    fan: Vec<FanTriangle>,
    fan_other: Vec<FanTriangle>,
    neighbours: Vec<u32>,
    candidates: Vec<Candidate>,
    changes: Vec<Change>,
    merges: Vec<(u32, u32)>,
}

#[derive(Debug, Clone, Copy)]
struct Candidate {
    neighbour: u32,
    freedom: Freedom,
    placement: Placement,
}

/// A triangle that stays, seen from the end of the edge it belongs to.
#[derive(Debug, Clone, Copy)]
struct Change {
    vertex: u32,
    triangle: FanTriangle,
    /// Its quadric after the collapse less that before.
    difference: Quadric,
}

impl Simplifier {
    /// Checks the mesh and the options; the work is left to [`Simplifier::step`].
    ///
    /// # Errors
    /// As [`Mesh::validate`], and `invalid-argument` for a negative or NaN error.
    pub fn new(mesh: &Mesh, options: &SimplifyOptions) -> Result<Self, Error> {
        mesh.validate()?;
        if options.max_error.is_nan() || options.max_error < 0.0 {
            return Err(Error::new(ErrorCode::InvalidArgument, "error", "must not be negative"));
        }
        Ok(Self {
            options: options.clone(),
            stage: Stage::Weld,
            topology: Topology::new([].into_iter(), Vec::new()),
            polylines: Vec::new(),
            triangle_wedges: Vec::new(),
            triangle_groups: Vec::new(),
            wedge_of_vertex: Vec::new(),
            weld: Weld::default(),
            spaces: Vec::new(),
            part_of_vertex: Vec::new(),
            moved: Vec::new(),
            error_squared: Vec::new(),
            keys: Vec::new(),
            threshold: 0.0,
            ready: Vec::new(),
            ready_next: 0,
            again: Vec::new(),
            live: Vec::new(),
            epoch: 0,
            rank_at: Vec::new(),
            ranks: Vec::new(),
            max_error_squared: f32::INFINITY,
            blocked_by_error: false,
            scratch: Scratch::default(),
            sequence: CollapseSequence {
                collapses: Vec::new(),
                wedge_merges: Vec::new(),
                wedge_merge_ends: Vec::new(),
                triangle_counts: Vec::new(),
                vertex_of_wedge: Vec::new(),
                initial_triangle_count: 0,
                stop_reason: StopReason::Constraints,
            },
        })
    }

    /// Does about `work` units (one is about half a microsecond; a stage of the preparation is
    /// not split). `mesh` is the one given to [`Simplifier::new`].
    pub fn step(&mut self, mesh: &Mesh, work: usize) -> Progress {
        match self.stage {
            Stage::Weld => {
                self.weld(mesh);
                self.stage = Stage::Triangles;
            }
            Stage::Triangles => {
                self.order_triangles(mesh);
                self.stage = Stage::Fans;
            }
            Stage::Fans => {
                self.build_fans(mesh);
                self.stage = Stage::Kinds;
            }
            Stage::Kinds => {
                self.classify(mesh);
                self.stage = Stage::Quadrics;
            }
            Stage::Quadrics => {
                self.compute_quadrics();
                self.stage = Stage::Keys(0);
            }
            Stage::Keys(first) => {
                let count = self.topology.triangles.len();
                let last = count.min(first.saturating_add(work.max(1)));
                self.compute_keys(first, last);
                self.stage = if last == count { Stage::Sweep } else { Stage::Keys(last) };
            }
            Stage::Sweep => self.sweep(mesh, work),
            Stage::Done => {}
        }
        self.progress()
    }

    fn progress(&self) -> Progress {
        let count = self.topology.triangles.len().max(1) as f32;
        let fraction = match self.stage {
            Stage::Weld => 0.0,
            Stage::Triangles => 0.05,
            Stage::Fans => 0.08,
            Stage::Kinds => 0.1,
            Stage::Quadrics => 0.15,
            Stage::Keys(done) => 0.2 + 0.1 * done as f32 / count,
            Stage::Sweep => {
                let all = self.sequence.initial_triangle_count.max(1);
                let gone = all - self.topology.live_triangle_count;
                let wanted = all.saturating_sub(self.options.target_triangle_count).max(1);
                0.3 + 0.699 * (gone as f32 / wanted as f32).min(1.0)
            }
            Stage::Done => 1.0,
        };
        Progress { fraction, done: self.stage == Stage::Done }
    }

    /// The recorded history; if the run is not over, of what was done so far.
    #[must_use]
    pub fn finish(mut self) -> CollapseSequence {
        if self.stage != Stage::Done {
            self.complete(StopReason::Constraints);
        }
        self.sequence
    }

    fn weld(&mut self, mesh: &Mesh) {
        let weld = weld::weld(mesh);
        let mut part_of_wedge = vec![0_u16; mesh.positions.len()];
        for set in &mesh.wedge_sets {
            part_of_wedge[set.wedges.clone()].fill(set.part as u16);
        }
        let diagonal = mesh.diagonal_of(weld.wedge_of_vertex.iter().map(|&w| (w, part_of_wedge[w as usize].into())));
        let world_per_engine = if diagonal > 0.0 { diagonal } else { 1.0 };
        self.spaces = part_spaces(mesh, world_per_engine);
        self.max_error_squared = (f64::from(self.options.max_error) / world_per_engine).powi(2) as f32;
        self.part_of_vertex = weld.wedge_of_vertex.iter().map(|&w| part_of_wedge[w as usize]).collect();

        self.weld = weld;
    }

    /// Triangles in the order of their lowest vertex, for the same locality as the vertices.
    fn order_triangles(&mut self, mesh: &Mesh) {
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
        let several_wedges =
            weld.wedge_of_vertex.len() < weld.vertex_of_wedge.iter().filter(|&&v| v != NO_VERTEX).count();
        let several_groups = mesh.groups.len() > 1;
        let mut triangles: Vec<Triangle> = vec![[0; 3]; count];
        if several_wedges {
            self.triangle_wedges = vec![[0; 3]; count];
        }
        if several_groups {
            self.triangle_groups = vec![0; count];
        }
        for (g, group) in mesh.groups.iter().enumerate() {
            for t in mesh.triangles[group.triangles.clone()].iter().filter(|t| proper(t)) {
                let start = &mut starts[lowest(t)];
                let slot = *start as usize;
                *start += 1;
                triangles[slot] = t.map(vertex);
                if several_wedges {
                    self.triangle_wedges[slot] = *t;
                }
                if several_groups {
                    self.triangle_groups[slot] = g as u32;
                }
            }
        }
        self.topology.triangles = triangles;
    }

    fn build_fans(&mut self, mesh: &Mesh) {
        let weld = std::mem::take(&mut self.weld);
        let positions = weld.wedge_of_vertex.iter().zip(&self.part_of_vertex).map(|(&w, &part)| {
            let (p, space) = (mesh.positions[w as usize], self.spaces[usize::from(part)]);
            let coordinate = |k: usize| ((f64::from(p[k]) - space.centre[k]) / space.local_per_engine) as f32;
            Vec3 { x: coordinate(0), y: coordinate(1), z: coordinate(2) }
        });
        let triangles = std::mem::take(&mut self.topology.triangles);
        let count = triangles.len();
        self.topology = Topology::new(positions, triangles);
        let vertex_count = weld.wedge_of_vertex.len();
        self.moved = vec![false; vertex_count];
        self.error_squared = vec![0.0; vertex_count];
        self.rank_at = vec![0.0; vertex_count];
        self.keys = vec![f32::INFINITY; vertex_count];
        self.live = (0..vertex_count as u32).collect();
        self.sequence.initial_triangle_count = count;
        self.sequence.vertex_of_wedge = weld
            .vertex_of_wedge
            .iter()
            .map(|&v| if v == NO_VERTEX { NO_VERTEX } else { weld.wedge_of_vertex[v as usize] })
            .collect();
        self.wedge_of_vertex = weld.wedge_of_vertex;
    }

    fn classify(&mut self, mesh: &Mesh) {
        let charts =
            if self.triangle_wedges.is_empty() { Vec::new() } else { charts(mesh, &self.sequence.vertex_of_wedge) };
        let (wedges, groups) = (&self.triangle_wedges, &self.triangle_groups);
        let triangles = self.topology.triangles.clone();
        let chart_at = |t: u32, v: u32| {
            let corner = triangles[t as usize].iter().position(|&x| x == v).unwrap_or(0);
            charts[wedges[t as usize][corner] as usize]
        };
        let is_seam = |a: u32, b: u32, v: u32, w: u32| {
            (!groups.is_empty() && groups[a as usize] != groups[b as usize])
                || (!wedges.is_empty() && (chart_at(a, v) != chart_at(b, v) || chart_at(a, w) != chart_at(b, w)))
        };
        self.polylines = vertex_kind::classify(&mut self.topology, self.options.lock_border, is_seam);
    }

    fn compute_quadrics(&mut self) {
        for t in 0..self.topology.triangles.len() {
            let [a, b, c] = self.topology.triangles[t];
            let n = self.topology.area_vector(self.topology.vertices[a as usize].position, b, c);
            let quadric = Quadric::of_triangle(n);
            for v in [a, b, c] {
                self.topology.vertices[v as usize].quadric += quadric;
            }
        }
        for v in 0..self.polylines.len() as u32 {
            let lines = self.line_quadric(v);
            self.topology.vertices[v as usize].quadric += lines;
        }
    }

    /// The quadric of the two polyline edges of a border or seam vertex, 0 for others.
    fn line_quadric(&self, v: u32) -> Quadric {
        let vertex = &self.topology.vertices[v as usize];
        if !matches!(vertex.kind, VertexKind::Border | VertexKind::Seam) {
            return Quadric::default();
        }
        let mut sum = Quadric::default();
        for w in self.polylines[v as usize] {
            let edge = self.topology.vertices[w as usize].position - vertex.position;
            sum += Quadric::of_line(edge, LINE_WEIGHT);
        }
        sum
    }

    /// First keys, from the triangles' edges: the cost of merging at the better end, which bounds
    /// the solved cost from above. No fan is walked and nothing is solved, and the error is as
    /// with solved keys: the first visit solves, and the thresholds are coarse.
    fn compute_keys(&mut self, first: usize, last: usize) {
        let vertices = &self.topology.vertices;
        for &[a, b, c] in &self.topology.triangles[first..last] {
            for (u, v) in [(a, b), (b, c), (c, a)] {
                // The other direction, from `v`, is in the triangle across the edge.
                let from = &vertices[u as usize];
                let cost = from.quadric.error_at(vertices[v as usize].position - from.position);
                for end in [u, v] {
                    let key = &mut self.keys[end as usize];
                    *key = quadric::smaller(*key, cost);
                }
            }
        }
    }

    /// Fills the candidates with every edge at `v` that its kind allows, at its best placement. The fan of `v` is in `scratch.fan`.
    fn gather_candidates(&mut self, v: u32) {
        let Self { topology, scratch, polylines, options, .. } = self;
        scratch.candidates.clear();
        scratch.neighbours.clear();
        let own = &topology.vertices[v as usize];
        let optimal = options.placement == PlacementRule::Optimal;
        let Scratch { fan, neighbours, candidates, .. } = scratch;
        let all_manifold = optimal
            && own.kind == VertexKind::Manifold
            && fan.iter().all(|t| topology.vertices[t.next as usize].kind == VertexKind::Manifold);
        let mut consider = |w: u32| {
            let other = &topology.vertices[w as usize];
            let freedom = vertex_kind::freedom(own.kind, other.kind, || {
                let (line, end) = if own.kind == VertexKind::Complex { (w, v) } else { (v, w) };
                polylines[line as usize].contains(&end)
            });
            let at_own =
                || Placement { position: own.position, cost: other.quadric.error_at(own.position - other.position) };
            let at_other =
                || Placement { position: other.position, cost: own.quadric.error_at(other.position - own.position) };
            let (freedom, placement) = match freedom {
                Freedom::Forbidden => return,
                Freedom::Anywhere if optimal => {
                    neighbours.push(w);
                    return;
                }
                Freedom::AtFirst => (freedom, at_own()),
                Freedom::AtSecond => (freedom, at_other()),
                Freedom::Anywhere => {
                    let (first, second) = (at_own(), at_other());
                    if first.cost <= second.cost { (Freedom::AtFirst, first) } else { (Freedom::AtSecond, second) }
                }
            };
            candidates.push(Candidate { neighbour: w, freedom, placement });
        };
        if all_manifold {
            // The common case, without a look at each pair of kinds.
            neighbours.extend(fan.iter().map(|t| t.next));
        } else if matches!(own.kind, VertexKind::Manifold | VertexKind::Seam) {
            for t in fan.iter() {
                consider(t.next);
            }
        } else {
            // Open and non-manifold fans: some neighbours only arrive, some come twice.
            for (i, t) in fan.iter().enumerate() {
                for w in [t.next, t.previous] {
                    if fan[..i].iter().all(|t| t.next != w && t.previous != w) {
                        consider(w);
                    }
                }
            }
        }
        for four in neighbours.chunks(WIDTH) {
            let others = std::array::from_fn(|k| &topology.vertices[four[k.min(four.len() - 1)] as usize]);
            let placements =
                placement::solve(own.position, &own.quadric, others.map(|o| o.position), others.map(|o| &o.quadric));
            for (&neighbour, placement) in four.iter().zip(placements) {
                candidates.push(Candidate { neighbour, freedom: Freedom::Anywhere, placement });
            }
        }
    }

    fn sweep(&mut self, mesh: &Mesh, work: usize) {
        let mut left = work;
        while left > 0 {
            if self.topology.live_triangle_count <= self.options.target_triangle_count {
                self.complete(StopReason::Target);
                return;
            }
            if self.ready_next == self.ready.len() {
                let cost = self.live.len() / 16;
                if !self.raise_threshold() {
                    self.complete(if self.blocked_by_error { StopReason::Error } else { StopReason::Constraints });
                    return;
                }
                left = left.saturating_sub(cost);
                continue;
            }
            let v = self.ready[self.ready_next];
            self.ready_next += 1;
            if self.keys[v as usize] <= self.threshold {
                let cost = self.visit(mesh, v);
                left = left.saturating_sub(cost);
            }
        }
    }

    /// Puts the record in the order of its ranks and ends the run.
    fn complete(&mut self, reason: StopReason) {
        let sequence = &mut self.sequence;
        let mut order: Vec<(u32, u32)> = self.ranks.iter().zip(0..).map(|(rank, i)| (rank.to_bits(), i)).collect();
        order.sort_unstable();
        let order = order.into_iter().map(|(_, i)| i as usize);

        let mut worst = 0.0_f32;
        let mut left = sequence.initial_triangle_count as u32;
        let mut collapses = Vec::with_capacity(sequence.collapses.len());
        let mut counts = Vec::with_capacity(sequence.collapses.len());
        let mut merges = Vec::with_capacity(sequence.wedge_merges.len());
        let mut ends = Vec::with_capacity(sequence.wedge_merge_ends.len());
        for i in order {
            let collapse = sequence.collapses[i];
            worst = worst.max(collapse.error);
            collapses.push(Collapse { error: worst, ..collapse });
            let before = if i == 0 { sequence.initial_triangle_count as u32 } else { sequence.triangle_counts[i - 1] };
            left -= before - sequence.triangle_counts[i];
            counts.push(left);
            if let Some(&end) = sequence.wedge_merge_ends.get(i) {
                let start = if i == 0 { 0 } else { sequence.wedge_merge_ends[i - 1] };
                merges.extend_from_slice(&sequence.wedge_merges[start as usize..end as usize]);
                ends.push(merges.len() as u32);
            }
        }
        sequence.collapses = collapses;
        sequence.triangle_counts = counts;
        sequence.wedge_merges = merges;
        sequence.wedge_merge_ends = ends;
        sequence.stop_reason = reason;
        self.stage = Stage::Done;
    }

    /// Makes the next list of vertices to visit; false when none can ever be.
    fn raise_threshold(&mut self) -> bool {
        self.ready.clear();
        self.ready_next = 0;
        if !self.again.is_empty() {
            std::mem::swap(&mut self.ready, &mut self.again);
            return true;
        }
        let mut lowest = f32::INFINITY;
        let keys = &self.keys;
        self.live.retain(|&v| {
            lowest = lowest.min(keys[v as usize]);
            keys[v as usize] < f32::INFINITY
        });
        if lowest == f32::INFINITY {
            return false;
        }
        let octaves = if self.options.target_triangle_count == 0 { OCTAVES_FOR_LEVELS } else { OCTAVES_TO_TARGET };
        self.threshold = next_threshold(lowest, octaves);
        let threshold = self.threshold;
        self.ready.extend(self.live.iter().copied().filter(|&v| keys[v as usize] <= threshold));
        // Near the target, take the cheapest part of the octave and not its first part in space.
        let missing = (self.topology.live_triangle_count - self.options.target_triangle_count).div_ceil(2);
        let quota = missing + missing / 2;
        if self.ready.len() > quota {
            let mut sorted: Vec<f32> = self.ready.iter().map(|&v| keys[v as usize]).collect();
            let (_, &mut limit, _) = sorted.select_nth_unstable_by(quota, f32::total_cmp);
            self.threshold = limit;
            self.ready.retain(|&v| keys[v as usize] <= limit);
        }
        true
    }

    /// Collapses the cheapest legal edge at `v` below the threshold and gives `v` a new key.
    /// Returns the work done.
    fn visit(&mut self, mesh: &Mesh, v: u32) -> usize {
        self.topology.walk_fan(v, &mut self.scratch.fan);
        self.gather_candidates(v);
        let mut refused = false;
        for _ in 0..TRIES {
            let Some(best) = take_cheapest(&mut self.scratch.candidates) else { break };
            if best.placement.cost > self.threshold {
                self.scratch.candidates.push(best);
                break;
            }
            let (into, from) = match best.freedom {
                Freedom::AtSecond => (best.neighbour, v),
                _ => (v, best.neighbour),
            };
            if self.try_collapse(mesh, from, into, v, best.placement) {
                self.keys[from as usize] = f32::INFINITY;
                if best.placement.cost * 4.0 < self.threshold {
                    self.keys[into as usize] = self.threshold;
                    self.again.push(into);
                } else {
                    self.keys[into as usize] = next_up(self.threshold);
                }
                return 4;
            }
            refused = true;
        }
        let mut key = cheapest(&self.scratch.candidates);
        if refused {
            // A refused edge gets another chance when its surroundings have changed.
            key = key.max(self.threshold).min(self.threshold * 2.0);
            if key <= self.threshold {
                key = self.threshold * 2.0;
            }
        }
        self.keys[v as usize] =
            if self.threshold >= MAX_THRESHOLD { f32::INFINITY } else { key.max(next_up(self.threshold)) };
        2
    }

    /// Collapses the edge if it is legal. `walked` is the end whose fan is in `scratch.fan`.
    fn try_collapse(&mut self, mesh: &Mesh, from: u32, into: u32, walked: u32, placement: Placement) -> bool {
        let Self { topology, scratch, .. } = self;
        let other = if walked == from { into } else { from };
        topology.walk_fan(other, &mut scratch.fan_other);
        let (fan_from, fan_into) =
            if walked == from { (&scratch.fan, &scratch.fan_other) } else { (&scratch.fan_other, &scratch.fan) };
        if !self.polylines.is_empty() && !polyline_stays_open(&self.polylines, &topology.vertices, from, into) {
            return false;
        }
        if legality::check_link(topology, (from, fan_from), (into, fan_into), &mut self.epoch).is_err() {
            return false;
        }
        let (old_from, old_into) = (topology.vertices[from as usize], topology.vertices[into as usize]);
        let weight = old_from.quadric.trace() + old_into.quadric.trace();
        let step = if weight > 0.0 { placement.cost / weight } else { 0.0 };
        let error_squared = self.error_squared[from as usize].max(self.error_squared[into as usize]) + step;
        if error_squared > self.max_error_squared {
            self.blocked_by_error = true;
            return false;
        }
        let (changes, position) = (&mut scratch.changes, placement.position);
        let Ok(sum) = gather_changes(topology, changes, (from, fan_from), (into, fan_into), position) else {
            return false;
        };

        // From here on the collapse is done.
        let mut opposite = [into; 2];
        for (t, slot) in fan_from.iter().filter(|t| t.next == into || t.previous == into).zip(&mut opposite) {
            let third = if t.next == into { t.previous } else { t.next };
            *slot = third;
            let n = topology.area_vector(old_from.position, t.next, t.previous);
            topology.vertices[third as usize].quadric -= Quadric::of_triangle(n);
        }
        self.merge_wedges(from, into);
        let Self { topology, scratch, .. } = self;
        for change in &scratch.changes {
            let FanTriangle { triangle, next, previous } = change.triangle;
            topology.vertices[next as usize].quadric += change.difference;
            topology.vertices[previous as usize].quadric += change.difference;
            if change.vertex == from {
                for corner in &mut topology.triangles[triangle as usize] {
                    *corner = if *corner == from { into } else { *corner };
                }
            }
        }
        let fan_from = if walked == from { &scratch.fan } else { &scratch.fan_other };
        for t in fan_from.iter().filter(|t| t.next == into || t.previous == into) {
            topology.kill(t.triangle);
        }
        topology.set_fan(into, from, scratch.changes.iter().map(|c| c.triangle.triangle));
        let vertex = &mut topology.vertices[into as usize];
        vertex.quadric = sum;
        let has_moved = vertex.position != placement.position;
        vertex.position = placement.position;
        self.update_polylines(from, into, old_from.position, old_into.position);
        self.error_squared[into as usize] = error_squared;
        self.moved[into as usize] |= has_moved;
        self.rank(from, into, &opposite, placement.cost);
        self.record(mesh, from, into);
        true
    }

    /// Renames the wedges of `from` that the vanishing triangles link to a wedge of `into`.
    fn merge_wedges(&mut self, from: u32, into: u32) {
        if self.triangle_wedges.is_empty() {
            return;
        }
        let Self { topology, scratch, triangle_wedges, .. } = self;
        scratch.merges.clear();
        let corner = |triangle: u32, v: u32| topology.triangles[triangle as usize].iter().position(|&x| x == v);
        // Of the two fans, the one of `from` is the one whose triangles have `from` as a corner
        // without being shared; shared triangles are in both, so either fan finds them.
        for t in scratch.fan.iter() {
            if let (Some(a), Some(b)) = (corner(t.triangle, from), corner(t.triangle, into)) {
                let [wedge_from, wedge_into] = [a, b].map(|c| triangle_wedges[t.triangle as usize][c]);
                if wedge_from != wedge_into && scratch.merges.iter().all(|m| m.0 != wedge_from) {
                    scratch.merges.push((wedge_from, wedge_into));
                }
            }
        }
        for change in &scratch.changes {
            let triangle = change.triangle.triangle;
            if let Some(c) = corner(triangle, from) {
                let wedge = &mut triangle_wedges[triangle as usize][c];
                if let Some(merge) = scratch.merges.iter().find(|m| m.0 == *wedge) {
                    *wedge = merge.1;
                }
            }
        }
    }

    /// Takes `from` out of its polyline and moves the line quadrics of the neighbours along.
    fn update_polylines(&mut self, from: u32, into: u32, old_from: Vec3, old_into: Vec3) {
        if self.polylines.is_empty() {
            return;
        }
        let has_lines = |kind| matches!(kind, VertexKind::Border | VertexKind::Seam);
        let kind_of = |s: &Self, v: u32| s.topology.vertices[v as usize].kind;
        let now = self.topology.vertices[into as usize].position;
        let along = has_lines(kind_of(self, from));
        if along {
            let ends = self.polylines[from as usize];
            let beyond = if ends[0] == into { ends[1] } else { ends[0] };
            for (v, old, new) in [(into, from, beyond), (beyond, from, into)] {
                if has_lines(kind_of(self, v)) {
                    for end in &mut self.polylines[v as usize] {
                        if *end == old {
                            *end = new;
                        }
                    }
                }
            }
            self.move_line(beyond, old_from, now);
            if has_lines(kind_of(self, into)) {
                for w in self.polylines[into as usize] {
                    if w != beyond {
                        self.move_line(w, old_into, now);
                    }
                }
            }
        }
        if has_lines(kind_of(self, into)) {
            let lines = self.line_quadric(into);
            self.topology.vertices[into as usize].quadric += lines;
        }
    }

    /// The polyline neighbour of border or seam vertex `v` moved from `old` to `new`.
    fn move_line(&mut self, v: u32, old: Vec3, new: Vec3) {
        let vertex = &mut self.topology.vertices[v as usize];
        if matches!(vertex.kind, VertexKind::Border | VertexKind::Seam) {
            vertex.quadric -= Quadric::of_line(old - vertex.position, LINE_WEIGHT);
            vertex.quadric += Quadric::of_line(new - vertex.position, LINE_WEIGHT);
        }
    }

    /// Ranks the collapse just done: its cost, or the rank of the latest collapse in its
    /// neighbourhood if that is higher. A collapse depends only on what happened in its ring, so
    /// the record may be put in the order of the ranks afterwards: the coarse, spatial order of
    /// the sweeps leaves no trace, and every level is as good as if it had been the target.
    fn rank(&mut self, from: u32, into: u32, opposite: &[u32; 2], cost: f32) {
        let mut rank = cost;
        let mut depend_on = |v: u32| {
            let at = self.rank_at[v as usize];
            rank = if at > rank { at } else { rank };
        };
        // Around a closed fan every vertex is next once; only open ends are just previous.
        let closed = matches!(self.topology.vertices[into as usize].kind, VertexKind::Manifold | VertexKind::Seam);
        for change in &self.scratch.changes {
            depend_on(change.triangle.next);
            if !closed {
                depend_on(change.triangle.previous);
            }
        }
        [from, into, opposite[0], opposite[1]].into_iter().for_each(depend_on);
        self.rank_at[into as usize] = rank;
        self.ranks.push(rank);
    }

    fn record(&mut self, mesh: &Mesh, from: u32, into: u32) {
        let part = usize::from(self.part_of_vertex[into as usize]);
        let space = self.spaces[part];
        let wedge = self.wedge_of_vertex[into as usize];
        let position = if self.moved[into as usize] {
            let e = self.topology.vertices[into as usize].position;
            let local = |c: f32, k: usize| (space.centre[k] + f64::from(c) * space.local_per_engine) as f32;
            [local(e.x, 0), local(e.y, 1), local(e.z, 2)]
        } else {
            mesh.positions[wedge as usize]
        };
        let world_per_engine = space.local_per_engine * f64::from(mesh.parts[part].scale);
        self.sequence.collapses.push(Collapse {
            from: self.wedge_of_vertex[from as usize],
            into: wedge,
            position,
            error: (f64::from(self.error_squared[into as usize]).sqrt() * world_per_engine) as f32,
        });
        if !self.triangle_wedges.is_empty() {
            self.sequence.wedge_merges.extend_from_slice(&self.scratch.merges);
            self.sequence.wedge_merge_ends.push(self.sequence.wedge_merges.len() as u32);
        }
        self.sequence.triangle_counts.push(self.topology.live_triangle_count as u32);
    }
}

/// Above this (engine units: the diagonal to the fourth power is 1) nothing is ever cheap enough.
const MAX_THRESHOLD: f32 = 1e6;

/// The least power of two above `cost` whose exponent is a multiple of `octaves`; on the bits,
/// because logarithms differ between platforms.
fn next_threshold(cost: f32, octaves: i32) -> f32 {
    let exponent = (cost.max(f32::MIN_POSITIVE).to_bits() >> 23) as i32 - 127;
    let next = (exponent.div_euclid(octaves) + 1) * octaves;
    f32::from_bits(((next + 127).clamp(1, 254) as u32) << 23)
}

fn next_up(x: f32) -> f32 {
    f32::from_bits(x.to_bits() + 1)
}

fn cheapest(candidates: &[Candidate]) -> f32 {
    candidates.iter().map(|c| c.placement.cost).fold(f32::INFINITY, quadric::smaller)
}

fn take_cheapest(candidates: &mut Vec<Candidate>) -> Option<Candidate> {
    let best =
        (0..candidates.len()).min_by(|&a, &b| candidates[a].placement.cost.total_cmp(&candidates[b].placement.cost))?;
    Some(candidates.swap_remove(best))
}

/// False if the collapse would close a border or seam loop onto itself.
fn polyline_stays_open(polylines: &[Polyline], vertices: &[topology::Vertex], from: u32, into: u32) -> bool {
    let has_lines = |v: u32| matches!(vertices[v as usize].kind, VertexKind::Border | VertexKind::Seam);
    if !has_lines(from) {
        return true;
    }
    let ends = polylines[from as usize];
    if !ends.contains(&into) {
        return false;
    }
    let beyond = if ends[0] == into { ends[1] } else { ends[0] };
    beyond != into && beyond != NONE && (!has_lines(into) || !polylines[into as usize].contains(&beyond))
}

/// The triangles that stay, with the change of their quadrics; four at a time. Returns the
/// quadric of the merged vertex, or refuses a flip.
#[inline(always)]
fn gather_changes(
    topology: &Topology,
    changes: &mut Vec<Change>,
    (from, fan_from): (u32, &[FanTriangle]),
    (into, fan_into): (u32, &[FanTriangle]),
    position: Vec3,
) -> Result<Quadric, Refusal> {
    changes.clear();
    for (v, other, fan) in [(from, into, fan_from), (into, from, fan_into)] {
        for t in fan.iter().filter(|t| t.next != other && t.previous != other) {
            changes.push(Change { vertex: v, triangle: *t, difference: Quadric::default() });
        }
    }
    let mut sum = QuadricLanes::zero();
    let at = |v: u32| topology.vertices[v as usize].position;
    let merged = Lanes3::gather([position; WIDTH]);
    for four in changes.chunks_mut(WIDTH) {
        let lane: [&Change; WIDTH] = std::array::from_fn(|k| &four[if k < four.len() { k } else { 0 }]);
        let origin = Lanes3::gather(lane.map(|c| at(c.vertex)));
        let (a, b) =
            (Lanes3::gather(lane.map(|c| at(c.triangle.next))), Lanes3::gather(lane.map(|c| at(c.triangle.previous))));
        let before = (a - origin).cross(b - origin);
        let (p, q, opposite) = (a - merged, b - merged, b - a);
        let after = p.cross(q);
        let longest = p.dot(p).max(q.dot(q)).max(opposite.dot(opposite));
        if !legality::keep_upright(before, after, longest) {
            return Err(Refusal::Flip);
        }
        let after = QuadricLanes::of_triangles(after);
        let difference = after.minus(&QuadricLanes::of_triangles(before));
        sum.add_weighted(&after, Lanes(std::array::from_fn(|k| if k < four.len() { 1.0 } else { 0.0 })));
        for (k, change) in four.iter_mut().enumerate() {
            change.difference = difference.lane(k);
        }
    }
    let (first, second) = (sum.lane(0) + sum.lane(1), sum.lane(2) + sum.lane(3));
    Ok(first + second)
}

/// The engine space of each part.
fn part_spaces(mesh: &Mesh, world_per_engine: f64) -> Vec<Space> {
    let mut bounds = vec![([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]); mesh.parts.len()];
    for set in &mesh.wedge_sets {
        let (low, high) = &mut bounds[set.part];
        for p in &mesh.positions[set.wedges.clone()] {
            for k in 0..3 {
                low[k] = low[k].min(f64::from(p[k]));
                high[k] = high[k].max(f64::from(p[k]));
            }
        }
    }
    bounds
        .iter()
        .zip(&mesh.parts)
        .map(|((low, high), part)| Space {
            centre: std::array::from_fn(|k| if low[k] <= high[k] { 0.5 * (low[k] + high[k]) } else { 0.0 }),
            local_per_engine: world_per_engine / f64::from(part.scale),
        })
        .collect()
}

/// The chart of each wedge: wedges of one vertex that agree in everything but the shading frame
/// share one, named by one of them.
fn charts(mesh: &Mesh, vertex_of_wedge: &[u32]) -> Vec<u32> {
    use crate::mesh::Blend;
    let mut chart: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    // The wedges that share a vertex with an earlier one, beside each other.
    let mut sharing: Vec<(u32, u32)> = vertex_of_wedge
        .iter()
        .enumerate()
        .filter(|&(w, &v)| v != NO_VERTEX && v as usize != w)
        .map(|(w, &v)| (v, w as u32))
        .collect();
    sharing.sort_unstable();
    let set_of = |w: u32| mesh.wedge_sets.partition_point(|s| s.wedges.end <= w as usize);
    let same = |a: u32, b: u32| {
        let set = set_of(a);
        set == set_of(b) && {
            let set = &mesh.wedge_sets[set];
            set.attributes.iter().filter(|x| !matches!(x.blend, Blend::Direction | Blend::Tangent)).all(|x| {
                let value = |w: u32| {
                    let at = (w as usize - set.wedges.start) * x.components;
                    &x.values[at..at + x.components]
                };
                value(a) == value(b)
            })
        }
    };
    for others in sharing.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(vertex, w)) in others.iter().enumerate() {
            let mut earlier = std::iter::once(vertex).chain(others[..i].iter().map(|o| o.1));
            if let Some(e) = earlier.find(|&e| same(e, w)) {
                chart[w as usize] = chart[e as usize];
            }
        }
    }
    chart
}
