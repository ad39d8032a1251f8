//! Simplification: greedy edge collapse by quadric error, in coarse spatial order.
//!
//! The outline: weld and number the vertices along a Morton curve; order the triangles at every
//! vertex into a ring; classify the vertices; compute every vertex's memoryless quadric and a first
//! key, the least cost of merging along one of its edges at an end. Then raise a threshold by
//! octaves of the cost, and at each sweep visit the vertices whose key is below it in spatial order:
//! evaluate the vertex's edges afresh, collapse the cheapest legal one, update the quadrics of the
//! ring, go on. Everything is recorded in a [`CollapseSequence`].
//!
//! Garland & Heckbert (1997) gave the quadric, Lindstrom & Turk (1998) the memoryless form and the
//! volume constraint. Sweeping in spatial order and not strictly by cost is as good on the average
//! and several times faster, because memory is touched in order.

mod attribute_layout;
mod attribute_update;
mod attributes;
mod blockers;
mod collapse;
mod contraction;
mod edges;
mod fit;
mod gradient;
pub(crate) mod lanes;
mod legality;
mod memory;
mod pairs;
mod placement;
mod polylines;
mod prepare;
mod protection;
mod prune;
mod quadric;
mod record;
mod sheets;
mod space;
mod thinning;
mod topology;
mod vertex_kind;

pub use attribute_layout::{AttributeWeights, POSE};

use crate::collapse_sequence::{Blockers, Collapse, CollapseSequence, StopReason};
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;
use attribute_layout::Layout;
use attributes::AttributeField;
use collapse::Patch;
use edges::Edges;
use fit::Fit;
use legality::Refusal;
pub use memory::estimate_bytes;
use pairs::Pairs;
use polylines::Polylines;
use prepare::{Preparation, Welded};
use protection::Protection;
use record::Record;
use space::Space;
use thinning::Thinning;
use topology::Topology;
use vertex_kind::{Freedom, VertexKind};

/// How strongly the lines of borders and seams hold, against the planes of the surface.
const LINE_WEIGHT: f32 = 4.0;

/// Octaves of the cost from one threshold to the next for a run whose record is to be read at any
/// level. A level in the middle of a wide sweep has a quarter more error than a run to that count;
/// with one octave it has the same.
const OCTAVES_FOR_LEVELS: i32 = 1;

/// How many of a vertex's cheapest edges are tried before it waits for a higher threshold.
const TRIES: usize = 3;

/// The same when nothing else is left to do: of the many edges at a vertex of a tangle few are legal.
const TRIES_AT_LAST: usize = 16;

/// Where merged vertices may be put.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PlacementRule {
    /// Wherever the error is least.
    #[default]
    Optimal,
    /// Only at one of the two ends: the result's vertices are a subset of the original's.
    Subset,
}

/// Time against quality.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Preset {
    /// Where only positions count, thinning by half-edges first; then the sweep alone.
    Fast,
    /// The sweep, and one round of fitting where it pays.
    #[default]
    Balanced,
    /// Finer sweeps, and many rounds of fitting.
    Best,
}

/// What a preset stands for.
#[derive(Debug, Clone, Copy)]
struct Tuning {
    /// Before the sweep, vertices go by half-edges down to so many times the target's triangles; 0: none.
    thin_above: f32,
    /// Octaves of the cost from one threshold to the next. 1, 2, 3 and 4 give the same error within
    /// 1 %, and 4 takes a quarter less work than 1: fewer visits are in vain.
    octaves: i32,
    /// Triangles are contracted whole for up to so many times the threshold of an edge; 0: never.
    contract_below: f32,
    /// … as long as there are more than so many times the target's triangles.
    contract_above: usize,
    /// How often the vertices that are left are fitted to the original.
    fit_rounds: usize,
    /// Samples for each triangle that is left.
    fit_samples: usize,
    /// A vertex whose triangles are farther from a sample than the root of so many times the mean squared
    /// distance stays where it is: what the sweep left there is better for the maximum.
    fit_hold: f32,
    /// No fit if there are fewer than this many original triangles for each that is left.
    fit_above: usize,
}

