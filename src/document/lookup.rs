//! The files given beside a model: which one a reference means, and what kind of image it is.

use std::borrow::Cow;

use super::NamedFile;

/// The file that a relative URI names: by its path from the referring file, as written, or by its
/// last part, because a drop on a page gives names without folders.
pub(super) fn find_file(uri: &str, files: &[NamedFile], main: usize) -> Option<usize> {
    let uri = uri.split(['?', '#']).next().unwrap_or(uri);
    let decoded = String::from_utf8_lossy(&percent_decode(uri)).into_owned();
    let folder = files.get(main).map_or("", |file| folder_of(&file.name));
    let wanted = [normalize(&format!("{folder}{decoded}")), normalize(&decoded), normalize(uri)];
    let others = || files.iter().enumerate().filter(|&(i, _)| i != main);
    for name in &wanted {
        if let Some((i, _)) = others().find(|(_, file)| normalize(&file.name) == *name) {
            return Some(i);
        }
    }
    let last = wanted[1].rsplit('/').next()?;
    let has_last = |same: fn(&str, &str) -> bool| {
        others().find(|(_, file)| normalize(&file.name).rsplit('/').next().is_some_and(|name| same(name, last)))
    };
    // Where a model was made, case may not have mattered.
    has_last(|a, b| a == b).or_else(|| has_last(str::eq_ignore_ascii_case)).map(|(i, _)| i)
}

fn folder_of(name: &str) -> &str {
    name.rfind(['/', '\\']).map_or("", |slash| &name[..=slash])
}

/// `./a/../b\c` as `b/c`.
fn normalize(name: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in name.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// A URI short enough for a one-line message.
pub(super) fn shorten(uri: &str) -> String {
    const LONGEST: usize = 80;
    match uri.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &uri[..end]),
        None => uri.to_owned(),
    }
}

/// `%20` and its like as the bytes they stand for; anything else as it is.
pub(super) fn percent_decode(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return Cow::Borrowed(text.as_bytes());
    }
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let digit = |i: usize| bytes.get(i).and_then(|&b| char::from(b).to_digit(16));
        if let (b'%', Some(high), Some(low)) = (bytes[at], digit(at + 1), digit(at + 2)) {
            out.push((high * 16 + low) as u8);
            at += 3;
        } else {
            out.push(bytes[at]);
            at += 1;
        }
    }
    Cow::Owned(out)
}

/// The MIME type by the first bytes, for the image formats that glTF files hold.
pub(super) fn image_type(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xFF, 0xD8, 0xFF, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xAB, b'K', b'T', b'X', b' ', b'2', b'0', 0xBB, ..] => Some("image/ktx2"),
        [b'D', b'D', b'S', b' ', ..] => Some("image/vnd-ms.dds"),
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', b'f' | b's', ..] => Some("image/avif"),
        _ => None,
    }
}
