//! The text of an OBJ file from a mesh: distinct elements once, faces that refer to them.
//!
//! Each appearance of a part is written in place, in world coordinates; OBJ has no transforms.
//! Elements come in the order of the wedges and triangles in their own order, so reading the text
//! again gives the same triangles, corner for corner and bit for bit.

use std::collections::{BTreeMap, BTreeSet};

use crate::document::color::to_srgb;
use crate::document::flat::{color, normal, texcoord};
use crate::document::place::Placement;
use crate::document::row_table::RowTable;
use crate::document::text::Text;
use crate::document::{GroupLabel, SceneLayout};
use crate::error::{Error, ErrorCode};
use crate::mesh::{Attribute, Mesh, WedgeSet};

/// For unnamed objects where a file needs to tell several apart.
const UNNAMED_OBJECT: &str = "object";

/// The text of `mesh`, placed and named by `layout`. Attributes other than `NORMAL`, `TEXCOORD_0`
/// and `COLOR_0` have no form in OBJ and are not written; nor are wedges without a triangle.
/// `smoothing_groups` has the `s` of each group, or is empty.
///
/// # Errors
/// `not-finite` if a placement moves a vertex beyond the range of `f32`; `too-large` if the text
/// would exceed 2 GB.
pub(super) fn write(mesh: &Mesh, layout: &SceneLayout, smoothing_groups: &[Option<String>]) -> Result<Vec<u8>, Error> {
    let mut text = Text::with_capacity(estimated_length(mesh, layout)?);
    text.line("# Decimesh", "");
    for library in &layout.material_libraries {
        text.line("mtllib", library);
    }
    let elements = Elements::new(mesh, layout.has_linear_colors);
    let mut names = Names::new(layout);
    let mut last_smoothing = None;
    // Elements written so far, by kind. Texture coordinates are the same in every instance.
    let (mut v_count, mut vn_count, mut vt_count) = (0, 0, 0);
    let mut first_vt: Vec<Option<usize>> = vec![None; mesh.parts.len()];
    for (i, instance) in layout.instances.iter().enumerate() {
        let Some(part) = elements.parts.get(instance.part) else { continue };
        let placement = Placement::new(&instance.world_from_local);
        let not_finite = || Error::new(ErrorCode::NotFinite, format!("instances[{i}]"), "moves a vertex out of range");
        for &wedge in &part.v {
            let position = placement.position(mesh.positions[wedge]).ok_or_else(not_finite)?;
            text.numbers("v", &position);
            if let Some(color) = elements.color(wedge) {
                text.more_numbers(&color[..if elements.has_alpha { 4 } else { 3 }]);
            }
            text.end_line();
        }
        let vt_base = *first_vt[instance.part].get_or_insert_with(|| {
            for &[u, v] in part.vt.rows() {
                let v = f32::from_bits(v);
                text.numbers("vt", &[f32::from_bits(u), if layout.texture_v_down { 1.0 - v } else { v }]);
                text.end_line();
            }
            vt_count += part.vt.rows().len();
            vt_count - part.vt.rows().len()
        });
        for &row in part.vn.rows() {
            text.numbers("vn", &placement.normal(row.map(f32::from_bits)));
            text.end_line();
        }
        let bases = [v_count, vt_base, vn_count];
        v_count += part.v.len();
        vn_count += part.vn.rows().len();
        for (number, group) in mesh.groups.iter().enumerate() {
            let set = &mesh.wedge_sets[group.wedge_set];
            if set.part != instance.part || group.triangles.is_empty() {
                continue;
            }
            names.write(&mut text, i, layout.groups.get(number));
            let smoothing = smoothing_groups.get(number).and_then(Option::as_deref);
            if smoothing != last_smoothing {
                text.line("s", smoothing.unwrap_or("off"));
                last_smoothing = smoothing;
            }
            let form = [texcoord(set).is_some(), normal(set).is_some()];
            for &[a, b, c] in &mesh.triangles[group.triangles.clone()] {
                let corners = if placement.is_mirrored() { [a, c, b] } else { [a, b, c] };
                text.face(corners.map(|wedge| elements.indices(wedge as usize, bases)), form);
            }
        }
    }
    Ok(text.into_bytes())
}

