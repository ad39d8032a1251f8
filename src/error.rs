//! One error type for the whole pipeline: a stable code, the place, and the reason.
//!
//! A malformed file, a wrong argument or an exceeded limit is a value of this type; a panic is
//! always a fault of this crate. The code survives the trip to JavaScript unchanged.

use std::fmt;

/// What went wrong, grouped by who can mend it. The string forms are stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorCode {
    // The file is at fault.
    /// The bytes are of no format that can be read.
    UnknownFormat,
    /// The file ends before its content does.
    Truncated,
    /// The text or the JSON does not parse, or a value breaks the format's rules.
    Syntax,
    /// An index, offset or length points outside of what it indexes.
    OutOfRange,
    /// A coordinate or attribute is NaN or infinite.
    NotFinite,
    /// There is no triangle in the file.
    NoTriangles,
    /// A file that this one refers to was not given.
    MissingResource,
    /// The file is valid but uses something that is not supported.
    Unsupported,
    // The caller is at fault.
    /// An argument is out of its range or of the wrong shape.
    InvalidArgument,
    /// The call is not possible in this state, e.g. a level before simplification.
    WrongState,
    // A limit was met.
    /// More memory or more elements than can be handled.
    TooLarge,
}

impl ErrorCode {
    /// The stable name, as JavaScript and the command line show it.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::UnknownFormat => "unknown-format",
            Self::Truncated => "truncated",
            Self::Syntax => "syntax",
            Self::OutOfRange => "out-of-range",
            Self::NotFinite => "not-finite",
            Self::NoTriangles => "no-triangles",
            Self::MissingResource => "missing-resource",
            Self::Unsupported => "unsupported",
            Self::InvalidArgument => "invalid-argument",
            Self::WrongState => "wrong-state",
            Self::TooLarge => "too-large",
        }
    }
}

/// A typed failure: `code` for programs, `place` and `message` for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    code: ErrorCode,
    place: String,
    message: String,
}

impl Error {
    /// `place` is a byte offset, a line, a JSON path or an argument's name, with the file's name
    /// where it is known: `model.obj:12`, `meshes[0].primitives[1].indices`.
    pub fn new(code: ErrorCode, place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { code, place: place.into(), message: message.into() }
    }

    /// The stable code.
    #[must_use]
    pub fn code(&self) -> ErrorCode {
        self.code
    }

    /// Where in the file or which argument; may be empty.
    #[must_use]
    pub fn place(&self) -> &str {
        &self.place
    }

    /// The reason, one line.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.message
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.place.is_empty() {
            write!(f, "{}: {}", self.code.as_str(), self.message)
        } else {
            write!(f, "{}: {}: {}", self.code.as_str(), self.place, self.message)
        }
    }
}

impl std::error::Error for Error {}

/// Something a reader or writer had to change or leave out, without failing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// Stable name, kebab-case.
    pub code: &'static str,
    /// One line for people.
    pub message: String,
    /// The place, as in [`Error`].
    pub place: String,
}
