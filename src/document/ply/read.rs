//! The mesh of a PLY file: what of each row is of use, and what the mesh makes of it.

use super::header::{self, Element, Header, Property};
use super::rows::{Cursor, Trouble};
use super::{PlySource, PlyStyle, texture_of};
use crate::document::NamedFile;
use crate::document::faces::{Corner, Faces, color_attribute};
use crate::document::material::{Images, Material, Materials};
use crate::document::notice::Kind;
use crate::error::{Error, ErrorCode, Warning};
use crate::mesh::{Attribute, Blend};

static NOT_FINITE_ATTRIBUTE: Kind =
    ("not-finite-attribute", "values of normals, colours or texture coordinates that are no finite numbers, read as 0");
static MIXED_CORNERS: Kind =
    ("mixed-corners", "faces whose texture coordinates are not two for each corner; they are left out");

/// What the material is called that a texture in a comment makes.
const TEXTURE_MATERIAL: &str = "texture";

/// Where a vertex's values go, by number: position, normal, colour with alpha, texture coordinates.
const CHANNELS: usize = 12;
const NORMAL: usize = 3;
const COLOR: usize = 6;
const ALPHA: usize = 9;
const TEXCOORD: usize = 10;

/// Pairs of names that exporters give texture coordinates.
const TEXCOORD_NAMES: [[&str; 2]; 5] =
    [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"], ["texcoord_u", "texcoord_v"]];
const COLOR_NAMES: [[&str; 4]; 3] = [
    ["red", "green", "blue", "alpha"],
    ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"],
    ["r", "g", "b", "a"],
];
const NORMAL_NAMES: [[&str; 3]; 2] = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];

/// Reads `files[main]`; the others may hold its texture.
///
/// # Errors
/// What the header says wrong; `truncated` if a count or a list exceeds the file; `syntax`,
/// `not-finite` and `out-of-range` with the line or the element's number.
pub(in crate::document) fn read(files: &[NamedFile], main: usize) -> Result<PlySource, Error> {
    let Some(NamedFile { name, bytes }) = files.get(main) else {
        return Err(Error::new(ErrorCode::InvalidArgument, "files", "no such file"));
    };
    let header = header::parse(name, bytes)?;
    let elements = &header.elements;
    let vertices = elements.iter().position(|element| element.name == "vertex");
    let polygons = elements.iter().position(|element| FaceColumns::of(element).is_some());
    let vertex_columns = vertices.map(|at| VertexColumns::of(&elements[at])).unwrap_or_default();
    let face_columns = polygons.and_then(|at| FaceColumns::of(&elements[at])).unwrap_or_default();
    let has_face_colors = face_columns.colors.is_some() && !vertex_columns.has(COLOR);
    let mut faces = Faces::new();
    let mut cursor = Cursor::new(bytes, &header);
    let mut faces_at = None;
    for (at, element) in elements.iter().enumerate() {
        if !cursor.can_hold(element) {
            let message = format!("{} rows of `{}` do not fit into the file", element.count, element.name);
            return Err(Error::new(ErrorCode::Truncated, cursor.place(name), message));
        }
        if Some(at) == vertices {
            read_vertices(name, element, &vertex_columns, &mut cursor, &mut faces)?;
            continue;
        }
        if Some(at) == polygons {
            if vertices.is_some_and(|vertices| vertices < at) {
                read_faces(name, element, &face_columns, has_face_colors, &mut cursor, &mut faces)?;
                continue;
            }
            // Faces before their vertices: come back when these are known.
            faces_at = Some(cursor.clone());
        }
        cursor.skip_element(name, element)?;
    }
    if let (Some(mut cursor), Some(at)) = (faces_at, polygons) {
        read_faces(name, &elements[at], &face_columns, has_face_colors, &mut cursor, &mut faces)?;
    }
    let mut content = faces.finish(name)?;
    let used = |at: usize, property: usize| {
        (Some(at) == vertices && vertex_columns.slots[property].is_some())
            || (Some(at) == polygons && face_columns.uses(property, has_face_colors))
    };
    content.warnings.extend(ignored(name, &header, &[vertices, polygons], used));
    if let Some(texture) = header.remarks.iter().find_map(|remark| texture_of(remark)) {
        let mut images = Images::new(files);
        let mut material = Material::new(TEXTURE_MATERIAL.into());
        material.base_color_image = images.find(texture, main);
        content.warnings.append(&mut images.warnings);
        content.layout.materials = Materials { list: vec![material], images: images.images };
        content.layout.groups.iter_mut().for_each(|label| label.material = Some(TEXTURE_MATERIAL.into()));
    }
    let color = vertex_columns.color_property.map(|at| &elements[vertices.unwrap_or(0)].properties[at]);
    let style = PlyStyle {
        has_float_colors: color.is_some_and(|property| property.scalar.is_float()),
        has_alpha: vertex_columns.has(ALPHA),
        texcoord_names: vertex_columns.texcoord_names,
        remarks: header.remarks,
    };
    Ok(PlySource { content, style })
}