impl Preset {
    fn tuning(self) -> Tuning {
        match self {
            Self::Fast => Tuning {
                thin_above: 2.5,
                octaves: 4,
                contract_below: 4.0,
                contract_above: 1,
                fit_rounds: 0,
                fit_samples: 0,
                fit_hold: 0.0,
                fit_above: 1,
            },
            Self::Balanced => Tuning {
                thin_above: 0.0,
                octaves: 3,
                contract_below: 0.0,
                contract_above: 4,
                fit_rounds: 1,
                fit_samples: 12,
                fit_hold: 10.4,
                fit_above: 3,
            },
            Self::Best => Tuning {
                thin_above: 0.0,
                octaves: 1,
                contract_below: 0.0,
                contract_above: 0,
                fit_rounds: 3,
                fit_samples: 24,
                fit_hold: f32::INFINITY,
                fit_above: 1,
            },
        }
    }
}

/// When to stop and what to keep.
#[derive(Debug, Clone, PartialEq)]
pub struct SimplifyOptions {
    /// At most this many triangles; 0 goes as far as the constraints allow. Default 0.
    pub target_triangle_count: usize,
    /// Largest estimated deviation in world units, ≥ 0. Default infinite.
    pub max_error: f32,
    /// Parts of the surface that are smaller than the error may vanish, the smallest first; one always
    /// stays. See [`Simplifier::pruned_count`]. Default off.
    pub prune: bool,
    /// Vertices on open borders neither move nor vanish. Default off.
    pub lock_border: bool,
    /// Vertices of separate components of one part that are nearer than this, in world units, may merge too, although no
    /// edge joins them; ≥ 0 and finite. The result is no manifold there. Default 0: none.
    pub merge_distance: f32,
    /// For each wedge a number ≥ 0: a collapse at its vertex counts 1 + weight times as dear, so that it comes later. 0
    /// is neutral, 1e6 is the most there is. What costs nothing goes all the same; see `locked`. Empty: all 0. Default.
    pub weights: Vec<f32>,
    /// For each wedge whether its vertex neither moves nor vanishes. Empty: none. Default.
    pub locked: Vec<bool>,
    /// What attributes weigh beside positions. Default 1 for each.
    pub attribute_weights: AttributeWeights,
    /// Default optimal.
    pub placement: PlacementRule,
    /// Default balanced.
    pub preset: Preset,
    /// Most bytes that the run may take beside the mesh itself, as estimated by [`estimate_bytes`]. Default: no limit.
    pub memory_limit: u64,
    /// The record is to be read at any level and not just at its end: sweeps are finer, the record
    /// is in the order of the error, and nothing is fitted. Default off.
    pub every_level: bool,
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self {
            target_triangle_count: 0,
            max_error: f32::INFINITY,
            prune: false,
            lock_border: false,
            merge_distance: 0.0,
            weights: Vec::new(),
            locked: Vec::new(),
            attribute_weights: AttributeWeights::default(),
            placement: PlacementRule::Optimal,
            preset: Preset::Balanced,
            memory_limit: u64::MAX,
            every_level: false,
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

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd)]
enum Stage {
    Weld,
    Triangles,
    Fans,
    Rings(usize),
    Attributes(usize),
    Thin,
    /// After thinning: quadrics and first keys from this vertex on.
    Quadrics(usize),
    Sweep,
    /// After a sweep that did not reach its target: the next vertex whose edges are looked at.
    Blockers(usize),
    Fit,
    Done,
}

