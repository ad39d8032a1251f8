//! The part of the tree that is only carried through: what is wrong there, or becomes so, is told.

use serde_json::Value;

use super::json::{index, items};
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
        visit(tree, way, &mut String::new(), &mut |place, value| {
            if index(value).is_none_or(|index| index >= count) {
                more += usize::from(first.is_some());
                first.get_or_insert_with(|| (place.to_owned(), count));
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
    visit(tree, &way, &mut String::new(), &mut |place, ids| {
        if first.is_none() && ids.get("attribute").is_none() && ids.get("texture").is_none() {
            first = Some(place.to_owned());
        }
    });
    if let Some(place) = first {
        let message = "the feature ids are the numbers of the vertices, which change; they are not kept".to_owned();
        warnings.push(Warning { code: "implicit-feature-ids", message, place });
    }
}

/// Calls `found` with the path and value of everything at the end of `way`.
fn visit(value: &Value, way: &[&str], place: &mut String, found: &mut dyn FnMut(&str, &Value)) {
    let Some((step, rest)) = way.split_first() else {
        return found(place, value);
    };
    let length = place.len();
    match value {
        Value::Array(values) if *step == "*" => {
            for (i, value) in values.iter().enumerate() {
                place.push_str(&format!("[{i}]"));
                visit(value, rest, place, found);
                place.truncate(length);
            }
        }
        Value::Object(object) => {
            for (key, value) in object.iter().filter(|(key, _)| *step == "*" || *step == *key) {
                if length > 0 {
                    place.push('.');
                }
                place.push_str(key);
                visit(value, rest, place, found);
                place.truncate(length);
            }
        }
        _ => {}
    }
}
