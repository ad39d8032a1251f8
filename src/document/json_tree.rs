//! A JSON text as a tree that is written again as it was read: members in their order, numbers with their digits.
//!
//! A file of thousands of small meshes is mostly JSON, and a general tree with a hash table for each object and a string for
//! each number takes longer to build than all else: here an object is a list (with an index when it is long) and a
//! whole number is a number. [`super::json_parse`] reads the text.

use std::ops::{Index, IndexMut};

/// A JSON value.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) enum Value {
    #[default]
    Null,
    Bool(bool),
    /// A number that its digits alone are: no sign, fraction or exponent.
    Whole(u64),
    /// Any other number, as it is written.
    Number(Box<str>),
    String(Box<str>),
    Array(Vec<Value>),
    Object(Members),
}

static NULL: Value = Value::Null;

impl Value {
    pub(crate) fn is_null(&self) -> bool {
        matches!(self, Self::Null)
    }

    pub(crate) fn is_object(&self) -> bool {
        matches!(self, Self::Object(_))
    }

    pub(crate) fn is_array(&self) -> bool {
        matches!(self, Self::Array(_))
    }

    pub(crate) fn as_object(&self) -> Option<&Members> {
        if let Self::Object(members) = self { Some(members) } else { None }
    }

    pub(crate) fn as_object_mut(&mut self) -> Option<&mut Members> {
        if let Self::Object(members) = self { Some(members) } else { None }
    }

    pub(crate) fn as_array(&self) -> Option<&Vec<Self>> {
        if let Self::Array(values) = self { Some(values) } else { None }
    }

    pub(crate) fn as_array_mut(&mut self) -> Option<&mut Vec<Self>> {
        if let Self::Array(values) = self { Some(values) } else { None }
    }

    pub(crate) fn as_str(&self) -> Option<&str> {
        if let Self::String(text) = self { Some(text) } else { None }
    }

    pub(crate) fn as_bool(&self) -> Option<bool> {
        if let Self::Bool(value) = self { Some(*value) } else { None }
    }

    /// The value, with `null` in its place.
    pub(crate) fn take(&mut self) -> Self {
        std::mem::take(self)
    }

    /// The number if it is written as a whole one below 2^64.
    pub(crate) fn as_u64(&self) -> Option<u64> {
        if let Self::Whole(value) = self { Some(*value) } else { None }
    }

    /// The nearest `f64`; `None` for what is no number or beyond all of them.
    pub(crate) fn as_f64(&self) -> Option<f64> {
        match self {
            Self::Whole(value) => Some(*value as f64),
            Self::Number(text) => text.parse().ok().filter(|value: &f64| value.is_finite()),
            _ => None,
        }
    }

    /// The member under `key` of an object.
    #[inline(never)]
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        self.as_object()?.get(key)
    }

    /// As [`Value::get`], to change.
    #[inline(never)]
    pub(crate) fn get_mut(&mut self, key: &str) -> Option<&mut Self> {
        self.as_object_mut()?.get_mut(key)
    }

    /// Appends the text, without spaces.
    pub(crate) fn write(&self, out: &mut Vec<u8>) {
        match self {
            Self::Null => out.extend(b"null"),
            Self::Bool(value) => out.extend(if *value { &b"true"[..] } else { b"false" }),
            Self::Whole(value) => out.extend(itoa::Buffer::new().format(*value).as_bytes()),
            Self::Number(text) => out.extend(text.as_bytes()),
            Self::String(text) => write_string(text, out),
            Self::Array(values) => {
                out.push(b'[');
                for (i, value) in values.iter().enumerate() {
                    if i > 0 {
                        out.push(b',');
                    }
                    value.write(out);
                }
                out.push(b']');
            }
            Self::Object(members) => {
                out.push(b'{');
                for (i, (key, value)) in members.iter().enumerate() {
                    if i > 0 {
                        out.push(b',');
                    }
                    write_string(key, out);
                    out.push(b':');
                    value.write(out);
                }
                out.push(b'}');
            }
        }
    }
}

