//! Written again with every triangle, a file is what it was: compared piece by piece.

use std::collections::BTreeSet;
use std::path::Path;

use base64::Engine as _;
use decimesh::document::{Document, Format, NamedFile};
use serde_json::{Map, Value, json};

use super::whole_files::models_under;
use super::*;

/// A file as JSON and the bytes of its buffers.
struct Parts {
    json: Value,
    buffers: Vec<Option<Vec<u8>>>,
}

impl Parts {
    fn of(files: &[NamedFile]) -> Self {
        let main = &files[0].bytes;
        let (json, binary) = if main.starts_with(b"glTF") {
            let end = 20 + u32::from_le_bytes(main[12..16].try_into().unwrap()) as usize;
            (&main[20..end], main.get(end + 8..).map(<[u8]>::to_vec))
        } else {
            (&main[..], None)
        };
        let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
        let json: Value = serde_json::from_slice(json.trim_ascii_end()).unwrap();
        let buffers = list(&json, "buffers").iter().enumerate().map(|(i, buffer)| {
            let Some(uri) = buffer["uri"].as_str() else {
                return binary.clone().filter(|_| i == 0);
            };
            match uri.split_once("base64,").filter(|_| uri.starts_with("data:")) {
                Some((_, data)) => Some(base64::engine::general_purpose::STANDARD.decode(data).unwrap()),
                None => files.iter().find(|file| file.name == uri.replace("%20", " ")).map(|file| file.bytes.clone()),
            }
        });
        let buffers = buffers.collect();
        Self { json, buffers }
    }

    fn view(&self, index: usize) -> Option<&[u8]> {
        let view = &self.json["bufferViews"][index];
        let offset = number(view, "byteOffset").unwrap_or(0);
        let buffer = self.buffers.get(number(view, "buffer")?)?.as_ref()?;
        buffer.get(offset..offset + number(view, "byteLength")?)
    }
}

fn list<'a>(json: &'a Value, key: &str) -> &'a [Value] {
    json[key].as_array().map_or(&[], Vec::as_slice)
}

fn number(json: &Value, key: &str) -> Option<usize> {
    json[key].as_f64().map(|number| number as usize)
}

fn without(json: &Value, keys: &[&str]) -> Value {
    let members = json.as_object().unwrap().iter().filter(|(key, _)| !keys.contains(&key.as_str()));
    Value::Object(members.map(|(key, value)| (key.clone(), value.clone())).collect::<Map<_, _>>())
}

/// Extensions of packed or numbered geometry, which the writer takes out.
const REMOVED: [&str; 6] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "CESIUM_primitive_outline",
    "EXT_mesh_manifold",
    "FB_ngon_encoding",
];

fn without_removed(json: &Value) -> Value {
    let mut json = json.clone();
    if let Some(extensions) = json.get_mut("extensions").and_then(Value::as_object_mut) {
        extensions.retain(|name, _| !REMOVED.contains(&name.as_str()));
        if extensions.is_empty() {
            json.as_object_mut().unwrap().remove("extensions");
        }
    }
    json
}

fn is_triangles(primitive: &Value) -> bool {
    let is_placed = primitive["attributes"].get("POSITION").is_some();
    is_placed && primitive.get("mode").is_none_or(|mode| mode.as_f64().unwrap() >= 4.0)
}

/// Accessors that triangles use.
fn touched(json: &Value) -> BTreeSet<usize> {
    let mut out = BTreeSet::new();
    let primitives = list(json, "meshes").iter().flat_map(|mesh| list(mesh, "primitives"));
    for primitive in primitives.filter(|p| is_triangles(p)) {
        let semantics = [&primitive["attributes"]].into_iter().chain(list(primitive, "targets"));
        let semantics = semantics.flat_map(|semantics| semantics.as_object().unwrap().values());
        out.extend(semantics.chain(primitive.get("indices")).map(|accessor| accessor.as_f64().unwrap() as usize));
    }
    out
}

/// Text, so that the order of members and the digits of numbers count, too.
#[track_caller]
fn assert_equal(what: &str, before: &Value, after: &Value) {
    assert_eq!(before.to_string(), after.to_string(), "{what}");
}

