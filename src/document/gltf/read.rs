//! From checked accessors to a [`Mesh`]: every triangle primitive becomes a group.
//!
//! Numbers are read column by column, straight to where they stay. Only vertices that a triangle uses are, and where that
//! is all of them, as in most files, nothing is looked up.

use super::PrimitiveSource;
use std::ops::Range;

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
    let mut ranges = vec![Vec::new(); sets.len()];
    mesh.groups.iter().for_each(|group| ranges[group.wedge_set].push(group.triangles.clone()));
    for (set, ranges) in sets.iter().zip(ranges) {
        reader.read_set(set, ranges, &mut mesh)?;
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
    let (start, count) = (triangles.len(), planned.count);
    let mut beside = Vec::new();
    let indices = if planned.mode == 4 {
        // Read in place, what is left over of a triangle too, for that has to be in range as well.
        triangles.resize(start + count.div_ceil(3), [0; 3]);
        &mut triangles[start..].as_flattened_mut()[..count]
    } else {
        beside.resize(count, 0);
        &mut beside[..]
    };
    match planned.indices {
        Some(accessor) => {
            let elements = open_indices(data, accessor, planned.source)?;
            elements.read_indices(indices);
            check_indices(indices, elements.layout.component, vertex_count, planned.source)?;
        }
        None => indices.iter_mut().zip(0..).for_each(|(index, vertex)| *index = vertex),
    }
    triangles.truncate(start + count / 3);
    // Every other triangle of a strip is turned round; repeated indices only stitch.
    let is_strip = planned.mode == 5;
    for i in 2..beside.len() {
        let [a, b, c] = match (is_strip, i % 2) {
            (true, 0) => [i - 2, i - 1, i],
            (true, _) => [i - 1, i - 2, i],
            (false, _) => [i - 1, i, 0],
        }
        .map(|i| beside[i]);
        if a != b && b != c && c != a {
            triangles.push([a, b, c]);
        }
    }
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
    /// Reads the vertices of a set that the triangles of `ranges` use, each distinct one once, and turns the indices of
    /// these triangles into wedges of the mesh.
    fn read_set(&mut self, planned: &PlannedSet, ranges: Vec<Range<usize>>, mesh: &mut Mesh) -> Result<(), Error> {
        let Mesh { positions, triangles, wedge_sets, .. } = mesh;
        let PlannedSet { set, source, vertex_count } = planned;
        let picked = self.pick(&ranges, triangles, *vertex_count);
        let count = picked.as_ref().map_or(*vertex_count, Vec::len);
        let columns = open_columns(self.data, &set.attributes, *source)?;
        let width: usize = columns.iter().map(|column| column.layout.components()).sum();
        self.budget.spend(count.saturating_mul(width), &|| source.place())?;

        let mut values: Vec<Vec<f32>> = Vec::with_capacity(columns.len());
        for (column, attribute) in columns.iter().zip(&set.attributes) {
            let components = column.layout.components();
            let mut numbers = vec![0.0; count * components];
            column.read(picked.as_deref(), &mut numbers);
            match not_finite(&numbers) {
                Some(at) if values.is_empty() => {
                    let vertex = picked.as_ref().map_or(at as u32 / 3, |picked| picked[at / 3]);
                    let message = format!("vertex {vertex} is not finite");
                    return Err(Error::new(ErrorCode::NotFinite, attribute.place(*source), message));
                }
                Some(_) => self.warnings.push(repair(&mut numbers, components, attribute.place(*source))),
                None => {}
            }
            values.push(numbers);
        }

        let widths = columns.iter().map(|column| column.layout.components());
        let rows: Vec<Rows<'_>> = values.iter().map(Vec::as_slice).zip(widths.clone()).collect();
        let numbers = repeated(&rows, count);
        if let Some(numbers) = &numbers {
            values.iter_mut().zip(widths.clone()).for_each(|(values, width)| keep(values, width, numbers));
        }
        let start = positions.len();
        let vertex = |row: usize| picked.as_ref().map_or(row, |picked| picked[row] as usize);
        if picked.is_some() || numbers.is_some() || start > 0 {
            for row in 0..count {
                let kept = numbers.as_ref().map_or(row as u32, |numbers| numbers[row]);
                self.slots[vertex(row)] = start as u32 + kept;
            }
            for range in ranges {
                let corners = triangles[range].as_flattened_mut();
                corners.iter_mut().for_each(|vertex| *vertex = self.slots[*vertex as usize]);
            }
        }
        (0..count).for_each(|row| self.slots[vertex(row)] = UNUSED);

        let mut attributes = Vec::with_capacity(columns.len());
        for (k, (values, components)) in values.into_iter().zip(widths).enumerate() {
            if k == 0 {
                positions.extend_from_slice(values.as_chunks::<3>().0);
            } else {
                attributes.push(Attribute { name: set.attributes[k].name(), components, values, blend: set.blend(k) });
            }
        }
        wedge_sets.push(WedgeSet { wedges: start..positions.len(), part: source.mesh, attributes });
        Ok(())
    }

    /// Those of `vertex_count` vertices that triangles of `ranges` use, ascending; `None` for all. Marks them in `slots`.
    #[inline(never)]
    fn pick(&mut self, ranges: &[Range<usize>], triangles: &[[u32; 3]], vertex_count: usize) -> Option<Vec<u32>> {
        self.slots.resize(self.slots.len().max(vertex_count), UNUSED);
        let index_count: usize = ranges.iter().map(|range| 3 * range.len()).sum();
        let is_dense = vertex_count / MOST_VERTICES_PER_INDEX <= index_count;
        let mut picked = Vec::new();
        let mut count = 0;
        for range in ranges {
            for &vertex in triangles[range.clone()].as_flattened() {
                if std::mem::replace(&mut self.slots[vertex as usize], 0) == UNUSED {
                    count += 1;
                    if !is_dense {
                        picked.push(vertex);
                    }
                }
            }
        }
        if count == vertex_count {
            return None;
        }
        if is_dense {
            picked.extend((0..vertex_count as u32).filter(|&vertex| self.slots[vertex as usize] == 0));
        } else {
            picked.sort_unstable();
        }
        Some(picked)
    }
}

/// The first number that is NaN or infinite.
#[inline(never)]
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