/// One run, advanced by [`Simplifier::step`] so that its owner can look up between the steps.
#[derive(Debug)]
pub struct Simplifier {
    options: SimplifyOptions,
    stage: Stage,
    preparation: Preparation,
    /// Triangles that thinning is to leave; none if it is left out.
    thinning_goal: Option<usize>,
    thinning: Thinning,
    topology: Topology,
    polylines: Polylines,
    wedge_of_vertex: Vec<u32>,
    vertex_of_wedge: Vec<u32>,
    /// Wedges that are the same as another of their vertex, and which.
    duplicates: Vec<(u32, u32)>,
    spaces: Vec<Space>,
    part_of_vertex: Vec<u16>,
    /// For each vertex, the cost below which a visit may be worth while; infinite: never.
    keys: Vec<f32>,
    threshold: f32,
    ready: Vec<u32>,
    ready_next: usize,
    again: Vec<u32>,
    live: Vec<u32>,
    max_error_squared: f32,
    blocked_by_error: bool,
    /// Nothing is left to do but what the surface's topology forbids, where there is no surface.
    last_resort: bool,
    /// When that is done too, how many edges of more than two triangles may be made until there are as many as there
    /// were at the start.
    spare_sheet_edges: Option<i64>,
    /// Triangles when the last resort was begun.
    last_resort_from: usize,
    pruned_count: usize,
    /// Vertices with usual surroundings may be looked at four neighbours at a time, all at once.
    near: bool,
    /// Triangles may be contracted whole.
    contracting: bool,
    protection: Protection,
    pairs: Pairs,
    /// A pair that no edge joins is being merged.
    pairing: bool,
    /// None if no attribute counts.
    attributes: Option<AttributeField>,
    edges: Edges,
    patch: Box<Patch>,
    initial_triangle_count: usize,
    fit: Option<Fit>,
    fitted: bool,
    record: Record,
    stop_reason: StopReason,
    blockers: Blockers,
}

impl Simplifier {
    /// Checks the mesh and the options; the work is left to [`Simplifier::step`].
    ///
    /// # Errors
    /// As [`Mesh::validate`], and `invalid-argument` for a negative or NaN error, for weights or locks of another number
    /// than the wedges', and for negative weights; `not-finite` for weights that are not; `too-large` above the memory
    /// limit.
    pub fn new(mesh: &Mesh, options: &SimplifyOptions) -> Result<Self, Error> {
        mesh.validate()?;
        if options.max_error.is_nan() || options.max_error < 0.0 {
            return Err(Error::new(ErrorCode::InvalidArgument, "error", "must not be negative"));
        }
        if !(options.merge_distance.is_finite() && options.merge_distance >= 0.0) {
            return Err(Error::new(
                ErrorCode::InvalidArgument,
                "mergeDistance",
                "must be a finite number of at least 0",
            ));
        }
        protection::check(mesh, options)?;
        options.attribute_weights.validate()?;
        memory::check(mesh, options)?;
        Ok(Self {
            options: options.clone(),
            stage: Stage::Weld,
            preparation: Preparation::default(),
            thinning_goal: None,
            thinning: Thinning::default(),
            topology: Topology::default(),
            polylines: Polylines::default(),
            wedge_of_vertex: Vec::new(),
            vertex_of_wedge: Vec::new(),
            duplicates: Vec::new(),
            spaces: Vec::new(),
            part_of_vertex: Vec::new(),
            keys: Vec::new(),
            threshold: 0.0,
            ready: Vec::new(),
            ready_next: 0,
            again: Vec::new(),
            live: Vec::new(),
            max_error_squared: f32::INFINITY,
            blocked_by_error: false,
            last_resort: false,
            spare_sheet_edges: None,
            last_resort_from: 0,
            pruned_count: 0,
            near: false,
            contracting: false,
            protection: Protection::default(),
            pairs: Pairs::default(),
            pairing: false,
            attributes: None,
            edges: Edges::default(),
            patch: Box::default(),
            initial_triangle_count: 0,
            fit: None,
            fitted: false,
            record: Record::default(),
            stop_reason: StopReason::Constraints,
            blockers: Blockers::default(),
        })
    }

