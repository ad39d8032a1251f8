//! From checked accessors to a [`Mesh`]: every triangle primitive becomes a group.
//!
//! Numbers are read column by column, straight to where they stay. Only vertices that a triangle uses are, and where that
//! is all of them, as in most files, nothing is looked up.

use super::PrimitiveSource;
use super::accessor::Data;
use super::layout::Component;
use super::plan::{Budget, Plan, Planned, PlannedSet, open_columns, open_indices};
use super::unique::{Rows, keep, repeated};
use crate::error::{Error, ErrorCode, Warning};
use crate::mesh::{Attribute, Group, Mesh, Part, WedgeSet};

/// Reads all vertices at once, and not one by one, where there are at most so many for each index.
const MOST_VERTICES_PER_INDEX: usize = 8;

/// Marks a vertex that no triangle uses.
const UNUSED: u32 = u32::MAX;

/// Reads what was planned.
///
/// # Errors
/// `out-of-range`, `not-finite` or `too-large` at the primitive's JSON path.
pub(super) fn geometry(
    data: Data<'_>,
    plan: &mut Plan,
    scales: &[f32],
    warnings: &mut Vec<Warning>,
) -> Result<Mesh, Error> {
    let Plan { primitives, sets, budget } = plan;
    let mut mesh = Mesh { parts: scales.iter().map(|&scale| Part { scale }).collect(), ..Mesh::default() };
    mesh.triangles.reserve_exact(primitives.iter().map(Planned::most_triangles).sum());
    for planned in &*primitives {
        let start = mesh.triangles.len();
        read_triangles(data, planned, sets[planned.set].vertex_count, &mut mesh.triangles)?;
        mesh.groups.push(Group { triangles: start..mesh.triangles.len(), wedge_set: planned.set });
    }
    let mut reader = Reader { data, warnings, budget, slots: Vec::new() };
    for (number, set) in sets.iter().enumerate() {
        reader.read_set(set, number, &mut mesh)?;
    }
    Ok(mesh)
}

/// Appends the triangles of a primitive; indices as in the file.
fn read_triangles(
    data: Data<'_>,
    planned: &Planned,
    vertex_count: usize,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), Error> {
    if planned.mode == 4 {
        let start = triangles.len();
        match planned.indices {
            Some(accessor) => {
                let elements = open_indices(data, accessor, planned.source)?;
                // Read in place, what is left over of a triangle too, for that has to be in range as well.
                triangles.resize(start + elements.count.div_ceil(3), [0; 3]);
                let out = &mut triangles[start..].as_flattened_mut()[..elements.count];
                elements.read_indices(out);
                check_indices(out, elements.layout.component, vertex_count, planned.source)?;
                triangles.truncate(start + elements.count / 3);
            }
            None => triangles.extend((0..vertex_count as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2])),
        }
        return Ok(());
    }
    let indices = match planned.indices {
        Some(accessor) => {
            let elements = open_indices(data, accessor, planned.source)?;
            let mut indices = vec![0; elements.count];
            elements.read_indices(&mut indices);
            check_indices(&indices, elements.layout.component, vertex_count, planned.source)?;
            indices
        }
        None => (0..vertex_count as u32).collect(),
    };
    // Every other triangle of a strip is turned round; repeated indices only stitch.
    let is_strip = planned.mode == 5;
    triangles.extend((2..indices.len()).filter_map(|i| {
        let [a, b, c] = match (is_strip, i % 2) {
            (true, 0) => [i - 2, i - 1, i],
            (true, _) => [i - 1, i - 2, i],
            (false, _) => [i - 1, i, 0],
        }
        .map(|i| indices[i]);
        (a != b && b != c && c != a).then_some([a, b, c])
    }));
    Ok(())
}

fn check_indices(
    indices: &[u32],
    component: Component,
    vertex_count: usize,
    source: PrimitiveSource,
) -> Result<(), Error> {
    let restart = match component {
        Component::U8 => u32::from(u8::MAX),
        Component::U16 => u32::from(u16::MAX),
        _ => u32::MAX,
    };
    // The largest first: that is many at a time.
    let end = restart.min(u32::try_from(vertex_count).unwrap_or(u32::MAX));
    let largest = indices.iter().fold(0, |largest, &index| if index > largest { index } else { largest });
    if largest < end {
        return Ok(());
    }
    let i = indices.iter().position(|&index| index >= end).unwrap_or(0);
    let index = indices[i];
    let reason = if index == restart {
        format!("index {i} is {index}, which is reserved for primitive restart")
    } else {
        format!("index {i} is {index}, but there are {vertex_count} vertices")
    };
    Err(Error::new(ErrorCode::OutOfRange, format!("{}.indices", source.place()), reason))
}

struct Reader<'a, 'w> {
    data: Data<'a>,
    warnings: &'w mut Vec<Warning>,
    budget: &'w mut Budget,
    /// For each vertex of the set being read, its place among the wedges; [`UNUSED`] between sets.
    slots: Vec<u32>,
}

