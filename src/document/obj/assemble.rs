//! The mesh of an OBJ file's statements: wedges from corners, triangles from faces, groups.
//!
//! A wedge is a distinct `(v, vt, vn)`; the faces of one attribute signature share a wedge set. If
//! no face has attributes of its own, every `v` is a wedge, in the order of the file.

use super::ObjSource;
use super::notice::Notice;
use super::statements::{HAS_NORMAL, HAS_TEXCOORD, Signature, Smoothing, Statements};
use crate::document::content::Content;
use crate::document::faces::IDENTITY;
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

    let mut group_triangles = triangulate_faces(name, &mut file, &mut sets, &group_sets, is_positions_only)?;

    let mut mesh = Mesh { parts: vec![Part { scale: 1.0 }], ..Mesh::default() };
    // Index of each set in the mesh; a set whose faces were all degenerate gets none.
    let mut set_numbers = vec![0; sets.len()];
    let colors = if is_positions_only {
        color_components(&file, group_triangles.iter().flatten().flatten().copied())
    } else {
        color_components(&file, sets.iter().flat_map(|set| set.table.rows()).map(|row| row[0]))
    };
    if is_positions_only {
        let attributes =
            colors.map(|count| color_attribute(&file, count, 0..file.positions.len())).into_iter().collect();
        mesh.positions = std::mem::take(&mut file.positions);
        mesh.wedge_sets.push(WedgeSet { wedges: 0..mesh.positions.len(), part: 0, attributes });
    } else {
        for (number, set) in set_numbers.iter_mut().zip(&sets).filter(|(_, set)| !set.table.rows().is_empty()) {
            *number = mesh.wedge_sets.len();
            let start = mesh.positions.len();
            mesh.positions.extend(set.table.rows().iter().map(|row| file.positions[row[0] as usize]));
            let attributes = attributes(&file, set, colors);
            mesh.wedge_sets.push(WedgeSet { wedges: start..mesh.positions.len(), part: 0, attributes });
        }
    }
    let mut layout = SceneLayout {
        instances: vec![Instance { part: 0, world_from_local: IDENTITY }],
        material_libraries: std::mem::take(&mut file.material_libraries),
        ..SceneLayout::default()
    };
    let text = |number: u32| Some(&file.names[number as usize]).filter(|name| !name.is_empty()).cloned();
    let mut smoothing_groups = Vec::new();
    for (number, (key, smoothing)) in file.groups.iter().enumerate() {
        let triangles = std::mem::take(&mut group_triangles[number]);
        if triangles.is_empty() {
            continue;
        }
        let start = mesh.triangles.len();
        let wedge_set = set_numbers[group_sets[number]];
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
    if mesh.positions.len() >= u32::MAX as usize || mesh.triangles.len() >= u32::MAX as usize / 4 {
        return Err(too_large(name));
    }
    let content = Content { mesh, layout, warnings: file.notices.into_warnings(name) };
    Ok(ObjSource { content, smoothing_groups })
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
    let (mut face, mut next_position, mut next_texcoord, mut next_normal) = (0, 0, 0, 0);
    let (mut rows, mut points): (Vec<[u32; 3]>, Vec<[f32; 3]>) = (Vec::new(), Vec::new());
    for run in &file.runs {
        let set = &mut sets[group_sets[run.group]];
        let triangles = &mut triangles_of[run.group];
        let size = run.corners_per_face;
        for _ in 0..run.face_count {
            let line = file.face_lines[face] as usize;
            face += 1;
            rows.clear();
            points.clear();
            for corner in 0..size {
                let v = file.corner_positions[next_position + corner];
                let Some(&point) = file.positions.get(v as usize) else {
                    let message = format!("in `f`: vertex {} of {}", u64::from(v) + 1, file.positions.len());
                    return Err(Error::new(ErrorCode::OutOfRange, format!("{name}:{line}"), message));
                };
                let mut row = [v, 0, 0];
                if set.signature & HAS_TEXCOORD != 0 {
                    row[1] = file.corner_texcoords[next_texcoord + corner];
                }
                if set.signature & HAS_NORMAL != 0 {
                    row[2] = file.corner_normals[next_normal + corner];
                }
                if points.last() != Some(&point) || size == 3 {
                    points.push(point);
                    rows.push(row);
                }
            }
            next_position += size;
            next_texcoord += if set.signature & HAS_TEXCOORD != 0 { size } else { 0 };
            next_normal += if set.signature & HAS_NORMAL != 0 { size } else { 0 };

            // A polygon may name a corner twice in a row, also across its end.
            while points.len() > 3 && points.first() == points.last() {
                points.pop();
                rows.pop();
            }
            if points.len() < 3 || (points.len() == 3 && coincide(&points, [0, 1, 2])) {
                file.notices.count(Notice::DegenerateFace, line);
                continue;
            }
            for _ in points.len()..size {
                file.notices.count(Notice::DegenerateTriangle, line);
            }
            let table = &mut set.table;
            let mut wedge = |row: [u32; 3]| if is_positions_only { row[0] } else { table.number(row) };
            if points.len() == 3 {
                triangles.push([wedge(rows[0]), wedge(rows[1]), wedge(rows[2])]);
                continue;
            }
            let (pieces, is_regular) = triangulator.triangulate(&points);
            if !is_regular {
                file.notices.count(Notice::UntriangulatedFace, line);
            }
            for &piece in pieces {
                if coincide(&points, piece) {
                    file.notices.count(Notice::DegenerateTriangle, line);
                } else {
                    triangles.push(piece.map(|corner| wedge(rows[corner])));
                }
            }
        }
    }
    Ok(triangles_of)
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
