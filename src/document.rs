//! `Document`: a whole file, of which the meshes can be replaced and the rest is kept.

mod color;
mod content;
mod external;
mod faces;
mod flat;
pub mod gltf;
mod json_parse;
mod json_tree;
mod lookup;
mod losses;
mod material;
mod notice;
pub mod obj;
pub mod off;
mod place;
pub mod ply;
mod polygon;
mod row_table;
mod scan;
pub mod smf;
mod sniff;
pub mod stl;
mod text;

pub use external::external_files;
pub use material::{Material, Materials};

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
    /// Stanford PLY, text or binary; written in binary.
    Ply,
    /// STL, text or binary; written in binary.
    Stl,
    /// Geomview OFF.
    Off,
    /// Garland's SMF.
    Smf,
}

impl Format {
    /// The lower-case name, also the file extension.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Off => "off",
            Self::Smf => "smf",
        }
    }

    /// The format that can be written under this name.
    #[must_use]
    pub fn output(name: &str) -> Option<Self> {
        Self::OUTPUT.into_iter().find(|format| format.as_str() == name)
    }

    /// Every format that can be written.
    pub const OUTPUT: [Self; 6] = [Self::Glb, Self::Obj, Self::Ply, Self::Stl, Self::Off, Self::Smf];
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
    /// Colours are linear (glTF) and not sRGB, as in every other format here. A writer of the other
    /// convention converts them. The glTF reader sets it.
    pub has_linear_colors: bool,
    /// Materials by name, for formats that hold them elsewhere than glTF does.
    pub materials: Materials,
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

/// A glTF file taken apart and checked, its geometry still as bytes: [`Document::open`] in two steps, for who wants to
/// know what a file is, or to decode it later.
///
/// It keeps the files it was given, without a copy. Of the other formats nothing can be known before all of it is read,
/// which is done at once.
#[derive(Debug)]
pub struct Outline {
    /// A glTF without its mesh, any other whole.
    source: Source,
    /// What is left to do for a glTF.
    geometry: Option<Box<gltf::Undecoded>>,
    byte_count: usize,
    /// Of the file that is the model.
    name: String,
}

impl Outline {
    /// Reads the container and the JSON of the first of `files` whose content is a model, and checks all references,
    /// counts and byte ranges that the triangles depend on.
    ///
    /// # Errors
    /// As of [`Document::open`], but for what takes the numbers themselves: indices of vertices that are not there, and
    /// positions that are not finite.
    pub fn parse(mut files: Vec<NamedFile>) -> Result<Self, Error> {
        let byte_count = files.iter().map(|f| f.bytes.len()).sum();
        let (main, format) = sniff::first_model(&mut files)?;
        let name = files[main].name.clone();
        let mut geometry = None;
        let source = match format {
            Format::Glb | Format::Gltf => {
                let (source, undecoded) = gltf::outline(files, main, format)?;
                geometry = Some(Box::new(undecoded));
                Source::Gltf(Box::new(source))
            }
            Format::Obj => Source::Obj(Box::new(obj::read(&files, main)?)),
            Format::Ply => Source::Ply(Box::new(ply::read(&files, main)?)),
            Format::Stl => Source::Stl(Box::new(stl::read(&files[main])?)),
            Format::Off => Source::Off(Box::new(off::read(&files[main])?)),
            Format::Smf => Source::Smf(Box::new(smf::read(&files[main])?)),
        };
        Ok(Self { source, geometry, byte_count, name })
    }

    /// The format that was read.
    #[must_use]
    pub fn format(&self) -> Format {
        self.source.format()
    }

    /// As [`Document::layout`].
    #[must_use]
    pub fn layout(&self) -> &SceneLayout {
        self.source.content().1
    }

    /// What reading had to change or leave out so far.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        self.source.content().2
    }

    /// Decodes the geometry.
    ///
    /// # Errors
    /// `out-of-range` for an index of a vertex that is not there, `not-finite` for a position, `too-large` for more than
    /// memory can hold, each with the JSON path of the primitive; `no-triangles` for another format than glTF without
    /// any.
    pub fn decode(self) -> Result<Document, Error> {
        let Self { mut source, geometry, byte_count, name } = self;
        if let (Source::Gltf(source), Some(geometry)) = (&mut source, geometry) {
            geometry.decode(source, &name)?;
        }
        let mut document = Document { source, byte_count };
        if document.mesh().triangles.is_empty() {
            let message = "the file has no triangles";
            // A glTF may be points, lines, or an animation alone, and goes through as it is.
            let Source::Gltf(source) = &mut document.source else {
                return Err(Error::new(ErrorCode::NoTriangles, name, message));
            };
            let message = format!("{message}: there is nothing to simplify");
            source.warnings.push(Warning { code: ErrorCode::NoTriangles.as_str(), message, place: name });
        }
        Ok(document)
    }
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
    Ply(Box<ply::PlySource>),
    Stl(Box<stl::StlSource>),
    Off(Box<off::OffSource>),
    Smf(Box<smf::SmfSource>),
}

