//! Every form an accessor may have, one small file each: the same square must be read.

use decimesh::document::{Document, Format};
use serde_json::{Value, json};

use super::*;

const CORNERS: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

/// The square with `indices` in place of its own.
fn with_indices(component: u32, indices: &[u8]) -> (Value, Vec<u8>) {
    let (mut json, mut binary) = square();
    binary.truncate(48);
    binary.extend(indices);
    json["accessors"][1]["componentType"] = json!(component);
    json["bufferViews"][1]["byteLength"] = json!(indices.len());
    json["buffers"][0]["byteLength"] = json!(binary.len());
    (json, binary)
}

/// Reads, writes and reads again.
#[track_caller]
fn assert_square(json: &Value, binary: Vec<u8>) -> Document {
    let document = open_glb(json, binary).unwrap();
    let written = document.write(document.mesh(), Format::Glb).unwrap();
    for document in [&document, &reopen(written)] {
        assert_eq!(document.mesh().positions, CORNERS);
        assert_eq!(document.mesh().triangles, TRIANGLES);
    }
    document
}

#[test]
fn indices_of_every_width() {
    let indices = [0u8, 1, 2, 0, 2, 3];
    let (json, binary) = with_indices(5121, &indices);
    assert_square(&json, binary);
    let (json, binary) = with_indices(5123, &indices.map(|i| u16::from(i).to_le_bytes()).concat());
    assert_square(&json, binary);
    let (json, binary) = with_indices(5125, &indices.map(|i| u32::from(i).to_le_bytes()).concat());
    assert_square(&json, binary);
    for component in [5120, 5122, 5126] {
        let (json, binary) = with_indices(component, &[0; 24]);
        assert_fails(Glb::new(&json, binary).bytes(), ErrorCode::Syntax, "m.glb: meshes[0].primitives[0].indices");
    }
}

#[test]
fn bounds_may_be_absent_or_wrong() {
    let (mut json, binary) = square();
    json["accessors"][0].as_object_mut().unwrap().remove("min");
    json["accessors"][0]["max"] = json!([-7, "x"]);
    let document = assert_square(&json, binary);
    let (written, _) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert_eq!(written["accessors"][0]["min"], json!([0.0, 0.0, 0.0]));
    assert_eq!(written["accessors"][0]["max"], json!([1.0, 1.0, 0.0]));
    assert_eq!(written["accessors"][1].get("min"), None, "indices need none");
}

#[test]
fn strided_and_overlapping_views() {
    // Positions and texture coordinates alternate, in views that cover each other.
    let (mut json, binary) = square();
    let mut mixed = vec![9u8; 4];
    for corner in binary[..48].chunks_exact(12) {
        mixed.extend(corner);
        mixed.extend([0.25f32, 0.75].map(f32::to_le_bytes).concat());
    }
    let end = mixed.len();
    mixed.extend(&binary[48..]);
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(2);
    json["accessors"][0]["byteOffset"] = json!(4);
    let texcoords = json!({ "bufferView": 2, "byteOffset": 8, "componentType": 5126, "count": 4, "type": "VEC2" });
    json["accessors"].as_array_mut().unwrap().push(texcoords);
    json["bufferViews"] = json!([
        { "buffer": 0, "byteLength": end, "byteStride": 20 },
        { "buffer": 0, "byteOffset": end, "byteLength": 12 },
        { "buffer": 0, "byteOffset": 8, "byteLength": end - 8, "byteStride": 20 }
    ]);
    json["buffers"][0]["byteLength"] = json!(mixed.len());
    let document = assert_square(&json, mixed);
    assert_eq!(document.mesh().wedge_sets[0].attributes[0].values, [0.25, 0.75].repeat(4));
}

#[test]
fn sparse_positions_with_and_without_a_base() {
    let (mut json, binary) = square();
    // Corner 2 is somewhere else in the base; the sparse part puts it right.
    let mut moved = binary.clone();
    moved[24..28].copy_from_slice(&5f32.to_le_bytes());
    moved.extend([2u8, 0, 0, 0]);
    moved.extend(&binary[24..36]);
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": 2, "componentType": 5121 },
        "values": { "bufferView": 2, "byteOffset": 4 }
    });
    json["accessors"][0]["sparse"] = sparse;
    json["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 0, "byteOffset": 60, "byteLength": 16 }));
    json["buffers"][0]["byteLength"] = json!(moved.len());
    assert_square(&json, moved);

    let (mut json, binary) = square();
    let mut others = binary[48..].to_vec();
    others.extend([1u16, 2, 3].map(u16::to_le_bytes).concat());
    others.extend([0, 0]);
    others.extend(&binary[12..48]);
    json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    json["accessors"][0]["sparse"] = json!({
        "count": 3,
        "indices": { "bufferView": 0, "componentType": 5123 },
        "values": { "bufferView": 2 }
    });
    json["bufferViews"] = json!([
        { "buffer": 0, "byteOffset": 12, "byteLength": 6 },
        { "buffer": 0, "byteLength": 12 },
        { "buffer": 0, "byteOffset": 20, "byteLength": 36 }
    ]);
    json["buffers"][0]["byteLength"] = json!(others.len());
    assert_square(&json, others.clone());
    for (index, place) in [(0u16, "sparse.indices"), (9, "sparse.indices")] {
        let mut wrong = others.clone();
        wrong[14..16].copy_from_slice(&index.to_le_bytes());
        assert_fails(Glb::new(&json, wrong).bytes(), ErrorCode::OutOfRange, &format!("m.glb: accessors[0].{place}"));
    }
    json["accessors"][0]["sparse"]["count"] = json!(5);
    assert_fails(Glb::new(&json, others).bytes(), ErrorCode::OutOfRange, "m.glb: accessors[0].sparse.count");
}

