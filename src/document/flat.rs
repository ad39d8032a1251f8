//! A scene as one list of vertices and one of triangles, for formats that have nothing more.
//!
//! Every appearance of a part is there, in world coordinates. Vertices come in the order of the
//! wedges and triangles in their own. Where a part has several wedge sets (materials of a glTF
//! mesh), vertices that are equal in all that is written become one, so that the surface stays
//! closed; within one set they stay as they were.

use super::SceneLayout;
use super::color::to_srgb;
use super::place::Placement;
use super::row_table::RowTable;
use crate::error::{Error, ErrorCode};
use crate::mesh::{Attribute, Mesh, WedgeSet};

/// Vertices, attributes that some of them had, and triangles.
#[derive(Debug, Default)]
pub(super) struct FlatMesh {
    pub(super) positions: Vec<[f32; 3]>,
    /// One for each vertex, or empty: not written unless every triangle has normals.
    pub(super) normals: Vec<[f32; 3]>,
    /// One for each vertex, or empty; v upwards; 0 where there was none.
    pub(super) texcoords: Vec<[f32; 2]>,
    /// One for each vertex, or empty; sRGB; white where there was none.
    pub(super) colors: Vec<[f32; 4]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl FlatMesh {
    /// `mesh` as placed by `layout`.
    ///
    /// # Errors
    /// `not-finite` if a placement moves a vertex beyond the range of `f32`; `no-triangles` if the
    /// scene shows none; `too-large` beyond four billion vertices.
    pub(super) fn new(mesh: &Mesh, layout: &SceneLayout) -> Result<Self, Error> {
        let mut is_used = vec![false; mesh.positions.len()];
        for &wedge in mesh.triangles.iter().flatten() {
            is_used[wedge as usize] = true;
        }
        let used_sets: Vec<usize> =
            (0..mesh.wedge_sets.len()).filter(|&s| mesh.wedge_sets[s].wedges.clone().any(|w| is_used[w])).collect();
        let has = |find: fn(&WedgeSet) -> Option<&Attribute>| {
            let mut sets = used_sets.iter().map(|&s| find(&mesh.wedge_sets[s]).is_some());
            (sets.clone().any(|has| has), sets.all(|has| has))
        };
        let columns = Columns { normals: has(normal).1, texcoords: has(texcoord).0, colors: has(color).0 };
        let mut flat = Self::default();
        let mut number_of = vec![0; mesh.positions.len()];
        for (i, instance) in layout.instances.iter().enumerate() {
            let placement = Placement::new(&instance.world_from_local);
            let sets: Vec<usize> =
                used_sets.iter().copied().filter(|&s| mesh.wedge_sets[s].part == instance.part).collect();
            let mut merged = (sets.len() > 1).then(|| (RowTable::<12>::new(), flat.positions.len()));
            for &s in &sets {
                let set = &mesh.wedge_sets[s];
                let (normal, texcoord, color) = (normal(set), texcoord(set), color(set));
                for wedge in set.wedges.clone().filter(|&wedge| is_used[wedge]) {
                    let at = wedge - set.wedges.start;
                    let Some(position) = placement.position(mesh.positions[wedge]) else {
                        let place = format!("instances[{i}]");
                        return Err(Error::new(ErrorCode::NotFinite, place, "moves a vertex out of range"));
                    };
                    let vertex = Vertex {
                        position,
                        normal: normal.filter(|_| columns.normals).map_or([0.0; 3], |a| {
                            placement.normal([a.values[3 * at], a.values[3 * at + 1], a.values[3 * at + 2]])
                        }),
                        texcoord: texcoord.map_or([0.0; 2], |a| {
                            let [u, v] = [a.values[2 * at], a.values[2 * at + 1]];
                            [u, if layout.texture_v_down { 1.0 - v } else { v }]
                        }),
                        color: color.map_or([1.0; 4], |a| rgba(a, at, layout.has_linear_colors)),
                    };
                    number_of[wedge] = match &mut merged {
                        None => flat.push(&vertex, &columns)?,
                        Some((table, first)) => {
                            let number = *first + table.number(vertex.bits()) as usize;
                            if number == flat.positions.len() { flat.push(&vertex, &columns)? } else { number as u32 }
                        }
                    };
                }
            }
            for group in &mesh.groups {
                if mesh.wedge_sets[group.wedge_set].part != instance.part {
                    continue;
                }
                for &triangle in &mesh.triangles[group.triangles.clone()] {
                    let [a, b, c] = triangle.map(|wedge| number_of[wedge as usize]);
                    flat.triangles.push(if placement.is_mirrored() { [a, c, b] } else { [a, b, c] });
                }
            }
        }
        if flat.triangles.is_empty() && !mesh.triangles.is_empty() {
            let message = "no triangle of the file stands in its scene";
            return Err(Error::new(ErrorCode::NoTriangles, "instances", message));
        }
        Ok(flat)
    }

    #[inline(never)]
    fn push(&mut self, vertex: &Vertex, columns: &Columns) -> Result<u32, Error> {
        let number = u32::try_from(self.positions.len())
            .map_err(|_| Error::new(ErrorCode::TooLarge, "instances", "more than four billion vertices"))?;
        self.positions.push(vertex.position);
        if columns.normals {
            self.normals.push(vertex.normal);
        }
        if columns.texcoords {
            self.texcoords.push(vertex.texcoord);
        }
        if columns.colors {
            self.colors.push(vertex.color);
        }
        Ok(number)
    }
}

/// Which attributes there are.
struct Columns {
    normals: bool,
    texcoords: bool,
    colors: bool,
}

struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    texcoord: [f32; 2],
    color: [f32; 4],
}

impl Vertex {
    fn bits(&self) -> [u32; 12] {
        let ([x, y, z], [nx, ny, nz], [u, v], [r, g, b, a]) = (self.position, self.normal, self.texcoord, self.color);
        [x, y, z, nx, ny, nz, u, v, r, g, b, a].map(f32::to_bits)
    }
}

fn rgba(attribute: &Attribute, at: usize, is_linear: bool) -> [f32; 4] {
    let values = &attribute.values[at * attribute.components..][..attribute.components];
    let alpha = values.get(3).copied().unwrap_or(1.0);
    let [r, g, b] = [values[0], values[1], values[2]].map(|c| if is_linear { to_srgb(c) } else { c });
    [r, g, b, alpha]
}

/// Texture coordinates of a set.
pub(super) fn texcoord(set: &WedgeSet) -> Option<&Attribute> {
    attribute(set, "TEXCOORD_0", &[2])
}

/// Normals of a set.
pub(super) fn normal(set: &WedgeSet) -> Option<&Attribute> {
    attribute(set, "NORMAL", &[3])
}

/// Colours of a set, of three or four numbers.
pub(super) fn color(set: &WedgeSet) -> Option<&Attribute> {
    attribute(set, "COLOR_0", &[3, 4])
}

fn attribute<'a>(set: &'a WedgeSet, name: &str, components: &[usize]) -> Option<&'a Attribute> {
    set.attributes.iter().find(|a| a.name == name && components.contains(&a.components))
}
