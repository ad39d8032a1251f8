//! Who needs an accessor or a buffer view besides the triangles that are replaced?
//!
//! What nobody is known to use is kept: an extension that is not understood may.

use crate::document::json_tree::{Members, Value};

use super::PrimitiveSource;
use super::json::{extension, for_each_extension, index as as_index, items, members, uint};
use super::schema::{DRACO_EXTENSION, MESHOPT_EXTENSIONS};

/// What may be overwritten: true where only replaced triangles used it.
pub(super) struct Replaceable {
    pub(super) accessors: Vec<bool>,
    pub(super) views: Vec<bool>,
}

/// Looks through the tree as read, with the primitives that will be replaced.
pub(super) fn replaceable(tree: &Value, replaced: &[PrimitiveSource]) -> Replaceable {
    let mut accessors = Marks::new(items(tree, "accessors").len());
    let mut views = Marks::new(items(tree, "bufferViews").len());
    let mut replaced = replaced.iter().peekable();
    for (mesh, json) in items(tree, "meshes").iter().enumerate() {
        for (primitive, json) in items(json, "primitives").iter().enumerate() {
            // Both lists have the order of the file.
            let is_replaced = replaced.next_if_eq(&&PrimitiveSource { mesh, primitive }).is_some();
            let targets =
                items(json, "targets").iter().filter_map(Value::as_object).flat_map(Members::iter).map(|(_, v)| v);
            let used = members(json, "attributes").map(|(_, v)| v).chain(json.get("indices")).chain(targets);
            used.filter_map(as_index).for_each(|accessor| accessors.mark(accessor, is_replaced));
            let draco = extension(json, DRACO_EXTENSION).and_then(|draco| uint(draco, "bufferView"));
            draco.into_iter().for_each(|view| views.mark(view, is_replaced));
        }
    }
    for animation in items(tree, "animations") {
        for sampler in items(animation, "samplers") {
            ["input", "output"].iter().filter_map(|key| uint(sampler, key)).for_each(|a| accessors.mark(a, false));
        }
    }
    for skin in items(tree, "skins") {
        uint(skin, "inverseBindMatrices").into_iter().for_each(|a| accessors.mark(a, false));
    }
    for image in items(tree, "images") {
        uint(image, "bufferView").into_iter().for_each(|view| views.mark(view, false));
    }
    for_each_extension(tree, &mut |name, value| {
        if name != DRACO_EXTENSION && !MESHOPT_EXTENSIONS.contains(&name) {
            mark_references(value, &mut accessors, &mut views);
        }
    });
    for (i, accessor) in items(tree, "accessors").iter().enumerate() {
        let sparse = &accessor["sparse"];
        let used = [accessor, &sparse["indices"], &sparse["values"]];
        for view in used.iter().filter_map(|json| uint(json, "bufferView")) {
            views.mark(view, accessors.is_replaceable(i));
        }
    }
    Replaceable { accessors: accessors.finish(), views: views.finish() }
}

/// Extensions refer by keys of these names, or (instancing) like a primitive's attributes.
fn mark_references(value: &Value, accessors: &mut Marks, views: &mut Marks) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| mark_references(value, accessors, views)),
        Value::Object(object) => {
            for (key, value) in object.iter() {
                match (key, as_index(value)) {
                    ("bufferView", Some(view)) => views.mark(view, false),
                    ("accessor" | "indices" | "input" | "output", Some(accessor)) => {
                        accessors.mark(accessor, false);
                    }
                    _ => mark_references(value, accessors, views),
                }
            }
            members(value, "attributes").filter_map(|(_, v)| as_index(v)).for_each(|a| accessors.mark(a, false));
        }
        _ => {}
    }
}

struct Marks {
    used: Vec<bool>,
    kept: Vec<bool>,
}

impl Marks {
    fn new(count: usize) -> Self {
        Self { used: vec![false; count], kept: vec![false; count] }
    }

    fn mark(&mut self, index: usize, is_replaced: bool) {
        if let (Some(used), Some(kept)) = (self.used.get_mut(index), self.kept.get_mut(index)) {
            *used = true;
            *kept |= !is_replaced;
        }
    }

    fn is_replaceable(&self, index: usize) -> bool {
        self.used[index] && !self.kept[index]
    }

    fn finish(&self) -> Vec<bool> {
        (0..self.used.len()).map(|index| self.is_replaceable(index)).collect()
    }
}
