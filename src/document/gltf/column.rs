//! A column of the output: the elements of one accessor, and how each is stored.

use crate::document::json_tree::Value;

use super::layout::{Component, Layout};

/// Weights nearer to 1 than this are as near as single precision gets.
const ROUNDED_WEIGHTS: f64 = 1e-7;

/// What will be written for one accessor.
#[derive(Debug)]
pub(super) struct Column<'m> {
    /// Index in the output's `accessors`.
    pub(super) accessor: usize,
    pub(super) layout: Layout,
    pub(super) content: Content<'m>,
    /// The wedge set it belongs to; `None` for indices.
    pub(super) set: Option<usize>,
    /// The buffer view that becomes free for it, and its offset there.
    pub(super) old_place: Option<(usize, usize)>,
    /// Whether `min` and `max` are written.
    pub(super) bounds: bool,
    /// Whether the numbers of an element are skin weights, which add up to 1.
    pub(super) weights: bool,
    /// Whether only the elements that are not zero were stored, and may be again.
    pub(super) sparse: bool,
}

/// What the description of sparse storage takes in the JSON, in bytes, about.
const SPARSE_TEXT: usize = 160;

/// `componentType` of the numbers of sparse elements, of which `last` is the largest, and the bytes of one.
pub(super) fn sparse_index(last: u32) -> (u32, usize) {
    match last {
        0..=0xff => (5121, 1),
        0x100..=0xffff => (5123, 2),
        _ => (5125, 4),
    }
}

/// The numbers themselves, where they lie in the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Content<'m> {
    Positions(&'m [[f32; 3]]),
    /// As many numbers per element as the layout has components.
    Values(&'m [f32]),
    /// Wedge indices, and the wedge that becomes vertex 0.
    Triangles(&'m [[u32; 3]], u32),
}

impl Column<'_> {
    pub(super) fn count(&self) -> usize {
        match self.content {
            Content::Positions(positions) => positions.len(),
            Content::Values(values) => values.len() / self.layout.components(),
            Content::Triangles(triangles, _) => triangles.len() * 3,
        }
    }

    /// Whether every number is zero: an accessor can say that without data.
    pub(super) fn is_zero(&self) -> bool {
        let is_zero = |value: &f32| *value == 0.0;
        match self.content {
            Content::Positions(positions) => positions.iter().flatten().all(is_zero),
            Content::Values(values) => values.iter().all(is_zero),
            Content::Triangles(..) => false,
        }
    }

    /// The elements that are not zero, if they alone, with their numbers, take fewer bytes than all.
    pub(super) fn sparse_elements(&self) -> Option<Vec<u32>> {
        if !self.sparse {
            return None;
        }
        let components = self.layout.components();
        let is_zero = |element: usize| (0..components).all(|c| self.layout.to_stored(self.number(element, c)) == 0.0);
        let elements: Vec<u32> = (0..self.count()).filter(|&e| !is_zero(e)).map(|e| e as u32).collect();
        let (_, index_size) = sparse_index(*elements.last()?);
        let size = self.layout.byte_size();
        (elements.len() * (size + index_size) + SPARSE_TEXT < self.count() * size).then_some(elements)
    }

    fn number(&self, element: usize, component: usize) -> f64 {
        match self.content {
            Content::Positions(positions) => f64::from(positions[element][component]),
            Content::Values(values) => f64::from(values[element * self.layout.components() + component]),
            Content::Triangles(triangles, first) => f64::from(triangles[element / 3][element % 3] - first),
        }
    }

    /// Writes `elements` into `out`, `stride` apart from `offset` on, and gives the bounds of
    /// each component as stored.
    pub(super) fn store(
        &self,
        elements: &mut dyn Iterator<Item = usize>,
        out: &mut [u8],
        offset: usize,
        stride: usize,
    ) -> Vec<(f64, f64)> {
        let components = self.layout.components();
        let mut bounds = vec![(f64::INFINITY, f64::NEG_INFINITY); components];
        let mut stored = vec![0.0; components];
        for (row, element) in elements.enumerate() {
            for (c, stored) in stored.iter_mut().enumerate() {
                *stored = self.layout.to_stored(self.number(element, c));
            }
            if self.weights {
                self.layout.complete_weights(&mut stored);
            }
            let start = offset + row * stride;
            for (c, (&stored, bounds)) in stored.iter().zip(&mut bounds).enumerate() {
                self.layout.encode(stored, &mut out[start + self.layout.offset(c)..]);
                *bounds = (bounds.0.min(stored), bounds.1.max(stored));
            }
        }
        bounds
    }
}

impl Layout {
    /// Smallest and largest value that can be stored; `None` for floats.
    fn range(self) -> Option<(f64, f64)> {
        match self.component {
            // -128 and -127 both mean -1, and only one of them has a counterpart.
            Component::I8 => Some((if self.normalized { -127.0 } else { -128.0 }, 127.0)),
            Component::I16 => Some((if self.normalized { -32767.0 } else { -32768.0 }, 32767.0)),
            Component::U8 => Some((0.0, f64::from(u8::MAX))),
            Component::U16 => Some((0.0, f64::from(u16::MAX))),
            Component::U32 => Some((0.0, f64::from(u32::MAX))),
            Component::F32 => None,
        }
    }

    /// The number that stands for `value` in the file: itself, or the nearest on the integer grid.
    fn to_stored(self, value: f64) -> f64 {
        match self.range() {
            Some((low, high)) => {
                let scaled = if self.normalized { value * high } else { value };
                scaled.round().clamp(low, high)
            }
            None => value,
        }
    }

    /// Weights add up to 1 by the specification, but not in every file, nor after rounding to
    /// integers. Renderers scale them at load, so scaling them here changes no picture; the rounding
    /// is put right at the largest.
    fn complete_weights(self, stored: &mut [f64]) {
        let sum: f64 = stored.iter().sum();
        match self.range() {
            None if sum > ROUNDED_WEIGHTS && (sum - 1.0).abs() > ROUNDED_WEIGHTS => {
                stored.iter_mut().for_each(|weight| *weight /= sum);
            }
            Some((_, high)) if self.normalized && (sum - high).abs() <= stored.len() as f64 => {
                if let Some(largest) = stored.iter_mut().max_by(|a, b| a.total_cmp(b)) {
                    *largest += high - sum;
                }
            }
            _ => {}
        }
    }

    fn encode(self, stored: f64, out: &mut [u8]) {
        match self.component {
            Component::I8 => put(out, (stored as i8).to_le_bytes()),
            Component::U8 => put(out, (stored as u8).to_le_bytes()),
            Component::I16 => put(out, (stored as i16).to_le_bytes()),
            Component::U16 => put(out, (stored as u16).to_le_bytes()),
            Component::U32 => put(out, (stored as u32).to_le_bytes()),
            Component::F32 => put(out, (stored as f32).to_le_bytes()),
        }
    }
}

fn put<const N: usize>(out: &mut [u8], bytes: [u8; N]) {
    out[..N].copy_from_slice(&bytes);
}

/// `min` and `max` for an accessor: whole numbers for integers, the exact f32 otherwise.
pub(super) fn bounds_to_json(layout: Layout, bounds: &[(f64, f64)]) -> (Value, Value) {
    let number = |value: f64| {
        if layout.component == Component::F32 { Value::from(value) } else { Value::from(value as i64) }
    };
    let list = |pick: fn(&(f64, f64)) -> f64| bounds.iter().map(|pair| number(pick(pair))).collect::<Vec<_>>().into();
    (list(|pair| pair.0), list(|pair| pair.1))
}
