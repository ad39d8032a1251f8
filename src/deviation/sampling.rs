//! Where a surface is sampled: a fixed sequence over its vertices, its edges and its faces.
//!
//! Faces carry the mean: samples at equal steps of area along the surface, its triangles taken in
//! their spatial order and each triangle along a curve. The curve is Basu & Owen's triangular
//! van der Corput sequence (2015) read forwards: the base-4 digits of the share of the triangle's
//! area that has been passed say which of the four similar sub-triangles, and so on down. Equal
//! shares get equal areas, and one sample is near the next, which makes the next query short.
//! Within its step each sample is moved by a golden-ratio sequence, or the steps would beat with
//! the triangles of a regular mesh.
//!
//! Vertices and edges have no area; they count for the maximum only, which likes to sit on them.

use super::triangle::{Point, length, point_at, wide};

/// A place to measure at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    /// Local space of the part.
    pub(super) point: Point,
    pub(super) kind: SampleKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SampleKind {
    /// At this wedge.
    Vertex(u32),
    Edge,
    /// Stands for one step of area.
    Face,
}

/// How densely a side is sampled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spacing {
    /// Area between two samples on faces, squared world units; > 0, may be infinite.
    pub(super) area: f64,
    /// Distance of two samples on an edge, world units: a square of this side has that area.
    pub(super) length: f64,
}

/// Walks through the triangles of one side, part by part, and gives the samples in order.
#[derive(Debug)]
pub(super) struct Sampler {
    spacing: Spacing,
    /// One bit a wedge: it was sampled.
    seen: Vec<u64>,
    /// Samples on faces so far, and the area that was passed before this triangle.
    face_samples: u64,
    area_before: f64,
    /// In the current part.
    triangle: usize,
    stage: Stage,
}

/// What comes next in a triangle.
#[derive(Debug, Clone, Copy)]
enum Stage {
    Vertex(usize),
    Edge { edge: usize, next: u32, count: u32, step: u32 },
    Face,
}

/// A surface to walk on: triangles in spatial order.
#[derive(Debug, Clone, Copy)]
pub(super) struct Walkway<'a> {
    pub(super) corners: &'a [[[f32; 3]; 3]],
    pub(super) wedges: &'a [[u32; 3]],
    /// Local units of area.
    pub(super) areas: &'a [f64],
    /// World units in a local one.
    pub(super) scale: f64,
}

impl Sampler {
    pub(super) fn new(spacing: Spacing, wedge_count: usize) -> Self {
        Self {
            spacing,
            seen: vec![0; wedge_count.div_ceil(64)],
            face_samples: 0,
            area_before: 0.0,
            triangle: 0,
            stage: Stage::Vertex(0),
        }
    }

    /// Distance of two samples, world units.
    pub(super) fn spacing(&self) -> f64 {
        self.spacing.length
    }

    /// Goes to the first triangle of another part.
    pub(super) fn enter_part(&mut self) {
        self.triangle = 0;
        self.stage = Stage::Vertex(0);
    }

    /// Triangles of the current part that are done.
    pub(super) fn triangle(&self) -> usize {
        self.triangle
    }

    /// The next sample on this part, or `None` at its end.
    pub(super) fn next(&mut self, way: Walkway<'_>) -> Option<Sample> {
        while let Some(corners) = way.corners.get(self.triangle) {
            let sample = match self.stage {
                Stage::Vertex(k) => self.at_vertex(k, corners, way),
                Stage::Edge { edge, next, count, step } => self.on_edge(edge, next, count, step, corners, way.scale),
                Stage::Face => self.on_face(corners, way),
            };
            if sample.is_some() {
                return sample;
            }
        }
        None
    }

    fn at_vertex(&mut self, k: usize, corners: &[[f32; 3]; 3], way: Walkway<'_>) -> Option<Sample> {
        let wedge = way.wedges[self.triangle][k];
        self.stage = if k < 2 { Stage::Vertex(k + 1) } else { self.edge(0, corners, way.scale) };
        let (word, bit) = (wedge as usize / 64, 1_u64 << (wedge % 64));
        if self.seen[word] & bit != 0 {
            return None;
        }
        self.seen[word] |= bit;
        Some(Sample { point: wide(corners[k]), kind: SampleKind::Vertex(wedge) })
    }

    /// An edge between two triangles is met twice, in opposite directions: each takes every second
    /// point, so that together they take all, and a border edge has half of them.
    fn edge(&self, edge: usize, corners: &[[f32; 3]; 3], scale: f64) -> Stage {
        let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
        // More than 2²⁰ on one edge would only be a long way to the next step.
        let count = (length(a, b) * scale / self.spacing.length).min(f64::from(1 << 20)) as u32;
        Stage::Edge { edge, next: if a < b { 1 } else { 2 }, count, step: 2 }
    }

    fn on_edge(
        &mut self,
        edge: usize,
        next: u32,
        count: u32,
        step: u32,
        corners: &[[f32; 3]; 3],
        scale: f64,
    ) -> Option<Sample> {
        if next > count {
            self.stage = if edge < 2 { self.edge(edge + 1, corners, scale) } else { Stage::Face };
            return None;
        }
        self.stage = Stage::Edge { edge, next: next + step, count, step };
        let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
        // Counted from the smaller end, whichever the direction.
        let (from, to) = if a < b { (wide(a), wide(b)) } else { (wide(b), wide(a)) };
        let t = f64::from(next) / f64::from(count + 1);
        Some(Sample { point: [0, 1, 2].map(|k| from[k] + (to[k] - from[k]) * t), kind: SampleKind::Edge })
    }

