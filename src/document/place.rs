//! Where an instance stands: positions by its matrix, normals by the inverse transpose.

/// A placement; the identity leaves every bit alone.
#[derive(Debug)]
pub(super) enum Placement {
    /// In place.
    Identity,
    /// `position' = linear · position + translation`, `normal' = cofactor · normal`, rows first.
    Affine { linear: [[f64; 3]; 3], translation: [f64; 3], cofactor: [[f64; 3]; 3], is_mirrored: bool },
}

impl Placement {
    /// From a column-major 4×4 matrix, whose last row is taken to be 0 0 0 1.
    pub(super) fn new(m: &[f64; 16]) -> Self {
        let linear = [[m[0], m[4], m[8]], [m[1], m[5], m[9]], [m[2], m[6], m[10]]];
        let translation = [m[12], m[13], m[14]];
        if linear == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] && translation == [0.0; 3] {
            return Self::Identity;
        }
        // Cofactors are the inverse transpose times the determinant: the same direction up to
        // sign, and they exist for flattening matrices too.
        let mut cofactor = [0, 1, 2].map(|i| cross(linear[(i + 1) % 3], linear[(i + 2) % 3]));
        let determinant = (0..3).map(|k| linear[0][k] * cofactor[0][k]).sum::<f64>();
        let is_mirrored = determinant < 0.0;
        if is_mirrored {
            cofactor = cofactor.map(|row| row.map(|c| -c));
        }
        Self::Affine { linear, translation, cofactor, is_mirrored }
    }

    /// Whether triangles change their orientation, so that their winding must be reversed.
    pub(super) fn is_mirrored(&self) -> bool {
        matches!(self, Self::Affine { is_mirrored: true, .. })
    }

    /// In the world; `None` if it leaves the range of `f32`.
    pub(super) fn position(&self, p: [f32; 3]) -> Option<[f32; 3]> {
        let Self::Affine { linear, translation, .. } = self else { return Some(p) };
        let moved = apply(linear, p);
        let world = [0, 1, 2].map(|k| to_f32(moved[k] + translation[k]));
        world.iter().all(|c| c.is_finite()).then_some(world)
    }

    /// In the world, of unit length; as it was where it has no direction.
    pub(super) fn normal(&self, n: [f32; 3]) -> [f32; 3] {
        let Self::Affine { cofactor, .. } = self else { return n };
        let turned = apply(cofactor, n);
        let length = turned.iter().map(|c| c * c).sum::<f64>().sqrt();
        // Adding 0 takes the sign off a zero.
        if length > 0.0 && length.is_finite() { turned.map(|c| to_f32(c / length + 0.0)) } else { n }
    }
}

fn apply(matrix: &[[f64; 3]; 3], v: [f32; 3]) -> [f64; 3] {
    let v = v.map(f64::from);
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[allow(clippy::cast_possible_truncation)] // rounding is what is wanted
fn to_f32(value: f64) -> f32 {
    value as f32
}