impl Reader<'_, '_> {
    /// Reads the vertices that triangles use of a set, each distinct one once, and turns the indices of these triangles
    /// into wedges of the mesh.
    fn read_set(&mut self, planned: &PlannedSet, number: usize, mesh: &mut Mesh) -> Result<(), Error> {
        let Mesh { positions, triangles, groups, wedge_sets, .. } = mesh;
        let PlannedSet { set, source, groups: beside, vertex_count } = planned;
        let groups = &groups[beside.clone()];
        let mine = || groups.iter().filter(|group| group.wedge_set == number).map(|group| group.triangles.clone());
        let picked = self.pick(mine().map(|range| triangles[range].as_flattened()), *vertex_count);
        let count = picked.as_ref().map_or(*vertex_count, Vec::len);
        let columns = open_columns(self.data, &set.attributes, *source)?;
        let width: usize = columns.iter().map(|column| column.layout.components()).sum();
        self.budget.spend(count.saturating_mul(width), &|| source.place())?;

        let start = positions.len();
        let mut attributes: Vec<Attribute> = Vec::with_capacity(columns.len());
        let mut points = vec![[0.0; 3]; count];
        for (k, (column, attribute)) in columns.iter().zip(&set.attributes).enumerate() {
            let components = column.layout.components();
            if k == 0 {
                column.read(picked.as_deref(), points.as_flattened_mut());
                if let Some(at) = not_finite(points.as_flattened()) {
                    let vertex = picked.as_ref().map_or(at as u32 / 3, |picked| picked[at / 3]);
                    let message = format!("vertex {vertex} is not finite");
                    return Err(Error::new(ErrorCode::NotFinite, attribute.place(*source), message));
                }
                continue;
            }
            let mut values = vec![0.0; count * components];
            column.read(picked.as_deref(), &mut values);
            if not_finite(&values).is_some() {
                self.warnings.push(repair(&mut values, components, attribute.place(*source)));
            }
            attributes.push(Attribute { name: attribute.name(), components, values, blend: set.blend(k) });
        }

        let mut rows: Vec<Rows<'_>> = vec![(points.as_flattened(), 3)];
        rows.extend(attributes.iter().map(|a| (a.values.as_slice(), a.components)));
        let numbers = repeated(&rows, count);
        if let Some(numbers) = &numbers {
            attributes.iter_mut().for_each(|a| keep(&mut a.values, a.components, numbers));
            let mut flat = points.into_flattened();
            keep(&mut flat, 3, numbers);
            points = flat.as_chunks::<3>().0.to_vec();
        }
        if picked.is_some() || numbers.is_some() || start > 0 {
            let place = |row: usize| start as u32 + numbers.as_ref().map_or(row as u32, |numbers| numbers[row]);
            match &picked {
                Some(picked) => picked.iter().enumerate().for_each(|(r, &v)| self.slots[v as usize] = place(r)),
                None => self.slots[..count].iter_mut().enumerate().for_each(|(r, slot)| *slot = place(r)),
            }
            for range in mine() {
                let vertices = triangles[range].as_flattened_mut();
                vertices.iter_mut().for_each(|vertex| *vertex = self.slots[*vertex as usize]);
            }
        }
        match &picked {
            Some(picked) => picked.iter().for_each(|&vertex| self.slots[vertex as usize] = UNUSED),
            None => self.slots[..count].fill(UNUSED),
        }
        if start == 0 {
            *positions = points;
        } else {
            positions.extend_from_slice(&points);
        }
        wedge_sets.push(WedgeSet { wedges: start..positions.len(), part: source.mesh, attributes });
        Ok(())
    }

    /// Those of `vertex_count` vertices that are used, ascending; `None` for all. Marks them in `slots`.
    fn pick<'i>(&mut self, used: impl Iterator<Item = &'i [u32]> + Clone, vertex_count: usize) -> Option<Vec<u32>> {
        self.slots.resize(self.slots.len().max(vertex_count), UNUSED);
        let index_count: usize = used.clone().map(<[u32]>::len).sum();
        if vertex_count / MOST_VERTICES_PER_INDEX <= index_count {
            used.for_each(|indices| indices.iter().for_each(|&vertex| self.slots[vertex as usize] = 0));
            let slots = self.slots[..vertex_count].iter();
            let is_whole = slots.clone().all(|&slot| slot == 0);
            return (!is_whole).then(|| slots.zip(0..).filter(|(slot, _)| **slot == 0).map(|(_, v)| v).collect());
        }
        let mut picked = Vec::new();
        for &vertex in used.flatten() {
            if std::mem::replace(&mut self.slots[vertex as usize], 0) == UNUSED {
                picked.push(vertex);
            }
        }
        picked.sort_unstable();
        Some(picked)
    }
}

/// The first number that is NaN or infinite.
fn not_finite(values: &[f32]) -> Option<usize> {
    const EXPONENT: u32 = 0x7f80_0000;
    // Of all together first: that is many at a time.
    let is_bad = |value: f32| value.to_bits() & EXPONENT == EXPONENT;
    if values.iter().fold(false, |any, &value| any | is_bad(value)) {
        return values.iter().position(|&value| is_bad(value));
    }
    None
}

/// Nothing is better than zeros in the place of what is no number.
fn repair(values: &mut [f32], components: usize, place: String) -> Warning {
    let mut count = 0;
    for row in values.chunks_exact_mut(components) {
        count += usize::from(row.iter().any(|value| !value.is_finite()));
        row.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
    }
    let message = format!("{count} vertices had values that are not finite; they are 0 now");
    Warning { code: "not-finite", message, place }
}
