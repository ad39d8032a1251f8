//! The boundary to JavaScript: the only file that names `wasm_bindgen`.
//!
//! Bytes and typed arrays come in, owned copies go out. Options and summaries cross as JSON text,
//! because a wrong field is then a typed error and not an undefined. Errors are thrown as plain
//! objects `{ code, message, where }`.

#![allow(unreachable_pub, reason = "wasm_bindgen exports what is pub in this private module")]

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use wasm_bindgen::prelude::*;

use crate::collapse_sequence::{Blockers, CollapseSequence};
use crate::deviation::{AttributeDeviation, Deviation, DeviationMeter, DeviationOptions, SideDeviation};
use crate::document::{Document, Format, NamedFile};
use crate::error::{Error, ErrorCode, Warning};
use crate::lod::{self, Level, LevelMesh, Levels};
use crate::mesh::{Attribute, Blend, Mesh};
use crate::simplify::{AttributeWeights, POSE, PlacementRule, Preset, Simplifier, SimplifyOptions};

#[wasm_bindgen]
extern "C" {
    /// Set by the package before the first call; keeps the message for the typed error.
    #[wasm_bindgen(js_namespace = globalThis, js_name = __decimeshPanic)]
    fn report_panic(message: &str);
}

/// Sends the message of a panic to JavaScript before the instance traps.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|info| report_panic(&info.to_string())));
}

/// The version of this crate.
#[wasm_bindgen]
#[must_use]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// JSON array of what a model or a material library names beside itself; empty if it does not parse
/// (opening it will say why).
#[wasm_bindgen(js_name = externalFiles)]
#[must_use]
pub fn external_files(bytes: &[u8]) -> String {
    serde_json::to_string(&crate::document::external_files(bytes)).unwrap_or_default()
}

fn thrown(error: Error) -> JsValue {
    #[derive(Serialize)]
    struct Thrown<'a> {
        code: &'a str,
        message: &'a str,
        r#where: &'a str,
    }
    let object = Thrown { code: error.code().as_str(), message: error.message(), r#where: error.place() };
    js_sys::JSON::parse(&serde_json::to_string(&object).unwrap_or_default()).unwrap_or(JsValue::UNDEFINED)
}

fn parse<'a, T: Deserialize<'a>>(json: &'a str, place: &str) -> Result<T, JsValue> {
    serde_json::from_slice(json.as_bytes())
        .map_err(|e| thrown(Error::new(ErrorCode::InvalidArgument, place, e.to_string())))
}

