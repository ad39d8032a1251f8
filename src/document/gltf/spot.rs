//! A value of the JSON tree together with its path, so that every check can say where it failed.
//!
//! `inline(never)` throughout: reading the JSON's fields takes no time that counts, and its code is
//! downloaded by everybody.

use crate::document::json_tree::Value;

use super::json::{index, member};
use crate::error::{Error, ErrorCode};

/// A value and the way to it. The way is a list on the stack: it costs nothing until it is printed.
#[derive(Clone, Copy)]
pub(super) struct Spot<'v, 'p> {
    pub(super) value: &'v Value,
    step: Step<'p>,
    parent: Option<&'p Spot<'v, 'p>>,
}

#[derive(Clone, Copy)]
enum Step<'p> {
    Key(&'p str),
    Index(usize),
}

impl<'v, 'p> Spot<'v, 'p> {
    /// The whole tree.
    pub(super) fn root(value: &'v Value) -> Self {
        Self { value, step: Step::Key(""), parent: None }
    }

    /// `meshes[0].primitives[1].mode`
    #[inline(never)]
    pub(super) fn path(&self) -> String {
        let Some(parent) = self.parent else {
            return String::new();
        };
        let mut path = parent.path();
        match self.step {
            Step::Key(key) => {
                if !path.is_empty() {
                    path.push('.');
                }
                path.push_str(key);
            }
            Step::Index(index) => path.push_str(&format!("[{index}]")),
        }
        path
    }

    /// The error of this place; the message begins with its name.
    pub(super) fn fail<T>(&self, code: ErrorCode, reason: &str) -> Result<T, Error> {
        Err(self.error(code, reason))
    }

    #[inline(never)]
    fn error(&self, code: ErrorCode, reason: &str) -> Error {
        let path = self.path();
        let name = path.rsplit('.').next().unwrap_or_default();
        let message = format!("{name} {reason}");
        Error::new(code, path, message)
    }

    /// The member under `key`; absent and `null` are the same.
    #[inline(never)]
    pub(super) fn field<'c>(&'c self, key: &'c str) -> Option<Spot<'v, 'c>> {
        let value = member(self.value, key).filter(|value| !value.is_null())?;
        Some(Spot { value, step: Step::Key(key), parent: Some(self) })
    }

    /// The member under `key`, which has to be there.
    #[inline(never)]
    pub(super) fn required<'c>(&'c self, key: &'c str) -> Result<Spot<'v, 'c>, Error> {
        match self.field(key) {
            Some(field) => Ok(field),
            None => Spot { value: self.value, step: Step::Key(key), parent: Some(self) }
                .fail(ErrorCode::Syntax, "is missing"),
        }
    }

    /// An object.
    #[inline(never)]
    pub(super) fn check_object(&self) -> Result<(), Error> {
        if self.value.is_object() { Ok(()) } else { self.fail(ErrorCode::Syntax, "must be an object") }
    }

    /// What `read` makes of each element of an array.
    pub(super) fn elements<T>(&self, mut read: impl FnMut(&Spot<'v, '_>) -> Result<T, Error>) -> Result<Vec<T>, Error> {
        let Some(values) = self.value.as_array() else {
            return self.fail(ErrorCode::Syntax, "must be an array");
        };
        let spots =
            values.iter().enumerate().map(|(i, value)| Spot { value, step: Step::Index(i), parent: Some(self) });
        spots.map(|spot| read(&spot)).collect()
    }

    /// Calls `visit` with each member of an object.
    pub(super) fn members(&self, mut visit: impl FnMut(&Spot<'v, '_>) -> Result<(), Error>) -> Result<(), Error> {
        let Some(object) = self.value.as_object() else {
            return self.fail(ErrorCode::Syntax, "must be an object");
        };
        object.iter().try_for_each(|(key, value)| visit(&Spot { value, step: Step::Key(key), parent: Some(self) }))
    }

    /// Calls `visit` with the member under `key`; for `*` with each member or element.
    pub(super) fn children(&self, key: &str, visit: &mut dyn FnMut(&Spot<'v, '_>)) {
        let mut child = |value, step| visit(&Spot { value, step, parent: Some(self) });
        match (self.value, key) {
            (Value::Array(values), "*") => values.iter().enumerate().for_each(|(i, v)| child(v, Step::Index(i))),
            (Value::Object(object), "*") => object.iter().for_each(|(key, value)| child(value, Step::Key(key))),
            (value, _) => member(value, key).into_iter().for_each(|value| child(value, Step::Key(key))),
        }
    }

    /// A whole number of at least 0; JSON may write it with a decimal point.
    #[inline(never)]
    pub(super) fn whole(&self) -> Result<u64, Error> {
        if let Some(number) = self.value.as_u64() {
            return Ok(number);
        }
        match index(self.value) {
            Some(number) => Ok(number as u64),
            None if self.value.as_f64().is_some_and(|number| number >= LARGEST_EXACT) => {
                self.fail(ErrorCode::TooLarge, "is larger than memory")
            }
            None => self.fail(ErrorCode::Syntax, "must be a whole number of at least 0"),
        }
    }

    /// A whole number that memory can hold.
    #[inline(never)]
    pub(super) fn size(&self) -> Result<usize, Error> {
        match usize::try_from(self.whole()?) {
            Ok(size) => Ok(size),
            Err(_) => self.fail(ErrorCode::TooLarge, "is larger than memory"),
        }
    }

    /// The number of one of `count` elements of the array `list`.
    #[inline(never)]
    pub(super) fn index_of(&self, list: &str, count: usize) -> Result<usize, Error> {
        let index = self.whole()?;
        match usize::try_from(index) {
            Ok(index) if index < count => Ok(index),
            _ => self.fail(ErrorCode::OutOfRange, &format!("is {index}, but there are {count} {list}")),
        }
    }

    /// An array of exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], Error> {
        let mut out = [0.0; N];
        let values = self.value.as_array().filter(|values| values.len() == N);
        let are_numbers = values.is_some_and(|values| {
            let mut slots = out.iter_mut().zip(values);
            slots.all(|(slot, value)| value.as_f64().map(|number| *slot = number).is_some())
        });
        if are_numbers { Ok(out) } else { self.fail(ErrorCode::Syntax, &format!("must be {N} numbers")) }
    }
}

/// 2^53: from here on not every integer is an `f64`.
const LARGEST_EXACT: f64 = 9_007_199_254_740_992.0;
