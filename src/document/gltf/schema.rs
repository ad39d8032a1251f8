//! Is this JSON a glTF 2.0 whose geometry can be relied on?
//!
//! The `gltf` crate checks types and index ranges, but it also refuses files for what has nothing
//! to do with triangles: an unknown required extension, an animation pointer, a texture without a
//! source. So its findings are collected and judged here: about geometry they are errors, about
//! anything else warnings, for that part of the tree is only carried through.

use ::gltf::json::validation::{Error as Finding, Validate};
use ::gltf::json::{Path, Root};
use serde_json::{Map, Value, json};

use super::json::{index, items, path_at, text};
use crate::error::{Error, ErrorCode, Warning};

pub(super) const DRACO_EXTENSION: &str = "KHR_draco_mesh_compression";
pub(super) const MESHOPT_EXTENSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// What the reader takes from the file; the rest is carried through.
const GEOMETRY: [&str; 9] =
    ["asset", "accessors", "bufferViews", "buffers", "meshes", "nodes", "scene", "scenes", "skins"];

/// Parses and checks; the tree is what will be edited, the root what is read.
///
/// # Errors
/// `syntax`, `out-of-range`, `too-large` or `unsupported`, at a JSON path.
pub(super) fn parse(json: &[u8], warnings: &mut Vec<Warning>) -> Result<(Value, Root), Error> {
    // Neither is allowed, and both occur: a byte-order mark, and zeros that pad a GLB chunk.
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    let json = &json[..json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1)];
    let tree: Value = serde_json::from_slice(json).map_err(|error| syntax_error(json, &error))?;
    check_version(&tree)?;
    check_unguarded_indices(&tree)?;
    let root = match serde_json::from_slice::<Root>(json) {
        Ok(root) => root,
        Err(error) => {
            // The fault may lie in a part that is only carried through.
            let reduced = serde_json::to_vec(&geometry_of(&tree)).unwrap_or_default();
            let root = serde_json::from_slice(&reduced).map_err(|error| syntax_error(&reduced, &error))?;
            let fault = syntax_error(json, &error);
            warnings.push(Warning {
                code: "schema",
                message: format!("{}; carried through unchanged", fault.message()),
                place: fault.place().to_owned(),
            });
            root
        }
    };
    judge(&root, warnings)?;
    Ok((tree, root))
}

/// Only the geometry of the tree; materials stay as empty ones, for their indices.
fn geometry_of(tree: &Value) -> Value {
    let kept = GEOMETRY.iter().filter_map(|&key| Some((key.to_owned(), tree.get(key)?.clone())));
    let mut reduced: Map<String, Value> = kept.collect();
    for node in reduced.get_mut("nodes").and_then(Value::as_array_mut).into_iter().flatten() {
        super::json::remove(node, "camera");
    }
    let materials = vec![json!({}); items(tree, "materials").len()];
    reduced.insert("materials".into(), materials.into());
    let mut reduced = Value::Object(reduced);
    write_integers_as_integers(&mut reduced);
    reduced
}

/// JSON does not tell 1.0 from 1, and some exporters write all numbers alike; the crate does mind.
fn write_integers_as_integers(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(write_integers_as_integers),
        Value::Object(object) => object.values_mut().for_each(write_integers_as_integers),
        Value::Number(number) if number.is_f64() => {
            if let Some(integer) = index(value) {
                *value = integer.into();
            }
        }
        _ => {}
    }
}

fn check_version(tree: &Value) -> Result<(), Error> {
    if !tree.is_object() {
        return Err(Error::new(ErrorCode::Syntax, "", "a glTF file is a JSON object"));
    }
    let asset = &tree["asset"];
    let version = text(asset, "version");
    // glTF 1.0 did not demand a version, but kept its meshes in an object.
    if version.is_some_and(|v| v.starts_with("1.")) || (version.is_none() && tree["meshes"].is_object()) {
        return Err(Error::new(ErrorCode::Unsupported, "asset.version", "glTF 1.0 is not supported; only 2.0 is"));
    }
    let Some(version) = version else {
        return Err(Error::new(ErrorCode::Syntax, "asset.version", "missing: a glTF file states its version"));
    };
    let (key, needed) = text(asset, "minVersion").map_or(("version", version), |v| ("minVersion", v));
    if needed.starts_with("2.") && (key == "version" || needed == "2.0") {
        return Ok(());
    }
    let message = format!("glTF {needed} is not supported; only 2.0 is");
    Err(Error::new(ErrorCode::Unsupported, format!("asset.{key}"), message))
}

