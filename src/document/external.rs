//! Which files a glTF refers to: asked before opening, so that they can be found and given.

use serde_json::Value;

/// The URIs of buffers and images that are not embedded, in order, each once. Empty for anything
/// that does not parse: opening it says why.
#[must_use]
pub fn external_files(bytes: &[u8]) -> Vec<String> {
    let json = if bytes.starts_with(b"glTF") { glb_json(bytes).unwrap_or_default() } else { bytes };
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    let Ok(tree) = serde_json::from_slice::<Value>(json) else { return Vec::new() };
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
}
