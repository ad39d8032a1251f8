//! A glTF file for a mesh that came from another format: the smallest tree that names its parts.

use crate::document::json_tree::Value;

use super::json::object;
use super::resource::Content;
use super::write::{array, write};
use super::{AttributeSource, GltfSource, PrimitiveSource, SetSource, materials};
use crate::document::color::to_linear;
use crate::document::{Format, GroupLabel, SceneLayout};
use crate::error::{Error, ErrorCode};
use crate::mesh::{Attribute, Group, Mesh, WedgeSet};

/// A GLB file with a glTF mesh and node for each object, a primitive for each group that has
/// triangles, and a material for each name: the layout's of that name, or a neutral one.
///
/// # Errors
/// What [`Mesh::validate`] finds; `invalid-argument` for an attribute of a width that glTF lacks;
/// `no-triangles` for an empty mesh; `too-large` beyond 4 GiB.
pub(in crate::document) fn write_new(mesh: &Mesh, layout: &SceneLayout) -> Result<Vec<u8>, Error> {
    mesh.validate()?;
    if mesh.triangles.is_empty() {
        return Err(Error::new(ErrorCode::NoTriangles, "mesh", "a glTF mesh cannot be empty"));
    }
    let empty = || Value::Array(Vec::new());
    let mut tree = object(vec![
        ("asset", object(vec![("version", "2.0".into()), ("generator", "Decimesh".into())])),
        ("scene", 0.into()),
        ("scenes", vec![object(vec![("nodes", empty())])].into()),
        ("nodes", empty()),
        ("meshes", empty()),
        ("accessors", empty()),
    ]);
    let (mesh, labels) = used_part(mesh, layout);
    let sets: Vec<SetSource> = mesh.wedge_sets.iter().map(|set| declare(&mut tree, set)).collect::<Result<_, _>>()?;
    let mut primitives = Vec::new();
    let mut objects: Vec<&Option<String>> = Vec::new();
    let mut materials: Vec<materials::Use<'_>> = Vec::new();
    for (group, label) in mesh.groups.iter().zip(&labels) {
        let owner = objects.iter().position(|known| **known == label.object).unwrap_or_else(|| {
            objects.push(&label.object);
            add_object(&mut tree, label.object.as_deref())
        });
        let mut primitive = object(vec![("attributes", object(Vec::new()))]);
        for attribute in &sets[group.wedge_set].attributes {
            primitive["attributes"][&*attribute.semantic] = attribute.accessor.into();
        }
        if let Some(name) = label.material.as_deref() {
            let has_texcoords = sets[group.wedge_set].attributes.iter().any(|a| a.semantic == "TEXCOORD_0");
            let wanted = materials::Use::new(name, has_texcoords, &layout.materials);
            let material = materials.iter().position(|known| *known == wanted).unwrap_or_else(|| {
                materials.push(wanted);
                materials.len() - 1
            });
            primitive["material"] = material.into();
        }
        let siblings = array(&mut tree["meshes"][owner], "primitives");
        siblings.push(primitive);
        primitives.push(PrimitiveSource { mesh: owner, primitive: siblings.len() - 1 });
    }
    let images = materials::add(&mut tree, &materials, &layout.materials);
    // The writer edits trees, so it gets this one as if it had been read, with all data still to come.
    let source = GltfSource {
        format: Format::Glb,
        mesh: Mesh::default(),
        layout: SceneLayout::default(),
        warnings: Vec::new(),
        tree,
        files: Vec::new(),
        buffers: Vec::new(),
        images: images.into_iter().map(|image| Content::Owned(image.to_vec())).collect(),
        primitives,
        sets,
    };
    write(&source, &mesh)
}

