//! The mesh of an OBJ file's statements: wedges from corners, triangles from faces, groups.
//!
//! A wedge is a distinct `(v, vt, vn)`; the faces of one attribute signature share a wedge set. If
//! no face has attributes of its own, every `v` is a wedge, in the order of the file.

use super::ObjSource;
use super::statements::{HAS_NORMAL, HAS_TEXCOORD, Signature, Smoothing, Statements};
use crate::document::content::Content;
use crate::document::faces::IDENTITY;
use crate::document::notice::{DEGENERATE_FACE, DEGENERATE_TRIANGLE, UNTRIANGULATED_FACE};
use crate::document::polygon::Triangulator;
use crate::document::row_table::RowTable;
use crate::document::{GroupLabel, Instance, SceneLayout};
use crate::error::{Error, ErrorCode};
use crate::mesh::{Attribute, Blend, Group, Mesh, Part, WedgeSet};

/// The wedges of one signature, as `(v, vt, vn)`; absent ones are 0.
struct Wedges {
    signature: Signature,
    table: RowTable<3>,
}

/// Builds the mesh; `name` is for places.
pub(super) fn assemble(name: &str, mut file: Statements) -> Result<ObjSource, Error> {
    let mut sets: Vec<Wedges> = Vec::new();
    let group_sets: Vec<usize> = file
        .groups
        .iter()
        .map(|(key, _)| {
            sets.iter().position(|set| set.signature == key.signature).unwrap_or_else(|| {
                sets.push(Wedges { signature: key.signature, table: RowTable::new() });
                sets.len() - 1
            })
        })
        .collect();
    let is_positions_only = sets.iter().all(|set| set.signature == 0);
    let triangles = triangulate_faces(name, &mut file, &mut sets, &group_sets, is_positions_only)?;

    let mut mesh = Mesh { parts: vec![Part { scale: 1.0 }], ..Mesh::default() };
    let set_numbers = if is_positions_only {
        all_positions(&mut mesh, &mut file, &triangles);
        vec![0; sets.len()]
    } else {
        wedge_sets(&mut mesh, &file, &sets)
    };
    let mut layout = SceneLayout {
        instances: vec![Instance { part: 0, world_from_local: IDENTITY }],
        material_libraries: std::mem::take(&mut file.material_libraries),
        ..SceneLayout::default()
    };
    let sets_of_groups = group_sets.iter().map(|&set| set_numbers[set]);
    let smoothing_groups = groups(name, &mut mesh, &mut layout, &file, triangles.into_iter().zip(sets_of_groups))?;
    if mesh.positions.len() >= u32::MAX as usize || mesh.triangles.len() >= u32::MAX as usize / 4 {
        return Err(too_large(name));
    }
    let content = Content { mesh, layout, warnings: file.notices.into_warnings() };
    Ok(ObjSource { content, smoothing_groups })
}

/// Every position is a wedge of the only set.
fn all_positions(mesh: &mut Mesh, file: &mut Statements, triangles: &[Vec<[u32; 3]>]) {
    let colors = color_components(file, triangles.iter().flatten().flatten().copied());
    let attributes = colors.map(|count| color_attribute(file, count, 0..file.positions.len())).into_iter().collect();
    mesh.positions = std::mem::take(&mut file.positions);
    mesh.wedge_sets.push(WedgeSet { wedges: 0..mesh.positions.len(), part: 0, attributes });
}

/// The wedges of each signature are a set of the mesh; the index of each there. A set whose faces were all degenerate gets none.
fn wedge_sets(mesh: &mut Mesh, file: &Statements, sets: &[Wedges]) -> Vec<usize> {
    let colors = color_components(file, sets.iter().flat_map(|set| set.table.rows()).map(|row| row[0]));
    let mut numbers = vec![0; sets.len()];
    for (number, set) in numbers.iter_mut().zip(sets).filter(|(_, set)| !set.table.rows().is_empty()) {
        *number = mesh.wedge_sets.len();
        let start = mesh.positions.len();
        mesh.positions.extend(set.table.rows().iter().map(|row| file.positions[row[0] as usize]));
        let attributes = attributes(file, set, colors);
        mesh.wedge_sets.push(WedgeSet { wedges: start..mesh.positions.len(), part: 0, attributes });
    }
    numbers
}

