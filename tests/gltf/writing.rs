//! What is written: what changes, what stays, and where it lies.

use decimesh::ErrorCode;
use decimesh::document::{Document, Format};
use decimesh::mesh::{Attribute, Blend};
use serde_json::{Value, json};

use super::*;

#[test]
fn what_is_not_geometry_stays() {
    let (mut json, binary) = square();
    json["extras"] = json!({ "zeta": [1.5, { "a": null }], "alpha": "ü" });
    json["extensionsUsed"] = json!(["VENDOR_thing"]);
    json["extensions"] = json!({ "VENDOR_thing": { "of": [1, 2] } });
    json["materials"] = json!([{ "name": "m", "extensions": { "VENDOR_thing": {} } }]);
    json["nodes"][0]["name"] = json!("node");
    json["buffers"][0]["name"] = json!("buffer");
    json["accessors"][0]["name"] = json!("accessor");
    let document = open_glb(&json, binary).unwrap();
    let (written, _) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    for key in ["asset", "scene", "scenes", "nodes", "extras", "extensions", "extensionsUsed", "materials", "meshes"] {
        assert_eq!(written[key].to_string(), json[key].to_string(), "{key}");
    }
    assert_eq!(written["buffers"][0]["name"], "buffer");
    assert_eq!(written["accessors"][0]["name"], "accessor");
}

#[test]
fn data_of_others_keeps_its_numbers_and_bytes() {
    // Points share the positions of the triangles, and a vendor extension may use view 2.
    let (mut json, mut binary) = square();
    binary.extend(b"precious");
    json["buffers"][0]["byteLength"] = json!(binary.len());
    json["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 0, "byteOffset": 60, "byteLength": 8 }));
    json["meshes"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "primitives": [{ "attributes": { "POSITION": 0 }, "mode": 0 }] }));
    let document = open_glb(&json, binary).unwrap();
    let mut mesh = document.mesh().clone();
    mesh.positions.iter_mut().for_each(|p| p[2] = 0.1);
    let (written, bytes) = take_apart(&document.write(&mesh, Format::Glb).unwrap());
    assert_eq!(written["meshes"][1]["primitives"][0]["attributes"]["POSITION"], 0);
    assert_eq!(written["meshes"][0]["primitives"][0]["attributes"]["POSITION"], 2, "a new one");
    assert_eq!(written["meshes"][0]["primitives"][0]["indices"], 1);
    assert_eq!(written["accessors"][0]["max"], json!([1, 1, 0]));
    assert_eq!(written["accessors"][2]["max"], json!([1.0, 1.0, f64::from(0.1f32)]));
    let offset = written["bufferViews"][2]["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(&bytes[offset..offset + 8], b"precious");
}

#[test]
fn overlapping_views_are_copied_once() {
    let (mut json, mut binary) = square();
    binary.resize(4096, 7);
    json["buffers"][0]["byteLength"] = json!(4096);
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.extend((0..1000).map(|i| json!({ "buffer": 0, "byteOffset": 60 + i, "byteLength": 3000 })));
    let document = open_glb(&json, binary).unwrap();
    let (written, bytes) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert!(bytes.len() < 5000, "{}", bytes.len());
    let last = written["bufferViews"][1001]["byteOffset"].as_u64().unwrap() as usize;
    assert!(bytes[last..last + 3000].iter().all(|&b| b == 7));
}

#[test]
fn integer_formats_stay_integer() {
    // u16 positions scaled by the node, normalised i8 normals, stride 12.
    let mut binary = Vec::new();
    for (x, y) in [(0u16, 0u16), (1000, 0), (1000, 1000)] {
        [x, y, 7].iter().for_each(|c| binary.extend(c.to_le_bytes()));
        binary.extend([0u8; 2]);
        binary.extend([0u8, 0, 127, 0]);
    }
    let json = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 } }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5123, "count": 3, "type": "VEC3", "min": [0, 0, 7], "max": [1000, 1000, 7] },
            { "bufferView": 0, "byteOffset": 8, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3" }
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 36, "byteStride": 12, "target": 34962 }],
        "buffers": [{ "byteLength": 36 }]
    });
    let document = open_glb(&json, binary).unwrap();
    let mut mesh = document.mesh().clone();
    assert_eq!(mesh.positions[1], [1000.0, 0.0, 7.0]);
    assert_eq!(mesh.wedge_sets[0].attributes[0].values[..3], [0.0, 0.0, 1.0]);
    mesh.positions[1] = [70000.0, -3.0, 6.6];
    mesh.wedge_sets[0].attributes[0].values[..3].copy_from_slice(&[0.0, 0.6, -0.8]);
    let bytes = document.write(&mesh, Format::Glb).unwrap();
    let (written, _) = take_apart(&bytes);
    assert_eq!(written["accessors"][0]["max"], json!([65535, 1000, 7]));
    assert_eq!(written["accessors"][0]["componentType"], 5123);
    assert_eq!(written["bufferViews"][0]["byteStride"], 12, "they alternate as before");
    let again = reopen(bytes);
    assert_eq!(again.mesh().positions[1], [65535.0, 0.0, 7.0]);
    let normal = &again.mesh().wedge_sets[0].attributes[0].values[..3];
    assert!((normal[1] - 0.6).abs() < 0.005 && (normal[2] + 0.8).abs() < 0.005, "{normal:?}");
}

