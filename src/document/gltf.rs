//! glTF 2.0: reads the triangles, writes by editing the JSON tree that was read.
//!
//! The tree is never rebuilt, so what is not understood here survives: materials, extensions,
//! extras, names, order. [`container`] takes GLB files apart, [`schema`] reads and checks what
//! the geometry needs of the JSON ([`spot`] knows the paths), [`plan`] finds the triangles' accessors, which [`accessor`] checks
//! and decodes, [`read`] makes the mesh; [`write()`] puts a mesh back, with
//! [`usage`] to know what else needs a buffer view and [`pack`] to lay out the binary chunk.
//! [`new`] makes a tree for a mesh that came from another format.

mod accessor;
mod attributes;
mod carried;
mod column;
mod container;
mod json;
mod layout;
mod materials;
mod new;
mod order;
mod pack;
mod plan;
mod read;
mod resource;
mod scene;
mod schema;
mod spot;
mod unique;
mod usage;
mod write;

use crate::document::json_tree::Value;

use crate::document::lookup::shorten;
use crate::document::{Format, NamedFile, SceneLayout};
use crate::error::{Error, Warning};
use crate::mesh::Mesh;

use accessor::{Data, view_bytes};
use json::{items, members, text};
use plan::Plan;
use resource::Content;
use scene::Appearances;
use schema::Root;

pub(super) use new::write_new;
pub(super) use write::write;

/// A glTF file as read.
#[derive(Debug)]
pub(super) struct GltfSource {
    pub(super) format: Format,
    pub(super) mesh: Mesh,
    pub(super) layout: SceneLayout,
    pub(super) warnings: Vec<Warning>,
    /// The JSON as in the file.
    tree: Value,
    files: Vec<NamedFile>,
    /// One for each entry of `buffers` and of `images` in the tree.
    buffers: Vec<Content>,
    images: Vec<Content>,
    /// One for each group and each wedge set of the mesh.
    primitives: Vec<PrimitiveSource>,
    sets: Vec<SetSource>,
}

impl GltfSource {
    /// The JSON as in the file.
    pub(super) fn tree(&self) -> &Value {
        &self.tree
    }
}

/// The primitive that a group is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct PrimitiveSource {
    mesh: usize,
    primitive: usize,
}

impl PrimitiveSource {
    /// Its JSON path.
    fn place(self) -> String {
        format!("meshes[{}].primitives[{}]", self.mesh, self.primitive)
    }
}

/// The accessors of a wedge set.
#[derive(Debug)]
struct SetSource {
    /// `POSITION` first, then one for each attribute of the wedge set.
    attributes: Vec<AttributeSource>,
}

/// One attribute of a primitive, or of one of its morph targets.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct AttributeSource {
    target: Option<usize>,
    semantic: String,
    accessor: usize,
}

/// What it takes to decode the geometry of a file.
#[derive(Debug)]
pub(super) struct Undecoded {
    root: Root,
    plan: Plan,
    /// Of each part.
    scales: Vec<f32>,
}

/// Reads `files[main]`, a GLB or .gltf, up to the numbers of the geometry; the other files are what it may refer to. The
/// source is whole but for its mesh and sets.
///
/// # Errors
/// A typed [`Error`] whose place is the file's name and a JSON path or byte offset.
pub(super) fn outline(files: Vec<NamedFile>, main: usize, format: Format) -> Result<(GltfSource, Undecoded), Error> {
    let name = files.get(main).map_or_else(String::new, |file| file.name.clone());
    let (mut source, undecoded) = outline_places(files, main, format).map_err(|error| error_in_file(&name, &error))?;
    put_in_file(&name, &mut source.warnings);
    Ok((source, undecoded))
}

impl Undecoded {
    /// Gives the file its geometry; `name` is the file's.
    ///
    /// # Errors
    /// As of [`outline()`]: `out-of-range` for indices, `not-finite` for positions, `too-large`.
    pub(super) fn decode(mut self, source: &mut GltfSource, name: &str) -> Result<(), Error> {
        let GltfSource { tree, files, buffers, warnings, .. } = source;
        let data = Data { root: &self.root, tree, buffers, files };
        let before = warnings.len();
        source.mesh = read::geometry(data, &mut self.plan, &self.scales, warnings)
            .map_err(|error| error_in_file(name, &error))?;
        put_in_file(name, &mut warnings[before..]);
        source.sets = self.plan.sets.into_iter().map(|planned| planned.set).collect();
        Ok(())
    }
}