/// Puts the triangles of each group, with the index of their wedge set, into the mesh, and its names into the layout; what
/// stood after `s`.
fn groups(
    name: &str,
    mesh: &mut Mesh,
    layout: &mut SceneLayout,
    file: &Statements,
    triangles_of: impl Iterator<Item = (Vec<[u32; 3]>, usize)>,
) -> Result<Vec<Option<String>>, Error> {
    let text = |number: u32| Some(&file.names[number as usize]).filter(|name| !name.is_empty()).cloned();
    let mut smoothing_groups = Vec::new();
    for ((key, smoothing), (triangles, wedge_set)) in file.groups.iter().zip(triangles_of) {
        if triangles.is_empty() {
            continue;
        }
        let start = mesh.triangles.len();
        let first_wedge = u32::try_from(mesh.wedge_sets[wedge_set].wedges.start).map_err(|_| too_large(name))?;
        if mesh.triangles.is_empty() && first_wedge == 0 {
            mesh.triangles = triangles;
        } else {
            mesh.triangles.extend(triangles.iter().map(|triangle| triangle.map(|wedge| wedge + first_wedge)));
        }
        mesh.groups.push(Group { triangles: start..mesh.triangles.len(), wedge_set });
        smoothing_groups.push(match *smoothing {
            Smoothing::One(number) => text(number),
            Smoothing::Mixed => None,
        });
        layout.groups.push(GroupLabel {
            object: text(key.object),
            group: text(key.group),
            material: text(key.material),
            mesh: 0,
            primitive: layout.groups.len(),
        });
    }
    Ok(smoothing_groups)
}

/// The triangles of each group, as wedge numbers within its set.
fn triangulate_faces(
    name: &str,
    file: &mut Statements,
    sets: &mut [Wedges],
    group_sets: &[usize],
    is_positions_only: bool,
) -> Result<Vec<Vec<[u32; 3]>>, Error> {
    let mut triangles_of: Vec<Vec<[u32; 3]>> = vec![Vec::new(); file.groups.len()];
    let mut triangulator = Triangulator::new();
    let (mut corners, mut face, mut polygon) = (Corners::default(), 0, Polygon::default());
    for run in &file.runs {
        let set = &mut sets[group_sets[run.group]];
        let triangles = &mut triangles_of[run.group];
        for _ in 0..run.face_count {
            let line = file.face_lines[face] as usize;
            let place = || format!("{name}:{line}");
            face += 1;
            corners.read(file, set.signature, run.corners_per_face, &mut polygon).map_err(|v| {
                let message = format!("in `f`: vertex {} of {}", u64::from(v) + 1, file.positions.len());
                Error::new(ErrorCode::OutOfRange, place(), message)
            })?;
            let Polygon { rows, points } = &polygon;
            if points.len() < 3 || (points.len() == 3 && coincide(points, [0, 1, 2])) {
                file.notices.count(&DEGENERATE_FACE, &place);
                continue;
            }
            for _ in points.len()..run.corners_per_face {
                file.notices.count(&DEGENERATE_TRIANGLE, &place);
            }
            let table = &mut set.table;
            let mut wedge = |row: [u32; 3]| if is_positions_only { row[0] } else { table.number(row) };
            if points.len() == 3 {
                triangles.push([wedge(rows[0]), wedge(rows[1]), wedge(rows[2])]);
                continue;
            }
            let (pieces, is_regular) = triangulator.triangulate(points);
            if !is_regular {
                file.notices.count(&UNTRIANGULATED_FACE, &place);
            }
            for &piece in pieces {
                if coincide(points, piece) {
                    file.notices.count(&DEGENERATE_TRIANGLE, &place);
                } else {
                    triangles.push(piece.map(|corner| wedge(rows[corner])));
                }
            }
        }
    }
    Ok(triangles_of)
}

