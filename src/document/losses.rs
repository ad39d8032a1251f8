//! What a file has and another format cannot hold.
//!
//! | | glb | obj | ply | stl | off | smf |
//! | --- | --- | --- | --- | --- | --- | --- |
//! | normals, texture coordinates | + | + | + | – | + | + |
//! | colours of vertices | + | + | + | – ¹ | + | + ² |
//! | names of objects and materials | + | + | – | – | – | – |
//! | materials with their textures | + | – ³ | – | – | – | – |
//! | several sets of attributes, skins, animations, nodes | + | – | – | – | – | – |
//!
//! ¹ from STL with colours of facets. ² without alpha. ³ from OBJ: its libraries are named.

use super::json_tree::Value;

use super::{Format, SceneLayout};
use crate::error::Warning;
use crate::mesh::Mesh;

/// One warning that names everything, or `None`. `gltf` is the tree of a glTF.
pub(super) fn losses(
    source: Format,
    mesh: &Mesh,
    layout: &SceneLayout,
    gltf: Option<&Value>,
    has_facet_colors: bool,
    target: Format,
) -> Option<Warning> {
    if matches!(target, Format::Glb | Format::Gltf) {
        return None;
    }
    let mut lost: Vec<&str> = Vec::new();
    let mut note = |is_lost: bool, what: &'static str| {
        if is_lost && !lost.contains(&what) {
            lost.push(what);
        }
    };
    let has = |name: &str| mesh.wedge_sets.iter().any(|set| set.attributes.iter().any(|a| a.name == name));
    // Formats with one list of vertices have normals for all or for none.
    let has_all_normals = mesh.wedge_sets.iter().all(|set| set.attributes.iter().any(|a| a.name == "NORMAL"));
    let is_stl = target == Format::Stl;
    note(has("NORMAL") && (is_stl || target != Format::Obj && !has_all_normals), "normals");
    note(has("TEXCOORD_0") && is_stl, "texture coordinates");
    note(has("COLOR_0") && is_stl && !has_facet_colors, "colours");
    let has_alpha = || {
        let mut sets = mesh.wedge_sets.iter().flat_map(|set| &set.attributes);
        sets.any(|a| a.name == "COLOR_0" && a.components == 4)
    };
    note(target == Format::Smf && has_alpha(), "alpha of colours");
    for attribute in mesh.wedge_sets.iter().flat_map(|set| &set.attributes) {
        note(attribute.name.starts_with("TEXCOORD_") && attribute.name != "TEXCOORD_0", "further texture coordinates");
        note(attribute.name.starts_with("COLOR_") && attribute.name != "COLOR_0", "further colours");
        note(attribute.name == "TANGENT", "tangents");
        note(attribute.name.starts_with('_'), "attributes of its own");
        note(attribute.name.starts_with("TARGET_") || attribute.name.starts_with("TARGET/"), "morph targets");
    }
    if target != Format::Obj {
        let label = |find: fn(&super::GroupLabel) -> bool| layout.groups.iter().any(find);
        note(label(|label| label.object.is_some() || label.group.is_some()), "names");
        note(label(|label| label.material.is_some()) && source != target, "materials");
    } else if source != Format::Obj {
        note(!layout.materials.list.is_empty(), "materials");
    }
    let count = |list: &str| gltf.and_then(|tree| tree.get(list)).and_then(Value::as_array).map_or(0, Vec::len);
    note(count("materials") > 0, "materials");
    note(count("skins") > 0, "skins");
    note(count("animations") > 0, "animations");
    note(count("cameras") > 0, "cameras");
    (!lost.is_empty()).then(|| Warning {
        code: "not-carried",
        message: format!("{} cannot hold what the file has: {}", target.as_str().to_ascii_uppercase(), lost.join(", ")),
        place: String::new(),
    })
}
