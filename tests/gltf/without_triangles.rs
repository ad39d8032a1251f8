//! Files without a triangle: points, lines, animations. They go through as they are.

use decimesh::document::Format;
use decimesh::simplify::{Simplifier, SimplifyOptions};
use decimesh::{deviation, lod};
use serde_json::json;

use super::*;

/// The square as lines, with an animation of its node.
fn lines() -> (Value, Vec<u8>) {
    let (mut json, mut binary) = square();
    json["meshes"][0]["primitives"][0]["mode"] = json!(1);
    json["meshes"][0]["primitives"][0]["extras"] = json!({ "kept": true });
    binary.extend([0f32, 1.0].map(f32::to_le_bytes).concat());
    json["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 0, "byteOffset": 60, "byteLength": 8 }));
    let times = json!({ "bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1] });
    json["accessors"].as_array_mut().unwrap().push(times);
    json["buffers"][0]["byteLength"] = json!(binary.len());
    (json, binary)
}

#[test]
fn lines_go_through_with_a_warning() {
    let (json, binary) = lines();
    let document = open_glb(&json, binary.clone()).unwrap();
    let warnings: Vec<_> = document.warnings().iter().map(|w| (w.code, w.place.as_str())).collect();
    assert_eq!(warnings, [("no-triangles", "m.glb")]);
    let (written, content) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    let without_places = |json: &Value| {
        let mut json = json.clone();
        for view in json["bufferViews"].as_array_mut().unwrap() {
            view["byteOffset"] = json!(0);
        }
        json["buffers"] = Value::Null;
        json
    };
    assert_eq!(without_places(&written), without_places(&json));
    for (view, old) in [(0, 0..48), (1, 48..60), (2, 60..68)] {
        let start = written["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
        assert_eq!(content[start..start + old.len()], binary[old]);
    }
}

#[test]
fn a_file_of_nodes_alone_goes_through() {
    let (mut json, binary) = square();
    json.as_object_mut().unwrap().remove("meshes");
    json["nodes"] = json!([{ "name": "alone" }]);
    let document = open_glb(&json, binary).unwrap();
    let (written, _) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert_eq!((&written["nodes"], written.get("meshes")), (&json["nodes"], None));
}

#[test]
fn a_view_of_nothing_keeps_a_buffer_to_name() {
    // Found by fuzzing: the buffer went with its content, and the output could not be read.
    let json = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": "data:application/octet-stream;base64,AAAAAA==", "byteLength": 4 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 0, "byteStride": 4 }],
    });
    let document = open_glb(&json, Vec::new()).unwrap();
    let (written, content) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert_eq!(content.len(), 0);
    assert_eq!(written["buffers"].as_array().unwrap().len(), 1);
    let again = open_glb(&written, content).unwrap();
    assert_eq!(again.mesh().triangles.len(), 0);
}

#[test]
fn there_is_nothing_to_simplify_or_measure() {
    let (json, binary) = lines();
    let document = open_glb(&json, binary).unwrap();
    let mesh = document.mesh();
    let mut simplifier = Simplifier::new(mesh, &SimplifyOptions::default()).unwrap();
    while !simplifier.step(mesh, 1000).done {}
    let sequence = simplifier.finish();
    let level = lod::extract(mesh, &sequence, lod::Level::Triangles(0));
    assert!(level.mesh.triangles.is_empty() && sequence.collapses.is_empty());
    let written = document.write(&level.mesh, Format::Glb).unwrap();
    assert_eq!(take_apart(&written).0["meshes"], json["meshes"]);
    let measured = deviation::measure(mesh, &level.mesh, &deviation::DeviationOptions::default()).unwrap();
    assert_eq!(measured.max, 0.0);
}

#[test]
fn other_formats_cannot_hold_it() {
    let (json, binary) = lines();
    let document = open_glb(&json, binary).unwrap();
    for format in Format::OUTPUT.into_iter().filter(|format| *format != Format::Glb) {
        let error = document.write(document.mesh(), format).unwrap_err();
        assert_eq!((error.code(), error.place()), (ErrorCode::NoTriangles, "format"), "{format:?}");
    }
}
