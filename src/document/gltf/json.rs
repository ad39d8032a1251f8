//! Small look-ups in a JSON tree: absent and mistyped are the same here, because types are checked first.
//!
//! `inline(never)` as in [`super::spot`]: for small code.

use crate::document::json_tree::{Members, Value};

/// An object with these members; `json!` would be a screen of code at every place.
#[inline(never)]
pub(super) fn object(members: Vec<(&str, Value)>) -> Value {
    Value::Object(members.into_iter().collect())
}

/// The member of an object under `key`.
pub(super) fn member<'a>(object: &'a Value, key: &str) -> Option<&'a Value> {
    object.get(key)
}

/// The array under `key`, or an empty one.
#[inline(never)]
pub(super) fn items<'a>(object: &'a Value, key: &str) -> &'a [Value] {
    object.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// The array under `key`, to change.
#[inline(never)]
pub(super) fn items_mut<'a>(object: &'a mut Value, key: &str) -> &'a mut [Value] {
    object.get_mut(key).and_then(Value::as_array_mut).map_or(&mut [], Vec::as_mut_slice)
}

/// The members of the object under `key`, in the order of the file.
pub(super) fn members<'a>(object: &'a Value, key: &str) -> impl Iterator<Item = (&'a str, &'a Value)> + use<'a> {
    object.get(key).and_then(Value::as_object).into_iter().flat_map(Members::iter)
}

/// A non-negative integer.
#[inline(never)]
pub(super) fn uint(object: &Value, key: &str) -> Option<usize> {
    member(object, key).and_then(index)
}

/// The value itself as a non-negative integer; JSON may write it with a decimal point.
#[inline(never)]
pub(super) fn index(value: &Value) -> Option<usize> {
    const EXACT: f64 = 9_007_199_254_740_992.0; // 2^53
    let integer = value.as_f64().filter(|number| (0.0..EXACT).contains(number) && number.fract() == 0.0);
    value.as_u64().or(integer.map(|number| number as u64)).and_then(|number| usize::try_from(number).ok())
}

/// A string.
#[inline(never)]
pub(super) fn text<'a>(object: &'a Value, key: &str) -> Option<&'a str> {
    member(object, key).and_then(Value::as_str)
}

/// The extension object of this name.
#[inline(never)]
pub(super) fn extension<'a>(object: &'a Value, name: &str) -> Option<&'a Value> {
    member(member(object, "extensions")?, name)
}

/// Removes one extension object, and `extensions` with it when nothing is left there.
#[inline(never)]
pub(super) fn remove_extension(object: &mut Value, name: &str) {
    let Some(object) = object.as_object_mut() else {
        return;
    };
    let Some(extensions) = object.get_mut("extensions").and_then(Value::as_object_mut) else {
        return;
    };
    if extensions.remove(name).is_some() && extensions.is_empty() {
        object.remove("extensions");
    }
}

/// Removes a member; the order of the others stays.
#[inline(never)]
pub(super) fn remove(object: &mut Value, key: &str) {
    if let Some(object) = object.as_object_mut() {
        object.remove(key);
    }
}

/// Calls `visit` with every `(extension name, its object)` of the whole tree.
pub(super) fn for_each_extension<'a>(tree: &'a Value, visit: &mut dyn FnMut(&'a str, &'a Value)) {
    match tree {
        Value::Array(values) => {
            let nested = values.iter().filter(|value| value.is_object() || value.is_array());
            nested.for_each(|value| for_each_extension(value, visit));
        }
        Value::Object(object) => {
            for (key, value) in object.iter() {
                if key == "extensions" {
                    value.as_object().into_iter().flat_map(Members::iter).for_each(|(name, value)| visit(name, value));
                }
                if key != "extras" {
                    for_each_extension(value, visit);
                }
            }
        }
        _ => {}
    }
}

/// The path (`meshes[0].name`) of what lies at or just before a byte of a JSON text.
pub(super) fn path_at(json: &[u8], end: usize) -> String {
    enum Step {
        Key(Option<String>),
        Index(usize),
    }
    let mut steps: Vec<Step> = Vec::new();
    let (mut at, mut expects_key) = (0, false);
    while at < end.min(json.len()) {
        match json[at] {
            b'{' => {
                steps.push(Step::Key(None));
                expects_key = true;
            }
            b'[' => {
                steps.push(Step::Index(0));
                expects_key = false;
            }
            b'}' | b']' if at + 1 < end => {
                steps.pop();
                expects_key = false;
            }
            // What an object lacks is noticed at its end, and has nothing to do with its last member.
            b'}' => {
                if let Some(Step::Key(key)) = steps.last_mut() {
                    *key = None;
                }
            }
            b',' if at + 1 < end => match steps.last_mut() {
                Some(Step::Index(index)) => *index += 1,
                Some(Step::Key(_)) => expects_key = true,
                None => {}
            },
            b'"' => {
                let start = at + 1;
                at = start;
                while at < json.len() && json[at] != b'"' {
                    at += if json[at] == b'\\' { 2 } else { 1 };
                }
                if let (true, Some(Step::Key(key))) = (expects_key, steps.last_mut()) {
                    let name = json.get(start..at).unwrap_or_default();
                    *key = Some(String::from_utf8_lossy(name).into_owned());
                    expects_key = false;
                }
            }
            _ => {}
        }
        at += 1;
    }
    let mut path = String::new();
    for step in &steps {
        match step {
            Step::Key(Some(key)) if path.is_empty() => path.push_str(key),
            Step::Key(Some(key)) => path.extend([".", key]),
            Step::Key(None) => {}
            Step::Index(index) => path.push_str(&format!("[{index}]")),
        }
    }
    path
}
