//! A mesh from vertices and polygons as a file lists them: triangles, wedges, groups.
//!
//! Vertices keep their order and become wedges as they are, unless faces or their corners have
//! values of their own; then a wedge is a distinct combination of vertex and values, numbered by
//! first use.

use super::content::Content;
use super::notice::{DEGENERATE_FACE, DEGENERATE_TRIANGLE, Kind, Notices, SMALL_FACE, UNTRIANGULATED_FACE};
use super::polygon::Triangulator;
use super::row_table::RowTable;
use super::{GroupLabel, Instance, SceneLayout};
use crate::error::{Error, ErrorCode};
use crate::mesh::{Attribute, Blend, Group, Mesh, Part, WedgeSet};

static FACE_COLORS_BLENDED: Kind =
    ("face-colors-blended", "file whose faces nearly all differ in colour; vertices have the mean of theirs");

/// The unit matrix, column-major.
pub(super) const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Sizes a list may be reserved at before its elements are known to be there.
const MOST_RESERVED: usize = 1 << 16;

/// As many colours as an indexed image has: more are shading and not paint.
const FEW_COLORS: usize = 256;

/// A vertex and values of its own for one corner of a face, by the numbers that
/// [`Faces::normal`], [`Faces::texcoord`] and [`Faces::color`] give; 0 for none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    pub(super) normal: u32,
    pub(super) texcoord: u32,
    pub(super) color: u32,
}

impl Corner {
    #[inline]
    fn has_values(&self) -> bool {
        (self.normal | self.texcoord | self.color) != 0
    }
}

/// Takes vertices and polygons.
#[derive(Debug)]
pub(super) struct Faces {
    /// The vertices so far.
    pub(super) positions: Vec<[f32; 3]>,
    /// Values for each vertex, in the order they are to have in the mesh.
    pub(super) attributes: Vec<Attribute>,
    /// How values that belong to corners blend: facets keep theirs.
    pub(super) color_blend: Blend,
    /// What was left out.
    pub(super) notices: Notices,
    /// Wedges by vertex and values; `None` while each vertex is a wedge.
    wedges: Option<RowTable<4>>,
    normals: RowTable<3>,
    texcoords: RowTable<2>,
    colors: RowTable<4>,
    triangles: Vec<[u32; 3]>,
    /// Start in `triangles` and name.
    groups: Vec<(usize, Option<String>)>,
    triangulator: Triangulator,
    /// The polygon at hand without corners that repeat.
    corners: Vec<Corner>,
    points: Vec<[f32; 3]>,
}

impl Faces {
    /// Nothing yet.
    pub(super) fn new() -> Self {
        Self {
            positions: Vec::new(),
            attributes: Vec::new(),
            color_blend: Blend::Linear,
            notices: Notices::default(),
            wedges: None,
            normals: RowTable::new(),
            texcoords: RowTable::new(),
            colors: RowTable::new(),
            triangles: Vec::new(),
            groups: Vec::new(),
            triangulator: Triangulator::new(),
            corners: Vec::new(),
            points: Vec::new(),
        }
    }

    /// The number of a normal for [`Corner::normal`].
    #[inline(never)]
    pub(super) fn normal(&mut self, value: [f32; 3]) -> u32 {
        self.normals.number(value.map(f32::to_bits)) + 1
    }

    /// The number of a texture coordinate for [`Corner::texcoord`].
    #[inline(never)]
    pub(super) fn texcoord(&mut self, value: [f32; 2]) -> u32 {
        self.texcoords.number(value.map(f32::to_bits)) + 1
    }

    /// The number of a colour (RGBA) for [`Corner::color`].
    #[inline(never)]
    pub(super) fn color(&mut self, value: [f32; 4]) -> u32 {
        self.colors.number(value.map(f32::to_bits)) + 1
    }

    /// Faces from here on belong to a group called `name`.
    pub(super) fn begin_group(&mut self, name: Option<String>) {
        self.groups.push((self.triangles.len(), name));
    }

    /// Room for `count` triangles, within reason: the count is only what a header says.
    pub(super) fn reserve(&mut self, count: usize) {
        self.triangles.reserve(count.min(MOST_RESERVED));
    }

