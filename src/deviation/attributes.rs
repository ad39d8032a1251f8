//! How far attributes are apart: at a sample, and at the place of the other surface that is nearest to it.
//!
//! Values are interpolated as they are drawn, linearly over the triangle. Where the nearest place is on the other side of a
//! seam, the difference is that between the two charts: the maximum of texture coordinates says little on a model with
//! seams, mean and rms say more the fewer there are.

use super::triangle::{Point, closest_weights};
use crate::mesh::Mesh;

/// The kinds of attributes that are compared, with the names that files and arrays have for them.
const KINDS: [(&str, &str); 3] = [("NORMAL", "normal"), ("TEXCOORD_0", "uv"), ("COLOR_0", "color")];

/// A difference over both surfaces.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AttributeDeviation {
    /// The largest at any sample.
    pub max: f64,
    /// The average over the area: that of the two sides' averages.
    pub mean: f64,
    /// The root mean square over the area likewise.
    pub rms: f64,
}

/// Differences of the attributes that both meshes have; nothing for others.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AttributeDeviations {
    /// Angle between normals, degrees.
    pub normal: Option<AttributeDeviation>,
    /// Distance of the first texture coordinates, in their own units: 1 is the width of the texture.
    pub texture: Option<AttributeDeviation>,
    /// Distance of the first colours, all components, 1 being the whole range of one.
    pub color: Option<AttributeDeviation>,
}

/// Values by wedge of each kind, up to four numbers; the first is NaN where a wedge has none.
#[derive(Debug, Default)]
pub(super) struct Values([Vec<[f32; 4]>; 3]);

impl Values {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let of_kind = |(file, array): (&str, &str)| {
            let mut values = Vec::new();
            for set in &mesh.wedge_sets {
                for attribute in set.attributes.iter().filter(|a| a.name == file || a.name == array) {
                    values.resize(mesh.positions.len(), [f32::NAN; 4]);
                    let wedges = values[set.wedges.clone()].iter_mut();
                    for (value, numbers) in wedges.zip(attribute.values.chunks_exact(attribute.components)) {
                        *value = [0, 1, 2, 3].map(|k| numbers.get(k).copied().unwrap_or(0.0));
                    }
                }
            }
            values
        };
        Self(KINDS.map(of_kind))
    }

    /// Interpolated in a triangle of these wedges; `None` where they have none.
    fn at(&self, kind: usize, wedges: &[u32; 3], weights: [f64; 3]) -> Option<[f64; 4]> {
        let mut sum = [0.0; 4];
        for (&wedge, weight) in wedges.iter().zip(weights) {
            let value = self.0[kind].get(wedge as usize).filter(|value| !value[0].is_nan())?;
            (0..4).for_each(|k| sum[k] += weight * f64::from(value[k]));
        }
        Some(sum)
    }
}

/// A triangle with its wedges.
pub(super) type Face<'a> = (&'a [[f32; 3]; 3], &'a [u32; 3]);

/// What one side adds up to.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    max: f64,
    sum: f64,
    squared: f64,
    count: u64,
}

/// The comparison while samples are taken.
#[derive(Debug)]
pub(super) struct Comparison {
    values: [Values; 2],
    sums: [[Sums; 3]; 2],
}

impl Comparison {
    /// Of the original and the simplified mesh; `None` if there is no attribute that both have.
    pub(super) fn new(original: &Mesh, simplified: &Mesh) -> Option<Self> {
        let values = [original, simplified].map(Values::new);
        let any = (0..KINDS.len()).any(|kind| values.iter().all(|values| !values.0[kind].is_empty()));
        any.then(|| Self { values, sums: Default::default() })
    }

    /// Compares at `point`, which is on triangle `mine` of `side` and nearest to `other` of the other side. On faces it
    /// counts for the mean.
    pub(super) fn add(&mut self, side: usize, point: Point, mine: Face<'_>, other: Face<'_>, on_face: bool) {
        let (here, there) = (closest_weights(point, mine.0), closest_weights(point, other.0));
        for kind in 0..KINDS.len() {
            let a = self.values[side].at(kind, mine.1, here);
            let (Some(a), Some(b)) = (a, self.values[1 - side].at(kind, other.1, there)) else { continue };
            let difference = if kind == 0 { angle(a, b) } else { length([0, 1, 2, 3].map(|k| a[k] - b[k])) };
            let sums = &mut self.sums[side][kind];
            sums.max = if difference > sums.max { difference } else { sums.max };
            if on_face {
                sums.sum += difference;
                sums.squared += difference * difference;
                sums.count += 1;
            }
        }
    }

    pub(super) fn finish(self) -> AttributeDeviations {
        let [normal, texture, color] = [0, 1, 2].map(|kind| {
            let sides = self.sums.map(|side| side[kind]);
            let counted: Vec<&Sums> = sides.iter().filter(|side| side.count > 0).collect();
            let share = 1.0 / counted.len() as f64;
            (!counted.is_empty()).then(|| AttributeDeviation {
                max: sides[0].max.max(sides[1].max),
                mean: counted.iter().map(|side| share * side.sum / side.count as f64).sum(),
                rms: counted.iter().map(|side| share * side.squared / side.count as f64).sum::<f64>().sqrt(),
            })
        });
        AttributeDeviations { normal, texture, color }
    }
}

fn length(v: [f64; 4]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// Degrees between two directions; 0 if one of them has none.
///
/// By halving the angle and a series: no platform's arc cosine, whose last bits are its own.
fn angle(a: [f64; 4], b: [f64; 4]) -> f64 {
    const HALVINGS: i32 = 6;
    let lengths = (length(a), length(b));
    if !(lengths.0 > 0.0 && lengths.1 > 0.0) {
        return 0.0;
    }
    // The chord of the angle on the unit circle, at most 2.
    let mut chord = length([0, 1, 2, 3].map(|k| a[k] / lengths.0 - b[k] / lengths.1)).min(2.0);
    for _ in 0..HALVINGS {
        chord /= (2.0 + (4.0 - chord * chord).max(0.0).sqrt()).sqrt();
    }
    let squared = chord * chord;
    let radians = chord * (1.0 + squared * (1.0 / 24.0 + squared * (3.0 / 640.0 + squared * 5.0 / 7168.0)));
    (radians * f64::from(1 << HALVINGS)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_arc_cosine() {
        for degrees in [0.0_f64, 1e-6, 0.1, 1.0, 30.0, 45.0, 90.0, 120.0, 179.9, 180.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let got = angle([0.0, 0.0, 2.0, 0.0], [0.5 * sine, 0.0, 0.5 * cosine, 0.0]);
            assert!((got - degrees).abs() < 1e-6, "{degrees}: {got}");
        }
        assert_eq!(angle([0.0; 4], [1.0, 0.0, 0.0, 0.0]), 0.0);
    }
}
