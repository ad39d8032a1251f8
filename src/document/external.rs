//! Which files a model refers to: asked before opening, so that they can be found and given.

use std::borrow::Cow;

use super::json_tree::Value;

use super::sniff::decode_utf16;
use super::{json_parse, obj, ply};

/// What a file names beside itself, in order, each once: the buffers and images of a glTF that are
/// not embedded, the material libraries of an OBJ, the images of such a library, the texture in a
/// comment of a PLY. Empty for anything else, and for what does not parse: opening it says why.
#[must_use]
pub fn external_files(bytes: &[u8]) -> Vec<String> {
    if ply::looks_like_ply(bytes) {
        return ply::texture_name(bytes).into_iter().collect();
    }
    let text = decode_utf16(bytes).unwrap_or(Cow::Borrowed(bytes));
    let first = text.iter().find(|byte| !byte.is_ascii_whitespace());
    if !bytes.starts_with(b"glTF") && first != Some(&b'{') {
        return obj::external_files(&text);
    }
    let json = if bytes.starts_with(b"glTF") { glb_json(bytes).unwrap_or_default() } else { bytes };
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    let Ok(tree) = json_parse::parse(json) else { return Vec::new() };
    let mut found: Vec<String> = Vec::new();
    for list in ["buffers", "images"] {
        for item in tree.get(list).and_then(Value::as_array).into_iter().flatten() {
            if let Some(uri) = item.get("uri").and_then(Value::as_str)
                && !uri.starts_with("data:")
                && !found.iter().any(|f| f == uri)
            {
                found.push(uri.to_owned());
            }
        }
    }
    found
}

/// The JSON chunk of a GLB: a 12-byte header, then the chunk's length and type.
fn glb_json(bytes: &[u8]) -> Option<&[u8]> {
    let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
    bytes.get(20..20_usize.checked_add(length)?)
}

#[cfg(test)]
mod tests {
    use super::external_files;

    #[test]
    fn names_are_listed_once_and_embedded_data_is_not() {
        let json =
            br#"{"buffers":[{"uri":"a.bin"},{"uri":"data:,x"},{}],"images":[{"uri":"t/b.png"},{"uri":"a.bin"}]}"#;
        assert_eq!(external_files(json), ["a.bin", "t/b.png"]);
        assert!(external_files(b"glTF").is_empty());
        assert!(external_files(b"not json").is_empty());
    }

    #[test]
    fn libraries_and_their_images_are_listed() {
        assert_eq!(external_files(b"# x\n mtllib a b.mtl c.mtl\nv 0 0 0\r\nmtllib c.mtl"), ["a b.mtl", "c.mtl"]);
        let library = b"newmtl a\nmap_Kd -s 1 1 1 a b.png\nKd 1 1 1\n\tmap_Bump n.png\nmap_Kd a b.png\n";
        assert_eq!(external_files(library), ["a b.png", "n.png"]);
        assert_eq!(external_files(b"ply\nformat ascii 1.0\ncomment TextureFile a b.png\nend_header\n"), ["a b.png"]);
    }
}