/// What each property of a vertex is for.
#[derive(Default)]
struct VertexColumns {
    /// The channel of each property, and what its values are divided by.
    slots: Vec<Option<(usize, f32)>>,
    color_property: Option<usize>,
    texcoord_names: Option<[&'static str; 2]>,
}

impl VertexColumns {
    fn of(element: &Element) -> Self {
        let mut columns = Self { slots: vec![None; element.properties.len()], ..Self::default() };
        let find = |name: &str| element.properties.iter().position(|p| p.name == name && p.length.is_none());
        let all = |names: &[&str]| names.iter().map(|name| find(name)).collect::<Option<Vec<usize>>>();
        for (channel, name) in ["x", "y", "z"].into_iter().enumerate() {
            if let Some(at) = find(name) {
                columns.slots[at] = Some((channel, 1.0));
            }
        }
        let mut take = |properties: &[usize], first: usize, range: &dyn Fn(usize) -> f32| {
            for (k, &at) in properties.iter().enumerate() {
                columns.slots[at] = Some((first + k, range(at)));
            }
        };
        if let Some(found) = NORMAL_NAMES.iter().find_map(|names| all(names)) {
            take(&found, NORMAL, &|_| 1.0);
        }
        let range = |at: usize| element.properties[at].scalar.color_range();
        if let Some((found, names)) = COLOR_NAMES.iter().find_map(|names| Some((all(&names[..3])?, names))) {
            take(&found, COLOR, &range);
            columns.color_property = Some(found[0]);
            if let Some(alpha) = find(names[3]) {
                columns.slots[alpha] = Some((ALPHA, range(alpha)));
            }
        }
        if let Some((found, names)) = TEXCOORD_NAMES.iter().find_map(|names| Some((all(names)?, names))) {
            for (k, at) in found.into_iter().enumerate() {
                columns.slots[at] = Some((TEXCOORD + k, 1.0));
            }
            columns.texcoord_names = Some(*names);
        }
        columns
    }