/// Bytes to reserve; an error if they, counted low, cannot be held in 32 bits.
fn estimated_length(mesh: &Mesh, layout: &SceneLayout) -> Result<usize, Error> {
    let mut triangle_counts = vec![0_u64; mesh.parts.len()];
    for group in &mesh.groups {
        triangle_counts[mesh.wedge_sets[group.wedge_set].part] += group.triangles.len() as u64;
    }
    let total = layout
        .instances
        .iter()
        .map(|instance| triangle_counts.get(instance.part).copied().unwrap_or(0))
        .fold(0_u64, u64::saturating_add);
    // A face takes about 24 bytes, and half a vertex per triangle about 16.
    usize::try_from(total.saturating_mul(40))
        .ok()
        .filter(|&length| length < i32::MAX as usize)
        .ok_or_else(|| Error::new(ErrorCode::TooLarge, "instances", "the text would exceed 2 GB"))
}

/// Distinct elements of every part, and which of them each wedge uses.
struct Elements {
    parts: Vec<PartElements>,
    /// `[v, vt, vn]` of each wedge, counted from 0 within its part.
    of_wedge: Vec<[u32; 3]>,
    /// RGBA of each wedge; empty if the mesh has no colours.
    colors: Vec<Option<[f32; 4]>>,
    /// Some colour is not opaque.
    has_alpha: bool,
}

/// Distinct elements of one part, in the order of its wedges.
struct PartElements {
    /// The first wedge with each distinct position (and colour).
    v: Vec<usize>,
    vt: RowTable<2>,
    vn: RowTable<3>,
}

impl Elements {
    fn new(mesh: &Mesh, has_linear_colors: bool) -> Self {
        let mut is_used = vec![false; mesh.positions.len()];
        for &wedge in mesh.triangles.iter().flatten() {
            is_used[wedge as usize] = true;
        }
        let colors = colors(mesh, has_linear_colors);
        let has_alpha = colors.iter().flatten().any(|color| color[3].to_bits() != 1.0_f32.to_bits());
        let mut of_wedge = vec![[0; 3]; mesh.positions.len()];
        let parts = (0..mesh.parts.len())
            .map(|part| {
                let sets = || mesh.wedge_sets.iter().filter(|set| set.part == part);
                let wedges = sets().flat_map(|set| set.wedges.clone()).filter(|&wedge| is_used[wedge]);
                let v = if colors.is_empty() {
                    distinct(wedges, &mut of_wedge, |wedge| mesh.positions[wedge].map(f32::to_bits))
                } else {
                    distinct(wedges, &mut of_wedge, |wedge| {
                        let ([x, y, z], [r, g, b, a]) = (mesh.positions[wedge], colors[wedge].unwrap_or([1.0; 4]));
                        [x, y, z, r, g, b, a].map(f32::to_bits)
                    })
                };
                let (mut vt, mut vn) = (RowTable::new(), RowTable::new());
                for set in sets() {
                    number_rows(texcoord(set), set, &is_used, &mut vt, |wedge, row| of_wedge[wedge][1] = row);
                    number_rows(normal(set), set, &is_used, &mut vn, |wedge, row| of_wedge[wedge][2] = row);
                }
                PartElements { v, vt, vn }
            })
            .collect();
        Self { parts, of_wedge, colors, has_alpha }
    }

    fn color(&self, wedge: usize) -> Option<[f32; 4]> {
        self.colors.get(wedge).copied().flatten()
    }

    /// Indices as OBJ counts them, from 1 over the whole file.
    #[inline]
    fn indices(&self, wedge: usize, bases: [usize; 3]) -> [usize; 3] {
        let [v, vt, vn] = self.of_wedge[wedge];
        [v as usize + bases[0] + 1, vt as usize + bases[1] + 1, vn as usize + bases[2] + 1]
    }
}