fn in_file(name: &str, place: &str) -> String {
    match (name.is_empty(), place.is_empty()) {
        (true, _) => place.to_owned(),
        (false, true) => name.to_owned(),
        (false, false) => format!("{name}: {place}"),
    }
}

fn error_in_file(name: &str, error: &Error) -> Error {
    Error::new(error.code(), in_file(name, error.place()), error.message())
}

fn put_in_file(name: &str, warnings: &mut [Warning]) {
    warnings.iter_mut().for_each(|warning| warning.place = in_file(name, &warning.place));
}

/// As [`outline()`], with places relative to the file.
fn outline_places(files: Vec<NamedFile>, main: usize, format: Format) -> Result<(GltfSource, Undecoded), Error> {
    let mut warnings = Vec::new();
    let bytes = files.get(main).map_or(&[][..], |file| &file.bytes);
    let (json, binary) = match format {
        Format::Glb => {
            let chunks = container::parse(bytes)?;
            if !chunks.is_padded {
                let message = "a chunk's length is not a multiple of 4".to_owned();
                warnings.push(Warning { code: "chunk-padding", message, place: "byte 12".into() });
            }
            (&bytes[chunks.json], chunks.binary)
        }
        _ => (bytes, None),
    };
    let (tree, root) = schema::parse(json)?;
    let buffers = resource::load_buffers(&tree, &root, &files, main, binary.as_ref())?;
    let data = Data { root: &root, tree: &tree, buffers: &buffers, files: &files };
    // Also those that no triangle needs: they are carried over to the output.
    for view in 0..root.views.len() {
        view_bytes(data, view)?;
    }
    let Appearances { instances, scales } = scene::appearances(data)?;
    let plan = plan::plan(data)?;
    let primitives: Vec<PrimitiveSource> = plan.primitives.iter().map(|planned| planned.source).collect();
    let groups = primitives.iter().map(|source| scene::label(&tree, source.mesh, source.primitive)).collect();
    let layout =
        SceneLayout { groups, instances, texture_v_down: true, has_linear_colors: true, ..SceneLayout::default() };
    let images = find_images(&tree, &files, main, &mut warnings);
    carried::warn_of_dangling(&tree, &mut warnings);
    warn_of_lost_extensions(&tree, &mut warnings);
    let (mesh, sets) = (Mesh::default(), Vec::new());
    let source = GltfSource { format, mesh, layout, warnings, tree, files, buffers, images, primitives, sets };
    Ok((source, Undecoded { root, plan, scales }))
}

/// An image that is not there does not stop anybody from simplifying the mesh.
fn find_images(tree: &Value, files: &[NamedFile], main: usize, warnings: &mut Vec<Warning>) -> Vec<Content> {
    let mut find = |(i, image): (usize, &Value)| {
        let Some(uri) = text(image, "uri") else {
            return Content::Absent;
        };
        let (code, message) = match resource::resolve(uri, files, main) {
            Ok(Some(content)) => return content,
            Ok(None) => {
                let file = shorten(uri);
                ("missing-image", format!("the file \"{file}\" was not given; the reference to it is kept"))
            }
            Err(reason) => ("bad-image", format!("{reason}; kept as it is")),
        };
        warnings.push(Warning { code, message, place: format!("images[{i}].uri") });
        Content::Absent
    };
    items(tree, "images").iter().enumerate().map(&mut find).collect()
}

/// What numbers vertices or triangles is an extension of a mesh or a primitive, so only these are looked through.
fn warn_of_lost_extensions(tree: &Value, warnings: &mut Vec<Warning>) {
    const FEATURES: &str = "EXT_mesh_features";
    let mut used = write::VERTEX_EXTENSIONS.map(|name| (name, false));
    let mut has_features = false;
    for mesh in items(tree, "meshes") {
        for holder in items(mesh, "primitives").iter().chain([mesh]) {
            for (found, _) in members(holder, "extensions") {
                has_features |= found == FEATURES;
                used.iter_mut().for_each(|(name, used)| *used |= found == *name);
            }
        }
    }
    if has_features {
        carried::warn_of_implicit_ids(tree, warnings);
    }
    for (name, _) in used.iter().filter(|(_, used)| *used) {
        warnings.push(Warning {
            code: "extension-dropped",
            message: format!("{name} numbers the vertices or triangles that change; it is not written"),
            place: "extensionsUsed".into(),
        });
    }
}
