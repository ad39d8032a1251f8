//! `Mesh`: one indexed triangle set with attributes, the only thing the simplifier sees of a file.
//!
//! A *wedge* is one set of attribute values at a position: what glTF calls a vertex and OBJ a
//! `v/vt/vn` tuple. Several wedges may share one position; [`weld`] finds which, and the
//! simplifier moves them together. Wedges are stored in [`WedgeSet`]s, one for each set of
//! accessors of the file, because the primitives of a file differ in which attributes they have.

pub mod attribute;
pub(crate) mod chart;
pub mod weld;

pub use attribute::{Attribute, Blend};

use std::ops::Range;

use crate::error::{Error, ErrorCode};

/// One indexed triangle set: positions and attributes per wedge, triangles in groups.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Position of each wedge, in the local space of its part, in the file's units.
    pub positions: Vec<[f32; 3]>,
    /// Wedge indices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Consecutive triangle ranges that together cover `triangles`: one for each primitive.
    pub groups: Vec<Group>,
    /// Consecutive wedge ranges that together cover `positions`.
    pub wedge_sets: Vec<WedgeSet>,
    /// Welding domains: wedges of different parts never share a vertex.
    pub parts: Vec<Part>,
}

/// The triangles of one primitive (one material of one object).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Range in [`Mesh::triangles`]; may be empty.
    pub triangles: Range<usize>,
    /// Index in [`Mesh::wedge_sets`] of the wedges these triangles use.
    pub wedge_set: usize,
}

/// Wedges that carry the same attributes.
#[derive(Debug, Clone, PartialEq)]
pub struct WedgeSet {
    /// Range in [`Mesh::positions`].
    pub wedges: Range<usize>,
    /// Index in [`Mesh::parts`].
    pub part: usize,
    /// Attribute values for just this range, in the order of the file.
    pub attributes: Vec<Attribute>,
}

/// A set of wedges in one local space, e.g. one glTF mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// World units in one local unit where the part appears largest; > 0, finite, 1 if unknown.
    /// Errors of different parts are compared, and reported, in world units.
    pub scale: f32,
}

impl Mesh {
    /// A mesh of one group, set and part from bare arrays.
    #[must_use]
    pub fn from_arrays(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>, attributes: Vec<Attribute>) -> Self {
        let (wedges, triangle_count) = (0..positions.len(), triangles.len());
        Self {
            positions,
            triangles,
            groups: vec![Group { triangles: 0..triangle_count, wedge_set: 0 }],
            wedge_sets: vec![WedgeSet { wedges, part: 0, attributes }],
            parts: vec![Part { scale: 1.0 }],
        }
    }

