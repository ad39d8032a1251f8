//! The mesh of an SMF file.

use super::SmfSource;
use super::transform::Transform;
use crate::document::NamedFile;
use crate::document::faces::{Corner, Faces, color_attribute};
use crate::document::notice::{Kind, UNKNOWN_STATEMENT};
use crate::document::place::Placement;
use crate::document::scan::{Fault, Scanner};
use crate::error::{Error, ErrorCode};
use crate::mesh::{Attribute, Blend};

static VALUES_IGNORED: Kind = (
    "values-ignored",
    "kinds of values (normals, colours or texture coordinates) that are not bound or too few left out",
);

/// Blocks within blocks beyond this are refused.
const DEEPEST: usize = 1024;

/// Reads an SMF file.
///
/// # Errors
/// With `name:line` as place: `syntax`, `truncated`, `not-finite`, `out-of-range`; `too-large` for
/// blocks nested deeper than 1024.
pub(in crate::document) fn read(file: &NamedFile) -> Result<SmfSource, Error> {
    let mut reader = Reader::new(file);
    reader.run()?;
    reader.finish()
}

/// What values belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Binding {
    None,
    Vertex,
    Face,
}

/// Values of one kind in the order of the file, and what they belong to.
struct Values<const N: usize> {
    rows: Vec<[f32; N]>,
    binding: Binding,
}

impl<const N: usize> Values<N> {
    fn new() -> Self {
        Self { rows: Vec::new(), binding: Binding::None }
    }
}

/// What `end` brings back.
#[derive(Clone, Copy)]
struct Block {
    transform: Transform,
    /// The first vertex that faces count from.
    first_vertex: usize,
    correction: f64,
}

struct Reader<'a> {
    name: &'a str,
    scan: Scanner<'a>,
    faces: Faces,
    block: Block,
    placement: Placement,
    outer: Vec<Block>,
    normals: Values<3>,
    colors: Values<3>,
    texcoords: Values<2>,
    /// Corners of every face, its size, its line.
    corners: Vec<u32>,
    sizes: Vec<(u32, u32)>,
}

