//! How the numbers of one accessor element are stored.

use crate::document::json_tree::Value;

use super::json::{index, text};

/// The type of each number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// By the number that stands for it in the file.
    pub(super) fn of(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// In bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// How many numbers, and in how many columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Scalar,
    Vec2,
    Vec3,
    Vec4,
    Mat2,
    Mat3,
    Mat4,
}

impl Shape {
    /// By its name in the file.
    pub(super) fn of(name: &str) -> Option<Self> {
        Some(match name {
            "SCALAR" => Self::Scalar,
            "VEC2" => Self::Vec2,
            "VEC3" => Self::Vec3,
            "VEC4" => Self::Vec4,
            "MAT2" => Self::Mat2,
            "MAT3" => Self::Mat3,
            "MAT4" => Self::Mat4,
            _ => return None,
        })
    }

    /// Columns and rows.
    fn grid(self) -> (usize, usize) {
        match self {
            Self::Scalar => (1, 1),
            Self::Vec2 => (1, 2),
            Self::Vec3 => (1, 3),
            Self::Vec4 => (1, 4),
            Self::Mat2 => (2, 2),
            Self::Mat3 => (3, 3),
            Self::Mat4 => (4, 4),
        }
    }
}

/// The form of an accessor's elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) component: Component,
    pub(super) shape: Shape,
    pub(super) normalized: bool,
}

impl Layout {
    /// What an accessor of the output states; one that says nothing is floating-point scalars.
    pub(super) fn of(accessor: &Value) -> Self {
        let component = index(&accessor["componentType"]).and_then(|code| Component::of(code as u64));
        Self {
            component: component.unwrap_or(Component::F32),
            shape: text(accessor, "type").and_then(Shape::of).unwrap_or(Shape::Scalar),
            normalized: accessor["normalized"].as_bool().unwrap_or(false),
        }
    }

    /// Numbers per element, 1 to 16.
    pub(super) fn components(self) -> usize {
        let (columns, rows) = self.shape.grid();
        columns * rows
    }

    /// Bytes of one element, without padding after it.
    pub(super) fn byte_size(self) -> usize {
        let (columns, rows) = self.shape.grid();
        (columns - 1) * self.column_stride() + rows * self.component.size()
    }

    /// Bytes from the start of the element to one of its numbers: matrix columns start at
    /// multiples of four.
    pub(super) fn offset(self, component: usize) -> usize {
        let (_, rows) = self.shape.grid();
        component / rows * self.column_stride() + component % rows * self.component.size()
    }

    fn column_stride(self) -> usize {
        (self.shape.grid().1 * self.component.size()).next_multiple_of(4)
    }

    /// The number stored at the start of `bytes`; normalised integers as their fraction.
    pub(super) fn decode(self, bytes: &[u8]) -> f32 {
        let fraction = |value: f32, largest: f32| {
            if self.normalized { (value / largest).max(-1.0) } else { value }
        };
        match (self.component, bytes) {
            (Component::I8, &[a, ..]) => fraction(f32::from(a as i8), 127.0),
            (Component::U8, &[a, ..]) => fraction(f32::from(a), 255.0),
            (Component::I16, &[a, b, ..]) => fraction(f32::from(i16::from_le_bytes([a, b])), 32767.0),
            (Component::U16, &[a, b, ..]) => fraction(f32::from(u16::from_le_bytes([a, b])), 65535.0),
            (Component::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]) as f32,
            (Component::F32, &[a, b, c, d, ..]) => f32::from_le_bytes([a, b, c, d]),
            // Unreachable: the range of every element was checked when the accessor was opened.
            _ => 0.0,
        }
    }
}