    /// Does about `work` units (one is about half a microsecond; the weld and the sorting of the
    /// triangles are not split). `mesh` is the one given to [`Simplifier::new`].
    pub fn step(&mut self, mesh: &Mesh, work: usize) -> Progress {
        let part = |first: usize, count: usize| first..count.min(first.saturating_add(work.max(1)));
        match self.stage {
            Stage::Weld => {
                self.weld(mesh);
                self.stage = Stage::Triangles;
            }
            Stage::Triangles => {
                self.duplicates = self.preparation.order_triangles(mesh, &self.vertex_of_wedge);
                self.stage = Stage::Fans;
            }
            Stage::Fans => {
                self.build_fans(mesh);
                self.stage = Stage::Rings(0);
            }
            Stage::Rings(first) => {
                let count = self.topology.vertices.len();
                let range = part(first, count);
                self.stage = if range.end == count { Stage::Sweep } else { Stage::Rings(range.end) };
                let bare = self.thinning_goal.is_some();
                let Self { preparation, topology, polylines, keys, options, .. } = self;
                preparation.build_rings(range, topology, polylines, keys, (options.lock_border, bare));
                if self.stage == Stage::Sweep {
                    self.begin_sweep(mesh);
                }
            }
            Stage::Attributes(first) => {
                let count = self.topology.vertices.len();
                let range = part(first, count);
                self.stage = if range.end == count { Stage::Sweep } else { Stage::Attributes(range.end) };
                if let Some(attributes) = &mut self.attributes {
                    range.for_each(|v| attributes.take_up(&self.topology, v as u32));
                }
            }
            Stage::Thin => {
                if self.thin(mesh, work) {
                    self.end_thinning();
                }
            }
            Stage::Quadrics(first) => {
                let count = self.topology.vertices.len();
                let range = part(first, count);
                self.stage = if range.end == count { Stage::Sweep } else { Stage::Quadrics(range.end) };
                self.take_quadrics(range);
            }
            Stage::Sweep => self.sweep(mesh, work),
            Stage::Blockers(first) => {
                let count = self.topology.vertices.len();
                let (mut next, mut left) = (first, work.max(1));
                while next < count && left > 0 {
                    // Vertices that are gone are stepped over in no time.
                    let range = next..count.min(next + 64);
                    next = range.end;
                    left = left.saturating_sub(1 + self.count_blockers(range));
                }
                if next == count {
                    self.begin_fit_or_end(mesh);
                } else {
                    self.stage = Stage::Blockers(next);
                }
            }
            Stage::Fit => {
                let mut fit = self.fit.take();
                if fit.as_mut().is_none_or(|fit| self.step_fit(mesh, fit, work)) {
                    self.fitted = true;
                    self.stage = Stage::Done;
                } else {
                    self.fit = fit;
                }
            }
            Stage::Done => {}
        }
        self.progress()
    }

    fn progress(&self) -> Progress {
        let vertices = self.topology.vertices.len().max(1) as f32;
        let fraction = match self.stage {
            Stage::Weld => 0.0,
            Stage::Triangles => 0.05,
            Stage::Fans => 0.08,
            Stage::Rings(done) => 0.1 + 0.15 * done as f32 / vertices,
            Stage::Attributes(done) => 0.25 + 0.05 * done as f32 / vertices,
            Stage::Thin | Stage::Quadrics(_) | Stage::Sweep => {
                let all = self.initial_triangle_count.max(1);
                let gone = all - self.topology.live_triangle_count;
                let wanted = all.saturating_sub(self.options.target_triangle_count).max(1);
                let share = if self.fits() { 0.6 } else { 0.699 };
                0.3 + share * (gone as f32 / wanted as f32).min(1.0)
            }
            Stage::Blockers(_) => {
                if self.fits() {
                    0.905
                } else {
                    0.9995
                }
            }
            Stage::Fit => {
                let rounds = self.tuning().fit_rounds;
                0.91 + 0.089 * self.fit.as_ref().map_or(0.0, |fit| fit.fraction(rounds))
            }
            Stage::Done => 1.0,
        };
        Progress { fraction, done: self.stage == Stage::Done }
    }

    /// Ends the run where it stands, for want of time. What was collapsed so far stays, a fit that is not complete
    /// is left out. The stop reason is [`StopReason::Time`] unless the collapsing was over. `mesh` is the one given to
    /// [`Simplifier::new`].
    pub fn stop(&mut self, mesh: &Mesh) {
        if self.stage < Stage::Rings(0) {
            // Nothing is welded yet: a history without an entry, over the mesh as it is stored.
            self.vertex_of_wedge = (0..mesh.positions.len() as u32).collect();
            self.initial_triangle_count = mesh.triangles.len();
            self.record = Record::new(self.initial_triangle_count, 0, 0, false);
        }
        if self.stage < Stage::Blockers(0) {
            self.stop_reason = StopReason::Time;
        } else if self.stage < Stage::Fit {
            // Half a count would mislead.
            self.blockers = Blockers::default();
        }
        self.stage = Stage::Done;
    }