#[inline(never)]
fn write_string(text: &str, out: &mut Vec<u8>) {
    const HEX: &[u8; 16] = b"0123456789abcdef";
    out.push(b'"');
    let mut start = 0;
    for (at, byte) in text.bytes().enumerate() {
        let escape = match byte {
            b'"' | b'\\' => byte,
            b'\n' => b'n',
            b'\r' => b'r',
            b'\t' => b't',
            8 => b'b',
            12 => b'f',
            0..32 => b'u',
            _ => continue,
        };
        out.extend(&text.as_bytes()[start..at]);
        start = at + 1;
        out.extend([b'\\', escape]);
        if escape == b'u' {
            out.extend([b'0', b'0', HEX[usize::from(byte >> 4)], HEX[usize::from(byte & 15)]]);
        }
    }
    out.extend(&text.as_bytes()[start..]);
    out.push(b'"');
}

/// `null` for what is not there.
impl Index<&str> for Value {
    type Output = Self;

    #[inline(never)]
    fn index(&self, key: &str) -> &Self {
        self.get(key).unwrap_or(&NULL)
    }
}

/// `null` for what is not there.
impl Index<usize> for Value {
    type Output = Self;

    #[inline(never)]
    fn index(&self, index: usize) -> &Self {
        self.as_array().and_then(|values| values.get(index)).unwrap_or(&NULL)
    }
}

/// A member that is not there is made; what is no object becomes one.
impl IndexMut<&str> for Value {
    #[inline(never)]
    fn index_mut(&mut self, key: &str) -> &mut Self {
        if !self.is_object() {
            *self = Self::Object(Members::default());
        }
        match self {
            Self::Object(members) => members.entry(key),
            _ => unreachable!("it was made an object"),
        }
    }
}

/// # Panics
/// For an element that is not there.
impl IndexMut<usize> for Value {
    #[inline(never)]
    fn index_mut(&mut self, index: usize) -> &mut Self {
        match self {
            Self::Array(values) => &mut values[index],
            _ => unreachable!("the caller knows an array"),
        }
    }
}

impl From<usize> for Value {
    fn from(value: usize) -> Self {
        Self::Whole(value as u64)
    }
}

impl From<i64> for Value {
    fn from(value: i64) -> Self {
        match u64::try_from(value) {
            Ok(value) => Self::Whole(value),
            Err(_) => Self::Number(itoa::Buffer::new().format(value).into()),
        }
    }
}

/// The constants of glTF.
impl From<u32> for Value {
    fn from(value: u32) -> Self {
        Self::Whole(value.into())
    }
}

/// Those without a name.
impl From<i32> for Value {
    fn from(value: i32) -> Self {
        i64::from(value).into()
    }
}

/// The fewest digits that are this number; `null` for what JSON cannot say.
impl From<f32> for Value {
    #[inline(never)]
    fn from(value: f32) -> Self {
        if value.is_finite() { Self::Number(zmij::Buffer::new().format_finite(value).into()) } else { Self::Null }
    }
}

/// As of `f32`.
impl From<f64> for Value {
    #[inline(never)]
    fn from(value: f64) -> Self {
        if value.is_finite() { Self::Number(zmij::Buffer::new().format_finite(value).into()) } else { Self::Null }
    }
}

impl From<&str> for Value {
    fn from(value: &str) -> Self {
        Self::String(value.into())
    }
}

impl<T: Into<Self>> From<Vec<T>> for Value {
    fn from(values: Vec<T>) -> Self {
        Self::Array(values.into_iter().map(Into::into).collect())
    }
}

/// The members of an object in the order of the file, each key once. An object without any takes no memory: a file may
/// have millions.
#[derive(Debug, Clone, Default)]
pub(crate) struct Members(Option<Box<List>>);

#[derive(Debug, Clone, Default)]
struct List {
    members: Vec<(Box<str>, Value)>,
    /// The numbers of the members by their keys; empty up to [`FEW`] of them, which are sooner found one by one.
    by_key: Vec<u32>,
}

/// Members that need no index.
const FEW: usize = 16;

