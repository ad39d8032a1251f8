//! The mesh of an OFF file.

use super::{Keyword, OffSource, OffStyle};
use crate::document::NamedFile;
use crate::document::faces::{Corner, Faces, color_attribute};
use crate::document::scan::{Fault, Scanner};
use crate::error::{Error, ErrorCode};
use crate::mesh::{Attribute, Blend};

/// Reads an OFF file.
///
/// # Errors
/// With `name:line` as place: `truncated` if counts exceed the file or it ends early, `syntax`,
/// `not-finite` and `out-of-range`; `unsupported` for other spaces than 3D and for binary files.
pub(in crate::document) fn read(file: &NamedFile) -> Result<OffSource, Error> {
    let mut reader = Reader { name: &file.name, scan: Scanner::new(&file.bytes) };
    reader.scan.skip_blank_lines();
    let keyword = Keyword::parse(reader.scan.word()).unwrap_or_default();
    if keyword.is_other_space {
        return Err(reader.error(ErrorCode::Unsupported, "only vertices in three dimensions can be read"));
    }
    let (vertex_count, face_count) = reader.counts()?;
    let mut faces = Faces::new();
    let mut style = OffStyle::default();
    let (mut normals, mut texcoords, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    faces.positions.reserve(vertex_count);
    for _ in 0..vertex_count {
        let position = reader.numbers::<3>("a vertex")?;
        faces.positions.push(position);
        if keyword.has_normals {
            normals.push(reader.numbers::<3>("a normal")?);
        }
        if keyword.has_colors {
            // The count is the file's to choose: three or four, before what else is on the line.
            let rest = reader.rest_of_line("a colour")?;
            let (color, is_float, used) = rest.color(if keyword.has_texcoords { 2 } else { 0 });
            style.has_float_colors |= is_float;
            colors.push(color);
            if keyword.has_texcoords {
                let Some(&[u, v]) = rest.values.get(used..used + 2) else {
                    return Err(reader.error(ErrorCode::Syntax, "texture coordinates are missing"));
                };
                texcoords.push([u, v]);
            }
        } else if keyword.has_texcoords {
            texcoords.push(reader.numbers::<2>("a texture coordinate")?);
        }
        reader.scan.finish_line();
    }
    if keyword.has_normals {
        let values = normals.into_flattened();
        faces.attributes.push(Attribute { name: "NORMAL".into(), components: 3, values, blend: Blend::Direction });
    }
    if keyword.has_texcoords {
        let values = texcoords.into_flattened();
        faces.attributes.push(Attribute { name: "TEXCOORD_0".into(), components: 2, values, blend: Blend::Linear });
    }
    if keyword.has_colors {
        faces.attributes.push(color_attribute(colors, Blend::Linear));
    }
    reader.faces(face_count, keyword.has_colors, &mut faces, &mut style)?;
    Ok(OffSource { content: faces.finish(reader.name)?, style })
}

struct Reader<'a> {
    name: &'a str,
    scan: Scanner<'a>,
}

/// Numbers up to the end of a line, of which at most eight are kept.
#[derive(Default)]
struct Rest {
    values: Vec<f32>,
    /// Written as an integer.
    is_integer: Vec<bool>,
}

impl Rest {
    /// The colour at the start, whether it is in floats, and how many numbers it takes, if the
    /// last `reserved` are something else. One number is an index in a map: white.
    fn color(&self, reserved: usize) -> ([f32; 4], bool, usize) {
        let count = self.values.len().saturating_sub(reserved).min(4);
        if count < 3 {
            return ([1.0; 4], false, count);
        }
        let is_float = !self.is_integer[..count].iter().all(|&is| is);
        let range = if is_float && self.values[..count].iter().all(|&value| value <= 1.0) { 1.0 } else { 255.0 };
        let mut color = [1.0; 4];
        for (channel, value) in color.iter_mut().zip(&self.values[..count]) {
            // Nothing is brighter than white: a colour out of range would be read otherwise when written.
            *channel = (value / range).clamp(0.0, 1.0);
        }
        (color, is_float, count)
    }
}

