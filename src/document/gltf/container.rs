//! The GLB container: a 12-byte header, a JSON chunk, and at most one binary chunk.

use std::ops::Range;

use crate::error::{Error, ErrorCode};

const MAGIC: &[u8; 4] = b"glTF";
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;
const HEADER_LENGTH: usize = 12;
const CHUNK_HEADER_LENGTH: usize = 8;

/// Where the two chunks lie in the file.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Chunks {
    pub(super) json: Range<usize>,
    pub(super) binary: Option<Range<usize>>,
    /// Whether every length is a multiple of four, as it must be.
    pub(super) is_padded: bool,
}

/// Finds the chunks of a GLB file; chunks of unknown type are passed over, as glTF 2.0 demands.
///
/// # Errors
/// `truncated`, `syntax` or `unsupported` (version 1), with the byte offset as the place.
pub(super) fn parse(bytes: &[u8]) -> Result<Chunks, Error> {
    if !bytes.starts_with(MAGIC) {
        return Err(fail(ErrorCode::UnknownFormat, 0, "a GLB file starts with \"glTF\""));
    }
    match read_u32(bytes, 4)? {
        2 => {}
        version @ 0..=1 => {
            let message = format!("GLB version {version} (glTF 1.0) is not supported; only 2 is");
            return Err(fail(ErrorCode::Unsupported, 4, message));
        }
        version => {
            return Err(fail(ErrorCode::Unsupported, 4, format!("GLB version {version} is not supported; only 2 is")));
        }
    }
    let length = read_u32(bytes, 8)? as usize;
    if length > bytes.len() {
        let message = format!("the header says {length} bytes, the file has {}", bytes.len());
        return Err(fail(ErrorCode::Truncated, 8, message));
    }
    if length < HEADER_LENGTH + CHUNK_HEADER_LENGTH {
        return Err(fail(ErrorCode::Syntax, 8, format!("a length of {length} bytes leaves no room for a chunk")));
    }
    // Bytes after the stated length are not part of the file: some servers pad.
    let bytes = &bytes[..length];
    let (mut json, mut binary, mut is_padded) = (None, None, true);
    let mut offset = HEADER_LENGTH;
    while offset < bytes.len() {
        let chunk_length = read_u32(bytes, offset)? as usize;
        let chunk_type = read_u32(bytes, offset + 4)?;
        let start = offset + CHUNK_HEADER_LENGTH;
        // Some writers leave out the padding; the chunks can be told apart all the same.
        is_padded &= chunk_length.is_multiple_of(4);
        let end = match start.checked_add(chunk_length) {
            Some(end) if end <= bytes.len() => end,
            _ => {
                let message = format!("a chunk of {chunk_length} bytes, but only {} are left", bytes.len() - start);
                return Err(fail(ErrorCode::Truncated, offset, message));
            }
        };
        match (chunk_type, &json) {
            (JSON_CHUNK, None) => json = Some(start..end),
            (_, None) => {
                return Err(fail(ErrorCode::Syntax, offset + 4, "the first chunk must be JSON"));
            }
            (BINARY_CHUNK, Some(_)) if binary.is_none() => binary = Some(start..end),
            _ => {}
        }
        offset = end;
    }
    match json {
        Some(json) if !json.is_empty() => Ok(Chunks { json, binary, is_padded }),
        _ => Err(fail(ErrorCode::Syntax, HEADER_LENGTH, "the JSON chunk is empty")),
    }
}

/// A GLB file of this JSON and binary chunk (left out when empty).
///
/// # Errors
/// `too-large` when the file would exceed the 4 GiB that its header can state.
pub(super) fn build(json: &[u8], binary: &[u8]) -> Result<Vec<u8>, Error> {
    let chunks = [(JSON_CHUNK, json, b' '), (BINARY_CHUNK, binary, 0)];
    let chunks = if binary.is_empty() { &chunks[..1] } else { &chunks[..] };
    let total = HEADER_LENGTH
        + chunks.iter().map(|(_, content, _)| CHUNK_HEADER_LENGTH + content.len().next_multiple_of(4)).sum::<usize>();
    let too_large = || Error::new(ErrorCode::TooLarge, "output", "a GLB file cannot exceed 4 GiB");
    let mut out = Vec::with_capacity(total);
    out.extend_from_slice(MAGIC);
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&u32::try_from(total).map_err(|_| too_large())?.to_le_bytes());
    for &(chunk_type, content, padding) in chunks {
        let padded = content.len().next_multiple_of(4);
        out.extend_from_slice(&u32::try_from(padded).map_err(|_| too_large())?.to_le_bytes());
        out.extend_from_slice(&chunk_type.to_le_bytes());
        out.extend_from_slice(content);
        out.resize(out.len() + padded - content.len(), padding);
    }
    Ok(out)
}

fn read_u32(bytes: &[u8], offset: usize) -> Result<u32, Error> {
    match bytes.get(offset..offset + 4) {
        Some(&[a, b, c, d]) => Ok(u32::from_le_bytes([a, b, c, d])),
        _ => Err(fail(ErrorCode::Truncated, offset, "the file ends inside a header")),
    }
}

fn fail(code: ErrorCode, offset: usize, message: impl Into<String>) -> Error {
    Error::new(code, format!("byte {offset}"), message)
}