    fn on_face(&mut self, corners: &[[f32; 3]; 3], way: Walkway<'_>) -> Option<Sample> {
        let area = way.areas[self.triangle] * way.scale * way.scale;
        let place = (self.face_samples as f64 + golden_fraction(self.face_samples)) * self.spacing.area;
        if place >= self.area_before + area {
            self.area_before += area;
            self.triangle += 1;
            self.stage = Stage::Vertex(0);
            return None;
        }
        self.face_samples += 1;
        let share = ((place - self.area_before) / area).max(0.0);
        Some(Sample { point: point_at(corners, weights_at(share)), kind: SampleKind::Face })
    }
}

/// The fractional part of i / φ, φ the golden ratio.
#[inline(always)]
fn golden_fraction(i: u64) -> f64 {
    // 2⁶⁴ / φ; of the product's low 64 bits the upper 53 are what an f64 holds.
    (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Sub-triangles down to a 4096th of the side: far below what a mean can notice.
const DIGITS: u32 = 12;

/// The barycentric coordinates of the point that divides a triangle's area at `share`, 0 to 1.
#[inline(always)]
fn weights_at(share: f64) -> [f64; 3] {
    let digits = ((share * f64::from(1_u32 << (2 * DIGITS))) as u32).min((1 << (2 * DIGITS)) - 1);
    // From the centroid half the way to the corner of the digit's sub-triangle, and again in that
    // one at half the size. The sub-triangle in the middle has the same centroid, upside down.
    let mut toward = [0.0_f64; 4];
    let mut half = 0.5_f64;
    for level in (0..DIGITS).rev() {
        let digit = (digits >> (2 * level)) as usize & 3;
        // The middle one lies between the first two corners' and the last's.
        if digit == 2 {
            half = -half;
        } else {
            toward[digit] += half;
        }
        half *= 0.5;
    }
    let base = (1.0 - toward[0] - toward[1] - toward[3]) / 3.0;
    [toward[0] + base, toward[1] + base, toward[3] + base]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[[f32; 3]; 3]; 2] =
        [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]];

    fn samples(count: usize, scale: f64) -> Vec<Sample> {
        let way = Walkway { corners: &SQUARE, wedges: &[[0, 1, 2], [0, 2, 3]], areas: &[0.5, 0.5], scale };
        let area = scale * scale / count as f64;
        let mut sampler = Sampler::new(Spacing { area, length: area.sqrt() }, 4);
        std::iter::from_fn(|| sampler.next(way)).collect()
    }

    #[test]
    fn equal_areas_get_equal_numbers_of_samples() {
        for scale in [1.0, 3.0] {
            let points: Vec<Point> = samples(10_000, scale)
                .into_iter()
                .filter(|sample| sample.kind == SampleKind::Face)
                .map(|sample| sample.point)
                .collect();
            assert_eq!(points.len(), 10_000);
            let mut cells = [0; 25];
            for [x, y, z] in points {
                assert!((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y) && z == 0.0);
                cells[(x * 5.0) as usize + 5 * (y * 5.0) as usize] += 1;
            }
            assert!(cells.iter().all(|n| (385..=415).contains(n)), "{cells:?}");
        }
    }

    #[test]
    fn every_vertex_is_taken_once_and_every_edge_at_its_spacing() {
        let samples = samples(10_000, 1.0);
        let vertices: Vec<u32> = samples
            .iter()
            .filter_map(|sample| match sample.kind {
                SampleKind::Vertex(wedge) => Some(wedge),
                _ => None,
            })
            .collect();
        assert_eq!(vertices, [0, 1, 2, 3]);
        let edges: Vec<Point> =
            samples.iter().filter(|s| s.kind == SampleKind::Edge).map(|sample| sample.point).collect();
        let on_diagonal = edges.iter().filter(|p| p[0] == p[1]).count();
        assert_eq!(on_diagonal, 141, "both triangles together take all");
        let on_bottom = edges.iter().filter(|p| p[1] == 0.0).count();
        assert_eq!(on_bottom, 50, "a border edge has one triangle");
    }

    #[test]
    fn one_sample_is_near_the_next() {
        let points: Vec<Point> =
            samples(10_000, 1.0).iter().filter(|s| s.kind == SampleKind::Face).map(|s| s.point).collect();
        let step = |w: &[Point]| ((w[1][0] - w[0][0]).powi(2) + (w[1][1] - w[0][1]).powi(2)).sqrt();
        let mean = points.windows(2).map(step).sum::<f64>() / points.len() as f64;
        assert!(mean < 0.03, "{mean}: at random it would be a third");
    }

    #[test]
    fn the_curve_fills_the_triangle_evenly() {
        let n = 4_u32.pow(6);
        let mut sum = [0.0; 3];
        for i in 0..n {
            let weights = weights_at((f64::from(i) + 0.5) / f64::from(n));
            assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{weights:?}");
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            (0..3).for_each(|k| sum[k] += weights[k] / f64::from(n));
        }
        assert!(sum.iter().all(|s| (s - 1.0 / 3.0).abs() < 1e-3), "{sum:?}");
        assert!(weights_at(0.0).iter().chain(&weights_at(1.0)).all(|w| (0.0..=1.0).contains(w)));
    }
}
