//! Which primitives become groups, and from which accessors: all that can be said of the geometry before a number of it
//! is read.

use std::collections::BTreeMap;

use crate::document::json_tree::Value;

use super::accessor::{Data, Elements};
use super::json::{extension, index as as_index, items, member, members, uint};
use super::layout::{Component, Shape};
use super::schema::DRACO_EXTENSION;
use super::{AttributeSource, PrimitiveSource, SetSource, attributes};
use crate::error::{Error, ErrorCode};

/// Numbers in a mesh (positions, attributes, indices), together 2 GiB: what a 4 GiB wasm memory
/// can hold besides the file.
const MOST_NUMBERS: usize = 1 << 29;
/// Primitives may share their data, so a mesh may be larger than its file, but not without bound: this
/// many numbers, and so many more for each byte. An unshared byte gives three at most (a strip of 8-bit
/// indices), and one of a usual file a quarter.
const MOST_NUMBERS_OF_NOTHING: usize = 1 << 22;
const MOST_NUMBERS_PER_BYTE: usize = 16;

/// The triangle primitives of all meshes, in order, and what they are made of. Every accessor lies within its buffer.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) primitives: Vec<Planned>,
    /// Sets of one mesh stand together, as its primitives do.
    pub(super) sets: Vec<PlannedSet>,
    pub(super) budget: Budget,
}

/// One primitive, to become a group.
#[derive(Debug)]
pub(super) struct Planned {
    pub(super) source: PrimitiveSource,
    /// Index in [`Plan::sets`].
    pub(super) set: usize,
    /// 4: triangles, 5: a strip, 6: a fan.
    pub(super) mode: usize,
    /// The accessor.
    pub(super) indices: Option<usize>,
    /// How many indices or, without any, vertices.
    pub(super) count: usize,
}

impl Planned {
    /// How many triangles it has, and a strip or a fan at most.
    pub(super) fn most_triangles(&self) -> usize {
        if self.mode == 4 { self.count.div_ceil(3) } else { self.count }
    }
}

/// The vertices of some primitives of one glTF mesh, to become a wedge set.
#[derive(Debug)]
pub(super) struct PlannedSet {
    pub(super) set: SetSource,
    /// The first primitive that uses it.
    pub(super) source: PrimitiveSource,
    /// Elements of each of the accessors.
    pub(super) vertex_count: usize,
}

/// How many numbers the mesh has so far, and its accessors name one by one.
#[derive(Debug)]
pub(super) struct Budget {
    spent: usize,
    /// Bytes of all files.
    bytes: usize,
}

impl Budget {
    pub(super) fn spend(&mut self, numbers: usize, place: &dyn Fn() -> String) -> Result<(), Error> {
        self.spent = self.spent.saturating_add(numbers);
        if self.spent > MOST_NUMBERS {
            return Err(Error::new(ErrorCode::TooLarge, place(), "the geometry does not fit into 2 GiB of memory"));
        }
        if self.spent > MOST_NUMBERS_OF_NOTHING.saturating_add(self.bytes.saturating_mul(MOST_NUMBERS_PER_BYTE)) {
            let message = format!("{} numbers from {} bytes: the geometry is shared too often", self.spent, self.bytes);
            return Err(Error::new(ErrorCode::TooLarge, place(), message));
        }
        Ok(())
    }

    /// Counts the elements that sparse accessors name, which opening looks through: one accessor may be that of many.
    fn spend_on_sparse(
        &mut self,
        data: Data<'_>,
        accessors: impl IntoIterator<Item = usize>,
        source: PrimitiveSource,
    ) -> Result<(), Error> {
        for accessor in accessors {
            let sparse = data.root.accessors.get(accessor).and_then(|accessor| accessor.sparse);
            if let Some(sparse) = sparse {
                // More than there are bytes are refused when they are opened, for what is wrong with them.
                let claimed = usize::try_from(sparse.count).unwrap_or(usize::MAX);
                self.spend(claimed.min(self.bytes), &|| source.place())?;
            }
        }
        Ok(())
    }
}