type Step<T = ()> = Result<T, (Fault, &'static str)>;

impl<'a> Reader<'a> {
    fn new(file: &'a NamedFile) -> Self {
        Self {
            name: &file.name,
            scan: Scanner::new(&file.bytes),
            faces: Faces::new(),
            block: Block { transform: Transform::IDENTITY, first_vertex: 0, correction: 0.0 },
            placement: Placement::Identity,
            outer: Vec::new(),
            normals: Values::new(),
            colors: Values::new(),
            texcoords: Values::new(),
            corners: Vec::new(),
            sizes: Vec::new(),
        }
    }

    fn place(&self) -> String {
        format!("{}:{}", self.name, self.scan.line())
    }

    fn error(&self, code: ErrorCode, message: impl Into<String>) -> Error {
        Error::new(code, self.place(), message)
    }

    fn run(&mut self) -> Result<(), Error> {
        while !self.scan.is_at_end() {
            self.scan.skip_blanks();
            if !self.scan.is_at_line_end() {
                let line = self.scan.line();
                let keyword = self.scan.word();
                match keyword {
                    b"begin" => self.begin()?,
                    b"end" => self.end()?,
                    b"f" => self.face()?,
                    b"v" => self.vertex()?,
                    _ => self.other(keyword, line)?,
                }
            }
            self.scan.finish_line();
        }
        Ok(())
    }

    fn numbers<const N: usize>(&mut self, statement: &'static str) -> Step<[f32; N]> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.scan.next_number().map_err(|fault| (fault, statement))?;
        }
        Ok(values)
    }

    fn told<T>(&self, step: Step<T>) -> Result<T, Error> {
        step.map_err(|(fault, statement)| {
            let (code, reason) = match fault {
                Fault::Missing if self.scan.is_at_end() => (ErrorCode::Truncated, "the file ends here"),
                Fault::Missing => (ErrorCode::Syntax, "a number is missing or incomplete"),
                Fault::NotFinite => (ErrorCode::NotFinite, "not a finite number"),
                Fault::NotANumber | Fault::OutOfRange => (ErrorCode::Syntax, "not a number"),
            };
            self.error(code, format!("in `{statement}`: {reason}"))
        })
    }

    fn begin(&mut self) -> Result<(), Error> {
        if self.outer.len() >= DEEPEST {
            return Err(self.error(ErrorCode::TooLarge, "blocks are nested too deeply"));
        }
        self.outer.push(self.block);
        self.block.first_vertex = self.faces.positions.len();
        self.block.correction = 0.0;
        Ok(())
    }

    fn end(&mut self) -> Result<(), Error> {
        let Some(block) = self.outer.pop() else {
            return Err(self.error(ErrorCode::Syntax, "`end` without `begin`"));
        };
        self.block = block;
        self.placement = block.transform.placement();
        Ok(())
    }

    #[inline]
    fn vertex(&mut self) -> Result<(), Error> {
        let read = self.numbers("v");
        let position = self.told(read)?;
        let Some(position) = self.placement.position(position) else {
            return Err(self.error(ErrorCode::NotFinite, "a transformation moves the vertex out of range"));
        };
        self.faces.positions.push(position);
        Ok(())
    }

    /// Numbers from 1 within the block, negative ones back from the last vertex.
    #[inline]
    fn face(&mut self) -> Result<(), Error> {
        let line = self.scan.line();
        let start = self.corners.len();
        let count = self.faces.positions.len() as f64;
        loop {
            self.scan.skip_blanks();
            if self.scan.is_at_line_end() {
                break;
            }
            let read = self.scan.integer().map_err(|fault| (fault, "f"));
            let number = self.told(read)?;
            let index = if number < 0.0 {
                count + number
            } else {
                number - 1.0 + self.block.correction + self.block.first_vertex as f64
            };
            if !(0.0..count).contains(&index) || index.fract() != 0.0 {
                let message = format!("in `f`: no vertex {number} so far in this block");
                return Err(self.error(ErrorCode::OutOfRange, message));
            }
            self.corners.push(index as u32);
        }
        if self.corners.len() - start < 3 && self.scan.is_at_end() {
            return Err(self.error(ErrorCode::Truncated, "in `f`: the file ends here"));
        }
        self.sizes.push(((self.corners.len() - start) as u32, u32::try_from(line).unwrap_or(u32::MAX)));
        Ok(())
    }

    fn other(&mut self, keyword: &[u8], line: usize) -> Result<(), Error> {
        let at_line = || format!("{}:{line}", self.name);
        match keyword {
            b"n" => {
                let read = self.numbers("n");
                let normal = self.told(read)?;
                self.normals.rows.push(self.placement.normal(normal));
            }
            b"c" => {
                let read = self.numbers("c");
                let color = self.told(read)?;
                self.colors.rows.push(color);
            }
            b"r" => {
                let read = self.numbers("r");
                let texcoord = self.told(read)?;
                self.texcoords.rows.push(texcoord);
            }
            b"bind" => self.bind(line),
            b"trans" | b"scale" | b"rot" | b"mmult" | b"mload" => {
                let read = self.transform(keyword);
                let next = self.told(read)?;
                if next.is_projective() {
                    return Err(self.error(ErrorCode::Unsupported, "the last row of a matrix must be 0 0 0 1"));
                }
                self.block.transform = next;
                self.placement = next.placement();
            }
            b"set" | b"inc" | b"dec" => {
                self.scan.skip_blanks();
                if self.scan.word() == b"vertex_correction" {
                    let read = self.scan.integer().or_else(|fault| match fault {
                        Fault::Missing if keyword != b"set" => Ok(1.0),
                        fault => Err((fault, "vertex_correction")),
                    });
                    let value = self.told(read)?;
                    self.block.correction = match keyword {
                        b"set" => value,
                        b"inc" => self.block.correction + value,
                        _ => self.block.correction - value,
                    };
                } else {
                    self.faces.notices.count(&UNKNOWN_STATEMENT, &at_line);
                }
            }
            _ => self.faces.notices.count(&UNKNOWN_STATEMENT, &at_line),
        }
        Ok(())
    }

    fn bind(&mut self, line: usize) {
        self.scan.skip_blanks();
        let kind = self.scan.word();
        self.scan.skip_blanks();
        let binding = match self.scan.word() {
            b"vertex" => Binding::Vertex,
            b"face" => Binding::Face,
            _ => Binding::None,
        };
        match kind {
            b"n" => self.normals.binding = binding,
            b"c" => self.colors.binding = binding,
            b"r" if binding != Binding::Face => self.texcoords.binding = binding,
            _ => {
                let at_line = || format!("{}:{line}", self.name);
                self.faces.notices.count(&("unknown-binding", "bindings of another kind left out"), &at_line);
            }
        }
    }

    /// The block's matrix after a statement.
    fn transform(&mut self, keyword: &[u8]) -> Step<Transform> {
        let now = self.block.transform;
        Ok(match keyword {
            b"trans" => now.then_inner(&Transform::translation(self.numbers::<3>("trans")?.map(f64::from))),
            b"scale" => now.then_inner(&Transform::scaling(self.numbers::<3>("scale")?.map(f64::from))),
            b"rot" => {
                self.scan.skip_blanks();
                let axis = match self.scan.word() {
                    b"x" => 0,
                    b"y" => 1,
                    b"z" => 2,
                    _ => return Err((Fault::NotANumber, "rot")),
                };
                let [degrees] = self.numbers::<1>("rot")?;
                now.then_inner(&Transform::rotation(axis, f64::from(degrees)))
            }
            b"mmult" => now.then_inner(&Transform::from_rows(self.numbers::<16>("mmult")?.map(f64::from))),
            _ => Transform::from_rows(self.numbers::<16>("mload")?.map(f64::from)),
        })
    }

    /// Values go to their vertices and faces when all are known; fewer than there should be are left
    /// out altogether.
    fn finish(mut self) -> Result<SmfSource, Error> {
        let (vertices, face_count) = (self.faces.positions.len(), self.sizes.len());
        let counts = [
            (self.normals.rows.len(), &mut self.normals.binding),
            (self.colors.rows.len(), &mut self.colors.binding),
            (self.texcoords.rows.len(), &mut self.texcoords.binding),
        ];
        for (count, binding) in counts {
            let wanted = match *binding {
                Binding::None => 0,
                Binding::Vertex => vertices,
                Binding::Face => face_count,
            };
            if count < wanted || count > 0 && wanted == 0 {
                self.faces.notices.count(&VALUES_IGNORED, &|| self.name.to_owned());
                *binding = Binding::None;
            } else if count == 0 {
                *binding = Binding::None;
            }
        }
        let mut add = |name: &str, components, values, blend| {
            self.faces.attributes.push(Attribute { name: name.into(), components, values, blend });
        };
        if self.normals.binding == Binding::Vertex {
            self.normals.rows.truncate(vertices);
            add("NORMAL", 3, self.normals.rows.as_flattened().to_vec(), Blend::Direction);
        }
        if self.texcoords.binding == Binding::Vertex {
            self.texcoords.rows.truncate(vertices);
            add("TEXCOORD_0", 2, self.texcoords.rows.as_flattened().to_vec(), Blend::Linear);
        }
        if self.colors.binding == Binding::Vertex {
            let colors = self.colors.rows[..vertices].iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
            self.faces.attributes.push(color_attribute(colors, Blend::Linear));
        }
        let mut rest = &self.corners[..];
        let mut corners: Vec<Corner> = Vec::new();
        for (face, &(size, line)) in self.sizes.iter().enumerate() {
            let (these, others) = rest.split_at(size as usize);
            rest = others;
            let mut values = Corner::default();
            if self.normals.binding == Binding::Face {
                values.normal = self.faces.normal(self.normals.rows[face]);
            }
            if self.colors.binding == Binding::Face {
                let [r, g, b] = self.colors.rows[face];
                values.color = self.faces.color([r, g, b, 1.0]);
            }
            corners.clear();
            corners.extend(these.iter().map(|&vertex| Corner { vertex, ..values }));
            self.faces.polygon(&corners, &|| format!("{}:{line}", self.name))?;
        }
        Ok(SmfSource { content: self.faces.finish(self.name)? })
    }
}
