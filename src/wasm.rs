//! The boundary to JavaScript: the only file that names `wasm_bindgen`.
//!
//! Bytes and typed arrays come in, owned copies go out. Options and summaries cross as JSON text,
//! because a wrong field is then a typed error and not an undefined. Errors are thrown as plain
//! objects `{ code, message, where }`.

#![allow(unreachable_pub, reason = "wasm_bindgen exports what is pub in this private module")]

use serde::{Deserialize, Serialize};
use wasm_bindgen::prelude::*;

use crate::collapse_sequence::CollapseSequence;
use crate::deviation::{Deviation, DeviationMeter, DeviationOptions, SideDeviation};
use crate::document::{Document, Format, NamedFile};
use crate::error::{Error, ErrorCode, Warning};
use crate::lod::{self, Level, LevelMesh, Levels};
use crate::mesh::{Attribute, Blend, Mesh};
use crate::simplify::{AttributeWeights, PlacementRule, Preset, Simplifier, SimplifyOptions};

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
    serde_json::Value::from(crate::document::external_files(bytes)).to_string()
}

fn thrown(error: Error) -> JsValue {
    let object = serde_json::json!({
        "code": error.code().as_str(),
        "message": error.message(),
        "where": error.place(),
    });
    js_sys::JSON::parse(&object.to_string()).unwrap_or(JsValue::UNDEFINED)
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
        Ok(SimplifyOptions {
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
}

#[derive(Serialize)]
struct SideSummary {
    max: f64,
    mean: f64,
    rms: f64,
    samples: u64,
}

impl From<Deviation> for DeviationSummary {
    fn from(deviation: Deviation) -> Self {
        let side = |SideDeviation { max, mean, rms, samples }| SideSummary { max, mean, rms, samples };
        Self {
            max: deviation.max,
            mean: deviation.mean,
            rms: deviation.rms,
            relative_to: deviation.diagonal,
            original_to_simplified: side(deviation.original_to_simplified),
            simplified_to_original: side(deviation.simplified_to_original),
        }
    }
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
    simplifier: Simplifier,
    /// As in [`SimplifyOptions`].
    max_error: f32,
    /// Whether the former record stays beside the result.
    keep_levels: bool,
}

/// What a simplification gave.
struct Recorded {
    sequence: CollapseSequence,
    /// The index of the sequence, made when a level other than the last is asked for.
    levels: Option<Levels>,
    /// The limit that every collapse kept to.
    max_error: f32,
}

/// A loaded model, its simplification and the selected level.
#[wasm_bindgen]
pub struct Model {
    source: Source,
    running: Option<Run>,
    record: Option<Recorded>,
    /// The result of a run that kept the record, until a level of it is selected.
    result: Option<Recorded>,
    level: Option<LevelMesh>,
    measuring: Option<DeviationMeter>,
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

    /// Starts a simplification; an earlier sequence stays until this one is done.
    #[wasm_bindgen(js_name = beginSimplify)]
    pub fn begin_simplify(&mut self, options: &str) -> Result<(), JsValue> {
        let request: SimplifyRequest = parse(options, "options")?;
        let options = request.options(self.mesh()).map_err(thrown)?;
        let simplifier = Simplifier::new(self.mesh(), &options).map_err(thrown)?;
        self.running = Some(Run { simplifier, max_error: options.max_error, keep_levels: request.keep_levels });
        Ok(())
    }

    /// Does about `work` units and returns the fraction done, exactly 1 when the result is ready.
    pub fn step(&mut self, work: f64) -> Result<f32, JsValue> {
        let Self { source, running, .. } = self;
        let run = running.as_mut().ok_or_else(not_simplifying)?;
        let progress = run.simplifier.step(source.mesh(), work.clamp(1.0, 1e9) as usize);
        if !progress.done {
            return Ok(progress.fraction.min(0.999));
        }
        self.finish();
        Ok(1.0)
    }

    /// Ends a running simplification for want of time; what was done so far is the result.
    #[wasm_bindgen(js_name = stopSimplify)]
    pub fn stop_simplify(&mut self) -> Result<(), JsValue> {
        let Self { source, running, .. } = self;
        running.as_mut().ok_or_else(not_simplifying)?.simplifier.stop(source.mesh());
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

    /// Selects the level of the record of at most `triangles`, or of at most `error` (world units), or both, or
    /// full detail if neither is given. Returns a JSON summary of it.
    #[wasm_bindgen(js_name = selectLevel)]
    pub fn select_level(&mut self, triangles: Option<f64>, error: Option<f64>) -> Result<String, JsValue> {
        // The old level's memory is free for the new one.
        self.level = None;
        let Self { source, record, .. } = self;
        let record = record.as_mut().ok_or_else(not_simplified)?;
        let (level, summary) = extract_level(source.mesh(), record, triangles, error);
        self.level = Some(level);
        to_json(&summary)
    }

    /// As [`Model::select_level`], of what the last run gave, also if it kept the former record; once.
    #[wasm_bindgen(js_name = selectResult)]
    pub fn select_result(&mut self, triangles: Option<f64>, error: Option<f64>) -> Result<String, JsValue> {
        let Some(mut result) = self.result.take() else {
            return self.select_level(triangles, error);
        };
        let (level, summary) = extract_level(self.mesh(), &mut result, triangles, error);
        self.level = Some(level);
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

    /// Prepares a measurement of the selected level against the original, with so many samples on
    /// each side's faces, in place of one that is running. Later changes of the level do not touch it.
    #[wasm_bindgen(js_name = beginMeasure)]
    pub fn begin_measure(&mut self, samples: Option<f64>) -> Result<(), JsValue> {
        let mut options = DeviationOptions::default();
        if let Some(samples) = samples {
            if !(1.0..=MOST_SAMPLES).contains(&samples) {
                return Err(thrown(Error::new(ErrorCode::InvalidArgument, "samples", "must be from 1 to 1e9")));
            }
            options.sample_count = samples as usize;
        }
        self.measuring = Some(DeviationMeter::new(self.mesh(), self.level_mesh(), &options).map_err(thrown)?);
        Ok(())
    }

    /// Advances the measurement by about `work` samples. Returns the fraction done, 0 to 1; at 1
    /// [`Model::take_deviation`] has the result.
    #[wasm_bindgen(js_name = stepMeasure)]
    pub fn step_measure(&mut self, work: f64) -> Result<f32, JsValue> {
        let meter = self.measuring.as_mut().ok_or_else(not_measuring)?;
        Ok(meter.step(work.clamp(1.0, 1e9) as usize).fraction)
    }

    /// The measurement's result as JSON, and the end of it.
    #[wasm_bindgen(js_name = takeDeviation)]
    pub fn take_deviation(&mut self) -> Result<String, JsValue> {
        let meter = self.measuring.take().ok_or_else(not_measuring)?;
        to_json(&DeviationSummary::from(meter.finish()))
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
        Self { source, running: None, record: None, result: None, level: None, measuring: None }
    }

    fn mesh(&self) -> &Mesh {
        self.source.mesh()
    }

    /// Takes over the result of the run that is done.
    fn finish(&mut self) {
        let Some(Run { simplifier, max_error, keep_levels }) = self.running.take() else { return };
        let recorded = Recorded { sequence: simplifier.finish(), levels: None, max_error };
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

/// The level of `record` for targets as [`Model::select_level`] takes them.
fn extract_level<'a>(
    mesh: &Mesh,
    Recorded { sequence, levels, max_error }: &'a mut Recorded,
    triangles: Option<f64>,
    error: Option<f64>,
) -> (LevelMesh, LevelSummary<'a>) {
    let by_count = triangles.map(|t| Level::Triangles(t.max(0.0) as usize));
    let by_error = error.map(|e| match e.max(0.0) as f32 {
        // The run's own limit: rounding must not leave out what it allowed.
        limit if limit >= *max_error => Level::Triangles(0),
        limit => Level::Error(limit),
    });
    let level = match (by_count, by_error) {
        (None, None) => Level::Full,
        (Some(level), None) | (None, Some(level)) => level,
        (Some(a), Some(b)) if lod::collapse_count(sequence, a) <= lod::collapse_count(sequence, b) => a,
        (Some(_), Some(b)) => b,
    };
    // The last level is what a run to a target is for, and often the only one that is wanted.
    let last = lod::collapse_count(sequence, level) == sequence.collapses.len();
    let extracted = match levels {
        None if last => lod::extract(mesh, sequence, level),
        levels => levels.get_or_insert_with(|| Levels::new(mesh, sequence)).extract(mesh, sequence, level),
    };
    let reached = match by_count {
        Some(Level::Triangles(n)) => extracted.mesh.triangles.len() <= n,
        _ => by_error.is_none(),
    };
    let held_by_error = by_error.is_some_and(|e| lod::collapse_count(sequence, e) < sequence.collapses.len());
    let stop_reason = match (reached, held_by_error) {
        (true, _) => "target",
        (false, true) => "error",
        (false, false) => sequence.stop_reason.as_str(),
    };
    let summary = LevelSummary {
        triangles: extracted.mesh.triangles.len(),
        vertices: extracted.mesh.positions.len(),
        estimated_error: extracted.error,
        stop_reason,
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
