//! glTF, both directions; here, what the tests share: files assembled from typed fields.
#![cfg(not(target_arch = "wasm32"))]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "helpers of tests may stop at the first surprise, too"
)]

#[path = "gltf/forms.rs"]
mod forms;
#[path = "gltf/malformed.rs"]
mod malformed;
#[path = "gltf/reading.rs"]
mod reading;
#[path = "gltf/round_trip.rs"]
mod round_trip;
#[path = "gltf/sparse_targets.rs"]
mod sparse_targets;
#[path = "gltf/whole_files.rs"]
mod whole_files;
#[path = "gltf/without_triangles.rs"]
mod without_triangles;
#[path = "gltf/writing.rs"]
mod writing;

use std::fs;
use std::path::{Path, PathBuf};

use decimesh::ErrorCode;
use decimesh::document::{Document, NamedFile, external_files};
use serde_json::{Value, json};

/// A GLB assembled from its fields; `None` takes the true value.
struct Glb {
    magic: [u8; 4],
    version: u32,
    length: Option<u32>,
    json: Vec<u8>,
    json_length: Option<u32>,
    binary: Vec<u8>,
    binary_length: Option<u32>,
}

impl Glb {
    fn new(json: &Value, binary: Vec<u8>) -> Self {
        let mut json = json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        Self { magic: *b"glTF", version: 2, length: None, json, json_length: None, binary, binary_length: None }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let total = (12 + 8 + self.json.len() + 8 + self.binary.len()) as u32;
        out.extend(self.magic);
        out.extend(self.version.to_le_bytes());
        out.extend(self.length.unwrap_or(total).to_le_bytes());
        out.extend(self.json_length.unwrap_or(self.json.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(&self.json);
        out.extend(self.binary_length.unwrap_or(self.binary.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(&self.binary);
        out
    }
}

/// A unit square of two triangles: positions at byte 0, indices at byte 48.
fn square() -> (Value, Vec<u8>) {
    let mut binary = Vec::new();
    let corners: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
    corners.iter().flatten().for_each(|c| binary.extend(c.to_le_bytes()));
    [0u16, 1, 2, 0, 2, 3].iter().for_each(|i| binary.extend(i.to_le_bytes()));
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "name": "Square", "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 12 }
        ],
        "buffers": [{ "byteLength": binary.len() }]
    });
    (json, binary)
}

fn named(name: &str, bytes: Vec<u8>) -> NamedFile {
    NamedFile { name: name.into(), bytes }
}

fn open_glb(json: &Value, binary: Vec<u8>) -> Result<Document, decimesh::Error> {
    Document::open(vec![named("m.glb", Glb::new(json, binary).bytes())])
}

#[track_caller]
fn assert_fails(bytes: Vec<u8>, code: ErrorCode, place: &str) {
    let error = Document::open(vec![named("m.glb", bytes)]).expect_err("must be refused");
    assert_eq!((error.code(), error.place()), (code, place), "{error}");
}

/// The square with one value of its JSON replaced.
#[track_caller]
fn assert_square_fails(pointer: &str, value: Value, code: ErrorCode, place: &str) {
    let (mut json, binary) = square();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = json.pointer_mut(parent).unwrap();
    match parent {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        other => other[key] = value,
    }
    assert_fails(Glb::new(&json, binary).bytes(), code, place);
}

/// JSON and binary chunk of a GLB that was written.
fn take_apart(glb: &[u8]) -> (Value, Vec<u8>) {
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&glb[..4], word(4), word(8)), (&b"glTF"[..], 2, glb.len()));
    let json_end = 20 + word(12);
    let json = serde_json::from_slice(&glb[20..json_end]).unwrap();
    let binary = if json_end == glb.len() { Vec::new() } else { glb[json_end + 8..].to_vec() };
    (json, binary)
}

fn reopen(bytes: Vec<u8>) -> Document {
    Document::open(vec![named("written.glb", bytes)]).expect("what is written can be read")
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/gltf")
}

/// A model and the files that it refers to.
fn load(path: &Path) -> Vec<NamedFile> {
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let uris = external_files(&bytes);
    let mut files = vec![named(&path.file_name().unwrap().to_string_lossy(), bytes)];
    for uri in uris {
        let name = uri.replace("%20", " ");
        files.extend(fs::read(path.with_file_name(&name)).ok().map(|bytes| named(&name, bytes)));
    }
    files
}
