//! What is read: exact small cases.

use std::fs;

use decimesh::ErrorCode;
use decimesh::document::{Document, Format, external_files};
use decimesh::mesh::Blend;
use serde_json::json;

use super::*;

#[test]
fn extensions_are_judged_by_what_they_touch() {
    let (mut json, binary) = square();
    for harmless in ["KHR_texture_basisu", "KHR_materials_variants", "KHR_mesh_quantization", "EXT_lights_image_based"]
    {
        json["extensionsUsed"] = json!([harmless]);
        json["extensionsRequired"] = json!([harmless]);
        assert!(open_glb(&json, binary.clone()).is_ok(), "{harmless}");
    }
    json["meshes"][0]["primitives"][0]["extensions"] =
        json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": {} } });
    let document = open_glb(&json, binary.clone()).expect("an uncompressed copy is there");
    let (written, _) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert_eq!(written["meshes"][0]["primitives"][0].get("extensions"), None);
    json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let place = "m.glb: meshes[0].primitives[0].extensions.KHR_draco_mesh_compression";
    assert_fails(Glb::new(&json, binary).bytes(), ErrorCode::Unsupported, place);
}

#[test]
fn strips_and_fans_become_triangles() {
    for (mode, expected) in [(5, vec![[0, 1, 2], [2, 1, 3]]), (6, vec![[1, 2, 0], [2, 3, 0]])] {
        let (mut json, binary) = square();
        let primitive = &mut json["meshes"][0]["primitives"][0];
        primitive["mode"] = json!(mode);
        primitive.as_object_mut().unwrap().remove("indices");
        let document = open_glb(&json, binary).unwrap();
        assert_eq!(document.mesh().triangles, expected);
        let written = document.write(document.mesh(), Format::Glb).unwrap();
        assert_eq!(take_apart(&written).0["meshes"][0]["primitives"][0]["mode"], 4);
        assert_eq!(reopen(written).mesh(), document.mesh());
    }
}

#[test]
fn triangles_without_positions_are_carried_through() {
    let (mut json, binary) = square();
    let other = json!({ "attributes": { "_PLACE": 0 }, "indices": 1 });
    json["meshes"][0]["primitives"].as_array_mut().unwrap().insert(0, other.clone());
    let document = open_glb(&json, binary).unwrap();
    assert_eq!(document.mesh().groups.len(), 1);
    let (written, _) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert_eq!(written["meshes"][0]["primitives"][0], other);
}

#[test]
fn equal_vertices_are_read_once() {
    let (mut json, mut binary) = square();
    let corners: Vec<u8> = [0usize, 1, 2, 0, 2, 3].iter().flat_map(|&c| binary[c * 12..c * 12 + 12].to_vec()).collect();
    binary = corners;
    json["accessors"][0]["count"] = json!(6);
    json["bufferViews"] = json!([{ "buffer": 0, "byteLength": 72 }]);
    json["buffers"][0]["byteLength"] = json!(72);
    json["accessors"].as_array_mut().unwrap().pop();
    json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    let document = open_glb(&json, binary).unwrap();
    assert_eq!(document.mesh().positions.len(), 4);
    assert_eq!(document.mesh().triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn scale_is_the_largest_of_all_appearances() {
    let (mut json, binary) = square();
    json["nodes"] = json!([
        { "scale": [1, -5, 1], "children": [1] },
        { "mesh": 0, "matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 7, 8, 9, 1] },
        { "mesh": 0, "scale": [1000, 1, 1] }
    ]);
    json["scenes"] = json!([{ "nodes": [0] }]);
    let document = open_glb(&json, binary.clone()).unwrap();
    assert_eq!(document.mesh().parts[0].scale, 10.0);
    assert_eq!(document.layout().instances.len(), 1);
    assert_eq!(document.layout().instances[0].world_from_local[12..], [7.0, -40.0, 9.0, 1.0]);
    json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [2] }]);
    assert_eq!(open_glb(&json, binary.clone()).unwrap().mesh().parts[0].scale, 1000.0);
    json["nodes"] = json!([{ "mesh": 0, "scale": [0, 0, 0] }]);
    json["scenes"] = json!([{ "nodes": [0] }]);
    assert_eq!(open_glb(&json, binary).unwrap().mesh().parts[0].scale, 1.0);
}

#[test]
fn every_mesh_is_where_its_ancestors_put_it() {
    let (mut json, binary) = square();
    // Of the two parents of node 2 the first counts, and of its two places among the children too.
    json["nodes"] = json!([
        { "translation": [1, 0, 0], "children": [5, 1, 2, 2, 4] },
        { "translation": [0, 0, 9] },
        { "translation": [0, 10, 0], "children": [3], "mesh": 0 },
        { "translation": [0, 0, 100], "mesh": 0 },
        { "scale": [2, 2, 2], "mesh": 0, "children": [2, 6] },
        { "translation": [1000, 0, 0], "children": [7] },
        { "translation": [3, 3, 3], "mesh": 0 },
        { "mesh": 0 }
    ]);
    json["scenes"] = json!([{ "nodes": [0] }]);
    let document = open_glb(&json, binary).unwrap();
    let places = document.layout().instances.iter().map(|instance| instance.world_from_local[12..15].to_vec());
    let expected = [[1.0, 10.0, 0.0], [1.0, 10.0, 100.0], [1.0, 0.0, 0.0], [7.0, 6.0, 6.0], [1001.0, 0.0, 0.0]];
    assert_eq!(places.collect::<Vec<_>>(), expected);
}

#[test]
fn attributes_keep_their_names_and_meaning() {
    let document = Document::open(load(&fixtures().join("SimpleSkin.gltf"))).unwrap();
    let list = |document: &Document| -> Vec<(String, Blend)> {
        document.mesh().wedge_sets[0].attributes.iter().map(|a| (a.name.clone(), a.blend)).collect()
    };
    assert_eq!(list(&document), [("JOINTS_0".into(), Blend::Joints), ("WEIGHTS_0".into(), Blend::Weights)]);
    let document = Document::open(load(&fixtures().join("AnimatedMorphCube.glb"))).unwrap();
    let names: Vec<String> = list(&document).into_iter().map(|(name, _)| name).collect();
    assert!(names.contains(&"TARGET_1/POSITION".to_owned()), "{names:?}");
    assert_eq!(list(&document)[0], ("NORMAL".into(), Blend::Direction));
}

#[test]
fn files_referred_to_are_listed() {
    let bytes = fs::read(fixtures().join("meshopt-fallback/meshopt-fallback.gltf")).unwrap();
    assert_eq!(external_files(&bytes), ["meshopt-fallback.bin", "meshopt-fallback.fallback.bin"]);
}