    /// Adds a polygon. `place` says where it is in the file.
    ///
    /// # Errors
    /// `out-of-range` for a vertex that there is not.
    #[inline(never)]
    pub(super) fn polygon(&mut self, corners: &[Corner], place: &dyn Fn() -> String) -> Result<(), Error> {
        let count = self.positions.len();
        for corner in corners {
            if corner.vertex as usize >= count {
                let message = format!("vertex {} of {count}, counted from 0", corner.vertex);
                return Err(Error::new(ErrorCode::OutOfRange, place(), message));
            }
        }
        if self.wedges.is_none() && corners.iter().any(Corner::has_values) {
            self.tell_wedges_apart();
        }
        if let &[a, b, c] = corners {
            let points = [a, b, c].map(|corner| self.positions[corner.vertex as usize]);
            if points[0] == points[1] || points[1] == points[2] || points[2] == points[0] {
                self.notices.count(&DEGENERATE_FACE, place);
            } else {
                let triangle = [self.wedge(a), self.wedge(b), self.wedge(c)];
                self.triangles.push(triangle);
            }
            return Ok(());
        }
        self.larger_polygon(corners, place);
        Ok(())
    }

    /// From here on a vertex may have several wedges.
    #[cold]
    fn tell_wedges_apart(&mut self) {
        let mut wedges = RowTable::new();
        for wedge in self.triangles.iter_mut().flatten() {
            *wedge = wedges.number([*wedge, 0, 0, 0]);
        }
        self.wedges = Some(wedges);
    }

    fn larger_polygon(&mut self, corners: &[Corner], place: &dyn Fn() -> String) {
        if corners.len() < 3 {
            self.notices.count(&SMALL_FACE, place);
            return;
        }
        self.corners.clear();
        self.points.clear();
        for &corner in corners {
            let point = self.positions[corner.vertex as usize];
            if self.points.last() != Some(&point) {
                self.points.push(point);
                self.corners.push(corner);
            }
        }
        while self.points.len() > 1 && self.points.first() == self.points.last() {
            self.points.pop();
            self.corners.pop();
        }
        if self.points.len() < 3 {
            self.notices.count(&DEGENERATE_FACE, place);
            return;
        }
        let (pieces, is_regular) = self.triangulator.triangulate(&self.points);
        if !is_regular {
            self.notices.count(&UNTRIANGULATED_FACE, place);
        }
        for &[a, b, c] in pieces {
            let points = &self.points;
            if points[a] == points[b] || points[b] == points[c] || points[c] == points[a] {
                self.notices.count(&DEGENERATE_TRIANGLE, place);
            } else {
                let wedges = &mut self.wedges;
                self.triangles.push([a, b, c].map(|corner| wedge_of(wedges, self.corners[corner])));
            }
        }
    }

    #[inline]
    fn wedge(&mut self, corner: Corner) -> u32 {
        wedge_of(&mut self.wedges, corner)
    }

    /// The mesh: one part, one wedge set, the groups that have triangles.
    ///
    /// # Errors
    /// `too-large` beyond a billion elements.
    pub(super) fn finish(mut self, file: &str) -> Result<Content, Error> {
        self.blend_scattered_colors(file);
        let (positions, attributes) = match &self.wedges {
            None => (std::mem::take(&mut self.positions), std::mem::take(&mut self.attributes)),
            Some(wedges) => self.split(wedges),
        };
        let count = positions.len();
        if count >= u32::MAX as usize || self.triangles.len() >= u32::MAX as usize / 4 {
            return Err(Error::new(ErrorCode::TooLarge, file, "more than a billion elements"));
        }
        let mut mesh = Mesh {
            positions,
            triangles: self.triangles,
            groups: Vec::new(),
            wedge_sets: vec![WedgeSet { wedges: 0..count, part: 0, attributes }],
            parts: vec![Part { scale: 1.0 }],
        };
        let mut layout =
            SceneLayout { instances: vec![Instance { part: 0, world_from_local: IDENTITY }], ..SceneLayout::default() };
        if self.groups.first().is_none_or(|&(start, _)| start > 0) {
            self.groups.insert(0, (0, None));
        }
        let ends = self.groups.iter().skip(1).map(|&(start, _)| start).chain([mesh.triangles.len()]);
        let ends: Vec<usize> = ends.collect();
        for ((start, object), end) in self.groups.into_iter().zip(ends).filter(|((start, _), end)| end > start) {
            let primitive = layout.groups.len();
            layout.groups.push(GroupLabel { object, primitive, ..GroupLabel::default() });
            mesh.groups.push(Group { triangles: start..end, wedge_set: 0 });
        }
        Ok(Content { mesh, layout, warnings: self.notices.into_warnings() })
    }