impl Members {
    /// Of members with the same key the last counts, in the place of the first.
    pub(super) fn of(mut list: Vec<(Box<str>, Value)>) -> Self {
        if list.len() <= FEW {
            // A later one with the same key is rare, and then moved.
            let mut at = 1;
            while at < list.len() {
                match list[..at].iter().position(|(key, _)| *key == list[at].0) {
                    Some(first) => list[first].1 = list.remove(at).1,
                    None => at += 1,
                }
            }
            return Self((!list.is_empty()).then(|| Box::new(List { members: list, by_key: Vec::new() })));
        }
        let mut order: Vec<u32> = (0..list.len() as u32).collect();
        order.sort_by(|&a, &b| list[a as usize].0.cmp(&list[b as usize].0).then(a.cmp(&b)));
        let chunks = order.chunk_by(|&a, &b| list[a as usize].0 == list[b as usize].0);
        let repeated: Vec<&[u32]> = chunks.filter(|same| same.len() > 1).collect();
        let mut goes = vec![false; list.len()];
        for same in repeated {
            let (first, last) = (same[0] as usize, same[same.len() - 1] as usize);
            list[first].1 = std::mem::take(&mut list[last].1);
            same[1..].iter().for_each(|&later| goes[later as usize] = true);
        }
        let mut goes = goes.iter();
        list.retain(|_| !goes.next().copied().unwrap_or(false));
        let mut out = Box::new(List { members: list, by_key: Vec::new() });
        out.sort();
        Self(Some(out))
    }

    fn list(&self) -> &[(Box<str>, Value)] {
        self.0.as_ref().map_or(&[], |list| &list.members)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list().is_empty()
    }

    pub(crate) fn get(&self, key: &str) -> Option<&Value> {
        let list = self.0.as_ref()?;
        list.find(key).ok().map(|at| &list.members[at].1)
    }

    pub(crate) fn get_mut(&mut self, key: &str) -> Option<&mut Value> {
        let list = self.0.as_mut()?;
        list.find(key).ok().map(|at| &mut list.members[at].1)
    }

    /// The member under `key`, made `null` if it was not there.
    fn entry(&mut self, key: &str) -> &mut Value {
        self.0.get_or_insert_default().entry(key)
    }

    /// Takes a member out; the order of the others stays.
    pub(crate) fn remove(&mut self, key: &str) -> Option<Value> {
        self.0.as_mut()?.remove(key)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.list().iter().map(|(key, value)| (&**key, value))
    }
}

impl PartialEq for Members {
    fn eq(&self, other: &Self) -> bool {
        self.list() == other.list()
    }
}

impl List {
    fn sort(&mut self) {
        self.by_key.clear();
        if self.members.len() > FEW {
            self.by_key.extend(0..self.members.len() as u32);
            let members = &self.members;
            self.by_key.sort_by(|&a, &b| members[a as usize].0.cmp(&members[b as usize].0));
        }
    }

    /// Where the key is; or, for one that is not there, its place in the index.
    #[inline(never)]
    fn find(&self, key: &str) -> Result<usize, usize> {
        if self.members.len() > FEW {
            let place = self.by_key.binary_search_by(|&at| (*self.members[at as usize].0).cmp(key))?;
            return Ok(self.by_key[place] as usize);
        }
        self.members.iter().position(|(name, _)| **name == *key).ok_or(0)
    }

    fn entry(&mut self, key: &str) -> &mut Value {
        let at = match self.find(key) {
            Ok(at) => at,
            Err(place) => {
                let at = self.members.len();
                self.members.push((key.into(), Value::Null));
                match at {
                    ..FEW => {}
                    FEW => self.sort(),
                    _ => self.by_key.insert(place, at as u32),
                }
                at
            }
        };
        &mut self.members[at].1
    }

    fn remove(&mut self, key: &str) -> Option<Value> {
        let at = self.find(key).ok()?;
        let (_, value) = self.members.remove(at);
        self.sort();
        Some(value)
    }
}

impl<'a> FromIterator<(&'a str, Value)> for Members {
    fn from_iter<I: IntoIterator<Item = (&'a str, Value)>>(members: I) -> Self {
        Self::of(members.into_iter().map(|(key, value)| (key.into(), value)).collect())
    }
}

#[cfg(test)]
#[path = "json_tree/tests.rs"]
mod tests;
