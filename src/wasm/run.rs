//! A simplification in steps, and what it gave.

use wasm_bindgen::prelude::*;

use super::requests::SimplifyRequest;
use super::{Model, missing, parse, thrown};
use crate::collapse_sequence::CollapseSequence;
use crate::error::{Error, ErrorCode};
use crate::lod::{self, Level, Levels};
use crate::mesh::{Attribute, Blend, Mesh};
use crate::simplify::{POSE, Simplifier};

/// Entries of the index's tables that take about as long as a unit of a simplification.
const ENTRIES_PER_UNIT: f64 = 50.0;

/// Of a run that makes the index too, the share of the time before that.
const SIMPLIFYING_SHARE: f32 = 0.9;

/// A simplification under way.
pub(super) struct Run {
    /// In the place of the model's mesh: the same with poses.
    posed: Option<Mesh>,
    /// Until its result is there.
    simplifier: Option<Simplifier>,
    /// The result, while its index is made.
    recorded: Option<Recorded>,
    /// As in [`SimplifyOptions`].
    max_error: f32,
    /// Whether the former record stays beside the result.
    keep_levels: bool,
    /// Whether the index of all levels is part of the run.
    index_levels: bool,
}

/// What a simplification gave.
pub(super) struct Recorded {
    pub(super) sequence: CollapseSequence,
    /// The index of the sequence, made when a level between the first and the last is asked for, or before.
    pub(super) levels: Levels,
    /// Full detail is the mesh itself.
    pub(super) is_whole: bool,
    /// The limit that every collapse kept to.
    max_error: f32,
}

#[wasm_bindgen]
impl Model {
    /// Weights and locks for the run that is begun next, a number for each vertex each; empty: none.
    #[wasm_bindgen(js_name = setProtection)]
    pub fn set_protection(&mut self, weights: Vec<f32>, locked: Vec<u8>) {
        (self.weights, self.locked) = (weights, locked);
    }

    /// Adds, for all runs, three numbers for each vertex of a wedge set that tell where its skin moves it.
    #[wasm_bindgen(js_name = addPose)]
    pub fn add_pose(&mut self, wedge_set: usize, values: Vec<f32>) -> Result<(), JsValue> {
        let set = self.mesh().wedge_sets.get(wedge_set).ok_or_else(|| missing("wedgeSet"))?;
        if values.len() != 3 * set.wedges.len() {
            return Err(missing("values"));
        }
        let name = format!("{POSE}{}", self.poses.iter().filter(|(known, _)| *known == wedge_set).count());
        self.poses.push((wedge_set, Attribute { name, components: 3, values, blend: Blend::Linear }));
        Ok(())
    }

    /// Starts a simplification; an earlier sequence stays until this one is done.
    #[wasm_bindgen(js_name = beginSimplify)]
    pub fn begin_simplify(&mut self, options: &str) -> Result<(), JsValue> {
        let request: SimplifyRequest = parse(options, "options")?;
        let mut options = request.options(self.mesh()).map_err(thrown)?;
        if !self.weights.is_empty() {
            options.weights = std::mem::take(&mut self.weights);
        }
        options.locked = std::mem::take(&mut self.locked).into_iter().map(|locked| locked != 0).collect();
        let posed = self.posed();
        let simplifier = Simplifier::new(posed.as_ref().unwrap_or(self.mesh()), &options).map_err(thrown)?;
        let SimplifyRequest { keep_levels, index_levels, .. } = request;
        let max_error = options.max_error;
        let simplifier = Some(simplifier);
        self.running = Some(Run { posed, simplifier, recorded: None, max_error, keep_levels, index_levels });
        Ok(())
    }

    /// Does about `work` units and returns the fraction done, exactly 1 when the result is ready.
    pub fn step(&mut self, work: f64) -> Result<f32, JsValue> {
        let Self { source, running, .. } = self;
        let run = running.as_mut().ok_or_else(not_simplifying)?;
        let share = if run.index_levels { SIMPLIFYING_SHARE } else { 1.0 };
        let mesh = source.mesh();
        let fraction = match (&mut run.simplifier, &mut run.recorded) {
            (Some(simplifier), _) => {
                let progress = simplifier.step(run.posed.as_ref().unwrap_or(mesh), work.clamp(1.0, 1e9) as usize);
                if progress.done {
                    run.take_result(mesh);
                }
                if progress.done && !run.index_levels { 1.0 } else { share * progress.fraction.min(0.999) }
            }
            (None, Some(recorded)) => share + (1.0 - share) * recorded.prepare(mesh, work),
            (None, None) => 1.0,
        };
        if fraction >= 1.0 {
            self.finish();
        }
        Ok(fraction)
    }

