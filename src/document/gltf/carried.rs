//! The part of the tree that is only carried through: what is wrong there, or becomes so, is told.

use crate::document::json_tree::Value;

use super::json::{index, items};
use super::spot::Spot;
use crate::error::Warning;

/// References outside of the geometry: the way to them (`*` is each element or member), and the
/// array that they number.
const REFERENCES: [(&[&str], &str); 10] = [
    (&["animations", "*", "samplers", "*", "input"], "accessors"),
    (&["animations", "*", "samplers", "*", "output"], "accessors"),
    (&["animations", "*", "channels", "*", "target", "node"], "nodes"),
    (&["images", "*", "bufferView"], "bufferViews"),
    (&["nodes", "*", "camera"], "cameras"),
    (&["skins", "*", "skeleton"], "nodes"),
    (&["textures", "*", "source"], "images"),
    (&["textures", "*", "sampler"], "samplers"),
    (&["materials", "*", "*", "index"], "textures"),
    (&["materials", "*", "pbrMetallicRoughness", "*", "index"], "textures"),
];

/// One warning for each list that something refers past the end of.
pub(super) fn warn_of_dangling(tree: &Value, warnings: &mut Vec<Warning>) {
    for (way, list) in REFERENCES {
        let count = items(tree, list).len();
        let mut first: Option<(String, usize)> = None;
        let mut more = 0usize;
        visit(&Spot::root(tree), way, &mut |spot| {
            if index(spot.value).is_none_or(|index| index >= count) {
                more += usize::from(first.is_some());
                first.get_or_insert_with(|| (spot.path(), count));
            }
        });
        if let Some((place, count)) = first {
            let others = if more > 0 { format!(", as do {more} others") } else { String::new() };
            let message =
                format!("refers to one of {count} {list} that does not exist{others}; carried through unchanged");
            warnings.push(Warning { code: "schema", message, place });
        }
    }
}

/// One warning for the first feature ids that are the numbers of the vertices, which change.
pub(super) fn warn_of_implicit_ids(tree: &Value, warnings: &mut Vec<Warning>) {
    let way = ["meshes", "*", "primitives", "*", "extensions", "EXT_mesh_features", "featureIds", "*"];
    let mut first = None;
    visit(&Spot::root(tree), &way, &mut |ids| {
        if first.is_none() && ids.value.get("attribute").is_none() && ids.value.get("texture").is_none() {
            first = Some(ids.path());
        }
    });
    if let Some(place) = first {
        let message = "the feature ids are the numbers of the vertices, which change; they are not kept".to_owned();
        warnings.push(Warning { code: "implicit-feature-ids", message, place });
    }
}

/// Calls `found` with everything at the end of `way`.
fn visit(spot: &Spot<'_, '_>, way: &[&str], found: &mut dyn FnMut(&Spot<'_, '_>)) {
    match way.split_first() {
        None => found(spot),
        Some((step, rest)) => spot.children(step, &mut |child| visit(child, rest, found)),
    }
}