    fn has(&self, channel: usize) -> bool {
        self.slots.iter().flatten().any(|slot| slot.0 == channel)
    }
}

fn read_vertices(
    name: &str,
    element: &Element,
    columns: &VertexColumns,
    cursor: &mut Cursor<'_>,
    faces: &mut Faces,
) -> Result<(), Error> {
    if let Some(axis) = (0..3).find(|&axis| !columns.has(axis)) {
        let message = format!("`vertex` has no property `{}`", ["x", "y", "z"][axis]);
        return Err(Error::new(ErrorCode::Syntax, name, message));
    }
    let (has_normals, has_colors, has_texcoords) = (columns.has(NORMAL), columns.has(COLOR), columns.has(TEXCOORD));
    // The rows are there: `can_hold` was asked.
    faces.positions.reserve_exact(element.count);
    let (mut normals, mut colors, mut texcoords) = (Vec::new(), Vec::new(), Vec::new());
    let mut values = [0.0_f32; CHANNELS];
    values[ALPHA] = 1.0;
    for row in 0..element.count {
        cursor.begin_row();
        for (property, slot) in element.properties.iter().zip(&columns.slots) {
            let fail = |cursor: &Cursor<'_>, trouble| cursor.error(trouble, name, element, row, property);
            let Some((channel, range)) = *slot else {
                cursor.skip(property).map_err(|trouble| fail(cursor, trouble))?;
                continue;
            };
            let value = cursor.value(property.scalar).map_err(|trouble| fail(cursor, trouble))?;
            #[allow(clippy::cast_possible_truncation)] // rounding is what is wanted
            let mut value = value as f32 / range;
            if !value.is_finite() {
                if channel < NORMAL {
                    return Err(fail(cursor, Trouble::Text(crate::document::scan::Fault::NotFinite)));
                }
                faces.notices.count(&NOT_FINITE_ATTRIBUTE, &|| cursor.place(name));
                value = 0.0;
            }
            values[channel] = value;
        }
        if cursor.end_row() {
            note_extra(faces, cursor, name);
        }
        let [x, y, z, nx, ny, nz, r, g, b, a, u, v] = values;
        faces.positions.push([x, y, z]);
        if has_normals {
            normals.push([nx, ny, nz]);
        }
        if has_colors {
            colors.push([r, g, b, a]);
        }
        if has_texcoords {
            texcoords.push([u, v]);
        }
    }
    let mut add = |name: &str, components, values, blend| {
        faces.attributes.push(Attribute { name: name.into(), components, values, blend });
    };
    if has_normals {
        add("NORMAL", 3, normals.into_flattened(), Blend::Direction);
    }
    if has_texcoords {
        add("TEXCOORD_0", 2, texcoords.into_flattened(), Blend::Linear);
    }
    if has_colors {
        faces.attributes.push(color_attribute(colors, Blend::Linear));
    }
    Ok(())
}

fn note_extra(faces: &mut Faces, cursor: &Cursor<'_>, name: &str) {
    faces.notices.count(&("extra-numbers-ignored", "lines with more numbers than they take"), &|| cursor.place(name));
}

/// What each property of a face is for, by the property's number.
#[derive(Default)]
struct FaceColumns {
    indices: usize,
    is_strip: bool,
    /// u and v of every corner.
    texcoords: Option<usize>,
    /// Red, green, blue, and alpha if it is there.
    colors: Option<[Option<usize>; 4]>,
}

impl FaceColumns {
    /// `None` if the rows are no faces.
    fn of(element: &Element) -> Option<Self> {
        let is_strip = element.name == "tristrips";
        if element.name != "face" && !is_strip {
            return None;
        }
        let list = |names: &[&str]| {
            element.properties.iter().position(|p| names.contains(&p.name.as_str()) && p.length.is_some())
        };
        let indices = list(&["vertex_indices", "vertex_index"])?;
        let single = |name: &str| element.properties.iter().position(|p| p.name == name && p.length.is_none());
        let texcoords = if is_strip { None } else { list(&["texcoord"]) };
        let colors = COLOR_NAMES[..2].iter().map(|names| names.map(single));
        let colors = colors.into_iter().find(|found| !is_strip && found[..3].iter().all(Option::is_some));
        Some(Self { indices, is_strip, texcoords, colors })
    }