    /// Ends a running simplification for want of time; what was done so far is the result.
    #[wasm_bindgen(js_name = stopSimplify)]
    pub fn stop_simplify(&mut self) -> Result<(), JsValue> {
        let Self { source, running, .. } = self;
        let Run { posed, simplifier, .. } = running.as_mut().ok_or_else(not_simplifying)?;
        if let Some(simplifier) = simplifier {
            simplifier.stop(posed.as_ref().unwrap_or(source.mesh()));
        }
        self.finish();
        Ok(())
    }

    /// Drops a running simplification.
    #[wasm_bindgen(js_name = cancelSimplify)]
    pub fn cancel_simplify(&mut self) {
        self.running = None;
    }
}

impl Model {
    /// The mesh with the poses among its attributes, if there are any.
    fn posed(&self) -> Option<Mesh> {
        if self.poses.is_empty() {
            return None;
        }
        let mut mesh = self.mesh().clone();
        for (set, pose) in &self.poses {
            mesh.wedge_sets[*set].attributes.push(pose.clone());
        }
        Some(mesh)
    }

    /// Takes over the result of the run that is done.
    fn finish(&mut self) {
        let Some(mut run) = self.running.take() else { return };
        run.take_result(self.mesh());
        let Run { recorded: Some(recorded), keep_levels, .. } = run else { return };
        if keep_levels && self.record.is_some() {
            self.result = Some(recorded);
        } else {
            self.record = Some(recorded);
            self.result = None;
            self.level = None;
        }
    }
}

impl Run {
    /// The result of what was done so far, in the place of the simplifier.
    fn take_result(&mut self, mesh: &Mesh) {
        if let Some(simplifier) = self.simplifier.take() {
            self.recorded = Some(Recorded::new(mesh, simplifier, self.max_error));
        }
    }
}

impl Recorded {
    fn new(mesh: &Mesh, simplifier: Simplifier, max_error: f32) -> Self {
        let mut sequence = simplifier.finish();
        // Poses are for the cost alone: the file has no such attributes.
        for (layout, set) in sequence.solved.layouts.iter_mut().zip(&mesh.wedge_sets) {
            layout.retain(|solved| solved.attribute < set.attributes.len());
        }
        let is_whole = lod::is_whole(mesh, &sequence);
        Self { sequence, levels: Levels::default(), is_whole, max_error }
    }

    /// Does about `work` units of the index and returns the fraction done, exactly 1 when it is there.
    pub(super) fn prepare(&mut self, mesh: &Mesh, work: f64) -> f32 {
        self.levels.step(mesh, &self.sequence, (work.clamp(1.0, 1e9) * ENTRIES_PER_UNIT) as usize)
    }

    /// The levels for targets as [`Model::select_level`] takes them.
    pub(super) fn targets(&self, triangles: Option<f64>, error: Option<f64>) -> (Option<Level>, Option<Level>) {
        let by_count = triangles.map(|t| Level::Triangles(t.max(0.0) as usize));
        let by_error = error.map(|e| match e.max(0.0) as f32 {
            // The run's own limit: rounding must not leave out what it allowed.
            limit if limit >= self.max_error => Level::Triangles(0),
            limit => Level::Error(limit),
        });
        (by_count, by_error)
    }

    /// Collapses to the first of the targets, none without one.
    pub(super) fn collapse_count(&self, (by_count, by_error): (Option<Level>, Option<Level>)) -> usize {
        let counts = by_count.into_iter().chain(by_error).map(|level| lod::collapse_count(&self.sequence, level));
        counts.min().unwrap_or(0)
    }
}

fn not_simplifying() -> JsValue {
    thrown(Error::new(ErrorCode::WrongState, "simplify", "no simplification is running"))
}