/// Numbers the distinct `row`s of the wedges, stores each wedge's as its first element, and
/// returns the first wedge of each.
fn distinct<const N: usize>(
    wedges: impl Iterator<Item = usize>,
    of_wedge: &mut [[u32; 3]],
    row: impl Fn(usize) -> [u32; N],
) -> Vec<usize> {
    let mut table = RowTable::new();
    let mut firsts = Vec::new();
    for wedge in wedges {
        let number = table.number(row(wedge));
        of_wedge[wedge][0] = number;
        if number as usize == firsts.len() {
            firsts.push(wedge);
        }
    }
    firsts
}

/// Numbers the values of one attribute of one set by their bits.
fn number_rows<const N: usize>(
    attribute: Option<&Attribute>,
    set: &WedgeSet,
    is_used: &[bool],
    table: &mut RowTable<N>,
    mut store: impl FnMut(usize, u32),
) {
    let Some(attribute) = attribute else { return };
    for (wedge, values) in set.wedges.clone().zip(attribute.values.as_chunks::<N>().0) {
        if is_used[wedge] {
            store(wedge, table.number(values.map(f32::to_bits)));
        }
    }
}

/// The colour of each wedge that has one; empty if none has.
fn colors(mesh: &Mesh, is_linear: bool) -> Vec<Option<[f32; 4]>> {
    if !mesh.wedge_sets.iter().any(|set| color(set).is_some()) {
        return Vec::new();
    }
    let mut colors = vec![None; mesh.positions.len()];
    for set in &mesh.wedge_sets {
        let Some(attribute) = color(set) else { continue };
        for (wedge, values) in set.wedges.clone().zip(attribute.values.chunks_exact(attribute.components)) {
            let [r, g, b] = [values[0], values[1], values[2]].map(|c| if is_linear { to_srgb(c) } else { c });
            colors[wedge] = Some([r, g, b, values.get(3).copied().unwrap_or(1.0)]);
        }
    }
    colors
}

/// Writes `o`, `g` and `usemtl` where they change, and keeps the names of objects apart.
struct Names<'a> {
    /// What the last lines said.
    object: Option<String>,
    group: Option<&'a str>,
    material: Option<&'a str>,
    /// An unnamed object would merge with others.
    has_several_instances: bool,
    /// The object names that were written.
    taken: BTreeSet<String>,
    /// The name of each instance and label.
    given: BTreeMap<(usize, &'a str), String>,
    /// The suffix to try next, by label.
    suffixes: BTreeMap<&'a str, usize>,
}

impl<'a> Names<'a> {
    fn new(layout: &SceneLayout) -> Self {
        Self {
            object: None,
            group: None,
            material: None,
            has_several_instances: layout.instances.len() > 1,
            taken: BTreeSet::new(),
            given: BTreeMap::new(),
            suffixes: BTreeMap::new(),
        }
    }

    fn write(&mut self, text: &mut Text, instance: usize, label: Option<&'a GroupLabel>) {
        let object = label.and_then(|label| label.object.as_deref());
        let object = object.or(self.has_several_instances.then_some(UNNAMED_OBJECT));
        let object = object.map(|label| self.object_name(instance, label));
        if self.object != object {
            text.line("o", object.as_deref().unwrap_or_default());
            self.object = object;
        }
        let group = label.and_then(|label| label.group.as_deref());
        if self.group != group {
            text.line("g", group.unwrap_or_default());
            self.group = group;
        }
        let material = label.and_then(|label| label.material.as_deref());
        if self.material != material {
            text.line("usemtl", material.unwrap_or_default());
            self.material = material;
        }
    }

    /// `label`, or `label_2`, `label_3` … if another instance or label has that name already.
    fn object_name(&mut self, instance: usize, label: &'a str) -> String {
        if let Some(name) = self.given.get(&(instance, label)) {
            return name.clone();
        }
        let mut name = label.to_owned();
        while self.taken.contains(&name) {
            let suffix = self.suffixes.entry(label).or_insert(1);
            *suffix += 1;
            name = format!("{label}_{suffix}");
        }
        self.taken.insert(name.clone());
        self.given.insert((instance, label), name.clone());
        name
    }
}

#[cfg(test)]
mod tests;
