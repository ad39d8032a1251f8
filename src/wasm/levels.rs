//! The levels of a record: which one is selected, its arrays, and the record itself.

use std::sync::Arc;

use wasm_bindgen::prelude::*;

use super::run::Recorded;
use super::summaries::LevelSummary;
use super::{Model, missing, thrown, to_json};
use crate::collapse_sequence::{Collapse, CollapseSequence};
use crate::error::{Error, ErrorCode};
use crate::lod::{self, Level, LevelMesh};
use crate::mesh::Mesh;

#[wasm_bindgen]
impl Model {
    /// Whether levels can be selected.
    #[wasm_bindgen(js_name = hasSequence)]
    #[must_use]
    pub fn has_sequence(&self) -> bool {
        self.record.is_some()
    }

    /// Whether [`Model::select_level`] for these takes no longer than the level does; if not, it makes the index of all
    /// levels at once, and [`Model::prepare_levels`] does so in steps.
    #[wasm_bindgen(js_name = levelAtHand)]
    pub fn level_at_hand(&self, triangles: Option<f64>, error: Option<f64>) -> Result<bool, JsValue> {
        let record = self.record.as_ref().ok_or_else(not_simplified)?;
        let count = record.collapse_count(record.targets(triangles, error));
        Ok(record.levels.is_done() || count == 0 || count == record.sequence.collapses.len())
    }

    /// Does about `work` units of the index of all levels and returns the fraction done, exactly 1 when it is there.
    #[wasm_bindgen(js_name = prepareLevels)]
    pub fn prepare_levels(&mut self, work: f64) -> Result<f32, JsValue> {
        let Self { source, record, .. } = self;
        Ok(record.as_mut().ok_or_else(not_simplified)?.prepare(source.mesh(), work))
    }

    /// Selects the level of the record of at most `triangles`, or of at most `error` (world units), or both, or
    /// full detail if neither is given. Returns a JSON summary of it.
    #[wasm_bindgen(js_name = selectLevel)]
    pub fn select_level(&mut self, triangles: Option<f64>, error: Option<f64>) -> Result<String, JsValue> {
        // The old level's memory is free for the new one.
        self.level = None;
        let Self { source, record, .. } = self;
        let record = record.as_mut().ok_or_else(not_simplified)?;
        let (level, summary) = extract_level(source.mesh(), record, triangles, error);
        self.level = level;
        to_json(&summary)
    }

    /// As [`Model::select_level`], of what the last run gave, also if it kept the former record; once.
    #[wasm_bindgen(js_name = selectResult)]
    pub fn select_result(&mut self, triangles: Option<f64>, error: Option<f64>) -> Result<String, JsValue> {
        let Some(mut result) = self.result.take() else {
            return self.select_level(triangles, error);
        };
        let (level, summary) = extract_level(self.mesh(), &mut result, triangles, error);
        self.level = level;
        to_json(&summary)
    }

    /// Puts the selected level aside: until [`Model::bring_back`] the arrays are those of the original.
    #[wasm_bindgen(js_name = putAside)]
    pub fn put_aside(&mut self) {
        self.aside = self.level.take();
    }

    /// Selects again what was put aside.
    #[wasm_bindgen(js_name = bringBack)]
    pub fn bring_back(&mut self) {
        self.level = self.aside.take();
    }

    /// Triangles of a group of the selected level, as indices in its wedge set.
    #[wasm_bindgen(js_name = levelIndices)]
    pub fn level_indices(&self, group: usize) -> Result<js_sys::Uint32Array, JsValue> {
        let mesh = self.level_mesh();
        let group = mesh.groups.get(group).ok_or_else(|| missing("group"))?;
        let start = mesh.wedge_sets[group.wedge_set].wedges.start as u32;
        let indices = mesh.triangles[group.triangles.clone()].as_flattened();
        if start == 0 {
            return Ok(indices.into());
        }
        let indices: Vec<u32> = indices.iter().map(|&w| w - start).collect();
        Ok(indices.as_slice().into())
    }

    /// Positions of a wedge set of the selected level.
    #[wasm_bindgen(js_name = levelPositions)]
    pub fn level_positions(&self, wedge_set: usize) -> Result<js_sys::Float32Array, JsValue> {
        let mesh = self.level_mesh();
        let set = mesh.wedge_sets.get(wedge_set).ok_or_else(|| missing("wedgeSet"))?;
        Ok(mesh.positions[set.wedges.clone()].as_flattened().into())
    }