fn compare(name: &str, before: &Parts, after: &Parts) {
    let (old, new) = (&before.json, &after.json);
    let geometry = ["accessors", "bufferViews", "buffers", "images", "meshes", "extensionsUsed", "extensionsRequired"];
    assert_equal(name, &without(old, &geometry), &without(new, &geometry));
    for key in ["extensionsUsed", "extensionsRequired"] {
        let names =
            |json| list(json, key).iter().filter(|n| !REMOVED.contains(&n.as_str().unwrap())).collect::<Vec<_>>();
        assert_eq!(names(old), names(new), "{name}: {key}");
    }

    assert_eq!(list(old, "meshes").len(), list(new, "meshes").len(), "{name}");
    for (m, (old, new)) in list(old, "meshes").iter().zip(list(new, "meshes")).enumerate() {
        assert_equal(name, &without(&without_removed(old), &["primitives"]), &without(new, &["primitives"]));
        assert_eq!(list(old, "primitives").len(), list(new, "primitives").len(), "{name}");
        for (p, (old, new)) in list(old, "primitives").iter().zip(list(new, "primitives")).enumerate() {
            let place = format!("{name}: meshes[{m}].primitives[{p}]");
            if !is_triangles(old) {
                assert_equal(&place, old, new);
                continue;
            }
            let numbered = ["attributes", "targets", "indices", "mode"];
            assert_equal(&place, &without(&without_removed(old), &numbered), &without(new, &numbered));
            let names = |json: &Value| json.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
            assert_eq!(names(&old["attributes"]), names(&new["attributes"]), "{place}");
            let targets = |json| list(json, "targets").iter().map(names).collect::<Vec<_>>();
            assert_eq!(targets(old), targets(new), "{place}");
            assert!(new.get("indices").is_some(), "{place}");
        }
    }

    let touched = touched(old);
    let mut free_views = BTreeSet::new();
    for (a, accessor) in list(old, "accessors").iter().enumerate() {
        let place = format!("{name}: accessors[{a}]");
        let views = [accessor, &accessor["sparse"]["indices"], &accessor["sparse"]["values"]];
        let views = views.into_iter().filter_map(|json| number(json, "bufferView"));
        if touched.contains(&a) {
            free_views.extend(views);
            // The last of the array may be gone.
            if let Some(new) = new["accessors"].get(a) {
                let moved =
                    ["bufferView", "byteOffset", "count", "min", "max", "sparse", "componentType", "normalized"];
                assert_equal(&place, &without(accessor, &moved), &without(new, &moved));
            }
        } else {
            assert_equal(&place, accessor, &new["accessors"][a]);
            for view in views {
                assert!(before.view(view) == after.view(view), "{place}: its data");
            }
        }
    }
    for (v, view) in list(old, "bufferViews").iter().enumerate().filter(|(v, _)| !free_views.contains(v)) {
        let packed = view.pointer("/extensions/EXT_meshopt_compression").is_some();
        let draco = old.to_string().contains("KHR_draco_mesh_compression");
        if packed || draco {
            continue;
        }
        let place = format!("{name}: bufferViews[{v}]");
        let new = &new["bufferViews"][v];
        assert_equal(&place, &without(view, &["buffer", "byteOffset"]), &without(new, &["buffer", "byteOffset"]));
        assert!(before.view(v) == after.view(v), "{place}: its data");
    }
    for (b, buffer) in list(old, "buffers").iter().enumerate() {
        let stated = without(&without_removed(buffer), &["uri", "byteLength"]);
        let kept = new["buffers"].get(b).map_or_else(|| json!({}), |kept| without(kept, &["uri", "byteLength"]));
        assert_equal(&format!("{name}: buffers[{b}]"), &stated, &kept);
    }
    for (i, (old, new)) in list(old, "images").iter().zip(list(new, "images")).enumerate() {
        let place = format!("{name}: images[{i}]");
        if old.get("uri").is_none() || new.get("uri").is_some() {
            assert_equal(&place, old, new);
        } else {
            let moved = ["uri", "bufferView", "mimeType"];
            assert_equal(&place, &without(old, &moved), &without(new, &moved));
        }
    }
}

/// Whether the file could be opened.
fn check(path: &Path) -> bool {
    let files = load(path);
    let before = Parts::of(&files);
    let Ok(document) = Document::open(files) else { return false };
    let written = document.write(document.mesh(), Format::Glb).unwrap();
    let after = Parts::of(&[named("written.glb", written)]);
    compare(&path.display().to_string(), &before, &after);
    true
}

#[test]
fn fixtures_stay_what_they_are() {
    let checked = models_under(&fixtures()).iter().filter(|path| check(path)).count();
    assert!(checked >= 8, "only {checked} could be opened");
}

#[test]
fn real_files_stay_what_they_are() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets/gltf");
    if !assets.is_dir() {
        println!("skipped: real_files_stay_what_they_are (../shared/assets is not there)");
        return;
    }
    // These are not JSON.
    let is_json = |path: &&PathBuf| !path.ends_with("scene-custom-fields.gltf");
    let checked = models_under(&assets).iter().filter(is_json).filter(|path| check(path)).count();
    assert!(checked > 100, "only {checked} could be opened");
}

#[test]
fn what_later_buffers_say_is_kept() {
    let (mut json, binary) = square();
    let data = |bytes: &[u8]| {
        let text = base64::engine::general_purpose::STANDARD.encode(bytes);
        format!("data:application/octet-stream;base64,{text}")
    };
    json["buffers"] = json!([
        { "byteLength": 48, "uri": data(&binary[..48]), "name": "positions" },
        { "byteLength": 4, "uri": data(b"none") },
        { "byteLength": 12, "uri": data(&binary[48..]), "name": "indices", "extras": { "by": 3 } },
        { "byteLength": 4, "uri": data(b"none") },
    ]);
    json["bufferViews"][1] = json!({ "buffer": 2, "byteLength": 12 });
    let files = [named("m.gltf", json.to_string().into_bytes())];
    let document = Document::open(files.to_vec()).unwrap();
    let written = document.write(document.mesh(), Format::Glb).unwrap();
    let after = Parts::of(&[named("written.glb", written.clone())]);
    compare("four buffers", &Parts::of(&files), &after);
    assert_eq!(list(&after.json, "buffers").len(), 3, "the last said nothing");
    assert_eq!(reopen(written).mesh(), document.mesh());
}

#[test]
fn digits_of_numbers_stay() {
    let (json, binary) = square();
    let text = json.to_string().replace(
        "\"name\":\"Square\"",
        "\"name\":\"Square\",\"extras\":[1.50,1e+400,-0.0,0.1000000000000000055511151231257827,18446744073709551616]",
    );
    let mut glb = Glb::new(&json, binary);
    glb.json = text.into_bytes();
    glb.json.resize(glb.json.len().next_multiple_of(4), b' ');
    let document = Document::open(vec![named("m.glb", glb.bytes())]).unwrap();
    let written = document.write(document.mesh(), Format::Glb).unwrap();
    let kept = b"[1.50,1e+400,-0.0,0.1000000000000000055511151231257827,18446744073709551616]";
    let found = written.windows(kept.len()).any(|window| window == kept);
    assert!(found, "{}", String::from_utf8_lossy(&written));
}