/// The mesh without empty groups and unused wedge sets, in glTF's conventions, and the labels of
/// its groups.
fn used_part(mesh: &Mesh, layout: &SceneLayout) -> (Mesh, Vec<GroupLabel>) {
    let mut out = Mesh { parts: mesh.parts.clone(), ..Mesh::default() };
    let mut labels = Vec::new();
    let mut renumbered: Vec<Option<usize>> = vec![None; mesh.wedge_sets.len()];
    for (g, group) in mesh.groups.iter().enumerate().filter(|(_, group)| !group.triangles.is_empty()) {
        let old = &mesh.wedge_sets[group.wedge_set];
        let wedge_set = *renumbered[group.wedge_set].get_or_insert_with(|| {
            let start = out.positions.len();
            out.positions.extend_from_slice(&mesh.positions[old.wedges.clone()]);
            let attributes = old.attributes.iter().map(|a| convert(a, layout)).collect();
            out.wedge_sets.push(WedgeSet { wedges: start..out.positions.len(), part: old.part, attributes });
            out.wedge_sets.len() - 1
        });
        let (from, to) = (old.wedges.start as u32, out.wedge_sets[wedge_set].wedges.start as u32);
        let start = out.triangles.len();
        let triangles = mesh.triangles[group.triangles.clone()].iter();
        out.triangles.extend(triangles.map(|triangle| triangle.map(|wedge| wedge - from + to)));
        out.groups.push(Group { triangles: start..out.triangles.len(), wedge_set });
        labels.push(layout.groups.get(g).cloned().unwrap_or_default());
    }
    (out, labels)
}

/// Texture coordinates have two components and v downwards, colours are linear, normals have unit length, and names
/// that glTF does not know begin with `_`.
fn convert(attribute: &Attribute, layout: &SceneLayout) -> Attribute {
    let mut out = attribute.clone();
    if out.name.starts_with("TEXCOORD_") && out.components >= 2 {
        out.values = out.values.chunks_exact(out.components).flat_map(|uvw| [uvw[0], uvw[1]]).collect();
        out.components = 2;
        if !layout.texture_v_down {
            out.values.chunks_exact_mut(2).for_each(|uv| uv[1] = 1.0 - uv[1]);
        }
    }
    if out.name.starts_with("COLOR_") && out.components >= 3 && !layout.has_linear_colors {
        out.values.chunks_exact_mut(out.components).for_each(|c| c[..3].iter_mut().for_each(|c| *c = to_linear(*c)));
    }
    if out.name == "NORMAL" && out.components == 3 {
        out.values.chunks_exact_mut(3).for_each(make_unit);
    }
    let base = out.name.split('_').next().unwrap_or_default();
    if !["NORMAL", "TANGENT", "TEXCOORD", "COLOR", ""].contains(&base) {
        out.name.insert(0, '_');
    }
    out
}

/// A normal without length says nothing, but glTF wants one of length 1 all the same.
fn make_unit(normal: &mut [f32]) {
    let length = normal.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
    if length > 0.0 {
        normal.iter_mut().for_each(|c| *c = (f64::from(*c) / length) as f32);
    } else {
        normal.copy_from_slice(&[0.0, 0.0, 1.0]);
    }
}

/// Accessors for the attributes of a set, with no data yet.
fn declare(tree: &mut Value, set: &WedgeSet) -> Result<SetSource, Error> {
    let columns =
        std::iter::once(("POSITION", 3)).chain(set.attributes.iter().map(|a| (a.name.as_str(), a.components)));
    let mut attributes = Vec::new();
    for (name, components) in columns {
        let shape = match components {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            9 => "MAT3",
            16 => "MAT4",
            _ => {
                let message = format!("glTF has no attribute of {components} numbers");
                return Err(Error::new(ErrorCode::InvalidArgument, name, message));
            }
        };
        let accessors = array(tree, "accessors");
        accessors.push(object(vec![("componentType", 5126.into()), ("count", 1.into()), ("type", shape.into())]));
        attributes.push(AttributeSource { target: None, semantic: name.to_owned(), accessor: accessors.len() - 1 });
    }
    Ok(SetSource { attributes })
}

/// A mesh and its node in the scene; the index of the mesh.
fn add_object(tree: &mut Value, name: Option<&str>) -> usize {
    let name = name.map(|name| ("name", Value::from(name)));
    let mut node = object(name.clone().into_iter().collect());
    let mesh = object(name.into_iter().chain([("primitives", Value::Array(Vec::new()))]).collect());
    let meshes = array(tree, "meshes");
    meshes.push(mesh);
    let index = meshes.len() - 1;
    node["mesh"] = index.into();
    let nodes = array(tree, "nodes");
    nodes.push(node);
    let node_index = nodes.len() - 1;
    array(&mut tree["scenes"][0], "nodes").push(node_index.into());
    index
}
