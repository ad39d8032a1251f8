//! From checked accessors to a [`Mesh`]: every triangle primitive becomes a group.

use serde_json::Value;

use super::accessor::{Data, Elements};
use super::json::{extension, index as as_index, items, members, uint};
use super::layout::{Component, Shape};
use super::schema::DRACO_EXTENSION;
use super::unique::keep_unique;
use super::{PrimitiveSource, SetSource, attributes};
use crate::error::{Error, ErrorCode, Warning};
use crate::mesh::{Attribute, Group, Mesh, Part, WedgeSet};

/// Numbers in a mesh (positions, attributes, indices), together 2 GiB: what a 4 GiB wasm memory
/// can hold besides the file.
const MOST_NUMBERS: usize = 1 << 29;
/// Primitives may share their data, so a mesh may be larger than its file, but not without bound: this
/// many numbers, and so many more for each byte. An unshared byte gives three at most (a strip of 8-bit
/// indices), and one of a usual file a quarter.
const MOST_NUMBERS_OF_NOTHING: usize = 1 << 22;
const MOST_NUMBERS_PER_BYTE: usize = 16;

/// The mesh and, for the writer, where each of its parts came from.
pub(super) struct Geometry {
    pub(super) mesh: Mesh,
    pub(super) primitives: Vec<PrimitiveSource>,
    pub(super) sets: Vec<SetSource>,
}

/// Triangles of one primitive, indices as in the file.
struct Indexed {
    source: PrimitiveSource,
    set: usize,
    triangles: Vec<[u32; 3]>,
}

/// Reads all triangle primitives of all meshes; points, lines and triangles without positions are passed over.
///
/// # Errors
/// Of [`Elements::open`], and `out-of-range`, `not-finite`, `syntax`, `unsupported` or `too-large`
/// at the primitive's JSON path.
pub(super) fn geometry(data: Data<'_>, scales: &[f32], warnings: &mut Vec<Warning>) -> Result<Geometry, Error> {
    let mut reader = Reader { data, warnings, numbers: 0, slots: Vec::new() };
    let parts = scales.iter().map(|&scale| Part { scale }).collect();
    let mut out = Geometry { mesh: Mesh { parts, ..Mesh::default() }, primitives: Vec::new(), sets: Vec::new() };
    for (m, mesh) in items(data.tree, "meshes").iter().enumerate() {
        let first_set = out.sets.len();
        let mut read: Vec<Indexed> = Vec::new();
        for (p, primitive) in items(mesh, "primitives").iter().enumerate() {
            let mode = uint(primitive, "mode").unwrap_or(4);
            if !(4..=6).contains(&mode) {
                continue;
            }
            // Valid, for an extension or a shader may place them; they are carried through like points.
            let attributes = primitive["attributes"].as_object();
            if attributes.is_some_and(|attributes| !attributes.is_empty() && !attributes.contains_key("POSITION")) {
                continue;
            }
            let place = format!("meshes[{m}].primitives[{p}]");
            reader.check_draco(primitive, &place)?;
            let attributes = attributes::list(primitive);
            let set = match out.sets[first_set..].iter().position(|set: &SetSource| set.attributes == attributes) {
                Some(known) => first_set + known,
                None => {
                    out.sets.push(SetSource { attributes, place: place.clone() });
                    out.sets.len() - 1
                }
            };
            let triangles = reader.triangles(primitive, mode, &place)?;
            read.push(Indexed { source: PrimitiveSource { mesh: m, primitive: p }, set, triangles });
        }
        for set in first_set..out.sets.len() {
            let wedges = reader.wedge_set(&out.sets[set], set, m, &mut read, &mut out.mesh)?;
            out.mesh.wedge_sets.push(wedges);
        }
        for Indexed { source, set, triangles } in read {
            let start = out.mesh.triangles.len();
            out.mesh.triangles.extend(triangles);
            out.mesh.groups.push(Group { triangles: start..out.mesh.triangles.len(), wedge_set: set });
            out.primitives.push(source);
        }
    }
    Ok(out)
}

struct Reader<'a, 'w> {
    data: Data<'a>,
    warnings: &'w mut Vec<Warning>,
    numbers: usize,
    /// For each vertex of the set being read, its place among the wedges; `u32::MAX` between sets.
    slots: Vec<u32>,
}