#[test]
fn quantised_forms_mean_the_same_numbers() {
    // KHR_mesh_quantization: each integer type, plain and normalised.
    type Encode = fn(f32) -> Vec<u8>;
    let cases: [(u32, bool, f32, Encode); 8] = [
        (5120, false, 1.0, |c| vec![c as i8 as u8]),
        (5121, false, 1.0, |c| vec![c as u8]),
        (5122, false, 1.0, |c| (c as i16).to_le_bytes().to_vec()),
        (5123, false, 1.0, |c| (c as u16).to_le_bytes().to_vec()),
        (5120, true, 127.0, |c| vec![c as i8 as u8]),
        (5121, true, 255.0, |c| vec![c as u8]),
        (5122, true, 32767.0, |c| (c as i16).to_le_bytes().to_vec()),
        (5123, true, 65535.0, |c| (c as u16).to_le_bytes().to_vec()),
    ];
    for (component, normalized, one, encode) in cases {
        let (mut json, binary) = square();
        let mut packed = Vec::new();
        for corner in CORNERS {
            packed.extend(corner.iter().flat_map(|c| encode(c * one)));
            packed.resize(packed.len().next_multiple_of(4), 0);
        }
        let (length, stride) = (packed.len(), packed.len() / 4);
        packed.extend(&binary[48..]);
        json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        json["accessors"][0]["componentType"] = json!(component);
        json["accessors"][0]["normalized"] = json!(normalized);
        json["bufferViews"] = json!([
            { "buffer": 0, "byteLength": length, "byteStride": stride },
            { "buffer": 0, "byteOffset": length, "byteLength": 12 }
        ]);
        json["buffers"][0]["byteLength"] = json!(packed.len());
        let document = assert_square(&json, packed);
        let (written, _) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
        assert_eq!(written["accessors"][0]["componentType"], component, "what was quantised stays so");
        assert_eq!(written["extensionsRequired"], json!(["KHR_mesh_quantization"]));
    }
}

#[test]
fn feature_ids_follow_their_vertices_and_extensions_stay() {
    let (mut json, mut binary) = square();
    binary.extend([3f32, 3.0, 5.0, 5.0].map(f32::to_le_bytes).concat());
    json["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 0, "byteOffset": 60, "byteLength": 16 }));
    binary.extend(7u32.to_le_bytes());
    json["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 0, "byteOffset": 76, "byteLength": 4 }));
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let ids = json!({ "bufferView": 2, "componentType": 5126, "count": 4, "type": "SCALAR" });
    json["accessors"].as_array_mut().unwrap().push(ids);
    json["extensionsUsed"] = json!(["EXT_mesh_features", "EXT_structural_metadata", "KHR_texture_transform"]);
    let primitive = &mut json["meshes"][0]["primitives"][0];
    primitive["attributes"]["_FEATURE_ID_0"] = json!(2);
    let features = json!({ "featureIds": [{ "featureCount": 6, "attribute": 0, "propertyTable": 0 }] });
    primitive["extensions"] = json!({ "EXT_mesh_features": features });
    // A table names its buffer view by an index that looks like any other number.
    let table = json!({ "class": "c", "count": 1, "properties": { "height": { "values": 3 } } });
    json["extensions"] = json!({ "EXT_structural_metadata": { "propertyTables": [table] } });
    let document = assert_square(&json, binary);
    let mut mesh = document.mesh().clone();
    mesh.triangles.truncate(1);
    mesh.groups[0].triangles = 0..1;
    let bytes = document.write(&mesh, Format::Glb).unwrap();
    let (written, binary) = take_apart(&bytes);
    assert_eq!(written["extensions"], json["extensions"]);
    assert_eq!(written["meshes"][0]["primitives"][0]["extensions"], json["meshes"][0]["primitives"][0]["extensions"]);
    let offset = written["bufferViews"][3]["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(binary[offset..offset + 4], 7u32.to_le_bytes());
    assert_eq!(reopen(bytes).mesh().wedge_sets[0].attributes[0].values, [3.0, 3.0, 5.0]);
    assert!(document.warnings().is_empty());
}

#[test]
fn ids_by_the_number_of_the_vertex_are_told() {
    let (mut json, binary) = square();
    json["extensionsUsed"] = json!(["EXT_mesh_features"]);
    json["meshes"][0]["primitives"][0]["extensions"] =
        json!({ "EXT_mesh_features": { "featureIds": [{ "featureCount": 4 }] } });
    let document = open_glb(&json, binary).unwrap();
    let warning = &document.warnings()[0];
    let place = "m.glb: meshes[0].primitives[0].extensions.EXT_mesh_features.featureIds[0]";
    assert_eq!((warning.code, warning.place.as_str()), ("implicit-feature-ids", place));
}
