//! Which accessor is which attribute: names, order, and what the names mean.

use crate::document::json_tree::{Members, Value};

use super::json::{index as as_index, items, members};
use super::layout::Shape;
use super::{AttributeSource, PrimitiveSource, SetSource};
use crate::mesh::Blend;

/// The attributes of a primitive in the order of the mesh: `POSITION`, then as in the file with
/// `WEIGHTS_n` after `JOINTS_n`, then those of the morph targets.
pub(super) fn list(primitive: &Value) -> Vec<AttributeSource> {
    // Looked up and not searched: there may be as many as the file has room for.
    let find = |name: &str| primitive["attributes"].get(name).and_then(as_index);
    let source = |target, name: &str, accessor| AttributeSource { target, semantic: name.to_owned(), accessor };
    let mut list: Vec<AttributeSource> = Vec::new();
    list.extend(find("POSITION").map(|position| source(None, "POSITION", position)));
    for (name, accessor) in members(primitive, "attributes") {
        let partner = |own: &str, other: &str| {
            let partner = name.strip_prefix(own).map(|n| format!("{other}{n}"))?;
            find(&partner).map(|accessor| (partner, accessor))
        };
        let Some(accessor) = as_index(accessor).filter(|_| name != "POSITION") else {
            continue;
        };
        if partner("WEIGHTS_", "JOINTS_").is_some() {
            continue;
        }
        list.push(source(None, name, accessor));
        list.extend(partner("JOINTS_", "WEIGHTS_").map(|(name, weights)| source(None, &name, weights)));
    }
    for (t, target) in items(primitive, "targets").iter().enumerate() {
        let deltas = target.as_object().into_iter().flat_map(Members::iter);
        let deltas = deltas.filter_map(|(name, accessor)| Some((name, as_index(accessor)?)));
        list.extend(deltas.map(|(name, accessor)| source(Some(t), name, accessor)));
    }
    list
}

impl SetSource {
    pub(super) fn blend(&self, attribute: usize) -> Blend {
        let AttributeSource { target, semantic, .. } = &self.attributes[attribute];
        let beside = |at: Option<usize>, name: String| {
            at.and_then(|at| self.attributes.get(at)).is_some_and(|a| a.target.is_none() && a.semantic == name)
        };
        if target.is_some() {
            return Blend::Linear;
        }
        match semantic.rsplit_once('_').unwrap_or((semantic, "")) {
            ("NORMAL", "") => Blend::Direction,
            ("TANGENT", "") => Blend::Tangent,
            ("TEXCOORD" | "COLOR", _) => Blend::Linear,
            // Joints or weights without the other mean nothing that could be blended.
            ("JOINTS", n) if beside(Some(attribute + 1), format!("WEIGHTS_{n}")) => Blend::Joints,
            ("WEIGHTS", n) if beside(attribute.checked_sub(1), format!("JOINTS_{n}")) => Blend::Weights,
            _ => Blend::Nearest,
        }
    }
}

impl AttributeSource {
    /// Its JSON path in a primitive.
    pub(super) fn place(&self, primitive: PrimitiveSource) -> String {
        match self.target {
            Some(target) => format!("{}.targets[{target}].{}", primitive.place(), self.semantic),
            None => format!("{}.attributes.{}", primitive.place(), self.semantic),
        }
    }

    /// The name in the mesh.
    pub(super) fn name(&self) -> String {
        match self.target {
            Some(target) => format!("TARGET_{target}/{}", self.semantic),
            None => self.semantic.clone(),
        }
    }

    pub(super) fn allows(&self, shape: Shape) -> bool {
        match self.semantic.split('_').next().unwrap_or_default() {
            "POSITION" | "NORMAL" => shape == Shape::Vec3,
            "TANGENT" => shape == if self.target.is_some() { Shape::Vec3 } else { Shape::Vec4 },
            "TEXCOORD" => shape == Shape::Vec2,
            "COLOR" => matches!(shape, Shape::Vec3 | Shape::Vec4),
            "JOINTS" | "WEIGHTS" => shape == Shape::Vec4,
            _ => true,
        }
    }
}
