//! `Document`: a whole file, of which the meshes can be replaced and the rest is kept.

mod external;
pub mod gltf;
pub mod obj;

pub use external::external_files;

use crate::error::{Error, ErrorCode, Warning};
use crate::mesh::Mesh;

/// A file by its name and content. Readers find referenced files by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedFile {
    /// As the referring file names it, relative, with `/`: `textures/a.png`; or just its last part.
    pub name: String,
    /// The content.
    pub bytes: Vec<u8>,
}

/// A file format that can be read or written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Binary glTF 2.0.
    Glb,
    /// glTF 2.0 as JSON, with embedded or separate files. Read only.
    Gltf,
    /// Wavefront OBJ.
    Obj,
}

impl Format {
    /// The lower-case name, also the file extension.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::Obj => "obj",
        }
    }
}

/// What a writer of another format needs to know of the scene: names, materials, placements.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneLayout {
    /// One for each [`Mesh::groups`] entry.
    pub groups: Vec<GroupLabel>,
    /// Where each part stands in the scene; a part may appear several times or never.
    pub instances: Vec<Instance>,
    /// Material libraries named by an OBJ file (`mtllib`), in order.
    pub material_libraries: Vec<String>,
    /// Texture coordinate v grows downwards (glTF) and not upwards (OBJ). A writer of the other
    /// convention flips it: v' = 1 - v. The glTF reader sets it.
    pub texture_v_down: bool,
}

/// Names that go with one group.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct GroupLabel {
    /// Object or mesh name; groups of one part and the same object belong together.
    pub object: Option<String>,
    /// `g` name(s) of an OBJ file, as written.
    pub group: Option<String>,
    /// Material name.
    pub material: Option<String>,
    /// Index of the glTF mesh and of the primitive in it (OBJ: 0 and the group's index).
    pub mesh: usize,
    /// See `mesh`.
    pub primitive: usize,
}

/// One appearance of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    /// Index in [`Mesh::parts`].
    pub part: usize,
    /// Column-major 4×4 matrix, world from the part's local space.
    pub world_from_local: [f64; 16],
}

/// A whole file in memory.
#[derive(Debug)]
pub struct Document {
    source: Source,
    byte_count: usize,
}

#[derive(Debug)]
enum Source {
    Gltf(Box<gltf::GltfSource>),
    Obj(Box<obj::ObjSource>),
}

impl Document {
    /// Reads the first of `files` whose content is a model; the others are what it refers to.
    ///
    /// # Errors
    /// A typed [`Error`] with the place for anything malformed, missing or unsupported.
    pub fn open(files: Vec<NamedFile>) -> Result<Self, Error> {
        let byte_count = files.iter().map(|f| f.bytes.len()).sum();
        let (main, format) = sniff_all(&files)?;
        let name = files[main].name.clone();
        let source = match format {
            Format::Glb | Format::Gltf => Source::Gltf(Box::new(gltf::read(files, main, format)?)),
            Format::Obj => Source::Obj(Box::new(obj::read(&files[main])?)),
        };
        let document = Self { source, byte_count };
        if document.mesh().triangles.is_empty() {
            return Err(Error::new(ErrorCode::NoTriangles, name, "the file has no triangles"));
        }
        Ok(document)
    }

    /// The format that was read.
    #[must_use]
    pub fn format(&self) -> Format {
        match &self.source {
            Source::Gltf(source) => source.format,
            Source::Obj(_) => Format::Obj,
        }
    }

    /// All bytes given to [`Document::open`].
    #[must_use]
    pub fn byte_count(&self) -> usize {
        self.byte_count
    }

    /// Every triangle of the file.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        match &self.source {
            Source::Gltf(source) => &source.mesh,
            Source::Obj(source) => &source.mesh,
        }
    }

    /// Names and placements, by the groups and parts of [`Document::mesh`].
    #[must_use]
    pub fn layout(&self) -> &SceneLayout {
        match &self.source {
            Source::Gltf(source) => &source.layout,
            Source::Obj(source) => &source.layout,
        }
    }

    /// What reading had to change or leave out.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        match &self.source {
            Source::Gltf(source) => &source.warnings,
            Source::Obj(source) => &source.warnings,
        }
    }

    /// The file with `mesh` in the place of what was read. `mesh` has the same groups, wedge
    /// sets (with the same attributes) and parts as [`Document::mesh`], in the same order; any of
    /// them may be empty.
    ///
    /// # Errors
    /// `unsupported` for a format that cannot be written.
    pub fn write(&self, mesh: &Mesh, format: Format) -> Result<Vec<u8>, Error> {
        match (&self.source, format) {
            (Source::Gltf(source), Format::Glb) => gltf::write(source, mesh),
            (Source::Obj(_), Format::Glb) => gltf::write_new(mesh, self.layout()),
            (Source::Obj(source), Format::Obj) => obj::write(source, mesh),
            (Source::Gltf(source), Format::Obj) => obj::write_new(mesh, &source.layout),
            (_, Format::Gltf) => {
                Err(Error::new(ErrorCode::Unsupported, "format", "writing .gltf is not supported; write .glb"))
            }
        }
    }
}

/// The first file that is a model, and its format.
fn sniff_all(files: &[NamedFile]) -> Result<(usize, Format), Error> {
    if let Some(found) = files.iter().enumerate().find_map(|(i, file)| Some((i, sniff(file)?))) {
        return Ok(found);
    }
    let name = files.first().map_or("", |f| f.name.as_str());
    Err(Error::new(
        ErrorCode::UnknownFormat,
        name,
        if files.is_empty() { "no file was given" } else { "neither glTF, GLB nor OBJ" },
    ))
}

/// The format by content, never by name alone: `None` if it is none of ours.
fn sniff(file: &NamedFile) -> Option<Format> {
    if file.bytes.starts_with(b"glTF") {
        return Some(Format::Glb);
    }
    let text = file.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&file.bytes);
    let first = text.iter().find(|b| !b.is_ascii_whitespace());
    if first == Some(&b'{') {
        return Some(Format::Gltf);
    }
    obj::looks_like_obj(text).then_some(Format::Obj)
}
