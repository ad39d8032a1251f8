//! Morph targets that the file stores as their few elements that are not zero: so are those of the output.

use decimesh::document::Format;
use serde_json::json;

use super::*;

const SIDE: usize = 20;

/// A grid of 400 vertices whose target moves every vertex from `first` on, as a sparse accessor.
fn grid(first: usize) -> (Value, Vec<u8>) {
    let mut binary = Vec::new();
    for v in 0..SIDE * SIDE {
        binary.extend([(v % SIDE) as f32, (v / SIDE) as f32, 0.0].map(f32::to_le_bytes).concat());
    }
    let positions = binary.len();
    let corners = (0..SIDE * (SIDE - 1)).filter(|v| v % SIDE + 1 < SIDE);
    let indices: Vec<usize> = corners.flat_map(|v| [v, v + 1, v + SIDE, v + SIDE, v + 1, v + SIDE + 1]).collect();
    indices.iter().for_each(|&i| binary.extend((i as u16).to_le_bytes()));
    let after_indices = binary.len();
    let moved = first..SIDE * SIDE;
    moved.clone().for_each(|v| binary.extend((v as u16).to_le_bytes()));
    binary.resize(binary.len().next_multiple_of(4), 0);
    let values = binary.len();
    moved.clone().for_each(|v| binary.extend([0.0, 0.0, v as f32].map(f32::to_le_bytes).concat()));
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "targets": [{ "POSITION": 2 }] }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 400, "type": "VEC3", "min": [0, 0, 0], "max": [19, 19, 0] },
            { "bufferView": 1, "componentType": 5123, "count": indices.len(), "type": "SCALAR" },
            {
                "componentType": 5126, "count": 400, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 399],
                "sparse": {
                    "count": moved.len(),
                    "indices": { "bufferView": 2, "componentType": 5123 },
                    "values": { "bufferView": 3 }
                }
            }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": positions },
            { "buffer": 0, "byteOffset": positions, "byteLength": after_indices - positions },
            { "buffer": 0, "byteOffset": after_indices, "byteLength": 2 * moved.len() },
            { "buffer": 0, "byteOffset": values, "byteLength": 12 * moved.len() }
        ],
        "buffers": [{ "byteLength": binary.len() }]
    });
    (json, binary)
}

/// Writes the grid and gives its target's accessor, after comparing the values.
#[track_caller]
fn written_target(first: usize) -> (Value, usize) {
    let (json, binary) = grid(first);
    let document = open_glb(&json, binary).unwrap();
    let bytes = document.write(document.mesh(), Format::Glb).unwrap();
    let tree = take_apart(&bytes).0;
    assert_eq!(reopen(bytes.clone()).mesh(), document.mesh());
    (tree["accessors"][2].clone(), bytes.len())
}

#[test]
fn few_elements_stay_few() {
    let (target, size) = written_target(390);
    assert_eq!(target["sparse"]["count"], 10);
    assert_eq!(target["sparse"]["indices"]["componentType"], 5123);
    assert_eq!((target.get("bufferView"), &target["max"]), (None, &json!([0.0, 0.0, 399.0])));
    assert!(size < written_target(0).1 - 4000, "{size}");
}

#[test]
fn many_elements_are_stored_as_a_list() {
    let (target, _) = written_target(20);
    assert_eq!((target.get("sparse"), target["count"].as_u64()), (None, Some(400)));
}

#[test]
fn what_has_become_zero_needs_no_bytes() {
    let (json, binary) = grid(390);
    let document = open_glb(&json, binary).unwrap();
    let mut mesh = document.mesh().clone();
    mesh.wedge_sets[0].attributes[0].values.fill(0.0);
    let bytes = document.write(&mesh, Format::Glb).unwrap();
    let target = take_apart(&bytes).0["accessors"][2].clone();
    assert_eq!((target.get("sparse"), target.get("bufferView"), &target["max"]), (None, None, &json!([0.0, 0.0, 0.0])));
    assert_eq!(reopen(bytes).mesh(), &mesh);
}