    /// Colours of faces that differ nearly everywhere (shading of a scan, say) would tear the surface
    /// into faces that nothing can simplify: they become the mean at each vertex. Few colours, or
    /// many on patches, stay as they are.
    fn blend_scattered_colors(&mut self, file: &str) {
        let Some(wedges) = &self.wedges else { return };
        if self.colors.rows().len() <= FEW_COLORS {
            return;
        }
        let mut blended: RowTable<4> = RowTable::new();
        let number_of: Vec<u32> = wedges.rows().iter().map(|&[v, n, t, _]| blended.number([v, n, t, 0])).collect();
        if wedges.rows().len() <= 2 * blended.rows().len() {
            return;
        }
        let mut sums = vec![[0.0_f64; 5]; blended.rows().len()];
        for (row, &number) in wedges.rows().iter().zip(&number_of).filter(|(row, _)| row[3] != 0) {
            let color = self.colors.rows()[row[3] as usize - 1].map(f32::from_bits);
            let sum = &mut sums[number as usize];
            (0..4).for_each(|channel| sum[channel] += f64::from(color[channel]));
            sum[4] += 1.0;
        }
        let mut colors = RowTable::new();
        let mut rows = RowTable::new();
        for (&[v, n, t, _], sum) in blended.rows().iter().zip(&sums) {
            #[allow(clippy::cast_possible_truncation)] // rounding is what is wanted
            let mean = [0, 1, 2, 3].map(|channel| (sum[channel] / sum[4].max(1.0)) as f32);
            let color = if sum[4] > 0.0 { colors.number(mean.map(f32::to_bits)) + 1 } else { 0 };
            rows.number([v, n, t, color]);
        }
        for wedge in self.triangles.iter_mut().flatten() {
            *wedge = number_of[*wedge as usize];
        }
        self.colors = colors;
        self.wedges = Some(rows);
        self.color_blend = Blend::Linear;
        self.notices.count(&FACE_COLORS_BLENDED, &|| file.to_owned());
    }

    /// The wedges' positions and attributes: what the corners say, else what their vertices say.
    fn split(&self, wedges: &RowTable<4>) -> (Vec<[f32; 3]>, Vec<Attribute>) {
        let rows = wedges.rows();
        let positions = rows.iter().map(|row| self.positions[row[0] as usize]).collect();
        let mut attributes = Vec::new();
        let own = |name: &str| match name {
            "NORMAL" => !self.normals.rows().is_empty(),
            "TEXCOORD_0" => !self.texcoords.rows().is_empty(),
            "COLOR_0" => !self.colors.rows().is_empty(),
            _ => false,
        };
        let add = |attributes: &mut Vec<Attribute>, name: &str, components, values, blend| {
            attributes.push(Attribute { name: name.into(), components, values, blend });
        };
        if own("NORMAL") {
            let values = column(rows, 1, self.normals.rows(), [0.0, 0.0, 1.0]);
            add(&mut attributes, "NORMAL", 3, values.into_flattened(), Blend::Direction);
        }
        if own("TEXCOORD_0") {
            let values = column(rows, 2, self.texcoords.rows(), [0.0; 2]);
            add(&mut attributes, "TEXCOORD_0", 2, values.into_flattened(), Blend::Linear);
        }
        if own("COLOR_0") {
            let values = column(rows, 3, self.colors.rows(), [1.0; 4]);
            attributes.push(color_attribute(values, self.color_blend));
        }
        for attribute in self.attributes.iter().filter(|attribute| !own(&attribute.name)) {
            let n = attribute.components;
            let of = |row: &[u32; 4]| &attribute.values[row[0] as usize * n..][..n];
            let values = rows.iter().flat_map(of).copied().collect();
            add(&mut attributes, &attribute.name, n, values, attribute.blend);
        }
        (positions, attributes)
    }
}

#[inline(never)]
fn wedge_of(wedges: &mut Option<RowTable<4>>, corner: Corner) -> u32 {
    match wedges {
        None => corner.vertex,
        Some(table) => table.number([corner.vertex, corner.normal, corner.texcoord, corner.color]),
    }
}

/// Each row's value by the number in its column `at`; number 0 is `absent`.
fn column<const N: usize>(rows: &[[u32; 4]], at: usize, values: &[[u32; N]], absent: [f32; N]) -> Vec<[f32; N]> {
    let value = |row: &[u32; 4]| match row[at] {
        0 => absent,
        number => values[number as usize - 1].map(f32::from_bits),
    };
    rows.iter().map(value).collect()
}

/// `COLOR_0` of three numbers if all colours are opaque, else of four.
pub(super) fn color_attribute(colors: Vec<[f32; 4]>, blend: Blend) -> Attribute {
    let is_opaque = colors.iter().all(|color| color[3].to_bits() == 1.0_f32.to_bits());
    let (components, values) = if is_opaque {
        (3, colors.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect())
    } else {
        (4, colors.into_flattened())
    };
    Attribute { name: "COLOR_0".into(), components, values, blend }
}
