//! Round trips over the fixtures, and over many real files where they are at hand.

use std::fs;
use std::path::{Path, PathBuf};

use decimesh::ErrorCode;
use decimesh::document::{Document, Format};
use decimesh::mesh::{Attribute, Blend, Mesh, WedgeSet};
use serde_json::json;

use super::*;

pub(crate) fn models_under(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "glb" || e == "gltf") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Every fourth triangle, and the wedges that they use.
fn thinned(mesh: &Mesh) -> Mesh {
    let mut out = Mesh { parts: mesh.parts.clone(), ..Mesh::default() };
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().step_by(4).flatten().for_each(|&w| used[w as usize] = true);
    let mut number = vec![0; mesh.positions.len()];
    for set in &mesh.wedge_sets {
        let start = out.positions.len();
        for w in set.wedges.clone().filter(|&w| used[w]) {
            number[w] = out.positions.len() as u32;
            out.positions.push(mesh.positions[w]);
        }
        let attributes = set.attributes.iter().map(|a| {
            let rows = a.values.chunks_exact(a.components).zip(&used[set.wedges.clone()]);
            let values = rows.filter(|(_, used)| **used).flat_map(|(row, _)| row).copied().collect();
            Attribute { values, ..a.clone() }
        });
        let attributes = attributes.collect();
        out.wedge_sets.push(WedgeSet { wedges: start..out.positions.len(), part: set.part, attributes });
    }
    for group in &mesh.groups {
        let start = out.triangles.len();
        let kept = group.triangles.clone().filter(|t| t % 4 == 0);
        out.triangles.extend(kept.map(|t| mesh.triangles[t].map(|w| number[w as usize])));
        let mut group = group.clone();
        group.triangles = start..out.triangles.len();
        out.groups.push(group);
    }
    out
}

/// Equal but for skin weights, which are made to add up to 1.
#[track_caller]
fn assert_same(a: &Mesh, b: &Mesh, what: &Path) {
    assert_eq!(a.positions, b.positions, "{}", what.display());
    assert_eq!((&a.triangles, &a.groups), (&b.triangles, &b.groups), "{}", what.display());
    for (a, b) in a.wedge_sets.iter().flat_map(|s| &s.attributes).zip(b.wedge_sets.iter().flat_map(|s| &s.attributes)) {
        assert_eq!((&a.name, a.values.len()), (&b.name, b.values.len()), "{}", what.display());
        let same = if a.blend == Blend::Weights {
            a.values.chunks(a.components).zip(b.values.chunks(a.components)).all(|(a, b)| {
                let sum: f32 = a.iter().sum();
                let scale = if sum > 1e-6 { 1.0 / sum } else { 1.0 };
                // One step of an 8-bit weight.
                a.iter().zip(b).all(|(a, b)| (a * scale - b).abs() <= 1.0 / 255.0)
            })
        } else {
            a.values == b.values
        };
        assert!(same, "{}: {}", what.display(), a.name);
    }
}

/// Opens; if that works, writes all and a quarter of it, and reads both again.
fn round_trip(path: &Path) -> Result<(), decimesh::Error> {
    let document = Document::open(load(path))?;
    document.mesh().validate().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(document.layout().groups.len(), document.mesh().groups.len());
    let again = reopen(document.write(document.mesh(), Format::Glb)?);
    assert_same(document.mesh(), again.mesh(), path);
    let fewer = thinned(document.mesh());
    let again = reopen(document.write(&fewer, Format::Glb)?);
    assert_eq!(again.mesh().triangles.len(), fewer.triangles.len(), "{}", path.display());
    Ok(())
}

#[test]
fn fixtures_survive() {
    let models = models_under(&fixtures());
    assert!(models.len() >= 8, "fixtures are missing");
    for path in models {
        round_trip(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }
}

#[test]
fn dropped_extensions_are_told() {
    let document = Document::open(load(&fixtures().join("BoxPrimitiveOutline.gltf"))).unwrap();
    assert_eq!(document.warnings()[0].code, "extension-dropped");
    let (tree, _) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert!(!tree.to_string().contains("\"CESIUM_primitive_outline\""));
    let document = Document::open(load(&fixtures().join("meshopt-fallback/meshopt-fallback.gltf"))).unwrap();
    let (tree, _) = take_apart(&document.write(document.mesh(), Format::Glb).unwrap());
    assert_eq!(tree["extensionsUsed"], json!(["KHR_mesh_quantization"]));
    assert_eq!(tree["buffers"].as_array().unwrap().len(), 1);
}

#[test]
fn real_files_survive() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    if !assets.is_dir() {
        println!("skipped: real_files_survive (../shared/assets is not there)");
        return;
    }
    let mut opened = 0;
    for path in models_under(&assets) {
        let is_model = path.strip_prefix(&assets).unwrap().starts_with("gltf");
        match round_trip(&path) {
            Ok(()) => opened += 1,
            Err(error) => {
                assert!(!error.place().contains("/shared/"), "{error}");
                use ErrorCode::{MissingResource, NoTriangles, Syntax, Unsupported};
                let known = [NoTriangles, Unsupported, MissingResource];
                let by_hand = ["magnum", "validator-ok"].iter().any(|part| path.iter().any(|p| p == *part));
                assert!(!is_model || known.contains(&error.code()) || (by_hand && error.code() == Syntax), "{error}");
            }
        }
    }
    assert!(opened > 100, "only {opened} could be opened");
}