impl Reader<'_> {
    fn place(&self) -> String {
        format!("{}:{}", self.name, self.scan.line())
    }

    #[cold]
    fn error(&self, code: ErrorCode, message: &str) -> Error {
        Error::new(code, self.place(), message)
    }

    #[cold]
    fn fault(&self, fault: Fault, what: &str) -> Error {
        let (code, reason) = match fault {
            Fault::Missing if self.scan.is_at_end() => (ErrorCode::Truncated, "the file ends here"),
            Fault::Missing => (ErrorCode::Syntax, "a number is missing or incomplete"),
            Fault::NotFinite => (ErrorCode::NotFinite, "not a finite number"),
            Fault::NotANumber | Fault::OutOfRange => (ErrorCode::Syntax, "not a number"),
        };
        self.error(code, &format!("in {what}: {reason}"))
    }

    /// Counts of vertices and faces, which the rest of the file can hold; that of edges is often
    /// wrong and of no use.
    fn counts(&mut self) -> Result<(usize, usize), Error> {
        let mut counts = [0.0; 2];
        for count in &mut counts {
            self.scan.skip_blank_lines();
            let mut ahead = self.scan.clone();
            if ahead.word() == b"BINARY" {
                return Err(self.error(ErrorCode::Unsupported, "binary OFF cannot be read"));
            }
            *count = self.scan.integer().map_err(|fault| self.fault(fault, "the counts"))?;
            if *count < 0.0 || count.fract() != 0.0 {
                return Err(self.error(ErrorCode::OutOfRange, "a count must be an integer of at least 0"));
            }
        }
        self.scan.finish_line();
        // Three numbers and their separators for a vertex, one for a face; the last can lack its own.
        let least = counts[0] * 6.0 + counts[1] * 2.0;
        #[allow(clippy::cast_precision_loss)] // a bound with slack
        if least > self.scan.remaining() as f64 + 1.0 {
            let message = format!("{} vertices and {} faces do not fit into the file", counts[0], counts[1]);
            return Err(self.error(ErrorCode::Truncated, &message));
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // smaller than the file
        Ok((counts[0] as usize, counts[1] as usize))
    }

    /// Numbers that may go on in the next line.
    fn numbers<const N: usize>(&mut self, what: &str) -> Result<[f32; N], Error> {
        let mut values = [0.0; N];
        for value in &mut values {
            self.scan.skip_blank_lines();
            *value = self.scan.next_number().map_err(|fault| self.fault(fault, what))?;
        }
        Ok(values)
    }

    /// Numbers up to the end of the line.
    fn rest_of_line(&mut self, what: &str) -> Result<Rest, Error> {
        let mut rest = Rest::default();
        loop {
            self.scan.skip_blanks();
            if self.scan.is_at_line_end() || rest.values.len() == 8 {
                return Ok(rest);
            }
            let mut word = self.scan.clone();
            rest.is_integer.push(word.word().iter().all(|byte| matches!(byte, b'0'..=b'9' | b'-' | b'+')));
            rest.values.push(self.scan.next_number().map_err(|fault| self.fault(fault, what))?);
        }
    }

    fn faces(
        &mut self,
        count: usize,
        has_vertex_colors: bool,
        faces: &mut Faces,
        style: &mut OffStyle,
    ) -> Result<(), Error> {
        faces.reserve(count);
        let mut corners: Vec<Corner> = Vec::new();
        for _ in 0..count {
            self.scan.skip_blank_lines();
            let line = self.scan.line();
            let name = self.name;
            let place = || format!("{name}:{line}");
            let size = self.scan.integer().map_err(|fault| self.fault(fault, "a face"))?;
            #[allow(clippy::cast_precision_loss)] // a bound
            if size < 0.0 || size.fract() != 0.0 || size > self.scan.remaining() as f64 {
                return Err(self.error(ErrorCode::OutOfRange, "a face has more corners than the file has bytes"));
            }
            corners.clear();
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // checked
            for _ in 0..size as usize {
                self.scan.skip_blank_lines();
                let index = self.scan.integer().map_err(|fault| self.fault(fault, "a face"))?;
                if index < 0.0 || index >= f64::from(u32::MAX) || index.fract() != 0.0 {
                    return Err(self.error(ErrorCode::OutOfRange, "an index must be an integer of at least 0"));
                }
                corners.push(Corner { vertex: index as u32, ..Corner::default() });
            }
            let rest = self.rest_of_line("the colour of a face")?;
            match rest.values.len() {
                0 => {}
                3.. if !has_vertex_colors => {
                    let (color, is_float, _) = rest.color(0);
                    style.has_float_colors |= is_float;
                    let color = faces.color(color);
                    corners.iter_mut().for_each(|corner| corner.color = color);
                }
                _ => faces.notices.count(&("face-colors-ignored", "colours of faces left out"), &place),
            }
            faces.polygon(&corners, &place)?;
            self.scan.finish_line();
        }
        Ok(())
    }
}
