//! Steps through the rows of a PLY file, one value after the other, whatever the encoding.
//!
//! Numbers come as `f64`, which holds every type exactly but the last bits of 64-bit integers.

use super::header::{Element, Encoding, Header, Property, Scalar};
use crate::document::scan::{Fault, Scanner};
use crate::error::{Error, ErrorCode};

/// Where the next value is.
#[derive(Debug, Clone)]
pub(super) enum Cursor<'a> {
    /// In text.
    Text(Scanner<'a>, /** Lines of the header. */ usize),
    /// In binary: all bytes, the offset, whether the big end comes first.
    Binary(&'a [u8], usize, bool),
}

/// Why a value cannot be had; the caller knows the place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trouble {
    /// The file ends.
    End,
    /// The line ends, or holds something else than a number.
    Text(Fault),
    /// A list's length is negative, or more than the rest of the file can hold.
    Length,
}

impl<'a> Cursor<'a> {
    /// At the first row.
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        match header.encoding {
            Encoding::Ascii => Self::Text(Scanner::new(&bytes[header.length..]), header.line_count),
            Encoding::LittleEndian => Self::Binary(bytes, header.length, false),
            Encoding::BigEndian => Self::Binary(bytes, header.length, true),
        }
    }

    /// Bytes that are left.
    pub(super) fn remaining(&self) -> usize {
        match self {
            Self::Text(scan, _) => scan.remaining(),
            Self::Binary(bytes, at, _) => bytes.len() - at,
        }
    }

    /// Line or byte, for an error's place.
    pub(super) fn place(&self, name: &str) -> String {
        match self {
            Self::Text(scan, header) => format!("{name}:{}", header + scan.line()),
            Self::Binary(_, at, _) => format!("{name}: byte {at}"),
        }
    }

    /// Whether the file can hold `element`: every row has a least size.
    pub(super) fn can_hold(&self, element: &Element) -> bool {
        let sizes = element.properties.iter().map(|property| match self {
            // A digit and what separates it from the next, which the last of the file can lack.
            Self::Text(..) => 2,
            Self::Binary(..) => property.length.unwrap_or(property.scalar).size(),
        });
        let slack = usize::from(matches!(self, Self::Text(..)));
        sizes.sum::<usize>().checked_mul(element.count).is_some_and(|size| size <= self.remaining() + slack)
    }

    /// Goes to the next row that has values: in text, to the next line that is not blank.
    #[inline]
    pub(super) fn begin_row(&mut self) {
        if let Self::Text(scan, _) = self {
            scan.skip_blank_lines();
        }
    }

    /// Leaves the row; whether there was more in it than it should have.
    pub(super) fn end_row(&mut self) -> bool {
        let Self::Text(scan, _) = self else { return false };
        scan.skip_blanks();
        let has_more = !scan.is_at_line_end();
        scan.finish_line();
        has_more
    }

    /// The next value.
    #[inline(never)]
    pub(super) fn value(&mut self, scalar: Scalar) -> Result<f64, Trouble> {
        match self {
            Self::Text(scan, _) => {
                if scalar.is_float() {
                    scan.number_or_nan().map(f64::from).map_err(Trouble::Text)
                } else {
                    scan.integer().map_err(Trouble::Text)
                }
            }
            Self::Binary(bytes, at, is_big) => {
                let size = scalar.size();
                let value = bytes.get(*at..*at + size).ok_or(Trouble::End)?;
                *at += size;
                Ok(decode(value, scalar, *is_big))
            }
        }
    }

    /// The length of the list that comes next, checked against the bytes that are left.
    #[inline(never)]
    pub(super) fn length(&mut self, length: Scalar, scalar: Scalar) -> Result<usize, Trouble> {
        let count = self.value(length)?;
        if count < 0.0 {
            return Err(Trouble::Length);
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates
        let count = count as usize;
        let least = if matches!(self, Self::Text(..)) { 2 } else { scalar.size() };
        // A list at the end of a text ends without a separator.
        let slack = usize::from(least == 2);
        match count.checked_mul(least) {
            Some(size) if size <= self.remaining() + slack => Ok(count),
            _ => Err(Trouble::Length),
        }
    }

    /// Steps over one property of the row.
    pub(super) fn skip(&mut self, property: &Property) -> Result<(), Trouble> {
        let count = match property.length {
            None => 1,
            Some(length) => self.length(length, property.scalar)?,
        };
        match self {
            Self::Text(scan, _) => (0..count).try_for_each(|_| scan.skip_word()).map_err(Trouble::Text),
            Self::Binary(bytes, at, _) => {
                let end = *at + count * property.scalar.size();
                *at = if end <= bytes.len() { end } else { return Err(Trouble::End) };
                Ok(())
            }
        }
    }

    /// Steps over all rows of an element that [`Cursor::can_hold`].
    pub(super) fn skip_element(&mut self, name: &str, element: &Element) -> Result<(), Error> {
        let row_size: Option<usize> =
            element.properties.iter().map(|p| p.length.is_none().then(|| p.scalar.size())).sum();
        if let (Self::Binary(_, at, _), Some(row_size)) = (&mut *self, row_size) {
            *at += row_size * element.count;
            return Ok(());
        }
        if element.properties.is_empty() {
            return Ok(());
        }
        for row in 0..element.count {
            self.begin_row();
            for property in &element.properties {
                self.skip(property).map_err(|trouble| self.error(trouble, name, element, row, property))?;
            }
            self.end_row();
        }
        Ok(())
    }

    /// The error for what went wrong at `property` of a row.
    #[cold]
    pub(super) fn error(
        &self,
        trouble: Trouble,
        name: &str,
        element: &Element,
        row: usize,
        property: &Property,
    ) -> Error {
        let (code, reason) = match trouble {
            Trouble::End => (ErrorCode::Truncated, "the file ends here"),
            Trouble::Text(Fault::Missing) if self.remaining() == 0 => (ErrorCode::Truncated, "the file ends here"),
            Trouble::Text(Fault::Missing) => (ErrorCode::Syntax, "a number is missing or incomplete"),
            Trouble::Text(Fault::NotFinite) => (ErrorCode::NotFinite, "not a finite number"),
            Trouble::Text(_) => (ErrorCode::Syntax, "not a number of its type"),
            Trouble::Length => (ErrorCode::Truncated, "a list is longer than the rest of the file"),
        };
        Error::new(code, self.place(name), format!("in {} {row}, `{}`: {reason}", element.name, property.name))
    }
}

/// A value of `scalar.size()` bytes.
#[inline]
#[allow(clippy::cast_precision_loss)] // see the module
fn decode(bytes: &[u8], scalar: Scalar, is_big: bool) -> f64 {
    let mut raw = [0; 8];
    let size = bytes.len();
    if is_big {
        raw[8 - size..].copy_from_slice(bytes);
    } else {
        raw[..size].copy_from_slice(bytes);
    }
    let bits = if is_big { u64::from_be_bytes(raw) } else { u64::from_le_bytes(raw) };
    #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap)] // the upper bytes are 0
    match scalar {
        Scalar::I8 => f64::from(bits as i8),
        Scalar::U8 => f64::from(bits as u8),
        Scalar::I16 => f64::from(bits as i16),
        Scalar::U16 => f64::from(bits as u16),
        Scalar::I32 => f64::from(bits as i32),
        Scalar::U32 => f64::from(bits as u32),
        Scalar::I64 => bits as i64 as f64,
        Scalar::U64 => bits as f64,
        Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
        Scalar::F64 => f64::from_bits(bits),
    }
}
