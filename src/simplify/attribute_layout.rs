//! Which attributes count in the cost of a collapse, where each lies among a wedge's values, and by
//! what it is multiplied so that differences of all of them are lengths in engine space.

use crate::collapse_sequence::{SolvedAttribute, SolvedValues};
use crate::error::{Error, ErrorCode};
use crate::mesh::{Attribute, Blend, Mesh, WedgeSet};

/// A normal that is off by 1 is as bad as a position off by this share of the model's diagonal. Of
/// 0.003, 0.006, 0.01, 0.015 and 0.03 it looked best over twelve models at a quarter of their
/// triangles, see docs/engine.md.
const NORMAL: f32 = 0.01;

/// A texture that is displaced by a length is as bad as a surface displaced by this share of it.
const TEXTURE: f32 = 0.3;

/// As [`NORMAL`], for a colour from 0 to 1.
const COLOR: f32 = 0.02;

/// Morph targets that count; those behind them follow.
const MOST_TARGETS: usize = 8;

/// Begins the names of attributes that say where a skin moves its vertices, in the mesh's own unit; a number follows.
pub const POSE: &str = "POSE_";

/// What attributes weigh in the cost of a collapse, each as a multiple of a weight that is found for
/// the model; ≥ 0 and finite. 0: it is blended along, and nothing is done to keep it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttributeWeights {
    /// Normals. Default 1.
    pub normal: f32,
    /// Texture coordinates; the found weight makes a unit of them as long as it is on the surface on
    /// the average. Default 1.
    pub texture: f32,
    /// Colours. Default 1.
    pub color: f32,
    /// Displacements of morph targets, and of skins in poses, which are lengths by themselves. Default 1.
    pub morph: f32,
}

impl Default for AttributeWeights {
    fn default() -> Self {
        Self { normal: 1.0, texture: 1.0, color: 1.0, morph: 1.0 }
    }
}

impl AttributeWeights {
    /// # Errors
    /// `invalid-argument` for a weight that is negative or not finite.
    pub(super) fn validate(&self) -> Result<(), Error> {
        let Self { normal, texture, color, morph } = *self;
        for (name, weight) in [("normal", normal), ("uv", texture), ("color", color), ("morph", morph)] {
            if !(weight >= 0.0 && weight.is_finite()) {
                let place = format!("attributeWeights.{name}");
                return Err(Error::new(ErrorCode::InvalidArgument, place, "must be a number of at least 0"));
            }
        }
        Ok(())
    }
}

/// An attribute of a wedge set among the values of its wedges.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    /// Index in the set's attributes.
    pub(super) attribute: usize,
    pub(super) start: usize,
    pub(super) length: usize,
    pub(super) weight: f32,
}

/// The places of all attributes that count.
#[derive(Debug, Default)]
pub(super) struct Layout {
    /// Values of a wedge.
    pub(super) components: usize,
    /// Where normals begin, and what a unit normal's length is.
    pub(super) normal: Option<(usize, f32)>,
    /// Where colours begin, how many numbers they are, and what 1 is.
    pub(super) color: Option<(usize, usize, f32)>,
    /// By wedge set.
    pub(super) sets: Vec<Vec<Placed>>,
}

/// What an attribute is, in the order in which they lie. The same of different sets lie in one place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Meaning {
    Normal,
    Texture(u8),
    Color,
    Target(u8),
    Pose(u8),
}

