//! Materials of OBJ and textures of PLY in a GLB, and text in UTF-16.

use decimesh::document::{Document, Format, NamedFile, external_files};
use serde_json::Value;

use super::{file, open, points, write};

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\nusemtl wood\nf 2/1 4/2 3/3\nusemtl unknown\nf 1/1 4/2 2/3\n";
const MTL: &str = "# two\nnewmtl red\nKd 1 0 0\nd 0.5\nKs 1 1 1\nNs 30\nKe 0 0 1\n\nnewmtl wood\n\tKd 0.8 0.8 0.8\nmap_Kd -s 2 2 1 tex\\wood grain.png\nmap_Bump -bm 0.2 height.png\nnorm normals.png\nmap_d alpha.tga\nPm 1\nPr 0.25\n";

/// The first bytes of a PNG: all that is looked at.
fn png(color_type: u8) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08".to_vec();
    bytes.push(color_type);
    bytes
}

fn files() -> Vec<NamedFile> {
    vec![
        file("a.obj", OBJ),
        file("A.MTL", MTL),
        file("tex/wood grain.png", png(2)),
        file("height.png", png(0)),
        file("normals.png", png(2)),
        file("alpha.tga", *b"no image"),
    ]
}

fn tree(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&glb[20..20 + length]).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn materials_of_an_obj_become_those_of_a_glb() {
    let document = Document::open(files()).unwrap();
    let codes: Vec<&str> = document.warnings().iter().map(|warning| warning.code).collect();
    assert_eq!(codes, ["bad-image"], "alpha.tga");
    let glb = write(&document, Format::Glb);
    let tree = tree(&glb);
    let names: Vec<&str> = tree["materials"].as_array().unwrap().iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["red", "wood", "unknown"]);
    let [red, wood, unknown] = [0, 1, 2].map(|i| &tree["materials"][i]);
    assert_eq!(red["pbrMetallicRoughness"]["baseColorFactor"], serde_json::json!([1.0, 0.0, 0.0, 0.5]));
    assert_eq!((number(&red["pbrMetallicRoughness"]["roughnessFactor"]), &red["alphaMode"]), (0.5, &"BLEND".into()));
    assert_eq!(red["emissiveFactor"], serde_json::json!([0.0, 0.0, 1.0]));
    let pbr = &wood["pbrMetallicRoughness"];
    assert_eq!((number(&pbr["metallicFactor"]), number(&pbr["roughnessFactor"])), (1.0, 0.25));
    assert!((number(&pbr["baseColorFactor"][0]) - 0.6038).abs() < 1e-3, "0.8 of sRGB");
    assert_eq!(wood["alphaMode"], Value::Null);
    let image = |reference: &Value| {
        let texture = &tree["textures"][reference["index"].as_u64().unwrap() as usize];
        let image = &tree["images"][texture["source"].as_u64().unwrap() as usize];
        assert_eq!(image["mimeType"], "image/png");
        assert!(image.get("uri").is_none() && image["bufferView"].is_u64(), "embedded");
        image["name"].as_str().unwrap().to_owned()
    };
    assert_eq!(image(&pbr["baseColorTexture"]), "wood grain");
    assert_eq!(image(&wood["normalTexture"]), "normals", "heights are no normals");
    assert_eq!(unknown["pbrMetallicRoughness"]["roughnessFactor"], 1.0);
    assert_eq!(tree["images"].as_array().unwrap().len(), 2);
    // The result opens again, with its materials as any GLB's.
    assert_eq!(points(open(glb).mesh()), points(document.mesh()));
}

#[test]
fn faces_without_texture_coordinates_have_no_textures() {
    let mut files = files();
    files[0] = file("a.obj", OBJ.replace("usemtl unknown\nf 1/1 4/2 2/3", "usemtl wood\nf 1 4 2\nusemtl red\nf 1 4 2"));
    let tree = tree(&write(&Document::open(files).unwrap(), Format::Glb));
    let materials = tree["materials"].as_array().unwrap();
    let names: Vec<&str> = materials.iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["red", "wood", "wood"]);
    assert!(materials[1]["pbrMetallicRoughness"].get("baseColorTexture").is_some());
    assert!(materials[2]["pbrMetallicRoughness"].get("baseColorTexture").is_none());
    assert!(materials[2].get("normalTexture").is_none());
}

#[test]
fn an_obj_keeps_its_libraries_and_what_is_missing_is_told() {
    let document = Document::open(files()).unwrap();
    let text = String::from_utf8(write(&document, Format::Obj)).unwrap();
    assert!(text.contains("mtllib a.mtl\n") && text.contains("usemtl red\n") && text.contains("usemtl wood\n"));
    let alone = Document::open(vec![file("a.obj", OBJ)]).unwrap();
    assert_eq!(alone.warnings()[0].code, "missing-material-library");
    assert_eq!(tree(&write(&alone, Format::Glb))["materials"].as_array().unwrap().len(), 3);
    let without_images = Document::open(files()[..2].to_vec()).unwrap();
    assert!(without_images.warnings().iter().all(|warning| warning.code == "missing-image"));
    assert_eq!(without_images.warnings().len(), 4);
}

#[test]
fn libraries_of_any_content_are_borne() {
    for text in [
        "Kd 1 1 1\n",
        "newmtl\nKd a b c\nd nan\nNs -inf\n",
        "newmtl x\nmap_Kd\nmap_Kd -s 1\nKd 1e39\nTr 7\n",
        "\0\u{1}\\",
    ] {
        let files = vec![file("a.obj", OBJ), file("a.mtl", text)];
        let document = Document::open(files).unwrap();
        open(write(&document, Format::Glb));
    }
    let utf16: Vec<u8> = [0xFF, 0xFE].into_iter().chain(MTL.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let document = Document::open(vec![file("a.obj", OBJ), file("a.mtl", utf16)]).unwrap();
    assert_eq!(document.layout().materials.list.len(), 2);
    let libraries: String = (0..1000).map(|i| format!("mtllib {i}.mtl\n")).collect();
    assert!(open(format!("{libraries}{OBJ}")).warnings().len() < 30);
    let many: String = (0..100_000).map(|i| format!("newmtl m{i}\n")).collect();
    open(write(&Document::open(vec![file("a.obj", OBJ), file("a.mtl", many)]).unwrap(), Format::Glb));
}

#[test]
fn the_texture_of_a_ply_is_embedded() {
    let ply = "ply\nformat ascii 1.0\ncomment TextureFile a b.png\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
    assert_eq!(external_files(ply.as_bytes()), ["a b.png"]);
    let document = Document::open(vec![file("m.ply", ply), file("a b.png", png(6))]).unwrap();
    let tree = tree(&write(&document, Format::Glb));
    assert_eq!(tree["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
    assert_eq!(tree["images"][0]["mimeType"], "image/png");
    let text = write(&document, Format::Ply);
    assert!(String::from_utf8_lossy(&text).contains("comment TextureFile a b.png\n"));
}

#[test]
fn utf16_is_read() {
    let plain = open("o Möbius\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let text = "o Möbius\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let little: Vec<u8> = [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let big: Vec<u8> = [0xFE, 0xFF].into_iter().chain(text.encode_utf16().flat_map(u16::to_be_bytes)).collect();
    for bytes in [little, big] {
        let document = open(&bytes);
        assert_eq!(document.mesh(), plain.mesh());
        assert_eq!(document.layout().groups[0].object.as_deref(), Some("Möbius"));
        // Cut within a character, too.
        let _ = Document::open(vec![file("a", &bytes[..bytes.len() - 1])]);
    }
}