/// The crate's own validation looks these indices up before it checks them.
fn check_unguarded_indices(tree: &Value) -> Result<(), Error> {
    let count = items(tree, "accessors").len();
    for (m, mesh) in items(tree, "meshes").iter().enumerate() {
        for (p, primitive) in items(mesh, "primitives").iter().enumerate() {
            let place = format!("meshes[{m}].primitives[{p}]");
            check_accessors(&primitive["attributes"], &format!("{place}.attributes"), count)?;
            for (t, target) in items(primitive, "targets").iter().enumerate() {
                check_accessors(target, &format!("{place}.targets[{t}]"), count)?;
            }
        }
    }
    Ok(())
}

fn check_accessors(semantics: &Value, place: &str, count: usize) -> Result<(), Error> {
    for (name, accessor) in semantics.as_object().into_iter().flatten() {
        if let Some(accessor) = index(accessor).filter(|&accessor| accessor >= count) {
            let message = format!("accessor {accessor} does not exist; there are {count}");
            return Err(Error::new(ErrorCode::OutOfRange, format!("{place}.{name}"), message));
        }
    }
    Ok(())
}

fn judge(root: &Root, warnings: &mut Vec<Warning>) -> Result<(), Error> {
    let mut findings: Vec<(Path, Finding)> = Vec::new();
    root.validate(root, Path::new, &mut |path, finding| {
        findings.push((path(), finding));
    });
    for (path, finding) in findings {
        let path = path.as_str().to_owned();
        let is_missing = matches!(finding, Finding::Missing);
        if is_repaired(&path, is_missing) {
            continue;
        }
        let (code, reason) = match finding {
            Finding::IndexOutOfBounds => (ErrorCode::OutOfRange, "refers to something that does not exist"),
            Finding::Missing => (ErrorCode::Syntax, "is missing"),
            Finding::Oversize => (ErrorCode::TooLarge, "is larger than memory"),
            Finding::Unsupported => (ErrorCode::Unsupported, "is not supported"),
            Finding::Invalid => (ErrorCode::Syntax, "has a value that glTF 2.0 does not allow"),
        };
        let top = path.split(['.', '[']).next().unwrap_or_default();
        if GEOMETRY.contains(&top) && !path.ends_with(".camera") {
            let name = path.rsplit('.').next().unwrap_or_default().to_owned();
            return Err(Error::new(code, path, format!("{name} {reason}")));
        }
        warnings.push(Warning { code: "schema", message: format!("{reason}; carried through unchanged"), place: path });
    }
    Ok(())
}

/// Findings about what was checked already, what may be left out (an accessor without a buffer
/// view is all zeros), or what the writer replaces.
fn is_repaired(path: &str, is_missing: bool) -> bool {
    path.starts_with("extensionsRequired")
        || path.contains("attributes[\"")
        || (is_missing && path.starts_with("accessors[") && path.ends_with("].bufferView"))
        || (path.starts_with("bufferViews[") && path.ends_with(".target"))
}

/// A parser's error at the JSON path where it struck, with line and column for an editor.
fn syntax_error(json: &[u8], error: &serde_json::Error) -> Error {
    let (line, column) = (error.line(), error.column());
    let line_start = match line {
        0 | 1 => 0,
        _ => json.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(line - 2).map_or(0, |(at, _)| at + 1),
    };
    let mut message = error.to_string();
    if let Some(end) = message.rfind(" at line ") {
        message.truncate(end);
    }
    let position = format!("line {line} column {column}");
    let path = path_at(json, line_start + column);
    // A nesting bomb has a path as long as itself.
    const LONGEST: usize = 120;
    let place = if path.is_empty() || path.len() > LONGEST { position } else { format!("{path} ({position})") };
    let code = if error.is_eof() { ErrorCode::Truncated } else { ErrorCode::Syntax };
    Error::new(code, place, format!("JSON: {message}"))
}
