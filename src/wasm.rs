//! The boundary to JavaScript: the only module that names `wasm_bindgen`.
//!
//! Bytes and typed arrays come in, owned copies go out. Options and summaries cross as JSON text,
//! because a wrong field is then a typed error and not an undefined. Errors are thrown as plain
//! objects `{ code, message, where }`.

#![allow(unreachable_pub, reason = "wasm_bindgen exports what is pub in this private module")]

mod levels;
mod measuring;
mod requests;
mod run;
mod summaries;

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use wasm_bindgen::prelude::*;

use crate::document::{Document, Format, NamedFile};
use crate::error::{Error, ErrorCode};
use crate::lod::LevelMesh;
use crate::mesh::{Attribute, Blend, Mesh};
use measuring::Measuring;
use requests::AttributeRequest;
use run::{Recorded, Run};
use summaries::{AttributeSummary, GroupSummary, Summary, WarningSummary, WedgeSetSummary};

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

    fn level_mesh(&self) -> &Mesh {
        self.level.as_ref().map_or(self.mesh(), |level| &level.mesh)
    }
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
