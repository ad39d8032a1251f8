//! The bytes behind buffers and images: the binary chunk, `data:` URIs, and files given alongside.

use std::ops::Range;

use crate::document::json_tree::Value;
use base64::Engine as _;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::json::{items, text, uint};
use super::schema::{MESHOPT_EXTENSIONS, Root};
use crate::document::NamedFile;
use crate::document::lookup::{find_file, percent_decode, shorten};
use crate::error::{Error, ErrorCode};

/// Padding at the end of base64 is often missing in the wild, and nothing is ambiguous without it.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Where the bytes of a buffer or an image are.
#[derive(Debug)]
pub(super) enum Content {
    /// In one of the given files.
    File { file: usize, range: Range<usize> },
    /// Decoded from a `data:` URI.
    Owned(Vec<u8>),
    /// Nowhere: nothing needs them, or only a decoder that is not there would fill them.
    Absent,
}

impl Content {
    pub(super) fn bytes<'a>(&'a self, files: &'a [NamedFile]) -> Option<&'a [u8]> {
        match self {
            Self::File { file, range } => files.get(*file)?.bytes.get(range.clone()),
            Self::Owned(bytes) => Some(bytes),
            Self::Absent => None,
        }
    }
}

/// Finds the bytes of every buffer, cut to its `byteLength`.
///
/// # Errors
/// `missing-resource`, `syntax` (a bad `data:` URI) or `truncated`, at `buffers[i]`.
pub(super) fn load_buffers(
    tree: &Value,
    root: &Root,
    files: &[NamedFile],
    main: usize,
    binary: Option<&Range<usize>>,
) -> Result<Vec<Content>, Error> {
    let mut needed = vec![false; items(tree, "buffers").len()];
    root.views.iter().for_each(|view| needed[view.buffer] = true);
    let buffers = items(tree, "buffers").iter().enumerate();
    buffers.map(|(i, buffer)| load_buffer(buffer, i, needed[i], files, main, binary)).collect()
}

fn load_buffer(
    buffer: &Value,
    index: usize,
    needed: bool,
    files: &[NamedFile],
    main: usize,
    binary: Option<&Range<usize>>,
) -> Result<Content, Error> {
    let length = uint(buffer, "byteLength").unwrap_or(0);
    let place = || format!("buffers[{index}].uri");
    let content = match (text(buffer, "uri"), binary) {
        (Some(uri), _) => match resolve(uri, files, main) {
            Ok(Some(content)) => content,
            Ok(None) => {
                return Err(Error::new(
                    ErrorCode::MissingResource,
                    place(),
                    format!("the file \"{}\" was not given", shorten(uri)),
                ));
            }
            Err(message) => return Err(Error::new(ErrorCode::Syntax, place(), message)),
        },
        (None, Some(binary)) if index == 0 => Content::File { file: main, range: binary.clone() },
        // A meshopt fallback buffer is filled by a decoder only; accessors that need it say so.
        (None, _) if is_fallback(buffer) || !needed => return Ok(Content::Absent),
        (None, _) => {
            let message = "the buffer has no uri, and there is no binary chunk for it";
            return Err(Error::new(ErrorCode::MissingResource, place(), message));
        }
    };
    let available = content.bytes(files).map_or(0, <[u8]>::len);
    if available < length {
        return Err(Error::new(
            ErrorCode::Truncated,
            format!("buffers[{index}].byteLength"),
            format!("{length} bytes are stated, {available} are there"),
        ));
    }
    Ok(match content {
        Content::File { file, range } => Content::File { file, range: range.start..range.start + length },
        Content::Owned(mut bytes) => {
            bytes.truncate(length);
            Content::Owned(bytes)
        }
        Content::Absent => Content::Absent,
    })
}

fn is_fallback(buffer: &Value) -> bool {
    MESHOPT_EXTENSIONS.iter().any(|&name| buffer["extensions"][name]["fallback"].as_bool() == Some(true))
}

/// The bytes a URI stands for; `Ok(None)` when it names a file that was not given.
///
/// # Errors
/// The reason why a `data:` URI cannot be decoded.
pub(super) fn resolve(uri: &str, files: &[NamedFile], main: usize) -> Result<Option<Content>, String> {
    if is_data_uri(uri) {
        return decode_data_uri(uri).map(|bytes| Some(Content::Owned(bytes)));
    }
    Ok(find_file(uri, files, main).map(|file| Content::File { file, range: 0..files[file].bytes.len() }))
}

pub(super) fn is_data_uri(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

fn decode_data_uri(uri: &str) -> Result<Vec<u8>, String> {
    let (head, data) = uri[5..].split_once(',').ok_or("a data: URI without a comma")?;
    if head.rsplit(';').next().is_some_and(|word| word.eq_ignore_ascii_case("base64")) {
        BASE64.decode(percent_decode(data).as_ref()).map_err(|error| format!("not base64: {error}"))
    } else {
        Ok(percent_decode(data).into_owned())
    }
}