impl Source {
    fn format(&self) -> Format {
        match self {
            Self::Gltf(source) => source.format,
            Self::Obj(_) => Format::Obj,
            Self::Ply(_) => Format::Ply,
            Self::Stl(_) => Format::Stl,
            Self::Off(_) => Format::Off,
            Self::Smf(_) => Format::Smf,
        }
    }

    fn content(&self) -> (&Mesh, &SceneLayout, &[Warning]) {
        let content = match self {
            Self::Gltf(source) => return (&source.mesh, &source.layout, &source.warnings),
            Self::Obj(source) => &source.content,
            Self::Ply(source) => &source.content,
            Self::Stl(source) => &source.content,
            Self::Off(source) => &source.content,
            Self::Smf(source) => &source.content,
        };
        (&content.mesh, &content.layout, &content.warnings)
    }
}

impl Document {
    /// Reads the first of `files` whose content is a model; the others are what it refers to.
    ///
    /// A glTF without triangles is read with a warning; its mesh is empty.
    ///
    /// # Errors
    /// A typed [`Error`] with the place for anything malformed, missing or unsupported; `no-triangles` for another
    /// format without any.
    pub fn open(files: Vec<NamedFile>) -> Result<Self, Error> {
        Outline::parse(files)?.decode()
    }

    /// The format that was read.
    #[must_use]
    pub fn format(&self) -> Format {
        self.source.format()
    }

    /// All bytes given to [`Document::open`].
    #[must_use]
    pub fn byte_count(&self) -> usize {
        self.byte_count
    }

    /// Every triangle of the file.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        self.source.content().0
    }

    /// Names and placements, by the groups and parts of [`Document::mesh`].
    #[must_use]
    pub fn layout(&self) -> &SceneLayout {
        self.source.content().1
    }

    /// What reading had to change or leave out.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        self.source.content().2
    }

    /// What the file has and `format` cannot hold: one warning, or none.
    #[must_use]
    pub fn losses(&self, format: Format) -> Option<Warning> {
        let has_facet_colors = matches!(&self.source, Source::Stl(source) if source.style.has_colors());
        let gltf_tree = match &self.source {
            Source::Gltf(source) => Some(source.tree()),
            _ => None,
        };
        losses::losses(self.format(), self.mesh(), self.layout(), gltf_tree, has_facet_colors, format)
    }

    /// The file with `mesh` in the place of what was read. `mesh` has the same groups, wedge
    /// sets (with the same attributes) and parts as [`Document::mesh`], in the same order; any of
    /// them may be empty. What `format` cannot hold is left out; [`Document::losses`] names it.
    ///
    /// # Errors
    /// `unsupported` for a format that cannot be written; `not-finite` if a placement moves a
    /// vertex out of range; `too-large` beyond what the format or memory can hold; `no-triangles` for another format
    /// than glTF if the file has none.
    pub fn write(&self, mesh: &Mesh, format: Format) -> Result<Vec<u8>, Error> {
        let layout = self.layout();
        if format != Format::Glb && self.mesh().triangles.is_empty() {
            let message = "the file has no triangles, which only glTF can hold";
            return Err(Error::new(ErrorCode::NoTriangles, "format", message));
        }
        match (format, &self.source) {
            (Format::Glb, Source::Gltf(source)) => gltf::write(source, mesh),
            (Format::Glb, _) => gltf::write_new(mesh, layout),
            (Format::Obj, Source::Obj(source)) => obj::write(source, mesh),
            (Format::Obj, _) => obj::write_new(mesh, layout),
            (Format::Ply, Source::Ply(source)) => ply::write(mesh, layout, &source.style),
            (Format::Ply, _) => ply::write(mesh, layout, &ply::PlyStyle::default()),
            (Format::Stl, Source::Stl(source)) => stl::write(mesh, layout, &source.style),
            (Format::Stl, _) => stl::write(mesh, layout, &stl::StlStyle::default()),
            (Format::Off, Source::Off(source)) => off::write(mesh, layout, source.style),
            (Format::Off, _) => off::write(mesh, layout, off::OffStyle::default()),
            (Format::Smf, _) => smf::write(mesh, layout),
            (Format::Gltf, _) => {
                Err(Error::new(ErrorCode::Unsupported, "format", "writing .gltf is not supported; write .glb"))
            }
        }
    }
}