/// Finds all triangle primitives; points, lines and triangles without positions are passed over.
///
/// # Errors
/// Of [`Elements::open`], and `syntax`, `unsupported` or `too-large` at the primitive's JSON path.
pub(super) fn plan(data: Data<'_>) -> Result<Plan, Error> {
    let budget = Budget { spent: 0, bytes: data.byte_count() };
    let mut plan = Plan { primitives: Vec::new(), sets: Vec::new(), budget };
    for (m, mesh) in items(data.tree, "meshes").iter().enumerate() {
        // Found by order and not one after the other: a mesh may have as many as the file has room for.
        let mut known = BTreeMap::new();
        for (p, primitive) in items(mesh, "primitives").iter().enumerate() {
            let mode = uint(primitive, "mode").unwrap_or(4);
            if !(4..=6).contains(&mode) {
                continue;
            }
            // Valid, for an extension or a shader may place them; they are carried through like points.
            let mut attributes = members(primitive, "attributes").peekable();
            if attributes.peek().is_some() && attributes.all(|(name, _)| name != "POSITION") {
                continue;
            }
            let source = PrimitiveSource { mesh: m, primitive: p };
            check_draco(data, primitive, source)?;
            let attributes = attributes::list(primitive);
            let set = match known.get(&attributes) {
                Some(&known) => known,
                None => {
                    plan.budget.spend_on_sparse(data, attributes.iter().map(|a| a.accessor), source)?;
                    let vertex_count = open_columns(data, &attributes, source)?.first().map_or(0, |first| first.count);
                    known.insert(attributes.clone(), plan.sets.len());
                    plan.sets.push(PlannedSet { set: SetSource { attributes }, source, vertex_count });
                    plan.sets.len() - 1
                }
            };
            let indices = uint(primitive, "indices");
            plan.budget.spend_on_sparse(data, indices, source)?;
            let count = match indices {
                None => plan.sets[set].vertex_count,
                Some(accessor) => open_indices(data, accessor, source)?.count,
            };
            let planned = Planned { source, set, mode, indices, count };
            plan.budget.spend(planned.most_triangles().saturating_mul(3), &|| source.place())?;
            plan.primitives.push(planned);
        }
    }
    Ok(plan)
}

/// Draco data without an uncompressed copy would read as zeros.
fn check_draco(data: Data<'_>, primitive: &Value, source: PrimitiveSource) -> Result<(), Error> {
    if extension(primitive, DRACO_EXTENSION).is_none() {
        return Ok(());
    }
    let accessors = items(data.tree, "accessors");
    let mut used = members(primitive, "attributes").map(|(_, v)| v).chain(member(primitive, "indices"));
    let has_copy = |accessor: &Value| {
        let accessor = as_index(accessor).and_then(|accessor| accessors.get(accessor));
        accessor.is_none_or(|json| member(json, "bufferView").is_some() || member(json, "sparse").is_some())
    };
    if used.all(has_copy) {
        return Ok(());
    }
    let place = format!("{}.extensions.{DRACO_EXTENSION}", source.place());
    Err(Error::new(ErrorCode::Unsupported, place, "Draco-compressed geometry cannot be decoded yet"))
}

/// The accessor of the indices of a primitive.
pub(super) fn open_indices(data: Data<'_>, accessor: usize, source: PrimitiveSource) -> Result<Elements<'_>, Error> {
    let elements = Elements::open(data, accessor)?;
    let is_unsigned = matches!(elements.layout.component, Component::U8 | Component::U16 | Component::U32);
    if elements.layout.shape != Shape::Scalar || !is_unsigned {
        let place = format!("{}.indices", source.place());
        return Err(Error::new(ErrorCode::Syntax, place, "indices must be unsigned integers"));
    }
    Ok(elements)
}

/// The accessors of a set: positions first, all of one length.
pub(super) fn open_columns<'a>(
    data: Data<'a>,
    attributes: &[AttributeSource],
    source: PrimitiveSource,
) -> Result<Vec<Elements<'a>>, Error> {
    if attributes.first().is_none_or(|first| first.target.is_some() || first.semantic != "POSITION") {
        let place = format!("{}.attributes.POSITION", source.place());
        return Err(Error::new(ErrorCode::Syntax, place, "triangles without positions"));
    }
    let mut columns: Vec<Elements<'a>> = Vec::with_capacity(attributes.len());
    for attribute in attributes {
        let column = Elements::open(data, attribute.accessor)?;
        let shape = column.layout.shape;
        let first = columns.first().map_or(column.count, |first| first.count);
        let (code, message) = if !attribute.allows(shape) {
            (ErrorCode::Syntax, format!("{} cannot be {shape:?}", attribute.semantic))
        } else if column.count != first {
            (ErrorCode::Syntax, format!("{} elements, but POSITION has {first}", column.count))
        } else if column.layout.component == Component::U32 {
            // An f32 holds every integer only up to 2^24.
            (ErrorCode::Unsupported, "32-bit integers are not allowed as vertex attributes".into())
        } else {
            columns.push(column);
            continue;
        };
        return Err(Error::new(code, attribute.place(source), message));
    }
    Ok(columns)
}
