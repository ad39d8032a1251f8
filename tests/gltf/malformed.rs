//! Bad files, each made by one change to a sound one: the code and the place of the error.

use decimesh::ErrorCode;
use decimesh::document::{Document, Format};
use serde_json::{Value, json};

use super::*;

#[test]
fn the_square_is_sound() {
    let (json, binary) = square();
    let document = open_glb(&json, binary).unwrap();
    assert_eq!(document.mesh().triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(document.warnings().is_empty());
}

#[test]
fn every_prefix_of_a_glb_is_an_error() {
    let (json, binary) = square();
    let bytes = Glb::new(&json, binary).bytes();
    for length in 0..bytes.len() {
        assert!(Document::open(vec![named("m.glb", bytes[..length].to_vec())]).is_err(), "{length} bytes");
        let mut patched = bytes[..length].to_vec();
        if let Some(field) = patched.get_mut(8..12) {
            field.copy_from_slice(&(length as u32).to_le_bytes());
        }
        assert!(Document::open(vec![named("m.glb", patched)]).is_err(), "{length} bytes, and the header says so");
    }
}

#[test]
fn no_single_changed_byte_panics() {
    let (json, binary) = square();
    let bytes = Glb::new(&json, binary).bytes();
    for at in 0..bytes.len() {
        for value in [0, 0x20, 0x31, 0x5D, 0x7F, 0xFF] {
            let mut changed = bytes.clone();
            changed[at] = value;
            if let Ok(document) = Document::open(vec![named("m.glb", changed)]) {
                document.write(document.mesh(), Format::Glb).unwrap();
            }
        }
    }
}

#[test]
fn bad_containers() {
    let glb = || {
        let (json, binary) = square();
        Glb::new(&json, binary)
    };
    assert_fails(Glb { magic: *b"glTg", ..glb() }.bytes(), ErrorCode::UnknownFormat, "m.glb");
    assert_fails(Glb { version: 1, ..glb() }.bytes(), ErrorCode::Unsupported, "m.glb: byte 4");
    assert_fails(Glb { version: 3, ..glb() }.bytes(), ErrorCode::Unsupported, "m.glb: byte 4");
    assert_fails(Glb { length: Some(1 << 30), ..glb() }.bytes(), ErrorCode::Truncated, "m.glb: byte 8");
    assert_fails(Glb { length: Some(12), ..glb() }.bytes(), ErrorCode::Syntax, "m.glb: byte 8");
    assert_fails(Glb { json_length: Some(u32::MAX - 3), ..glb() }.bytes(), ErrorCode::Truncated, "m.glb: byte 12");
    let binary_chunk = 20 + glb().json.len();
    assert_fails(
        Glb { binary_length: Some(64), ..glb() }.bytes(),
        ErrorCode::Truncated,
        &format!("m.glb: byte {binary_chunk}"),
    );
    assert_fails(Glb { json: Vec::new(), ..glb() }.bytes(), ErrorCode::Syntax, "m.glb: byte 12");
    assert_fails(b"glTF".to_vec(), ErrorCode::Truncated, "m.glb: byte 4");
}

#[test]
fn bad_json() {
    let open = |json: &str| Document::open(vec![named("m.gltf", json.into())]).expect_err("must be refused");
    let error = open(r#"{"asset":{"version":"2.0"},"nodes":[{},{"mesh": nope}]}"#);
    assert_eq!((error.code(), error.place()), (ErrorCode::Syntax, "m.gltf: nodes[1].mesh (line 1 column 50)"));
    let error = open(r#"{"asset":{"version":"2.0"},"meshes":[{"primitives":7}]}"#);
    assert_eq!((error.code(), error.place()), (ErrorCode::Syntax, "m.gltf: meshes[0].primitives"));
    assert_eq!(open(r#"{"asset":{"version":"2.0""#).code(), ErrorCode::Truncated);
    assert_eq!(open(r#"{"meshes":{}}"#).code(), ErrorCode::Unsupported);
    assert_eq!(open(r#"{"asset":{"version":"1.0"}}"#).code(), ErrorCode::Unsupported);
    assert_eq!(open(r#"{"asset":{}}"#).place(), "m.gltf: asset.version");
    let bomb = format!("{{\"asset\":{}", "[".repeat(1_000_000));
    assert_eq!(open(&bomb).code(), ErrorCode::Syntax);
    let bomb = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"extras\":{}1", "{\"a\":".repeat(500_000));
    assert_eq!(open(&bomb).code(), ErrorCode::Syntax);
}

#[test]
fn bad_references_and_ranges() {
    use ErrorCode::{OutOfRange, Syntax, TooLarge, Truncated};
    let cases = [
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(9),
            OutOfRange,
            "meshes[0].primitives[0].attributes.POSITION",
        ),
        ("/meshes/0/primitives/0/indices", json!(9), OutOfRange, "meshes[0].primitives[0].indices"),
        ("/meshes/0/primitives/0/attributes", json!({}), Syntax, "meshes[0].primitives[0].attributes.POSITION"),
        ("/meshes/0/primitives/0/mode", json!(7), Syntax, "meshes[0].primitives[0].mode"),
        ("/meshes/0/primitives/0/indices", json!(0), Syntax, "meshes[0].primitives[0].indices"),
        ("/nodes/0/mesh", json!(1), OutOfRange, "nodes[0].mesh"),
        ("/scene", json!(3), OutOfRange, "scene"),
        ("/accessors/0/bufferView", json!(2), OutOfRange, "accessors[0].bufferView"),
        ("/accessors/0/count", json!(5), OutOfRange, "accessors[0]"),
        ("/accessors/0/count", json!(0), Syntax, "accessors[0].count"),
        ("/accessors/0/count", json!(u64::MAX), TooLarge, "accessors[0].count"),
        ("/accessors/1/count", json!(4_000_000_000u32), OutOfRange, "accessors[1]"),
        ("/accessors/0/byteOffset", json!(u64::MAX - 4), OutOfRange, "accessors[0]"),
        ("/accessors/0/componentType", json!(5130), Syntax, "accessors[0].componentType"),
        ("/accessors/0/type", json!("VEC2"), Syntax, "meshes[0].primitives[0].attributes.POSITION"),
        ("/bufferViews/0/byteLength", json!(61), OutOfRange, "bufferViews[0]"),
        ("/bufferViews/1/byteOffset", json!(u64::MAX), OutOfRange, "bufferViews[1]"),
        ("/bufferViews/0/byteStride", json!(4), Syntax, "bufferViews[0].byteStride"),
        ("/bufferViews/0/byteStride", json!(20), OutOfRange, "accessors[0]"),
        ("/buffers/0/byteLength", json!(1000), Truncated, "buffers[0].byteLength"),
    ];
    for (pointer, value, code, place) in cases {
        assert_square_fails(pointer, value, code, &format!("m.glb: {place}"));
    }
    for negative in ["/bufferViews/1/byteOffset", "/accessors/0/count", "/nodes/0/mesh"] {
        let (mut json, binary) = square();
        *json.pointer_mut(negative).unwrap() = json!(-1);
        assert_eq!(open_glb(&json, binary).unwrap_err().code(), Syntax, "{negative}");
    }
}

#[test]
fn bad_numbers() {
    let (json, binary) = square();
    for (value, code) in [(f32::NAN, ErrorCode::NotFinite), (f32::NEG_INFINITY, ErrorCode::NotFinite)] {
        let mut binary = binary.clone();
        binary[16..20].copy_from_slice(&value.to_le_bytes());
        assert_fails(Glb::new(&json, binary).bytes(), code, "m.glb: meshes[0].primitives[0].attributes.POSITION");
    }
    for index in [4u16, 9999, u16::MAX] {
        let mut binary = binary.clone();
        binary[52..54].copy_from_slice(&index.to_le_bytes());
        let place = "m.glb: meshes[0].primitives[0].indices";
        assert_fails(Glb::new(&json, binary).bytes(), ErrorCode::OutOfRange, place);
    }
}

#[test]
fn a_few_bytes_cannot_ask_for_gigabytes() {
    let (mut json, binary) = square();
    json["accessors"][0] = json!({ "componentType": 5126, "count": 4_000_000_000u32, "type": "VEC3" });
    json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    assert_fails(Glb::new(&json, binary).bytes(), ErrorCode::TooLarge, "m.glb: accessors[0].count");
}

/// Every name of a sparse accessor has all of its elements looked through.
#[test]
fn a_sparse_accessor_under_many_names_is_too_large() {
    const ELEMENTS: usize = 20_000;
    let (mut json, mut binary) = square();
    let start = binary.len();
    binary.extend((0..ELEMENTS as u32).flat_map(u32::to_le_bytes));
    binary.resize(binary.len() + 12 * ELEMENTS, 0);
    let views = json["bufferViews"].as_array_mut().unwrap();
    let first = views.len();
    views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": 4 * ELEMENTS }));
    views.push(json!({ "buffer": 0, "byteOffset": start + 4 * ELEMENTS, "byteLength": 12 * ELEMENTS }));
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let indices = json!({ "bufferView": first, "componentType": 5125 });
    let sparse = json!({ "count": ELEMENTS, "indices": indices, "values": { "bufferView": first + 1 } });
    json["accessors"][0] = json!({ "componentType": 5126, "count": ELEMENTS, "type": "VEC3", "sparse": sparse });
    open_glb(&json, binary.clone()).unwrap();
    for name in 0..1000 {
        json["meshes"][0]["primitives"][0]["attributes"][format!("_{name}")] = json!(0);
    }
    assert_fails(Glb::new(&json, binary).bytes(), ErrorCode::TooLarge, "m.glb: meshes[0].primitives[0]");
}

#[test]
fn uneven_attributes_are_an_error() {
    let (mut json, binary) = square();
    json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(2);
    let normal = json!({ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" });
    json["accessors"].as_array_mut().unwrap().push(normal);
    let place = "m.glb: meshes[0].primitives[0].attributes.NORMAL";
    assert_fails(Glb::new(&json, binary).bytes(), ErrorCode::Syntax, place);
}

#[test]
fn buffers_outside_of_the_file() {
    let (mut json, binary) = square();
    let open = |json: &Value, others: Vec<NamedFile>| {
        let mut files = others;
        files.push(named("models/m.gltf", json.to_string().into_bytes()));
        Document::open(files)
    };
    let place = "models/m.gltf: buffers[0].uri";
    json["buffers"][0]["uri"] = json!("data/a%20b.bin");
    let error = open(&json, vec![]).unwrap_err();
    assert_eq!((error.code(), error.place()), (ErrorCode::MissingResource, place));
    assert!(error.message().contains("data/a%20b.bin"));
    for name in ["models/data/a b.bin", "data/a b.bin", "a b.bin", "./data/a%20b.bin", "elsewhere\\a b.bin"] {
        assert!(open(&json, vec![named(name, binary.clone())]).is_ok(), "{name}");
    }
    assert_eq!(open(&json, vec![named("a b.bin", binary[..59].to_vec())]).unwrap_err().code(), ErrorCode::Truncated);

    json["buffers"][0]["uri"] = json!("data:application/octet-stream;base64,****");
    let error = open(&json, vec![]).unwrap_err();
    assert_eq!((error.code(), error.place()), (ErrorCode::Syntax, place));
    json["buffers"][0]["uri"] = json!("data:nothing");
    assert_eq!(open(&json, vec![]).unwrap_err().code(), ErrorCode::Syntax);
    json["buffers"][0].as_object_mut().unwrap().remove("uri");
    assert_eq!(open(&json, vec![]).unwrap_err().code(), ErrorCode::MissingResource);
}

#[test]
fn node_cycles_end() {
    let (mut json, binary) = square();
    json["nodes"] = json!([{ "mesh": 0, "children": [1] }, { "children": [0] }, { "children": [2] }]);
    assert_eq!(open_glb(&json, binary.clone()).unwrap().mesh().triangles.len(), 2);
    // A chain too deep for recursion.
    let nodes: Vec<Value> = (1..200_000).map(|child| json!({ "children": [child], "scale": [1, 1, 1] })).collect();
    json["nodes"] = nodes.into_iter().chain([json!({ "mesh": 0, "scale": [3, 3, 3] })]).collect();
    assert_eq!(open_glb(&json, binary).unwrap().mesh().parts[0].scale, 3.0);
}