    /// The recorded history; if the run is not over, of what was done so far.
    #[must_use]
    pub fn finish(mut self) -> CollapseSequence {
        let vertices = &self.topology.vertices;
        let fitted: Vec<(u32, [f32; 3])> = (0..if self.fitted { vertices.len() } else { 0 })
            .filter(|&v| vertices[v].ring_length() > 0 && vertices[v].moved)
            .map(|v| {
                let space = self.spaces[usize::from(self.part_of_vertex[v])];
                (self.wedge_of_vertex[v], space.to_local(self.topology.vertices[v].position()))
            })
            .collect();
        // Putting the record in order takes as much again: what is done with goes first.
        (self.topology, self.polylines) = (Topology::default(), Polylines::default());
        (self.keys, self.live, self.ready, self.again) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        self.attributes = None;
        self.record.finish(
            (self.vertex_of_wedge, self.duplicates),
            self.initial_triangle_count,
            (self.stop_reason, self.blockers),
            fitted,
        )
    }

    /// How many parts of the surface have vanished; 0 without [`SimplifyOptions::prune`].
    #[must_use]
    pub fn pruned_count(&self) -> usize {
        self.pruned_count
    }

    fn weld(&mut self, mesh: &Mesh) {
        let Welded { spaces, part_of_vertex, wedge_of_vertex, vertex_of_wedge } = self.preparation.weld(mesh);
        if let Some(space) = spaces.first() {
            self.max_error_squared = (f64::from(self.options.max_error) / space.world_per_engine).powi(2) as f32;
        }
        self.spaces = spaces;
        self.part_of_vertex = part_of_vertex;
        self.wedge_of_vertex = wedge_of_vertex;
        self.vertex_of_wedge = vertex_of_wedge;
    }

    fn build_fans(&mut self, mesh: &Mesh) {
        self.preparation.build_fans();
        self.initial_triangle_count = self.preparation.triangle_count();
        let positions = self.wedge_of_vertex.iter().zip(&self.part_of_vertex);
        let spaces = &self.spaces;
        let positions = positions.map(|(&w, &part)| spaces[usize::from(part)].to_engine(mesh.positions[w as usize]));
        self.topology = self.preparation.topology(positions);
        self.patch.set_starts = mesh.wedge_sets.iter().map(|set| set.wedges.start as u32).collect();
        let vertex_count = self.wedge_of_vertex.len();
        self.keys = vec![f32::INFINITY; vertex_count];
        self.record = Record::new(self.initial_triangle_count, 0, 0, false);
        self.thinning_goal = self.thinning_goal(mesh);
    }

    /// When the rings are there, what they were made from goes, and only then comes what the sweep needs.
    fn begin_sweep(&mut self, mesh: &Mesh) {
        self.preparation = Preparation::default();
        self.protect();
        if let (true, Some(space)) = (self.options.merge_distance > 0.0, self.spaces.first()) {
            let distance = f64::from(self.options.merge_distance) / space.world_per_engine;
            self.find_pairs((distance as f32).max(f32::MIN_POSITIVE));
        }
        let vertex_count = self.wedge_of_vertex.len();
        self.live = (0..vertex_count as u32).collect();
        let wanted = self.initial_triangle_count.saturating_sub(self.options.target_triangle_count);
        self.record = Record::new(
            self.initial_triangle_count,
            vertex_count.min(wanted / 2 + 1),
            vertex_count,
            self.options.every_level,
        );
        self.begin_attributes(mesh);
        self.near =
            self.options.placement == PlacementRule::Optimal && self.attributes.is_none() && self.pairs.is_empty();
        self.contracting = self.tuning().contract_below > 0.0 && self.contracts();
        if let Some(goal) = self.thinning_goal {
            self.begin_thinning(goal);
            self.stage = Stage::Thin;
        }
    }

