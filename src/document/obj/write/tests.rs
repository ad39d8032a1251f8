//! Layouts that no OBJ file has: several parts and instances, matrices, glTF's texture direction.

use super::*;
use crate::document::Instance;
use crate::mesh::{Blend, Group, Part};

fn attribute(name: &str, components: usize, values: &[f32]) -> Attribute {
    Attribute { name: name.into(), components, values: values.to_vec(), blend: Blend::Linear }
}

/// A triangle with a normal and texture coordinates, placed by each of `matrices`.
fn placed(matrices: &[[f64; 16]]) -> (Mesh, SceneLayout) {
    let mesh = Mesh::from_arrays(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        vec![[0, 1, 2]],
        vec![
            attribute("NORMAL", 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
            attribute("TEXCOORD_0", 2, &[0.0, 0.25, 1.0, 0.25, 0.0, 1.0]),
            attribute("TEXCOORD_1", 2, &[0.0; 6]),
        ],
    );
    let label = GroupLabel { object: Some("leaf".into()), ..GroupLabel::default() };
    let instances = matrices.iter().map(|&world_from_local| Instance { part: 0, world_from_local }).collect();
    (mesh, SceneLayout { groups: vec![label], instances, ..SceneLayout::default() })
}

fn text(mesh: &Mesh, layout: &SceneLayout) -> String {
    mesh.validate().unwrap();
    String::from_utf8(write(mesh, layout, &[]).unwrap()).unwrap()
}

/// Column-major from the linear part's columns and a translation.
fn matrix(x: [f64; 3], y: [f64; 3], z: [f64; 3], t: [f64; 3]) -> [f64; 16] {
    [x[0], x[1], x[2], 0.0, y[0], y[1], y[2], 0.0, z[0], z[1], z[2], 0.0, t[0], t[1], t[2], 1.0]
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

#[test]
fn instances_are_placed_named_apart_and_share_texture_coordinates() {
    let (mesh, mut layout) = placed(&[matrix(X, Y, Z, [0.0; 3]), matrix(Y, Z, X, [10.0, 0.0, 0.0])]);
    let expected = "# Decimesh\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvt 1 0.25\nvt 0 1\nvn 0 0 1\n\
                    o leaf\nf 1/1/1 2/2/1 3/3/1\nv 10 0 0\nv 10 1 0\nv 10 0 1\nvn 1 0 0\n\
                    o leaf_2\nf 4/1/2 5/2/2 6/3/2\n";
    assert_eq!(text(&mesh, &layout), expected);
    layout.texture_v_down = true;
    assert!(text(&mesh, &layout).contains("vt 0 0.75\nvt 1 0.75\nvt 0 0\n"));
    layout.groups[0].object = None;
    assert!(text(&mesh, &layout).contains("\no object\n") && text(&mesh, &layout).contains("\no object_2\n"));
}

#[test]
fn mirrors_reverse_the_winding_and_stretching_keeps_normals_upright() {
    let (mesh, layout) = placed(&[matrix([-1.0, 0.0, 0.0], Y, Z, [0.0; 3])]);
    assert!(text(&mesh, &layout).ends_with(
        "v 0 0 0\nv -1 0 0\nv 0 1 0\nvt 0 0.25\nvt 1 0.25\nvt 0 1\nvn 0 0 1\no leaf\nf 1/1/1 3/3/1 2/2/1\n"
    ));
    // A shear tips the surface z = 0 over: (x, y, z) to (x, y, z + 3 x), normal (-3, 0, 1) / √10.
    let (mesh, layout) = placed(&[matrix([1.0, 0.0, 3.0], Y, Z, [0.0; 3])]);
    assert!(text(&mesh, &layout).contains("vn -0.9486833 0 0.31622776\n"));
    // Flattened to the plane z = 0 the normal is still defined.
    let (mesh, layout) = placed(&[matrix(X, Y, [0.0; 3], [0.0; 3])]);
    assert!(text(&mesh, &layout).contains("vn 0 0 1\n"));
}

#[test]
fn parts_may_be_absent_or_share_a_name() {
    let (mut mesh, mut layout) = placed(&[matrix(X, Y, Z, [0.0; 3])]);
    mesh.positions.extend([[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
    mesh.triangles.extend([[3, 4, 5], [3, 5, 4]]);
    mesh.wedge_sets.push(WedgeSet { wedges: 3..6, part: 1, attributes: Vec::new() });
    mesh.groups.push(Group { triangles: 1..2, wedge_set: 1 });
    mesh.groups.push(Group { triangles: 2..3, wedge_set: 1 });
    mesh.parts.push(Part { scale: 1.0 });
    layout.groups.push(layout.groups[0].clone());
    layout.groups.push(GroupLabel { material: Some(" a\nb \\".into()), ..layout.groups[0].clone() });
    assert!(!text(&mesh, &layout).contains("v 5"));
    layout.instances.push(Instance { part: 1, world_from_local: matrix(X, Y, Z, [0.0; 3]) });
    let end = "v 5 0 0\nv 6 0 0\nv 5 1 0\no leaf_2\nf 4 5 6\nusemtl a b \\ \nf 4 6 5\n";
    assert!(text(&mesh, &layout).ends_with(end), "{}", text(&mesh, &layout));
    layout.instances.push(Instance { part: 9, world_from_local: [0.0; 16] });
    assert!(text(&mesh, &layout).ends_with(end));
}

#[test]
fn opaque_colours_are_written_without_alpha() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]];
    let colors = [1.0, 0.0, 0.5, 1.0].repeat(4);
    let mut mesh = Mesh::from_arrays(positions, vec![[0, 1, 2], [3, 2, 1]], vec![attribute("COLOR_0", 4, &colors)]);
    let (_, layout) = placed(&[matrix(X, Y, Z, [0.0; 3])]);
    let expected = "# Decimesh\nv 0 0 0 1 0 0.5\nv 1 0 0 1 0 0.5\nv 0 1 0 1 0 0.5\no leaf\nf 1 2 3\nf 1 3 2\n";
    assert_eq!(text(&mesh, &layout), expected);
    // Another colour at the same place is another vertex.
    mesh.wedge_sets[0].attributes[0].values[15] = 0.5;
    let expected = "# Decimesh\nv 0 0 0 1 0 0.5 1\nv 1 0 0 1 0 0.5 1\nv 0 1 0 1 0 0.5 1\nv 0 0 0 1 0 0.5 0.5\n\
                    o leaf\nf 1 2 3\nf 4 3 2\n";
    assert_eq!(text(&mesh, &layout), expected);
}

#[test]
fn what_cannot_be_written_is_an_error() {
    let (mesh, layout) = placed(&[matrix(X, Y, Z, [0.0; 3]), matrix(X, Y, Z, [1e39, 0.0, 0.0])]);
    let error = write(&mesh, &layout, &[]).unwrap_err();
    assert_eq!((error.code(), error.place()), (ErrorCode::NotFinite, "instances[1]"));
    let (mesh, mut layout) = placed(&[matrix(X, Y, Z, [0.0; 3])]);
    layout.instances = vec![layout.instances[0].clone(); 1000];
    let groups = vec![Group { triangles: 0..100_000, wedge_set: 0 }];
    let mesh = Mesh { triangles: vec![[0, 1, 2]; 100_000], groups, ..mesh };
    let error = write(&mesh, &layout, &[]).unwrap_err();
    assert_eq!((error.code(), error.place()), (ErrorCode::TooLarge, "instances"));
}
