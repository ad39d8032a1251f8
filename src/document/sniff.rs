//! Which format a file has, by its content.

use std::borrow::Cow;

use super::{Format, NamedFile, obj, off, ply, smf, stl};
use crate::error::{Error, ErrorCode};

/// The first file that is a model, and its format. Text in UTF-16 becomes UTF-8 if it is one.
pub(super) fn first_model(files: &mut [NamedFile]) -> Result<(usize, Format), Error> {
    for (i, file) in files.iter_mut().enumerate() {
        if let Some(text) = decode_utf16(&file.bytes)
            && let Some(format) = sniff_text(&text)
        {
            file.bytes = text.into_owned();
            return Ok((i, format));
        }
        if let Some(format) = sniff(file) {
            return Ok((i, format));
        }
    }
    let name = files.first().map_or("", |f| f.name.as_str());
    let message = if files.is_empty() { "no file was given" } else { "neither glTF, GLB, OBJ, PLY, STL, OFF nor SMF" };
    Err(Error::new(ErrorCode::UnknownFormat, name, message))
}

/// `None` if it is none of ours. The name counts only where the content leaves it open.
fn sniff(file: &NamedFile) -> Option<Format> {
    if file.bytes.starts_with(b"glTF") {
        return Some(Format::Glb);
    }
    if ply::looks_like_ply(&file.bytes) {
        return Some(Format::Ply);
    }
    // Before text: its header may say anything.
    if stl::looks_like_stl(&file.bytes, false) {
        return Some(Format::Stl);
    }
    sniff_text(&file.bytes).or_else(|| {
        let is_named_stl = file.name.get(file.name.len().saturating_sub(4)..)?.eq_ignore_ascii_case(".stl");
        stl::looks_like_stl(&file.bytes, is_named_stl).then_some(Format::Stl)
    })
}

fn sniff_text(bytes: &[u8]) -> Option<Format> {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let first = text.iter().find(|b| !b.is_ascii_whitespace());
    if first == Some(&b'{') {
        return Some(Format::Gltf);
    }
    if off::looks_like_off(text) {
        return Some(Format::Off);
    }
    if smf::looks_like_smf(text) {
        return Some(Format::Smf);
    }
    obj::looks_like_obj(text).then_some(Format::Obj)
}

/// Bytes that begin with a byte order mark of UTF-16, as UTF-8; `None` for others.
pub(super) fn decode_utf16(bytes: &[u8]) -> Option<Cow<'_, [u8]>> {
    let (unit, rest): (fn([u8; 2]) -> u16, _) = match bytes {
        [0xFF, 0xFE, rest @ ..] => (u16::from_le_bytes, rest),
        [0xFE, 0xFF, rest @ ..] => (u16::from_be_bytes, rest),
        _ => return None,
    };
    let units = rest.as_chunks::<2>().0.iter().map(|&pair| unit(pair));
    let text: String = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    Some(Cow::Owned(text.into_bytes()))
}