fn to_json(value: &impl Serialize) -> Result<String, JsValue> {
    serde_json::to_string(value).map_err(|e| thrown(Error::new(ErrorCode::WrongState, "", e.to_string())))
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct AttributeRequest {
    name: String,
    components: usize,
    blend: String,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct WeightRequest {
    normal: Option<f32>,
    uv: Option<f32>,
    color: Option<f32>,
    morph: Option<f32>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
struct SimplifyRequest {
    triangles: Option<f64>,
    ratio: Option<f64>,
    error: Option<f64>,
    error_relative: Option<f64>,
    lock_border: bool,
    prune: bool,
    attribute_weights: WeightRequest,
    placement: Option<String>,
    preset: Option<String>,
    every_level: bool,
    keep_levels: bool,
    index_levels: bool,
    /// Name of an attribute, as [`Mesh::channel`] takes it.
    weight_attribute: Option<String>,
    weight_scale: Option<f32>,
    /// World units.
    merge_distance: f32,
    /// Bytes.
    memory_limit: Option<f64>,
}

impl WeightRequest {
    fn weights(&self) -> AttributeWeights {
        let automatic = AttributeWeights::default();
        AttributeWeights {
            normal: self.normal.unwrap_or(automatic.normal),
            texture: self.uv.unwrap_or(automatic.texture),
            color: self.color.unwrap_or(automatic.color),
            morph: self.morph.unwrap_or(automatic.morph),
        }
    }
}

impl SimplifyRequest {
    fn options(&self, mesh: &Mesh) -> Result<SimplifyOptions, Error> {
        let invalid = |place: &str, message: &str| Err(Error::new(ErrorCode::InvalidArgument, place, message));
        let mut targets: Vec<f64> = Vec::new();
        if let Some(triangles) = self.triangles {
            if !(triangles >= 0.0 && triangles.is_finite()) {
                return invalid("triangles", "must be a number of at least 0");
            }
            targets.push(triangles.floor());
        }
        if let Some(ratio) = self.ratio {
            if !(0.0..=1.0).contains(&ratio) {
                return invalid("ratio", "must be between 0 and 1");
            }
            targets.push((ratio * mesh.triangles.len() as f64).floor());
        }
        let mut max_error = f64::INFINITY;
        for (place, error, unit) in
            [("error", self.error, 1.0), ("errorRelative", self.error_relative, mesh.diagonal())]
        {
            if let Some(error) = error {
                if error.is_nan() || error < 0.0 {
                    return invalid(place, "must be a number of at least 0");
                }
                max_error = max_error.min(error * unit);
            }
        }
        // Of several targets the first that is reached stops the run: the largest count.
        let target = targets.into_iter().fold(0.0, f64::max);
        let placement = match self.placement.as_deref() {
            None | Some("optimal") => PlacementRule::Optimal,
            Some("subset") => PlacementRule::Subset,
            Some(_) => return invalid("placement", "must be 'optimal' or 'subset'"),
        };
        let preset = match self.preset.as_deref() {
            Some("fast") => Preset::Fast,
            None | Some("balanced") => Preset::Balanced,
            Some("best") => Preset::Best,
            Some(_) => return invalid("preset", "must be 'fast', 'balanced' or 'best'"),
        };
        let mut weights = match &self.weight_attribute {
            Some(name) => mesh.channel(name)?,
            None => Vec::new(),
        };
        let scale = self.weight_scale.unwrap_or(1.0);
        if !(scale.is_finite() && scale >= 0.0) {
            return invalid("weightScale", "must be a finite number of at least 0");
        }
        weights.iter_mut().for_each(|weight| *weight *= scale);
        // What the model itself takes is there already. A sixteenth is left for results and what no count explains.
        let most = (u64::from(u32::MAX) / 16 * 15).saturating_sub(mesh.byte_count());
        Ok(SimplifyOptions {
            merge_distance: self.merge_distance,
            memory_limit: self.memory_limit.map_or(most, |limit| most.min(limit as u64)),
            weights,
            locked: Vec::new(),
            target_triangle_count: target as usize,
            max_error: max_error as f32,
            lock_border: self.lock_border,
            prune: self.prune,
            attribute_weights: self.attribute_weights.weights(),
            placement,
            preset,
            every_level: self.every_level,
        })
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Summary<'a> {
    format: &'a str,
    bytes: usize,
    triangles: usize,
    vertices: usize,
    meshes: usize,
    diagonal: f64,
    groups: Vec<GroupSummary<'a>>,
    wedge_sets: Vec<WedgeSetSummary<'a>>,
    warnings: Vec<WarningSummary<'a>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct GroupSummary<'a> {
    mesh: usize,
    primitive: usize,
    object: Option<&'a str>,
    material: Option<&'a str>,
    wedge_set: usize,
}

#[derive(Serialize)]
struct WedgeSetSummary<'a> {
    vertices: usize,
    attributes: Vec<AttributeSummary<'a>>,
}

#[derive(Serialize)]
struct AttributeSummary<'a> {
    name: &'a str,
    components: usize,
}

#[derive(Serialize)]
struct WarningSummary<'a> {
    code: &'a str,
    message: &'a str,
    #[serde(rename = "where")]
    place: &'a str,
}

impl<'a> From<&'a Warning> for WarningSummary<'a> {
    fn from(warning: &'a Warning) -> Self {
        Self { code: warning.code, message: &warning.message, place: &warning.place }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct LevelSummary<'a> {
    triangles: usize,
    vertices: usize,
    estimated_error: f32,
    stop_reason: &'a str,
    /// What blocks the edges that are left; only at the end of a run that did not reach its target.
    blockers: Option<BlockersSummary>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct BlockersSummary {
    seam: usize,
    corner: usize,
    border: usize,
    non_manifold: usize,
    locked: usize,
    topology: usize,
    flip: usize,
    error: usize,
    other: usize,
}

impl From<Blockers> for BlockersSummary {
    fn from(blockers: Blockers) -> Self {
        let Blockers { seam, corner, border, non_manifold, locked, topology, flip, error, other } = blockers;
        Self { seam, corner, border, non_manifold, locked, topology, flip, error, other }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct DeviationSummary {
    max: f64,
    mean: f64,
    rms: f64,
    relative_to: f64,
    original_to_simplified: SideSummary,
    simplified_to_original: SideSummary,
    #[serde(skip_serializing_if = "AttributesSummary::is_empty")]
    attributes: AttributesSummary,
    /// With a map: how many values each wedge set of the level has in it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    map_lengths: Vec<usize>,
}

/// Of the attributes that there are.
#[derive(Serialize)]
struct AttributesSummary {
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<SpreadSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    uv: Option<SpreadSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    color: Option<SpreadSummary>,
}

impl AttributesSummary {
    fn is_empty(&self) -> bool {
        self.normal.is_none() && self.uv.is_none() && self.color.is_none()
    }
}

#[derive(Serialize)]
struct SpreadSummary {
    max: f64,
    mean: f64,
    rms: f64,
}

#[derive(Serialize)]
struct SideSummary {
    max: f64,
    mean: f64,
    rms: f64,
    samples: u64,
}

impl From<&Deviation> for DeviationSummary {
    fn from(deviation: &Deviation) -> Self {
        let side = |SideDeviation { max, mean, rms, samples }| SideSummary { max, mean, rms, samples };
        let spread = |AttributeDeviation { max, mean, rms }| SpreadSummary { max, mean, rms };
        Self {
            max: deviation.max,
            mean: deviation.mean,
            rms: deviation.rms,
            relative_to: deviation.diagonal,
            original_to_simplified: side(deviation.original_to_simplified),
            simplified_to_original: side(deviation.simplified_to_original),
            attributes: AttributesSummary {
                normal: deviation.attributes.normal.map(spread),
                uv: deviation.attributes.texture.map(spread),
                color: deviation.attributes.color.map(spread),
            },
            map_lengths: Vec::new(),
        }
    }
}

/// A measurement under way.
struct Measuring {
    meter: DeviationMeter,
    /// As in [`DeviationSummary`].
    map_lengths: Vec<usize>,
}

/// Where the mesh came from.
enum Source {
    File(Document),
    Arrays(Mesh),
}

impl Source {
    fn mesh(&self) -> &Mesh {
        match self {
            Self::File(document) => document.mesh(),
            Self::Arrays(mesh) => mesh,
        }
    }
}

/// A simplification under way.
struct Run {
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
struct Recorded {
    sequence: CollapseSequence,
    /// The index of the sequence, made when a level between the first and the last is asked for, or before.
    levels: Levels,
    /// Full detail is the mesh itself.
    is_whole: bool,
    /// The limit that every collapse kept to.
    max_error: f32,
}

/// A loaded model, its simplification and the selected level.
#[wasm_bindgen]
pub struct Model {
    source: Source,
    /// For the next run: a number for each wedge, or nothing.
    weights: Vec<f32>,
    locked: Vec<u8>,
    /// Where a skin moves the vertices of a wedge set.
    poses: Vec<(usize, Attribute)>,
    running: Option<Run>,
    record: Option<Recorded>,
    /// The result of a run that kept the record, until a level of it is selected.
    result: Option<Recorded>,
    level: Option<Arc<LevelMesh>>,
    aside: Option<Arc<LevelMesh>>,
    measuring: Option<Measuring>,
    /// Of the measurement that was taken last: the distances at all vertices, then those around them.
    map: Vec<f32>,
}

#[wasm_bindgen]
impl Model {
    /// Reads the first model among the files.
    pub fn open(names: Vec<String>, contents: Vec<js_sys::Uint8Array>) -> Result<Model, JsValue> {
        let files = names
            .into_iter()
            .zip(contents)
            .map(|(name, content)| NamedFile { name, bytes: content.to_vec() })
            .collect();
        Ok(Self::new(Source::File(Document::open(files).map_err(thrown)?)))
    }

    /// A mesh from bare arrays: 3 numbers a position; `indices` absent means every 3 positions are
    /// a triangle; `attributes` is JSON `[{name, components, blend}]` with one array each.
    #[wasm_bindgen(js_name = fromArrays)]
    pub fn from_arrays(
        positions: Vec<f32>,
        indices: Option<Vec<u32>>,
        attributes: &str,
        values: Vec<js_sys::Float32Array>,
    ) -> Result<Model, JsValue> {
        let invalid = |place: &str, message: &str| thrown(Error::new(ErrorCode::InvalidArgument, place, message));
        let requests: Vec<AttributeRequest> = parse(attributes, "attributes")?;
        if requests.len() != values.len() {
            return Err(invalid("attributes", "one array each"));
        }
        let (points, rest) = positions.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(invalid("positions", "length must be a multiple of 3"));
        }
        let indices = indices.unwrap_or_else(|| (0..points.len() as u32 / 3 * 3).collect());
        let (triangles, rest) = indices.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(invalid("indices", "length must be a multiple of 3"));
        }
        let mut list = Vec::with_capacity(requests.len());
        for (request, values) in requests.into_iter().zip(values) {
            let blend = match request.blend.as_str() {
                "linear" => Blend::Linear,
                "direction" => Blend::Direction,
                "tangent" => Blend::Tangent,
                "nearest" => Blend::Nearest,
                "joints" => Blend::Joints,
                "weights" => Blend::Weights,
                _ => return Err(invalid("attributes", "unknown blend")),
            };
            let values = values.to_vec();
            if request.components == 0 || values.len() != points.len() * request.components {
                return Err(invalid(&request.name, "length must be the vertex count times the components"));
            }
            list.push(Attribute { name: request.name, components: request.components, values, blend });
        }
        let mesh = Mesh::from_arrays(points.to_vec(), triangles.to_vec(), list);
        mesh.validate().map_err(thrown)?;
        Ok(Self::new(Source::Arrays(mesh)))
    }

    /// JSON: format, counts, groups, wedge sets and warnings.
    pub fn summary(&self) -> Result<String, JsValue> {
        let mesh = self.mesh();
        let wedge_sets = mesh
            .wedge_sets
            .iter()
            .map(|set| WedgeSetSummary {
                vertices: set.wedges.len(),
                attributes: set
                    .attributes
                    .iter()
                    .map(|a| AttributeSummary { name: &a.name, components: a.components })
                    .collect(),
            })
            .collect();
        let mut summary = Summary {
            format: "arrays",
            bytes: 0,
            triangles: mesh.triangles.len(),
            vertices: mesh.positions.len(),
            meshes: mesh.parts.len(),
            diagonal: mesh.diagonal(),
            groups: Vec::new(),
            wedge_sets,
            warnings: Vec::new(),
        };
        if let Source::File(document) = &self.source {
            summary.format = document.format().as_str();
            summary.bytes = document.byte_count();
            summary.warnings = document.warnings().iter().map(WarningSummary::from).collect();
            summary.groups = document
                .layout()
                .groups
                .iter()
                .zip(&mesh.groups)
                .map(|(label, group)| GroupSummary {
                    mesh: label.mesh,
                    primitive: label.primitive,
                    object: label.object.as_deref(),
                    material: label.material.as_deref(),
                    wedge_set: group.wedge_set,
                })
                .collect();
        }
        to_json(&summary)
    }

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
        let stays = |c: &crate::collapse_sequence::Collapse| c.position == mesh.positions[c.into as usize];
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

    /// Prepares a measurement of the selected level against the original, with so many samples on
    /// each side's faces and, if wanted, a map, in place of one that is running. Later changes of the level do not
    /// touch it.
    #[wasm_bindgen(js_name = beginMeasure)]
    pub fn begin_measure(&mut self, samples: Option<f64>, map: bool) -> Result<(), JsValue> {
        let mut options = DeviationOptions { simplified_map: map, ..DeviationOptions::default() };
        if let Some(samples) = samples {
            if !(1.0..=MOST_SAMPLES).contains(&samples) {
                return Err(thrown(Error::new(ErrorCode::InvalidArgument, "samples", "must be from 1 to 1e9")));
            }
            options.sample_count = samples as usize;
        }
        let level = self.level_mesh();
        let meter = DeviationMeter::new(self.mesh(), level, &options).map_err(thrown)?;
        let sets = level.wedge_sets.iter().filter(|_| map);
        self.measuring = Some(Measuring { meter, map_lengths: sets.map(|set| set.wedges.len()).collect() });
        Ok(())
    }

    /// Advances the measurement by about `work` samples. Returns the fraction done, 0 to 1; at 1
    /// [`Model::take_deviation`] has the result.
    #[wasm_bindgen(js_name = stepMeasure)]
    pub fn step_measure(&mut self, work: f64) -> Result<f32, JsValue> {
        let measuring = self.measuring.as_mut().ok_or_else(not_measuring)?;
        Ok(measuring.meter.step(work.clamp(1.0, 1e9) as usize).fraction)
    }

    /// The measurement's result as JSON, and the end of it.
    #[wasm_bindgen(js_name = takeDeviation)]
    pub fn take_deviation(&mut self) -> Result<String, JsValue> {
        let Measuring { meter, map_lengths } = self.measuring.take().ok_or_else(not_measuring)?;
        let mut deviation = meter.finish();
        let summary = DeviationSummary { map_lengths, ..DeviationSummary::from(&deviation) };
        self.map = std::mem::take(&mut deviation.simplified_distances);
        self.map.append(&mut deviation.simplified_surroundings);
        to_json(&summary)
    }

    /// The map of the measurement taken last, once: for all vertices of the measured level the distance at each, then
    /// for all of them the largest around each.
    #[wasm_bindgen(js_name = takeMap)]
    pub fn take_map(&mut self) -> js_sys::Float32Array {
        std::mem::take(&mut self.map).as_slice().into()
    }

    /// Drops a running measurement.
    #[wasm_bindgen(js_name = cancelMeasure)]
    pub fn cancel_measure(&mut self) {
        self.measuring = None;
    }

    /// The file at the selected level.
    pub fn write(&self, format: &str) -> Result<Vec<u8>, JsValue> {
        let Source::File(document) = &self.source else {
            return Err(thrown(Error::new(ErrorCode::WrongState, "write", "arrays have no file")));
        };
        document.write(self.level_mesh(), output_format(format)?).map_err(thrown)
    }

    /// JSON array of warnings: what the file has and `format` cannot hold.
    pub fn losses(&self, format: &str) -> Result<String, JsValue> {
        let format = output_format(format)?;
        let losses = match &self.source {
            Source::File(document) => document.losses(format),
            Source::Arrays(_) => None,
        };
        to_json(&losses.iter().map(WarningSummary::from).collect::<Vec<_>>())
    }
}

impl Model {
    fn new(source: Source) -> Self {
        Self {
            source,
            weights: Vec::new(),
            locked: Vec::new(),
            poses: Vec::new(),
            running: None,
            record: None,
            result: None,
            level: None,
            aside: None,
            measuring: None,
            map: Vec::new(),
        }
    }

    fn mesh(&self) -> &Mesh {
        self.source.mesh()
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

    fn level_mesh(&self) -> &Mesh {
        self.level.as_ref().map_or(self.mesh(), |level| &level.mesh)
    }
}

/// Entries of the index's tables that take about as long as a unit of a simplification.
const ENTRIES_PER_UNIT: f64 = 50.0;

impl Run {
    /// The result of what was done so far, in the place of the simplifier.
    fn take_result(&mut self, mesh: &Mesh) {
        if let Some(simplifier) = self.simplifier.take() {
            self.recorded = Some(Recorded::new(mesh, simplifier, self.max_error));
        }
    }
}

/// Of a run that makes the index too, the share of the time before that.
const SIMPLIFYING_SHARE: f32 = 0.9;

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
    fn prepare(&mut self, mesh: &Mesh, work: f64) -> f32 {
        self.levels.step(mesh, &self.sequence, (work.clamp(1.0, 1e9) * ENTRIES_PER_UNIT) as usize)
    }

    /// The levels for targets as [`Model::select_level`] takes them.
    fn targets(&self, triangles: Option<f64>, error: Option<f64>) -> (Option<Level>, Option<Level>) {
        let by_count = triangles.map(|t| Level::Triangles(t.max(0.0) as usize));
        let by_error = error.map(|e| match e.max(0.0) as f32 {
            // The run's own limit: rounding must not leave out what it allowed.
            limit if limit >= self.max_error => Level::Triangles(0),
            limit => Level::Error(limit),
        });
        (by_count, by_error)
    }

    /// Collapses to the first of the targets, none without one.
    fn collapse_count(&self, (by_count, by_error): (Option<Level>, Option<Level>)) -> usize {
        let counts = by_count.into_iter().chain(by_error).map(|level| lod::collapse_count(&self.sequence, level));
        counts.min().unwrap_or(0)
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

/// More would take hours and change nothing.
const MOST_SAMPLES: f64 = 1e9;

fn not_simplifying() -> JsValue {
    thrown(Error::new(ErrorCode::WrongState, "simplify", "no simplification is running"))
}

fn not_simplified() -> JsValue {
    thrown(Error::new(ErrorCode::WrongState, "level", "simplify first"))
}

fn not_measuring() -> JsValue {
    thrown(Error::new(ErrorCode::WrongState, "measure", "begin first"))
}

fn output_format(name: &str) -> Result<Format, JsValue> {
    Format::output(name).ok_or_else(|| {
        let known: Vec<&str> = Format::OUTPUT.iter().map(|format| format.as_str()).collect();
        thrown(Error::new(ErrorCode::InvalidArgument, "format", format!("must be one of {}", known.join(", "))))
    })
}

fn missing(argument: &str) -> JsValue {
    thrown(Error::new(ErrorCode::OutOfRange, argument, "no such index"))
}
