//! `Document`: a whole file, of which the meshes can be replaced and the rest is kept.

mod color;
mod content;
mod external;
mod faces;
mod flat;
pub mod gltf;
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

impl Document {
    /// Reads the first of `files` whose content is a model; the others are what it refers to.
    ///
    /// A glTF without triangles is read with a warning; its mesh is empty.
    ///
    /// # Errors
    /// A typed [`Error`] with the place for anything malformed, missing or unsupported; `no-triangles` for another
    /// format without any.
    pub fn open(mut files: Vec<NamedFile>) -> Result<Self, Error> {
        let byte_count = files.iter().map(|f| f.bytes.len()).sum();
        let (main, format) = sniff::first_model(&mut files)?;
        let name = files[main].name.clone();
        let source = match format {
            Format::Glb | Format::Gltf => Source::Gltf(Box::new(gltf::read(files, main, format)?)),
            Format::Obj => Source::Obj(Box::new(obj::read(&files, main)?)),
            Format::Ply => Source::Ply(Box::new(ply::read(&files, main)?)),
            Format::Stl => Source::Stl(Box::new(stl::read(&files[main])?)),
            Format::Off => Source::Off(Box::new(off::read(&files[main])?)),
            Format::Smf => Source::Smf(Box::new(smf::read(&files[main])?)),
        };
        let mut document = Self { source, byte_count };
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

    /// The format that was read.
    #[must_use]
    pub fn format(&self) -> Format {
        match &self.source {
            Source::Gltf(source) => source.format,
            Source::Obj(_) => Format::Obj,
            Source::Ply(_) => Format::Ply,
            Source::Stl(_) => Format::Stl,
            Source::Off(_) => Format::Off,
            Source::Smf(_) => Format::Smf,
        }
    }

    /// All bytes given to [`Document::open`].
    #[must_use]
    pub fn byte_count(&self) -> usize {
        self.byte_count
    }

    fn content(&self) -> (&Mesh, &SceneLayout, &[Warning]) {
        let content = match &self.source {
            Source::Gltf(source) => return (&source.mesh, &source.layout, &source.warnings),
            Source::Obj(source) => &source.content,
            Source::Ply(source) => &source.content,
            Source::Stl(source) => &source.content,
            Source::Off(source) => &source.content,
            Source::Smf(source) => &source.content,
        };
        (&content.mesh, &content.layout, &content.warnings)
    }

    /// Every triangle of the file.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        self.content().0
    }

    /// Names and placements, by the groups and parts of [`Document::mesh`].
    #[must_use]
    pub fn layout(&self) -> &SceneLayout {
        self.content().1
    }

    /// What reading had to change or leave out.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        self.content().2
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
