//! The header of a PLY file: encoding, elements, properties, remarks.

use crate::error::{Error, ErrorCode};

/// A number's type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "int64" => Self::I64,
            "uint64" => Self::U64,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in binary.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Not an integer.
    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// What a colour of this type is divided by.
    pub(super) fn color_range(self) -> f32 {
        match self {
            Self::F32 | Self::F64 => 1.0,
            Self::I16 | Self::U16 => 65535.0,
            _ => 255.0,
        }
    }
}

/// One value, or a list with its length before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    /// Type of a list's length; `None` for a single value.
    pub(super) length: Option<Scalar>,
    pub(super) scalar: Scalar,
}

/// Rows of the same properties.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// How rows are encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The header.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// `comment` and `obj_info` lines.
    pub(super) remarks: Vec<String>,
    /// Bytes up to the first row.
    pub(super) length: usize,
    /// Lines up to the first row.
    pub(super) line_count: usize,
}

/// Elements and properties beyond this are no model any more.
const MOST_DECLARATIONS: usize = 4096;

/// Reads the header of `bytes`; `name` is for places.
///
/// # Errors
/// `truncated` without `end_header`, `syntax`, `unsupported` for an unknown encoding, all with the
/// line; `out-of-range` for a count that is no count; `too-large` beyond 4096 declarations.
pub(super) fn parse(name: &str, bytes: &[u8]) -> Result<Header, Error> {
    let mut lines = Lines { bytes, at: 0 };
    let mut encoding = None;
    let (mut elements, mut remarks): (Vec<Element>, Vec<String>) = (Vec::new(), Vec::new());
    let mut declarations = 0;
    let mut number = 0;
    loop {
        number += 1;
        let fail = |code, message: String| Err(Error::new(code, format!("{name}:{number}"), message));
        let Some(line) = lines.next() else {
            return fail(ErrorCode::Truncated, "the file ends before `end_header`".into());
        };
        let text = String::from_utf8_lossy(line);
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        if matches!(words[..], ["element" | "property", ..]) {
            declarations += 1;
            if declarations > MOST_DECLARATIONS {
                return fail(ErrorCode::TooLarge, format!("more than {MOST_DECLARATIONS} elements and properties"));
            }
        }
        match words[..] {
            ["ply"] if number == 1 => {}
            [] => {}
            ["comment" | "obj_info", ..] => remarks.push(text.trim().replace(|c: char| c.is_ascii_control(), " ")),
            ["format", kind, version] => {
                encoding = match kind {
                    "ascii" => Some(Encoding::Ascii),
                    "binary_little_endian" => Some(Encoding::LittleEndian),
                    "binary_big_endian" => Some(Encoding::BigEndian),
                    _ => return fail(ErrorCode::Unsupported, format!("unknown encoding `{}`", shorten(kind))),
                };
                if version != "1.0" {
                    return fail(ErrorCode::Unsupported, format!("unknown version `{}`", shorten(version)));
                }
            }
            ["element", element, count] => {
                let Ok(count) = count.parse::<u64>() else {
                    return fail(ErrorCode::OutOfRange, format!("`{}` is no count", shorten(count)));
                };
                let count = usize::try_from(count).unwrap_or(usize::MAX);
                elements.push(Element { name: element.to_owned(), count, properties: Vec::new() });
            }
            ["property", ref words @ ..] => {
                let Some(element) = elements.last_mut() else {
                    return fail(ErrorCode::Syntax, "`property` before any `element`".into());
                };
                // A name may come twice; the first is the one that counts.
                let property = match property(words) {
                    Ok(property) => property,
                    Err(reason) => return fail(ErrorCode::Syntax, reason),
                };
                element.properties.push(property);
            }
            ["end_header"] => break,
            [word, ..] => {
                return fail(ErrorCode::Syntax, format!("`{}` makes no sense here", shorten(word)));
            }
        }
    }
    let Some(encoding) = encoding else {
        return Err(Error::new(ErrorCode::Syntax, format!("{name}:{number}"), "the header has no `format`"));
    };
    Ok(Header { encoding, elements, remarks, length: lines.at, line_count: number })
}

fn property(words: &[&str]) -> Result<Property, String> {
    let scalar = |word: &str| Scalar::parse(word).ok_or_else(|| format!("unknown type `{}`", shorten(word)));
    match *words {
        ["list", length, values, name] => {
            let length = scalar(length)?;
            if length.is_float() {
                return Err("the length of a list must be an integer".into());
            }
            Ok(Property { name: name.to_owned(), length: Some(length), scalar: scalar(values)? })
        }
        [kind, name] if kind != "list" => Ok(Property { name: name.to_owned(), length: None, scalar: scalar(kind)? }),
        _ => Err("`property` takes a type and a name".into()),
    }
}

/// At most 40 characters of what a file says.
fn shorten(word: &str) -> &str {
    word.char_indices().nth(40).map_or(word, |(end, _)| &word[..end])
}

/// Lines by `\n`, `\r\n` or a lone `\r`. After `\r`, a `\n` can be the first byte of binary rows;
/// it is taken for half of a line end only if the first line ended so too.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.at;
        let rest = &self.bytes[start..];
        let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r'))?;
        self.at += length + 1;
        let is_pair = |end: usize| self.bytes.get(end..end + 2) == Some(b"\r\n");
        let first_end = self.bytes.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(0);
        if is_pair(start + length) && is_pair(first_end) {
            self.at += 1;
        }
        Some(&rest[..length])
    }
}