impl Layout {
    /// Of the attributes that weigh anything; none if there are none.
    pub(super) fn new(
        mesh: &Mesh,
        weights: &AttributeWeights,
        engine_per_local: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let mut found: Vec<(Meaning, usize, Placed)> = Vec::new();
        for (s, set) in mesh.wedge_sets.iter().enumerate() {
            for (attribute, values) in set.attributes.iter().enumerate() {
                let Some(meaning) = meaning(values) else { continue };
                let per_local = engine_per_local(set.part) as f32;
                let (length, weight) = match meaning {
                    Meaning::Normal => (3, NORMAL * weights.normal),
                    Meaning::Texture(_) if weights.texture > 0.0 => {
                        (2, TEXTURE * weights.texture * texture_size(mesh, s, &values.values) * per_local)
                    }
                    Meaning::Texture(_) => (2, 0.0),
                    Meaning::Color => (values.components, COLOR * weights.color),
                    Meaning::Target(_) => (3, weights.morph * per_local),
                    Meaning::Pose(_) => (3, weights.morph * per_local),
                };
                if weight > 0.0 && weight.is_finite() {
                    found.push((meaning, s, Placed { attribute, start: 0, length, weight }));
                }
            }
        }
        found.sort_by_key(|f| f.0);
        let mut layout = Self { sets: vec![Vec::new(); mesh.wedge_sets.len()], ..Self::default() };
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let start = layout.components;
            let length = same.iter().map(|f| f.2.length).max().unwrap_or(0);
            layout.components += length;
            match same[0].0 {
                Meaning::Normal => layout.normal = Some((start, same[0].2.weight)),
                Meaning::Color => layout.color = Some((start, length, same[0].2.weight)),
                _ => {}
            }
            for &(_, set, placed) in same {
                // Of two names for the same in one set the first counts: they may differ, and have one place.
                if layout.sets[set].last().is_none_or(|last| last.start != start) {
                    layout.sets[set].push(Placed { start, ..placed });
                }
            }
        }
        (layout.components > 0).then_some(layout)
    }

    /// What is where in the values that a run records, none yet.
    pub(super) fn solved(&self) -> SolvedValues {
        let solved = |p: &Placed| SolvedAttribute { attribute: p.attribute, start: p.start, length: p.length };
        let layouts = self.sets.iter().map(|layout| layout.iter().map(solved).collect()).collect();
        SolvedValues { layouts, components: self.components, values: Vec::new() }
    }
}

/// By the names of glTF, and those of the package's arrays.
fn meaning(attribute: &Attribute) -> Option<Meaning> {
    let name = attribute.name.as_str();
    match (attribute.blend, attribute.components) {
        (Blend::Direction, 3) if matches!(name, "NORMAL" | "normal") => Some(Meaning::Normal),
        (Blend::Linear, 2) if matches!(name, "TEXCOORD_0" | "uv") => Some(Meaning::Texture(0)),
        (Blend::Linear, 2) if name == "TEXCOORD_1" => Some(Meaning::Texture(1)),
        (Blend::Linear, 3 | 4) if matches!(name, "COLOR_0" | "color") => Some(Meaning::Color),
        (Blend::Linear, 3) if name.starts_with(POSE) => Some(Meaning::Pose(name[POSE.len()..].parse().ok()?)),
        (Blend::Linear, 3) => {
            let target: u8 = name.strip_prefix("TARGET_")?.strip_suffix("/POSITION")?.parse().ok()?;
            (usize::from(target) < MOST_TARGETS).then_some(Meaning::Target(target))
        }
        _ => None,
    }
}

/// Local units that one unit of texture coordinates covers, by the areas of both; 0 where the
/// coordinates cover none.
fn texture_size(mesh: &Mesh, set: usize, values: &[f32]) -> f32 {
    let WedgeSet { wedges, .. } = &mesh.wedge_sets[set];
    let (mut surface, mut texture) = (0.0_f64, 0.0_f64);
    for t in mesh.groups.iter().filter(|g| g.wedge_set == set).flat_map(|g| &mesh.triangles[g.triangles.clone()]) {
        let [a, b, c] = t.map(|w| mesh.positions[w as usize].map(f64::from));
        let e: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
        let f: [f64; 3] = std::array::from_fn(|k| c[k] - a[k]);
        let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        surface += (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        let [a, b, c] = t.map(|w| {
            let at = 2 * (w as usize - wedges.start);
            [f64::from(values[at]), f64::from(values[at + 1])]
        });
        texture += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    }
    if texture > 0.0 { (surface / texture).sqrt() as f32 } else { 0.0 }
}
