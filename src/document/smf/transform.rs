//! The matrices of `trans`, `scale`, `rot`, `mmult` and `mload`: each acts before those above it.

use crate::document::place::Placement;

/// From a block's vertices to the world; columns of a 4×4 matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform([f64; 16]);

impl Transform {
    /// Leaves everything in place.
    pub(super) const IDENTITY: Self = Self(crate::document::faces::IDENTITY);

    /// From 16 numbers, row by row.
    pub(super) fn from_rows(rows: [f64; 16]) -> Self {
        Self(std::array::from_fn(|at| rows[at % 4 * 4 + at / 4]))
    }

    pub(super) fn translation([x, y, z]: [f64; 3]) -> Self {
        let mut matrix = Self::IDENTITY;
        matrix.0[12..15].copy_from_slice(&[x, y, z]);
        matrix
    }

    pub(super) fn scaling(factors: [f64; 3]) -> Self {
        let mut matrix = Self::IDENTITY;
        (0..3).for_each(|axis| matrix.0[5 * axis] = factors[axis]);
        matrix
    }

    /// About axis 0, 1 or 2, counter-clockwise seen from its end.
    pub(super) fn rotation(axis: usize, degrees: f64) -> Self {
        let (sine, cosine) = sine_and_cosine(degrees);
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut matrix = Self::IDENTITY;
        matrix.0[5 * j] = cosine;
        matrix.0[5 * k] = cosine;
        matrix.0[4 * j + k] = sine;
        matrix.0[4 * k + j] = -sine;
        matrix
    }

    /// First `inner`, then `self`.
    pub(super) fn then_inner(&self, inner: &Self) -> Self {
        let product =
            |row: usize, column: usize| -> f64 { (0..4).map(|k| self.0[4 * k + row] * inner.0[4 * column + k]).sum() };
        Self(std::array::from_fn(|at| product(at % 4, at / 4)))
    }

    /// How points and normals move.
    pub(super) fn placement(&self) -> Placement {
        Placement::new(&self.0)
    }

    /// Whether the last row is not 0 0 0 1, so that points would have to be divided by w.
    pub(super) fn is_projective(&self) -> bool {
        [3, 7, 11, 15].map(|at| self.0[at]) != [0.0, 0.0, 0.0, 1.0]
    }
}

/// By their series in a sixteenth of a turn about 0, and doubling: no platform's `sin` gives the
/// same bits on every other. Exact at multiples of 90°.
fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    // Within an eighth of a turn.
    let x = (degrees - quarters * 90.0) * (std::f64::consts::PI / 180.0);
    let square = x * x;
    let series = |first: f64, start: f64| {
        let mut term = first;
        let mut sum = first;
        let mut n = start;
        for _ in 0..10 {
            term *= -square / (n * (n + 1.0));
            sum += term;
            n += 2.0;
        }
        sum
    };
    let (sine, cosine) = (series(x, 2.0), series(1.0, 1.0));
    match quarters.rem_euclid(4.0) {
        1.0 => (cosine, -sine),
        2.0 => (-sine, -cosine),
        3.0 => (-cosine, sine),
        _ => (sine, cosine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles() {
        for degrees in -800..=800 {
            let (sine, cosine) = sine_and_cosine(f64::from(degrees) / 2.0);
            let (expected_sine, expected_cosine) = (f64::from(degrees) / 2.0).to_radians().sin_cos();
            assert!((sine - expected_sine).abs() < 1e-13 && (cosine - expected_cosine).abs() < 1e-13, "{degrees}");
        }
        assert_eq!(sine_and_cosine(90.0), (1.0, 0.0));
    }

    #[test]
    fn the_last_statement_acts_first() {
        let moved = Transform::translation([1.0, 0.0, 0.0]).then_inner(&Transform::scaling([2.0; 3]));
        assert_eq!(moved.placement().position([1.0, 1.0, 1.0]), Some([3.0, 2.0, 2.0]));
        let turned = Transform::rotation(2, 90.0);
        assert_eq!(turned.placement().position([1.0, 0.0, 0.0]), Some([0.0, 1.0, 0.0]));
    }
}
