//! From every format to every other: the geometry always, attributes where both can hold them, and
//! one warning for what is lost.

use decimesh::document::{Document, Format};
use decimesh::mesh::{Attribute, Blend, Mesh};
use decimesh::simplify::{Simplifier, SimplifyOptions};

use super::{attribute, open, points, support, write};

/// A tube with normals, texture coordinates and colours of whole bytes, as a document of `format`.
fn source(format: Format) -> Document {
    let mut mesh = support::tube_with_seam(12, 5);
    let colors: Vec<f32> =
        (0..mesh.positions.len()).flat_map(|i| [i % 256, 128, 255 - i % 256]).map(|c| c as f32 / 255.0).collect();
    mesh.wedge_sets[0].attributes.push(Attribute {
        name: "COLOR_0".into(),
        components: 3,
        values: colors,
        blend: Blend::Linear,
    });
    let text = ply_text(&mesh);
    let document = open(text);
    if format == Format::Ply { document } else { open(write(&document, format)) }
}

fn ply_text(mesh: &Mesh) -> String {
    let set = &mesh.wedge_sets[0];
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", mesh.positions.len());
    for name in ["x", "y", "z", "nx", "ny", "nz", "s", "t"] {
        text += &format!("property float {name}\n");
    }
    for name in ["red", "green", "blue"] {
        text += &format!("property uchar {name}\n");
    }
    text += &format!("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangles.len());
    for (i, p) in mesh.positions.iter().enumerate() {
        let mut row: Vec<String> = p.iter().map(f32::to_string).collect();
        for attribute in &set.attributes {
            let scale = if attribute.name == "COLOR_0" { 255.0 } else { 1.0 };
            let values = &attribute.values[i * attribute.components..][..attribute.components];
            row.extend(values.iter().map(|v| (v * scale).to_string()));
        }
        text += &format!("{}\n", row.join(" "));
    }
    for [a, b, c] in &mesh.triangles {
        text += &format!("3 {a} {b} {c}\n");
    }
    text
}

fn assert_near(a: &Document, b: &Document, name: &str, tolerance: f32) {
    let values = |document: &Document| -> Vec<f32> {
        let mesh = document.mesh();
        let mut values = Vec::new();
        for group in &mesh.groups {
            let set = &mesh.wedge_sets[group.wedge_set];
            let attribute = set.attributes.iter().find(|a| a.name == name).unwrap_or_else(|| panic!("no {name}"));
            for &wedge in mesh.triangles[group.triangles.clone()].iter().flatten() {
                let at = (wedge as usize - set.wedges.start) * attribute.components;
                values.extend(&attribute.values[at..at + attribute.components.min(3)]);
            }
        }
        values
    };
    for (x, y) in values(a).into_iter().zip(values(b)) {
        assert!((x - y).abs() <= tolerance, "{name}: {x} {y}");
    }
}

#[test]
fn every_format_becomes_every_other() {
    for from in Format::OUTPUT {
        let document = source(from);
        for to in Format::OUTPUT {
            let converted = open(write(&document, to));
            assert_eq!(converted.format(), to);
            assert_eq!(points(converted.mesh()), points(document.mesh()), "{from:?} -> {to:?}");
            let losses = document.losses(to).map(|warning| warning.message);
            if from == Format::Stl {
                assert_eq!(losses, None);
                continue;
            }
            if to == Format::Stl {
                let message = "STL cannot hold what the file has: normals, texture coordinates, colours";
                assert_eq!(losses.as_deref(), Some(message));
                continue;
            }
            assert_eq!(losses, None, "{from:?} -> {to:?}");
            if from != Format::Glb && to != Format::Glb {
                for name in ["NORMAL", "TEXCOORD_0", "COLOR_0"] {
                    assert_near(
                        &converted,
                        &document,
                        name,
                        if to == Format::Off || to == Format::Ply { 1e-6 } else { 0.0 },
                    );
                }
            }
            // Back again, through what each takes for the direction of v and for the scale of colours.
            let back = open(write(&converted, from));
            for name in ["NORMAL", "TEXCOORD_0", "COLOR_0"] {
                assert_near(&back, &document, name, 1e-5);
            }
        }
    }
}

#[test]
fn colours_are_linear_in_gltf_alone() {
    let ply = source(Format::Ply);
    let glb = open(write(&ply, Format::Glb));
    // 128 of 255 in sRGB is 0.2158605 of the light.
    assert!((attribute(&glb, "COLOR_0").unwrap().values[1] - 0.215_860_5).abs() < 1e-6);
    for format in [Format::Obj, Format::Ply, Format::Smf, Format::Off] {
        let back = open(write(&glb, format));
        assert!((attribute(&back, "COLOR_0").unwrap().values[1] - 128.0 / 255.0).abs() < 1e-6, "{format:?}");
    }
}

/// A GLB with other nodes, of which those in `shown` are in its scene.
fn with_nodes(glb: &[u8], nodes: serde_json::Value, shown: serde_json::Value) -> Vec<u8> {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut tree: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    tree["nodes"] = nodes;
    tree["scenes"][0] = serde_json::json!({ "nodes": shown });
    let mut json = tree.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let rest = &glb[20 + length..];
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend(((20 + json.len() + rest.len()) as u32).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(&json);
    out.extend(rest);
    out
}

#[test]
fn a_scene_that_shows_nothing_makes_no_file() {
    let bytes = write(&open(write(&source(Format::Ply), Format::Glb)), Format::Glb);
    let hidden = open(with_nodes(&bytes, serde_json::json!([{}]), serde_json::json!([0])));
    for format in [Format::Ply, Format::Stl, Format::Off, Format::Smf] {
        let error = hidden.write(hidden.mesh(), format).unwrap_err();
        assert_eq!(error.code(), decimesh::ErrorCode::NoTriangles, "{format:?}");
    }
}

#[test]
fn placed_and_mirrored_parts_of_a_scene_are_written_where_they_stand() {
    let glb = open(write(&source(Format::Ply), Format::Glb));
    let bytes = write(&glb, Format::Glb);
    // The same mesh again, mirrored and moved.
    let nodes = serde_json::json!([{ "mesh": 0 }, { "mesh": 0, "scale": [-1, 1, 1], "translation": [10, 0, 0] }]);
    let scene = open(with_nodes(&bytes, nodes, serde_json::json!([0, 1])));
    let one = points(glb.mesh());
    for format in [Format::Ply, Format::Stl, Format::Off, Format::Smf] {
        let flat = open(write(&scene, format));
        let found = points(flat.mesh());
        assert_eq!(found.len(), 2 * one.len());
        assert_eq!(found[..one.len()], one);
        for (triangle, original) in found[one.len()..].as_chunks::<3>().0.iter().zip(one.as_chunks::<3>().0) {
            let mirrored = original.map(|[x, y, z]| [10.0 - x, y, z]);
            assert_eq!(*triangle, [mirrored[0], mirrored[2], mirrored[1]], "wound the other way round");
        }
    }
}

#[test]
fn parts_of_one_surface_stay_together() {
    // A side with normals meets one without: a GLB stores their edge twice, one list of vertices once.
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nusemtl a\nf 1//1 2//1 3//1\nusemtl b\nf 1 3 4\n";
    let glb = open(write(&open(obj), Format::Glb));
    assert_eq!(glb.mesh().positions.len(), 6);
    let off = open(write(&glb, Format::Off));
    assert_eq!(off.mesh().positions.len(), 4);
    let loss = glb.losses(Format::Off).unwrap();
    let message = "OFF cannot hold what the file has: normals, materials";
    assert_eq!((loss.code, loss.message.as_str()), ("not-carried", message));
    assert_eq!(open(obj).losses(Format::Obj), None);
}

#[test]
fn every_format_can_be_simplified_and_written() {
    for from in Format::OUTPUT {
        let document = source(from);
        let mesh = document.mesh();
        let options = SimplifyOptions { target_triangle_count: mesh.triangles.len() / 2, ..SimplifyOptions::default() };
        let mut simplifier = Simplifier::new(mesh, &options).unwrap();
        while !simplifier.step(mesh, 1_000_000).done {}
        let sequence = simplifier.finish();
        let level = decimesh::lod::extract(mesh, &sequence, decimesh::lod::Level::Triangles(mesh.triangles.len() / 2));
        assert!(level.mesh.triangles.len() <= mesh.triangles.len() / 2);
        for to in Format::OUTPUT {
            let again = open(document.write(&level.mesh, to).unwrap());
            assert_eq!(again.mesh().triangles.len(), level.mesh.triangles.len(), "{from:?} -> {to:?}");
        }
    }
}