    /// Values of an attribute of a wedge set of the selected level.
    #[wasm_bindgen(js_name = levelAttribute)]
    pub fn level_attribute(&self, wedge_set: usize, attribute: usize) -> Result<js_sys::Float32Array, JsValue> {
        let set = self.level_mesh().wedge_sets.get(wedge_set).ok_or_else(|| missing("wedgeSet"))?;
        Ok(set.attributes.get(attribute).ok_or_else(|| missing("attribute"))?.values.as_slice().into())
    }

    /// For each wedge of the selected level, the vertex of the original that it came from.
    #[wasm_bindgen(js_name = levelWedgeMap)]
    #[must_use]
    pub fn level_wedge_map(&self) -> js_sys::Uint32Array {
        match &self.level {
            Some(level) => level.wedge_map.as_slice().into(),
            None => (0..self.mesh().positions.len() as u32).collect::<Vec<_>>().as_slice().into(),
        }
    }

    /// The record for a progressive mesh, in words: how many wedges, duplicates and collapses; the vertex of each wedge;
    /// the duplicates' pairs; for each collapse the vertices `from` and `into`, the bits of its error, how many wedges
    /// merge, and their pairs.
    pub fn history(&self) -> Result<js_sys::Uint32Array, JsValue> {
        let CollapseSequence { collapses, vertex_of_wedge, duplicates, fitted, solved, .. } =
            &self.record.as_ref().ok_or_else(not_simplified)?.sequence;
        let mesh = self.mesh();
        let stays = |c: &Collapse| c.position == mesh.positions[c.into as usize];
        if !(fitted.is_empty() && solved.values.is_empty() && collapses.iter().all(stays)) {
            let message = "needs a record of every level made with placement 'subset'";
            return Err(thrown(Error::new(ErrorCode::WrongState, "history", message)));
        }
        let mut words = vec![vertex_of_wedge.len() as u32, duplicates.len() as u32, collapses.len() as u32];
        words.extend(vertex_of_wedge);
        words.extend(duplicates.iter().flat_map(|&(from, into)| [from, into]));
        let sequence = self.record.as_ref().map(|record| &record.sequence);
        for (collapse, merges) in collapses.iter().zip(sequence.into_iter().flat_map(|s| s.merges_from(0))) {
            words.extend([collapse.from, collapse.into, collapse.error.to_bits(), 0]);
            let count = words.len() - 1;
            merges.for_each(|(from, into)| words.extend([from, into]));
            words[count] = (words.len() - 1 - count) as u32 / 2;
        }
        Ok(words.as_slice().into())
    }
}

/// The level of `record` for targets as [`Model::select_level`] takes them; nothing for the mesh itself.
fn extract_level<'a>(
    mesh: &Mesh,
    record: &'a mut Recorded,
    triangles: Option<f64>,
    error: Option<f64>,
) -> (Option<Arc<LevelMesh>>, LevelSummary<'a>) {
    let targets = record.targets(triangles, error);
    let count = record.collapse_count(targets);
    let (by_count, by_error) = targets;
    let Recorded { sequence, levels, is_whole, .. } = record;
    let all = sequence.collapses.len();
    let level = match targets {
        (Some(level), None) | (None, Some(level)) => level,
        (Some(level), Some(_)) if lod::collapse_count(sequence, level) == count => level,
        (Some(_), Some(level)) => level,
        (None, None) => Level::Full,
    };
    let extracted = if count == 0 && *is_whole {
        None
    } else if count == all && !levels.is_done() {
        // The last level is what a run to a target is for, and often the only one that is wanted.
        Some(Arc::new(lod::extract(mesh, sequence, level)))
    } else {
        levels.step(mesh, sequence, usize::MAX);
        Some(levels.extract(mesh, sequence, level))
    };
    let (level, estimated_error) = extracted.as_ref().map_or((mesh, 0.0), |level| (&level.mesh, level.error));
    let reached = match by_count {
        Some(Level::Triangles(n)) => level.triangles.len() <= n,
        _ => by_error.is_none(),
    };
    let held_by_error = by_error.is_some_and(|e| lod::collapse_count(sequence, e) < all);
    let stop_reason = match (reached, held_by_error) {
        (true, _) => "target",
        (false, true) => "error",
        (false, false) => sequence.stop_reason.as_str(),
    };
    let stuck = count == all && stop_reason != "target" && sequence.blockers.total() > 0;
    let summary = LevelSummary {
        triangles: level.triangles.len(),
        vertices: level.positions.len(),
        estimated_error,
        stop_reason,
        blockers: stuck.then(|| sequence.blockers.into()),
    };
    (extracted, summary)
}

fn not_simplified() -> JsValue {
    thrown(Error::new(ErrorCode::WrongState, "level", "simplify first"))
}