    fn uses(&self, property: usize, has_face_colors: bool) -> bool {
        let is_color = || self.colors.is_some_and(|colors| colors.contains(&Some(property)));
        property == self.indices || self.texcoords == Some(property) || (has_face_colors && is_color())
    }
}

fn read_faces(
    name: &str,
    element: &Element,
    columns: &FaceColumns,
    has_face_colors: bool,
    cursor: &mut Cursor<'_>,
    faces: &mut Faces,
) -> Result<(), Error> {
    faces.reserve(element.count);
    let is_text = matches!(cursor, Cursor::Text(..));
    let (mut indices, mut texcoords): (Vec<i64>, Vec<f32>) = (Vec::new(), Vec::new());
    let mut corners: Vec<Corner> = Vec::new();
    for row in 0..element.count {
        cursor.begin_row();
        indices.clear();
        texcoords.clear();
        let mut color = [1.0_f32; 4];
        for (at, property) in element.properties.iter().enumerate() {
            let mut read = |cursor: &mut Cursor<'_>| -> Result<(), Trouble> {
                match property.length {
                    Some(length) if at == columns.indices => {
                        for _ in 0..cursor.length(length, property.scalar)? {
                            #[allow(clippy::cast_possible_truncation)] // saturates, out of every range
                            indices.push(cursor.value(property.scalar)? as i64);
                        }
                    }
                    Some(length) if columns.texcoords == Some(at) => {
                        for _ in 0..cursor.length(length, property.scalar)? {
                            let value = to_f32(cursor.value(property.scalar)?);
                            texcoords.push(if value.is_finite() { value } else { 0.0 });
                        }
                    }
                    None if has_face_colors && columns.uses(at, true) => {
                        let value = to_f32(cursor.value(property.scalar)?) / property.scalar.color_range();
                        let channel = columns.colors.and_then(|colors| colors.iter().position(|c| *c == Some(at)));
                        color[channel.unwrap_or(0)] = if value.is_finite() { value } else { 0.0 };
                    }
                    _ => cursor.skip(property)?,
                }
                Ok(())
            };
            read(cursor).map_err(|trouble| cursor.error(trouble, name, element, row, property))?;
        }
        let place = || if is_text { cursor.place(name) } else { format!("{name}: {} {row}", element.name) };
        if columns.is_strip {
            strip(&indices, faces, &place)?;
        } else {
            let color = if has_face_colors { faces.color(color) } else { 0 };
            let has_texcoords = texcoords.len() == 2 * indices.len();
            if !has_texcoords && !texcoords.is_empty() {
                faces.notices.count(&MIXED_CORNERS, &place);
            }
            corners.clear();
            for (k, &index) in indices.iter().enumerate() {
                let texcoord = if has_texcoords { faces.texcoord([texcoords[2 * k], texcoords[2 * k + 1]]) } else { 0 };
                corners.push(Corner { vertex: vertex(index, &place)?, texcoord, color, normal: 0 });
            }
            faces.polygon(&corners, &place)?;
        }
        if cursor.end_row() {
            note_extra(faces, cursor, name);
        }
    }
    Ok(())
}

/// The triangles of strips that -1 separates. Repeated indices, which turn or bridge a strip, make
/// none.
fn strip(indices: &[i64], faces: &mut Faces, place: &dyn Fn() -> String) -> Result<(), Error> {
    for strip in indices.split(|&index| index == -1) {
        for (at, triple) in strip.windows(3).enumerate() {
            let [a, b, c] = [triple[0], triple[1], triple[2]];
            if a == b || b == c || c == a {
                continue;
            }
            let winding = if at % 2 == 0 { [a, b, c] } else { [b, a, c] };
            let mut corners = [Corner::default(); 3];
            for (corner, index) in corners.iter_mut().zip(winding) {
                corner.vertex = vertex(index, place)?;
            }
            faces.polygon(&corners, place)?;
        }
    }
    Ok(())
}

fn vertex(index: i64, place: &dyn Fn() -> String) -> Result<u32, Error> {
    u32::try_from(index).map_err(|_| Error::new(ErrorCode::OutOfRange, place(), format!("{index} is no vertex")))
}

#[allow(clippy::cast_possible_truncation)] // rounding is what is wanted
fn to_f32(value: f64) -> f32 {
    value as f32
}

/// One warning for the elements and one for the properties that are not used.
fn ignored(name: &str, header: &Header, known: &[Option<usize>], used: impl Fn(usize, usize) -> bool) -> Vec<Warning> {
    let (mut elements, mut properties): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    for (at, element) in header.elements.iter().enumerate().filter(|(_, element)| element.count > 0) {
        if !known.contains(&Some(at)) {
            elements.push(element.name.clone());
            continue;
        }
        let unused = element.properties.iter().enumerate().filter(|(property, _)| !used(at, *property));
        properties.extend(unused.map(|(_, Property { name, .. })| format!("{}.{name}", element.name)));
    }
    let warning = |code, mut names: Vec<String>, what: &str| {
        let count = names.len();
        names.truncate(8);
        let more = if count > names.len() { format!(" and {} more", count - names.len()) } else { String::new() };
        let message = format!("{what} left out: {}{more}", names.join(", "));
        (count > 0).then(|| Warning { code, message, place: name.to_owned() })
    };
    let elements = warning("elements-ignored", elements, "elements");
    elements.into_iter().chain(warning("properties-ignored", properties, "properties")).collect()
}