/// One face: its distinct corners, and where they are.
#[derive(Default)]
struct Polygon {
    rows: Vec<[u32; 3]>,
    points: Vec<[f32; 3]>,
}

/// How many of the file's corners have been read, with positions, texture coordinates and normals.
#[derive(Default)]
struct Corners {
    positions: usize,
    texcoords: usize,
    normals: usize,
}

impl Corners {
    /// Reads the next `size` corners; the number of a position that there is not is an error.
    #[inline]
    fn read(&mut self, file: &Statements, signature: Signature, size: usize, polygon: &mut Polygon) -> Result<(), u32> {
        let Polygon { rows, points } = polygon;
        rows.clear();
        points.clear();
        for corner in 0..size {
            let v = file.corner_positions[self.positions + corner];
            let point = *file.positions.get(v as usize).ok_or(v)?;
            let mut row = [v, 0, 0];
            if signature & HAS_TEXCOORD != 0 {
                row[1] = file.corner_texcoords[self.texcoords + corner];
            }
            if signature & HAS_NORMAL != 0 {
                row[2] = file.corner_normals[self.normals + corner];
            }
            if points.last() != Some(&point) || size == 3 {
                points.push(point);
                rows.push(row);
            }
        }
        self.positions += size;
        self.texcoords += if signature & HAS_TEXCOORD != 0 { size } else { 0 };
        self.normals += if signature & HAS_NORMAL != 0 { size } else { 0 };
        // A polygon may name a corner twice in a row, also across its end.
        while points.len() > 3 && points.first() == points.last() {
            points.pop();
            rows.pop();
        }
        Ok(())
    }
}

/// Whether two corners of a triangle are at one point: it has no area, and as soon as equal
/// points are one vertex no three corners either.
fn coincide(points: &[[f32; 3]], [a, b, c]: [usize; 3]) -> bool {
    points[a] == points[b] || points[b] == points[c] || points[c] == points[a]
}

/// `None` without colours, 4 with an alpha other than 1 at a vertex that is used, else 3.
fn color_components(file: &Statements, mut used: impl Iterator<Item = u32>) -> Option<usize> {
    if file.colors.is_empty() {
        return None;
    }
    let has_alpha = used.any(|v| file.colors[v as usize][3].to_bits() != 1.0_f32.to_bits());
    Some(if has_alpha { 4 } else { 3 })
}

fn color_attribute(file: &Statements, components: usize, of: impl Iterator<Item = usize>) -> Attribute {
    let values = of.flat_map(|v| file.colors[v].into_iter().take(components)).collect();
    Attribute { name: "COLOR_0".into(), components, values, blend: Blend::Linear }
}

fn attributes(file: &Statements, set: &Wedges, colors: Option<usize>) -> Vec<Attribute> {
    let rows = set.table.rows();
    let mut attributes = Vec::new();
    if set.signature & HAS_NORMAL != 0 {
        let values = rows.iter().flat_map(|row| file.normals[row[2] as usize]).collect();
        attributes.push(Attribute { name: "NORMAL".into(), components: 3, values, blend: Blend::Direction });
    }
    if set.signature & HAS_TEXCOORD != 0 {
        let values = rows.iter().flat_map(|row| file.texcoords[row[1] as usize]).collect();
        attributes.push(Attribute { name: "TEXCOORD_0".into(), components: 2, values, blend: Blend::Linear });
    }
    if let Some(components) = colors {
        attributes.push(color_attribute(file, components, rows.iter().map(|row| row[0] as usize)));
    }
    attributes
}

fn too_large(name: &str) -> Error {
    Error::new(ErrorCode::TooLarge, name, "more than a billion elements")
}