#[test]
fn index_width_follows_the_vertex_count() {
    for (count, component) in [(65_535usize, 5123), (65_536, 5125)] {
        let (json, binary) = square();
        let document = open_glb(&json, binary).unwrap();
        let mut mesh = document.mesh().clone();
        mesh.positions = (0..count).map(|i| [i as f32, 0.0, (i % 7) as f32]).collect();
        mesh.wedge_sets[0].wedges = 0..count;
        mesh.triangles = vec![[0, 1, count as u32 - 1], [0, 2, 3]];
        let bytes = document.write(&mesh, Format::Glb).unwrap();
        assert_eq!(take_apart(&bytes).0["accessors"][1]["componentType"], component);
        // Only 0, 1, 2, 3 and the last are in use, and only those are read.
        assert_eq!(reopen(bytes).mesh().positions[4], mesh.positions[count - 1]);
    }
}

#[test]
fn images_given_are_embedded_and_others_keep_their_uri() {
    let (mut json, binary) = square();
    json["images"] = json!([{ "uri": "a.png", "name": "A" }, { "uri": "gone.png" }, { "uri": "b.jpg" }]);
    let png = b"\x89PNG\r\n\x1a\nrest".to_vec();
    let files = vec![
        named("m.glb", Glb::new(&json, binary).bytes()),
        named("a.png", png.clone()),
        named("b.jpg", b"\x89PNG but named jpg".to_vec()),
    ];
    let document = Document::open(files).unwrap();
    assert_eq!(document.warnings().len(), 1);
    assert_eq!(
        (document.warnings()[0].code, &*document.warnings()[0].place),
        ("missing-image", "m.glb: images[1].uri")
    );
    let (written, bytes) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert_eq!(written["images"][1], json!({ "uri": "gone.png" }));
    assert_eq!((&written["images"][0]["mimeType"], &written["images"][0]["name"]), (&json!("image/png"), &json!("A")));
    assert_eq!(written["images"][2]["mimeType"], "image/png", "by content, not by name");
    let view = &written["bufferViews"][written["images"][0]["bufferView"].as_u64().unwrap() as usize];
    let offset = view["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(bytes[offset..offset + png.len()], png);
}

#[test]
fn primitives_without_triangles_leave_a_valid_file() {
    let (mut json, binary) = square();
    let primitive = json["meshes"][0]["primitives"][0].clone();
    json["meshes"] = json!([{ "primitives": [primitive, primitive] }]);
    let document = open_glb(&json, binary).unwrap();
    let mut mesh = document.mesh().clone();
    assert_eq!((mesh.groups.len(), mesh.wedge_sets.len(), mesh.positions.len()), (2, 1, 4));
    mesh.triangles.truncate(2);
    mesh.groups[1].triangles = 2..2;
    let (written, _) = take_apart(&document.write(&mesh, Format::Glb).unwrap());
    assert_eq!(written["meshes"][0]["primitives"].as_array().unwrap().len(), 1, "one is left out");
    mesh.triangles.clear();
    mesh.groups.iter_mut().for_each(|group| group.triangles = 0..0);
    let (written, _) = take_apart(&document.write(&mesh, Format::Glb).unwrap());
    let left = written["meshes"][0]["primitives"].as_array().unwrap();
    assert_eq!((left.len(), &left[0]["mode"]), (1, &json!(0)), "a point of the original");
    assert_eq!(written["accessors"][0]["count"], 1);
}

#[test]
fn a_mesh_of_another_shape_is_refused() {
    let (json, binary) = square();
    let document = open_glb(&json, binary).unwrap();
    let mut mesh = document.mesh().clone();
    mesh.wedge_sets[0].attributes.push(Attribute {
        name: "TEXCOORD_0".into(),
        components: 2,
        values: vec![0.0; 8],
        blend: Blend::Linear,
    });
    assert_eq!(document.write(&mesh, Format::Glb).unwrap_err().code(), ErrorCode::InvalidArgument);
    mesh.wedge_sets.clear();
    assert!(document.write(&mesh, Format::Glb).is_err());
}

#[test]
fn an_obj_becomes_a_small_tree() {
    let obj = "o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0.25\nvt 0 1\n\
               usemtl red\nf 1/1 2/2 3/3\nusemtl blue\nf 1/1 3/3 4/2\no two\nusemtl red\nf 2 3 4\n";
    let document = Document::open(vec![named("m.obj", obj.into())]).unwrap();
    let bytes = document.write(document.mesh(), Format::Glb).unwrap();
    let (tree, _) = take_apart(&bytes);
    assert_eq!(tree["asset"], json!({ "version": "2.0", "generator": "Decimesh" }));
    let names: Vec<&Value> = tree["materials"].as_array().unwrap().iter().map(|m| &m["name"]).collect();
    assert_eq!(names, ["red", "blue"]);
    let meshes = tree["meshes"].as_array().unwrap();
    assert_eq!(meshes.iter().map(|m| m["primitives"].as_array().unwrap().len()).collect::<Vec<_>>(), [2, 1]);
    assert_eq!((&meshes[0]["name"], &tree["nodes"][1]["mesh"]), (&json!("one"), &json!(1)));
    let again = reopen(bytes);
    assert_eq!(again.mesh().triangles.len(), 3);
    let uv = again.mesh().wedge_sets[0].attributes.iter().find(|a| a.name == "TEXCOORD_0").unwrap();
    let second = again.mesh().triangles[0][1] as usize;
    assert_eq!(uv.values[second * 2..second * 2 + 2], [1.0, 0.75], "v is turned upside down");
}

#[test]
fn normals_of_an_obj_get_unit_length() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 40\nvn 0 0 0\nf 1//1 2//1 3//2\n";
    let document = Document::open(vec![named("m.obj", obj.into())]).unwrap();
    let again = reopen(document.write(document.mesh(), Format::Glb).unwrap());
    let normals = &again.mesh().wedge_sets[0].attributes[0];
    assert_eq!(normals.name, "NORMAL");
    assert!(normals.values.chunks_exact(3).all(|n| n == [0.0, 0.0, 1.0]));
}