    /// Takes up the attributes that count, if there are any.
    fn begin_attributes(&mut self, mesh: &Mesh) {
        let spaces = &self.spaces;
        let per_local = |part: usize| spaces[part].engine_per_local();
        let Some(layout) = Layout::new(mesh, &self.options.attribute_weights, per_local) else { return };
        if self.options.placement == PlacementRule::Optimal {
            self.record.solved = layout.solved();
        }
        let wedges = (self.vertex_of_wedge.as_slice(), self.wedge_of_vertex.as_slice());
        self.attributes = Some(AttributeField::new(mesh, layout, &self.topology, wedges));
        self.stage = Stage::Attributes(0);
    }

    fn tuning(&self) -> Tuning {
        self.options.preset.tuning()
    }

    /// Whether the vertices that are left are fitted to the original at the end.
    fn fits(&self) -> bool {
        self.tuning().fit_rounds > 0 && !self.options.every_level && self.options.placement == PlacementRule::Optimal
    }

    /// Octaves of the cost from one threshold to the next.
    fn octaves(&self) -> i32 {
        if self.options.every_level { OCTAVES_FOR_LEVELS } else { self.tuning().octaves }
    }

    fn sweep(&mut self, mesh: &Mesh, work: usize) {
        let mut left = work;
        while left > 0 {
            if self.topology.live_triangle_count <= self.options.target_triangle_count {
                self.complete(mesh, StopReason::Target);
                return;
            }
            if self.ready_next == self.ready.len() {
                let cost = self.live.len() / 16;
                if !self.raise_threshold() && !self.begin_last_resort(mesh) {
                    let reason = if self.blocked_by_error { StopReason::Error } else { StopReason::Constraints };
                    self.complete(mesh, reason);
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

    /// When nothing else is left to do, gives the vertices that no surface goes through, and their
    /// neighbours, another chance; false if there is none. First no edge may become one of more than two triangles; then
    /// one may as long as there are no more of them than at the start, as often as that leads anywhere.
    fn begin_last_resort(&mut self, mesh: &Mesh) -> bool {
        let count = self.topology.live_triangle_count;
        if self.spare_sheet_edges.is_some() && count + count / 16 >= self.last_resort_from {
            return false;
        }
        if self.last_resort && self.spare_sheet_edges.is_none() {
            let before = sheets::edges_of_mesh(mesh, &self.vertex_of_wedge);
            self.spare_sheet_edges = Some(before as i64 - sheets::edges_of_rings(&self.topology) as i64);
        }
        self.last_resort = true;
        self.last_resort_from = count;
        self.threshold = 0.0;
        let Self { topology, keys, live, .. } = self;
        live.clear();
        for v in 0..topology.vertices.len() as u32 {
            let vertex = &topology.vertices[v as usize];
            if vertex.kind == VertexKind::NonManifold && vertex.ring_length() > 0 {
                keys[v as usize] = 0.0;
                live.push(v);
            }
        }
        !live.is_empty()
    }

    /// Ends the sweep; a fit of what is left may follow, and before it a look at what blocks that.
    fn complete(&mut self, mesh: &Mesh, reason: StopReason) {
        self.stop_reason = reason;
        if reason == StopReason::Target {
            self.begin_fit_or_end(mesh);
        } else {
            self.stage = Stage::Blockers(0);
        }
    }

    fn begin_fit_or_end(&mut self, mesh: &Mesh) {
        let tuning = self.tuning();
        let dense = self.topology.live_triangle_count * tuning.fit_above > self.initial_triangle_count;
        if self.fits() && !dense && self.topology.live_triangle_count < self.initial_triangle_count {
            // Its samples need the room.
            (self.keys, self.live, self.ready, self.again) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
            self.fit = Some(self.begin_fit(mesh, tuning));
            self.stage = Stage::Fit;
        } else {
            self.stage = Stage::Done;
        }
    }

    /// Makes the next list of vertices to visit; false when none can ever be.
    fn raise_threshold(&mut self) -> bool {
        self.ready.clear();
        self.ready_next = 0;
        if !self.again.is_empty() {
            std::mem::swap(&mut self.ready, &mut self.again);
            return true;
        }
        // One pass if anything is below the threshold that follows, which is usual.
        let octaves = self.octaves();
        let mut lowest = self.collect_ready(next_threshold(self.threshold, octaves));
        if lowest == f32::INFINITY {
            return false;
        }
        if self.ready.is_empty() {
            lowest = self.collect_ready(next_threshold(lowest, octaves));
        }
        debug_assert!(lowest <= self.threshold);
        // Near the target, take the cheapest part of the octave and not its first part in space.
        let missing = (self.topology.live_triangle_count - self.options.target_triangle_count).div_ceil(2);
        let quota = missing + missing / 2;
        if self.ready.len() > quota {
            let keys = &self.keys;
            let limit = limit_of(self.ready.iter().map(|&v| keys[v as usize]), quota);
            self.threshold = limit;
            self.ready.retain(|&v| keys[v as usize] <= limit);
        }
        true
    }

    /// Sets the threshold and fills `ready` with the vertices below it, in spatial order. Drops
    /// the vertices that never will be. Returns the lowest key of all.
    fn collect_ready(&mut self, threshold: f32) -> f32 {
        let Self { keys, live, ready, .. } = self;
        let mut lowest = f32::INFINITY;
        live.retain(|&v| {
            let key = keys[v as usize];
            lowest = quadric::smaller(key, lowest);
            if key <= threshold {
                ready.push(v);
            }
            key < f32::INFINITY
        });
        self.threshold = threshold;
        lowest
    }

    /// Collapses the cheapest legal edge at `v` below the threshold and gives `v` a new key.
    /// Returns the work done.
    fn visit(&mut self, mesh: &Mesh, v: u32) -> usize {
        self.topology.refresh(v, &mut self.patch.builder);
        if self.options.prune && self.is_last_of_part(v) {
            return self.visit_last_of_part(mesh, v);
        }
        if self.near && self.edges.approach(&self.topology, v) {
            // Where the edges are hardly below the threshold, few triangles are, and those make the maximum worse.
            if self.contracting && self.keys[v as usize] * 2.0 <= self.threshold && self.visit_triangles(mesh, v) {
                return 4;
            }
            self.edges.solve_near(self.topology.ring(v).len());
        } else {
            self.edges.gather(
                &self.topology,
                &self.polylines,
                self.attributes.as_ref(),
                self.options.placement,
                self.last_resort,
                v,
            );
        }
        if !self.pairs.is_empty() {
            let Self { edges, topology, polylines, attributes, pairs, options, .. } = self;
            let others = pairs.of(topology, v);
            if !others.is_empty() {
                edges.list(topology, polylines, attributes.as_ref(), options.placement, self.last_resort, v);
                edges.add_pairs(topology, options.placement, &others);
            }
        }
        if !self.protection.is_empty() {
            let Self { edges, topology, protection, .. } = self;
            edges.weigh(topology, |w| protection.factor(v, w));
        }
        let mut refused = false;
        let mut key = f32::INFINITY;
        let most_tries = if self.spare_sheet_edges.is_some() { TRIES_AT_LAST } else { TRIES };
        for tries in 0..=most_tries {
            let Some((index, edge)) = self.edges.cheapest(&self.topology) else { break };
            let cost = edge.placement.cost;
            if cost > self.threshold || tries == most_tries {
                key = cost;
                break;
            }
            let (into, from) =
                if edge.freedom == Freedom::AtSecond { (edge.neighbour, v) } else { (v, edge.neighbour) };
            let is_pair = !self.pairs.is_empty() && !self.topology.ring(v).contains(&edge.neighbour);
            let done = if is_pair {
                self.try_pair(from, into, edge.placement)
            } else {
                self.try_collapse(from, into, edge.placement)
            };
            match done {
                Ok(()) => {
                    self.record_collapse(mesh, from, into);
                    if !self.protection.is_empty() {
                        self.protection.merge(from, into);
                    }
                    if !self.pairs.is_empty() {
                        self.pairs.merge(from, into);
                    }
                    self.keys[from as usize] = f32::INFINITY;
                    if cost * 4.0 < self.threshold {
                        self.keys[into as usize] = self.threshold;
                        self.again.push(into);
                    } else {
                        self.keys[into as usize] = next_up(self.threshold);
                    }
                    return 4;
                }
                Err(refusal) => self.blocked_by_error |= refusal == Refusal::Error,
            }
            self.edges.refuse(index);
            refused = true;
        }
        if refused {
            // A refused edge gets another chance when its surroundings have changed.
            key = if key <= self.threshold { self.threshold } else { key }.min(self.threshold * 2.0);
            if key <= self.threshold {
                key = self.threshold * 2.0;
            }
        }
        self.keys[v as usize] =
            if self.threshold >= MAX_THRESHOLD { f32::INFINITY } else { key.max(next_up(self.threshold)) };
        2
    }

    /// Contracts the cheapest triangle at `v` if it costs little; false if the edges are to be looked at.
    #[inline(always)]
    fn visit_triangles(&mut self, mesh: &Mesh, v: u32) -> bool {
        let least = (self.options.target_triangle_count * self.tuning().contract_above).saturating_add(4);
        if self.topology.live_triangle_count < least {
            self.contracting = false;
            return false;
        }
        let length = self.topology.ring(v).len();
        let (slot, placement) = self.edges.cheapest_triangle(length);
        if placement.cost > self.threshold * self.tuning().contract_below {
            return false;
        }
        let ring = self.topology.ring(v);
        let corners = [v, ring[slot], ring[if slot + 1 == length { 0 } else { slot + 1 }]];
        if self.try_contraction(mesh, corners, placement).is_err() {
            return false;
        }
        if placement.cost * 4.0 < self.threshold {
            self.keys[v as usize] = self.threshold;
            self.again.push(v);
        } else {
            self.keys[v as usize] = next_up(self.threshold);
        }
        true
    }

    fn record_collapse(&mut self, mesh: &Mesh, from: u32, into: u32) {
        let vertex = &self.topology.vertices[into as usize];
        let space = self.spaces[usize::from(self.part_of_vertex[into as usize])];
        let wedge = self.wedge_of_vertex[into as usize];
        let position = if vertex.moved { space.to_local(vertex.position()) } else { mesh.positions[wedge as usize] };
        let collapse = Collapse {
            from: self.wedge_of_vertex[from as usize],
            into: wedge,
            position,
            error: (f64::from(vertex.error_squared).sqrt() * space.world_per_engine) as f32,
        };
        self.record.push(collapse, self.topology.live_triangle_count);
        if self.topology.has_wedges() {
            self.record.push_merges(&self.patch.merges);
        }
        let solved = &mut self.record.solved;
        if let (Some(attributes), true) = (&self.attributes, solved.components > 0) {
            let plain = [(collapse.from, wedge)];
            let merges = if self.topology.has_wedges() { &self.patch.merges[..] } else { &plain };
            for &(_, wedge) in merges {
                let set = self.patch.set_starts.partition_point(|&start| start <= wedge) - 1;
                attributes.push_values((into, wedge, set), &mut solved.values);
            }
        }
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

/// A number that at least `quota` of the keys are not above, and few more: the upper end of one of
/// 1,024 equal parts of what they span, as bits. Keys are at least 0.
fn limit_of(keys: impl Iterator<Item = f32> + Clone, quota: usize) -> f32 {
    const PARTS: u32 = 1024;
    let (mut low, mut high) = (u32::MAX, 0);
    for key in keys.clone() {
        let bits = key.to_bits();
        (low, high) = (if bits < low { bits } else { low }, if bits > high { bits } else { high });
    }
    let width = high.saturating_sub(low) / PARTS + 1;
    let mut counts = [0_usize; PARTS as usize];
    for key in keys {
        counts[((key.to_bits() - low) / width).min(PARTS - 1) as usize] += 1;
    }
    let mut sum = 0;
    for (part, count) in (1..).zip(counts) {
        sum += count;
        if sum >= quota {
            return f32::from_bits((low + part * width - 1).min(high));
        }
    }
    f32::from_bits(high)
}

fn next_up(x: f32) -> f32 {
    f32::from_bits(x.to_bits() + 1)
}