impl<'a> Reader<'a, '_> {
    fn spend(&mut self, numbers: usize, place: &str) -> Result<(), Error> {
        self.numbers = self.numbers.saturating_add(numbers);
        if self.numbers > MOST_NUMBERS {
            return Err(Error::new(ErrorCode::TooLarge, place, "the geometry does not fit into 2 GiB of memory"));
        }
        let bytes = self.data.byte_count();
        if self.numbers > MOST_NUMBERS_OF_NOTHING.saturating_add(bytes.saturating_mul(MOST_NUMBERS_PER_BYTE)) {
            let message = format!("{} numbers from {bytes} bytes: the geometry is shared too often", self.numbers);
            return Err(Error::new(ErrorCode::TooLarge, place, message));
        }
        Ok(())
    }

    /// Draco data without an uncompressed copy would read as zeros.
    fn check_draco(&self, primitive: &Value, place: &str) -> Result<(), Error> {
        if extension(primitive, DRACO_EXTENSION).is_none() {
            return Ok(());
        }
        let accessors = items(self.data.tree, "accessors");
        let mut used = members(primitive, "attributes").map(|(_, v)| v).chain(primitive.get("indices"));
        let has_copy = |accessor: &Value| {
            let accessor = as_index(accessor).and_then(|accessor| accessors.get(accessor));
            accessor.is_none_or(|json| json.get("bufferView").is_some() || json.get("sparse").is_some())
        };
        if used.all(has_copy) {
            return Ok(());
        }
        let place = format!("{place}.extensions.{DRACO_EXTENSION}");
        Err(Error::new(ErrorCode::Unsupported, place, "Draco-compressed geometry cannot be decoded yet"))
    }

    fn triangles(&mut self, primitive: &Value, mode: usize, place: &str) -> Result<Vec<[u32; 3]>, Error> {
        let Some(position) = uint(&primitive["attributes"], "POSITION") else {
            let place = format!("{place}.attributes.POSITION");
            return Err(Error::new(ErrorCode::Syntax, place, "triangles without positions"));
        };
        let vertex_count = Elements::open(self.data, position)?.count;
        let indices = match uint(primitive, "indices") {
            None => None,
            Some(accessor) => Some(self.indices(accessor, vertex_count, &format!("{place}.indices"))?),
        };
        let count = indices.as_ref().map_or(vertex_count, Vec::len);
        self.spend(count.saturating_mul(if mode == 4 { 1 } else { 3 }), place)?;
        let at = |i: usize| indices.as_ref().map_or(i as u32, |indices| indices[i]);
        Ok(match mode {
            4 => (0..count / 3).map(|t| [at(3 * t), at(3 * t + 1), at(3 * t + 2)]).collect(),
            // Every other triangle of a strip is turned round; repeated indices only stitch.
            5 => (2..count)
                .map(|i| if i % 2 == 0 { [at(i - 2), at(i - 1), at(i)] } else { [at(i - 1), at(i - 2), at(i)] })
                .filter(is_proper)
                .collect(),
            _ => (2..count).map(|i| [at(i - 1), at(i), at(0)]).filter(is_proper).collect(),
        })
    }

    fn indices(&self, accessor: usize, vertex_count: usize, place: &str) -> Result<Vec<u32>, Error> {
        let elements = Elements::open(self.data, accessor)?;
        let layout = elements.layout;
        let restart = match (layout.shape, layout.component) {
            (Shape::Scalar, Component::U8) => u32::from(u8::MAX),
            (Shape::Scalar, Component::U16) => u32::from(u16::MAX),
            (Shape::Scalar, Component::U32) => u32::MAX,
            _ => {
                return Err(Error::new(ErrorCode::Syntax, place, "indices must be unsigned integers"));
            }
        };
        let indices = elements.read_indices();
        if let Some(i) = indices.iter().position(|&index| index as usize >= vertex_count || index == restart) {
            let index = indices[i];
            let reason = if index == restart {
                format!("index {i} is {index}, which is reserved for primitive restart")
            } else {
                format!("index {i} is {index}, but there are {vertex_count} vertices")
            };
            return Err(Error::new(ErrorCode::OutOfRange, place, reason));
        }
        Ok(indices)
    }

    /// Reads the vertices that `primitives` use of a set, each distinct one once, and turns their
    /// indices into wedges of the mesh.
    fn wedge_set(
        &mut self,
        source: &SetSource,
        set: usize,
        part: usize,
        primitives: &mut [Indexed],
        mesh: &mut Mesh,
    ) -> Result<WedgeSet, Error> {
        let columns = self.open_columns(source)?;
        let vertex_count = columns.first().map_or(0, |column| column.count);
        self.slots.resize(self.slots.len().max(vertex_count), u32::MAX);
        let mut used = Vec::new();
        let mine = |primitive: &&mut Indexed| primitive.set == set;
        for &vertex in primitives.iter_mut().filter(mine).flat_map(|p| p.triangles.iter().flatten()) {
            if std::mem::replace(&mut self.slots[vertex as usize], 0) == u32::MAX {
                used.push(vertex);
            }
        }
        used.sort_unstable();
        let width: usize = columns.iter().map(|column| column.layout.components()).sum();
        self.spend(used.len().saturating_mul(width), &source.place)?;

        let start = mesh.positions.len();
        let mut rows = vec![0.0f32; used.len() * width];
        let mut repaired = vec![0usize; columns.len()];
        let mut offset = 0;
        for (k, (column, repaired)) in columns.iter().zip(&mut repaired).enumerate() {
            column.read_rows(&used, &mut rows, width, offset);
            let components = column.layout.components();
            for (row, vertex) in rows.chunks_exact_mut(width).zip(&used) {
                let element = &mut row[offset..offset + components];
                if element.iter().all(|value| value.is_finite()) {
                    continue;
                }
                if k == 0 {
                    let message = format!("vertex {vertex} is not finite");
                    return Err(Error::new(ErrorCode::NotFinite, source.place_of(0), message));
                }
                *repaired += 1;
                element.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
            }
            offset += components;
        }
        for (&vertex, number) in used.iter().zip(keep_unique(&mut rows, width)) {
            self.slots[vertex as usize] = start as u32 + number;
        }
        for primitive in primitives.iter_mut().filter(mine) {
            primitive.triangles.iter_mut().flatten().for_each(|vertex| *vertex = self.slots[*vertex as usize]);
        }
        used.iter().for_each(|&vertex| self.slots[vertex as usize] = u32::MAX);
        for (k, &count) in repaired.iter().enumerate().filter(|(_, count)| **count > 0) {
            self.warnings.push(Warning {
                code: "not-finite",
                message: format!("{count} vertices had values that are not finite; they are 0 now"),
                place: source.place_of(k),
            });
        }
        let rows = rows.chunks_exact(width);
        mesh.positions.extend(rows.clone().map(|row| [row[0], row[1], row[2]]));
        let mut offset = 0;
        let mut attributes = Vec::new();
        for (k, column) in columns.iter().enumerate() {
            let components = column.layout.components();
            if k > 0 {
                let mut values = Vec::with_capacity(rows.len() * components);
                rows.clone().for_each(|row| values.extend_from_slice(&row[offset..offset + components]));
                let blend = source.blend(k);
                attributes.push(Attribute { name: source.attributes[k].name(), components, values, blend });
            }
            offset += components;
        }
        Ok(WedgeSet { wedges: start..mesh.positions.len(), part, attributes })
    }

    fn open_columns(&mut self, source: &SetSource) -> Result<Vec<Elements<'a>>, Error> {
        let mut columns: Vec<Elements<'a>> = Vec::new();
        for (k, attribute) in source.attributes.iter().enumerate() {
            let column = Elements::open(self.data, attribute.accessor)?;
            if !attribute.allows(column.layout.shape) {
                let message = format!("{} cannot be {:?}", attribute.semantic, column.layout.shape);
                return Err(Error::new(ErrorCode::Syntax, source.place_of(k), message));
            }
            if let Some(first) = columns.first().filter(|first| first.count != column.count) {
                let message = format!("{} elements, but POSITION has {}", column.count, first.count);
                return Err(Error::new(ErrorCode::Syntax, source.place_of(k), message));
            }
            // An f32 holds every integer only up to 2^24.
            if column.layout.component == Component::U32 {
                let message = "32-bit integers are not allowed as vertex attributes";
                return Err(Error::new(ErrorCode::Unsupported, source.place_of(k), message));
            }
            columns.push(column);
        }
        Ok(columns)
    }
}

fn is_proper([a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}