    /// Checks every invariant named in the fields' documentation.
    ///
    /// # Errors
    /// `out-of-range` for a bad index, `not-finite` for NaN or infinity, `invalid-argument` for
    /// ranges and lengths that do not fit; the place names the first offender.
    pub fn validate(&self) -> Result<(), Error> {
        let fail = |code, place: String, message: &str| Err(Error::new(code, place, message));
        let mut next = 0;
        for (i, set) in self.wedge_sets.iter().enumerate() {
            if set.wedges.start != next || set.wedges.end < next {
                return fail(ErrorCode::InvalidArgument, format!("wedge_sets[{i}]"), "ranges must be consecutive");
            }
            next = set.wedges.end;
            if set.part >= self.parts.len() {
                return fail(ErrorCode::OutOfRange, format!("wedge_sets[{i}].part"), "no such part");
            }
            for (k, attribute) in set.attributes.iter().enumerate() {
                if attribute.components == 0 || attribute.values.len() != set.wedges.len() * attribute.components {
                    return fail(
                        ErrorCode::InvalidArgument,
                        format!("wedge_sets[{i}].attributes[{k}]"),
                        "length must be wedge count times components",
                    );
                }
                if let Some(at) = attribute.values.iter().position(|v| !v.is_finite()) {
                    return fail(
                        ErrorCode::NotFinite,
                        format!("{}[{}]", attribute.name, at / attribute.components),
                        "attribute values must be finite",
                    );
                }
            }
        }
        if next != self.positions.len() {
            return fail(ErrorCode::InvalidArgument, "wedge_sets".into(), "ranges must cover all positions");
        }
        if self.positions.len() >= u32::MAX as usize || self.triangles.len() >= u32::MAX as usize / 4 {
            return fail(ErrorCode::TooLarge, "mesh".into(), "more than a billion elements");
        }
        for (i, part) in self.parts.iter().enumerate() {
            if !(part.scale > 0.0 && part.scale.is_finite()) {
                return fail(ErrorCode::InvalidArgument, format!("parts[{i}].scale"), "must be positive");
            }
        }
        if let Some(at) = self.positions.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            return fail(ErrorCode::NotFinite, format!("positions[{at}]"), "positions must be finite");
        }
        let mut next = 0;
        for (i, group) in self.groups.iter().enumerate() {
            if group.triangles.start != next || group.triangles.end < next || group.triangles.end > self.triangles.len()
            {
                return fail(ErrorCode::InvalidArgument, format!("groups[{i}]"), "ranges must be consecutive");
            }
            next = group.triangles.end;
            let Some(set) = self.wedge_sets.get(group.wedge_set) else {
                return fail(ErrorCode::OutOfRange, format!("groups[{i}].wedge_set"), "no such wedge set");
            };
            for (t, triangle) in self.triangles[group.triangles.clone()].iter().enumerate() {
                if !triangle.iter().all(|&w| set.wedges.contains(&(w as usize))) {
                    return fail(
                        ErrorCode::OutOfRange,
                        format!("triangles[{}]", group.triangles.start + t),
                        "index outside of the vertices",
                    );
                }
            }
        }
        if next != self.triangles.len() {
            return fail(ErrorCode::InvalidArgument, "groups".into(), "ranges must cover all triangles");
        }
        Ok(())
    }

    /// Bytes of all positions, attributes and triangles.
    #[must_use]
    pub fn byte_count(&self) -> u64 {
        let values: usize = self.wedge_sets.iter().flat_map(|set| &set.attributes).map(|a| a.values.len()).sum();
        (size_of_val(self.positions.as_slice()) + size_of_val(self.triangles.as_slice()) + 4 * values) as u64
    }

    /// One component of an attribute for each wedge, 0 where a wedge has none: `name` is the attribute's, or the name
    /// and a component, `COLOR_0.g` (of x y z w or r g b a); without one the first.
    ///
    /// # Errors
    /// `invalid-argument` if no wedge set has it; the message lists what there is.
    pub fn channel(&self, name: &str) -> Result<Vec<f32>, Error> {
        let has = |name: &str| self.wedge_sets.iter().flat_map(|set| &set.attributes).any(|a| a.name == name);
        let (base, component) = match name.rsplit_once('.') {
            Some((base, letter)) if !has(name) => {
                (base, ["xr", "yg", "zb", "wa"].iter().position(|two| letter.len() == 1 && two.contains(letter)))
            }
            _ => (name, Some(0)),
        };
        let mut values = vec![0.0; self.positions.len()];
        let mut found = false;
        for set in &self.wedge_sets {
            for attribute in set.attributes.iter().filter(|a| a.name == base) {
                if let Some(component) = component.filter(|&c| c < attribute.components) {
                    found = true;
                    for (value, of) in
                        values[set.wedges.clone()].iter_mut().zip(attribute.values.chunks(attribute.components))
                    {
                        *value = of[component];
                    }
                }
            }
        }
        if found {
            return Ok(values);
        }
        let mut names: Vec<&str> =
            self.wedge_sets.iter().flat_map(|set| &set.attributes).map(|a| a.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        let known = if names.is_empty() { "nothing".into() } else { names.join(", ") };
        Err(Error::new(
            ErrorCode::InvalidArgument,
            "weightAttribute",
            format!("no vertex has '{name}'; there is {known}"),
        ))
    }

    /// Length of the bounding box's diagonal over the referenced wedges, parts scaled to world
    /// units; the unit of relative errors. 0 for an empty mesh.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        let parts = self.groups.iter().filter_map(|g| Some((g, self.wedge_sets.get(g.wedge_set)?.part)));
        self.diagonal_of(parts.flat_map(|(group, part)| {
            self.triangles[group.triangles.clone()].iter().flatten().map(move |&w| (w, part))
        }))
    }

    /// As [`Mesh::diagonal`], over the given wedges and their parts.
    pub(crate) fn diagonal_of(&self, wedges: impl Iterator<Item = (u32, usize)>) -> f64 {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (w, part) in wedges {
            let (p, scale) = (self.positions[w as usize], f64::from(self.parts[part].scale));
            for k in 0..3 {
                let c = f64::from(p[k]) * scale;
                low[k] = if c < low[k] { c } else { low[k] };
                high[k] = if c > high[k] { c } else { high[k] };
            }
        }
        let squared: f64 = (0..3).map(|k| (high[k] - low[k]).max(0.0).powi(2)).sum();
        squared.sqrt()
    }
}
