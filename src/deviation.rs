//! The measured two-sided distance between two surfaces, by sampling.
//!
//! This is Metro's method (Cignoni, Rocchini & Scopigno 1998): either surface is sampled, and each
//! sample's distance from the nearest point of the other one is found. A simplifier's own error is
//! an estimate; this is what a ruler would say. [`DeviationMeter`] works in bounded steps.
//!
//! Mean and root mean square are over area, so samples on faces, at equal steps of area, make them
//! up. The maximum also looks at every vertex and along the edges, where it likes to sit, and then
//! climbs from the farthest samples to where the distance is largest ([`farthest`]). It is never above
//! the Hausdorff distance.
//!
//! Each part is measured against the same part of the other mesh, in its own space; distances and
//! areas are then put together in world units ([`Part::scale`](crate::mesh::Part)). Triangles
//! without an area are not part of a surface.

mod attributes;
mod bvh;
mod farthest;
mod map;
mod sampling;
mod surface;
mod triangle;

pub use attributes::{AttributeDeviation, AttributeDeviations};

use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;
use crate::simplify::Progress;
use attributes::Comparison;
use farthest::{Candidate, Farthest, climb};
use map::DistanceMap;
use sampling::{Sample, SampleKind, Sampler, Spacing};
use surface::Surface;
use triangle::Point;

/// How to measure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviationOptions {
    /// Samples on the faces of each side, at least 1; default 400,000. Mean and rms are then exact
    /// to a small part of a per cent, and the maximum where no spot is smaller than their distance.
    pub sample_count: usize,
    /// Whether [`Deviation::vertex_distances`] is wanted; default false.
    pub vertex_distances: bool,
    /// Whether [`Deviation::simplified_distances`] and [`Deviation::simplified_surroundings`] are wanted; default false.
    pub simplified_map: bool,
}

impl Default for DeviationOptions {
    fn default() -> Self {
        Self { sample_count: 400_000, vertex_distances: false, simplified_map: false }
    }
}

/// Distances of one surface's samples from the other surface, world units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SideDeviation {
    /// The largest distance.
    pub max: f64,
    /// The average over the area.
    pub mean: f64,
    /// The root mean square over the area.
    pub rms: f64,
    /// How many places were measured at: on faces, edges and vertices, and from the farthest of them on.
    pub samples: u64,
}

/// The measured distance between two meshes, world units.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Deviation {
    /// The larger of the two sides' maxima.
    pub max: f64,
    /// The average of the two sides' means.
    pub mean: f64,
    /// The root of the average of the two sides' mean squares.
    pub rms: f64,
    /// Length of the original's bounding box diagonal, for relative figures; see [`Mesh::diagonal`].
    pub diagonal: f64,
    /// Samples on the original, distances from the simplified surface: what was lost.
    pub original_to_simplified: SideDeviation,
    /// Samples on the simplified surface, distances from the original: what was made up.
    pub simplified_to_original: SideDeviation,
    /// How far attributes are apart at the same samples.
    pub attributes: AttributeDeviations,
    /// For each wedge of the original its distance from the simplified surface, 0 for wedges
    /// without a triangle; empty unless it was asked for.
    pub vertex_distances: Vec<f32>,
    /// For each wedge of the simplified mesh its distance from the original; 0 for wedges without a triangle. Empty
    /// unless a map was asked for.
    pub simplified_distances: Vec<f32>,
    /// For each wedge of the simplified mesh the largest distance that was measured, either way, nearer to its vertex
    /// than to others; so also what is lost next to a vertex that is in its place. Empty likewise.
    pub simplified_surroundings: Vec<f32>,
}

/// Measures to the end. See [`DeviationMeter`] for doing it in bounded steps.
///
/// # Errors
/// Those of [`DeviationMeter::new`].
pub fn measure(original: &Mesh, simplified: &Mesh, options: &DeviationOptions) -> Result<Deviation, Error> {
    Ok(DeviationMeter::new(original, simplified, options)?.finish())
}

/// One measurement, advanced by [`DeviationMeter::step`]. It keeps its own copy of both surfaces.
///
/// The result does not depend on the size of the steps, and has the same bits on every machine.
#[derive(Debug)]
pub struct DeviationMeter {
    sample_count: usize,
    diagonal: f64,
    /// World units in a local unit of each part.
    scales: Vec<f64>,
    /// The original's surfaces and the simplified ones, by part.
    sides: [Vec<Surface>; 2],
    wedge_counts: [usize; 2],
    sums: [Sums; 2],
    vertex_distances: Vec<f32>,
    map: Option<DistanceMap>,
    comparison: Option<Comparison>,
    stage: Stage,
    work_done: f64,
    work_in_all: f64,
}

#[derive(Debug)]
enum Stage {
    Build { side: usize, part: usize },
    Walk(Box<Walk>),
    Climb(Climbs),
    Done,
}

/// Where the samples of one side have got to.
#[derive(Debug)]
struct Walk {
    side: usize,
    part: usize,
    sampler: Sampler,
    /// The last answer, near which the next one is.
    hint: u32,
    farthest: Farthest,
}

/// Climbs from the farthest samples of one side that are still to do, the farthest last.
#[derive(Debug)]
struct Climbs {
    side: usize,
    candidates: Vec<Candidate>,
    /// World units.
    step: f64,
}

/// What a side adds up to.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    max: f64,
    distance: f64,
    squared: f64,
    face_samples: u64,
    samples: u64,
    /// Squared world units.
    area: f64,
    /// Of parts that the other side has nothing of: their area, and that times their distance.
    lost_area: f64,
    lost_distance: f64,
    lost_squared: f64,
}

/// A query is the unit of work; building a tree handles this many triangles in the same time.
const TRIANGLES_PER_QUERY: usize = 24;

/// Queries that look at more nodes than this, far from the other surface, are worth several.
const NODES_PER_QUERY: usize = 32;

/// What is nearer than this, times the largest coordinate, is the rounding of a sample's position.
const NOTHING: f64 = 1.0 / (1_u64 << 48) as f64;

impl DeviationMeter {
    /// Takes both surfaces in; measures nothing yet. `simplified` has the same parts as `original`,
    /// as a [`LevelMesh`](crate::lod::LevelMesh) has. Either may be empty.
    ///
    /// # Errors
    /// Those of [`Mesh::validate`] for either mesh; `invalid-argument` with the place
    /// `sample_count` or `parts`.
    pub fn new(original: &Mesh, simplified: &Mesh, options: &DeviationOptions) -> Result<Self, Error> {
        original.validate()?;
        simplified.validate()?;
        let invalid = |place: &str, message: &str| Err(Error::new(ErrorCode::InvalidArgument, place, message));
        if options.sample_count == 0 {
            return invalid("sample_count", "must be at least 1");
        }
        if original.parts != simplified.parts {
            return invalid("parts", "both meshes must have the same parts");
        }
        let sides = [original, simplified].map(Surface::of_parts);
        let triangle_count: usize = sides.iter().flatten().map(Surface::triangle_count).sum();
        // Splitting goes through all triangles once for each bit of their number.
        let passes = f64::from(triangle_count.max(2).ilog2()) + 3.0;
        let build_work = triangle_count as f64 * passes / TRIANGLES_PER_QUERY as f64;
        let walk_work = 2.0 * options.sample_count as f64 + triangle_count as f64;
        Ok(Self {
            sample_count: options.sample_count,
            diagonal: original.diagonal(),
            scales: original.parts.iter().map(|part| f64::from(part.scale)).collect(),
            sides,
            wedge_counts: [original.positions.len(), simplified.positions.len()],
            sums: [Sums::default(); 2],
            vertex_distances: if options.vertex_distances { vec![0.0; original.positions.len()] } else { Vec::new() },
            comparison: Comparison::new(original, simplified),
            map: options.simplified_map.then(|| DistanceMap::new(simplified)),
            stage: Stage::Build { side: 0, part: 0 },
            work_done: 0.0,
            work_in_all: build_work + walk_work,
        })
    }

    /// Does about `work` queries' worth, at least one thing. A call after the end does nothing.
    ///
    /// The longest step that cannot be divided is the first split of a part's tree, a pass over all
    /// of the part's triangles.
    pub fn step(&mut self, work: usize) -> Progress {
        let mut left = work.max(1);
        while left > 0 {
            let used = match &mut self.stage {
                Stage::Build { .. } => self.build(),
                Stage::Walk(_) => self.walk(left),
                Stage::Climb(_) => self.climb(),
                Stage::Done => return Progress { fraction: 1.0, done: true },
            };
            left = left.saturating_sub(used.max(1));
        }
        if matches!(self.stage, Stage::Done) {
            return Progress { fraction: 1.0, done: true };
        }
        Progress { fraction: ((self.work_done / self.work_in_all) as f32).clamp(0.0, 0.999), done: false }
    }

    /// Does what is left to do, and gives the result.
    #[must_use]
    pub fn finish(mut self) -> Deviation {
        while !self.step(usize::MAX).done {}
        let [lost, made_up] = self.sums.map(Sums::result);
        // A side without a surface has nothing to say.
        let both = self.sums.iter().all(Sums::any);
        let share = if both { 0.5 } else { 1.0 };
        let (simplified_distances, simplified_surroundings) = self.map.map(DistanceMap::finish).unwrap_or_default();
        Deviation {
            max: lost.max.max(made_up.max),
            mean: share * (lost.mean + made_up.mean),
            rms: (share * (lost.rms * lost.rms + made_up.rms * made_up.rms)).sqrt(),
            diagonal: self.diagonal,
            original_to_simplified: lost,
            simplified_to_original: made_up,
            attributes: self.comparison.map(Comparison::finish).unwrap_or_default(),
            vertex_distances: self.vertex_distances,
            simplified_distances,
            simplified_surroundings,
        }
    }

    /// One step of a tree; returns the queries that it is worth.
    fn build(&mut self) -> usize {
        let Stage::Build { side, part } = self.stage else { return 0 };
        if part == self.scales.len() {
            self.stage = if side == 0 { Stage::Build { side: 1, part: 0 } } else { self.walk_on(0) };
            return 0;
        }
        let other = self.sides[1 - side][part].reach();
        let triangles = self.sides[side][part].build_step(other);
        if triangles == 0 {
            self.stage = Stage::Build { side, part: part + 1 };
        }
        self.work_done += triangles as f64 / TRIANGLES_PER_QUERY as f64;
        triangles / TRIANGLES_PER_QUERY
    }

    /// The walk over `side`, from its start.
    fn walk_on(&mut self, side: usize) -> Stage {
        let mut sums = Sums::default();
        for (part, &scale) in self.scales.iter().enumerate() {
            let (mine, other) = (&self.sides[side][part], &self.sides[1 - side][part]);
            if other.is_empty() {
                sums.lose(mine, scale);
            } else {
                sums.area = mine.add_area(sums.area, scale);
            }
        }
        if side == 0 && !self.vertex_distances.is_empty() {
            self.mark_lost();
        }
        let area = sums.area / self.sample_count as f64;
        self.sums[side] = sums;
        Stage::Walk(Box::new(Walk {
            side,
            part: 0,
            sampler: Sampler::new(Spacing { area, length: area.sqrt() }, self.wedge_counts[side]),
            hint: 0,
            farthest: Farthest::default(),
        }))
    }

    /// Takes samples for up to `most` queries' worth; returns how many that was.
    fn walk(&mut self, most: usize) -> usize {
        let Stage::Walk(walk) = &mut self.stage else { return 0 };
        let side = walk.side;
        if walk.part == self.scales.len() {
            let candidates = std::mem::take(&mut walk.farthest).finish(self.sums[side].max);
            self.stage = Stage::Climb(Climbs { side, candidates, step: walk.sampler.spacing() });
            return 0;
        }
        let (mine, other) = (&self.sides[side][walk.part], &self.sides[1 - side][walk.part]);
        let scale = self.scales[walk.part];
        let sums = &mut self.sums[side];
        let (before, triangle_before) = (*sums, walk.sampler.triangle());
        let mut used = 0;
        let mut ended = mine.is_empty() || other.is_empty();
        if !ended {
            let nothing = (f64::from(mine.reach().max(other.reach())) * NOTHING).powi(2);
            while used < most {
                let Some(Sample { point, kind }) = walk.sampler.next(mine.walkway(scale)) else {
                    ended = true;
                    break;
                };
                let nearest = other.bvh().nearest(point, walk.hint);
                walk.hint = nearest.triangle;
                used += 1 + nearest.nodes as usize / NODES_PER_QUERY;
                let squared = if nearest.distance_squared > nothing { nearest.distance_squared } else { 0.0 };
                let distance = squared.sqrt() * scale;
                sums.add(distance, kind);
                let triangle = walk.sampler.triangle();
                if let Some(comparison) = &mut self.comparison {
                    let (way, opposite) = (mine.walkway(scale), other.walkway(scale));
                    let at = nearest.triangle as usize;
                    let here = (&way.corners[triangle], &way.wedges[triangle]);
                    let there = (&opposite.corners[at], &opposite.wedges[at]);
                    comparison.add(side, point, here, there, kind == SampleKind::Face);
                }
                walk.farthest.offer(
                    Candidate {
                        distance,
                        part: walk.part,
                        triangle: triangle as u32,
                        nearest: nearest.triangle,
                        point,
                    },
                    sums.max,
                );
                if let Some(map) = &mut self.map {
                    mark(map, side, point, distance, (mine, triangle), (other, nearest.triangle as usize));
                    if let (1, SampleKind::Vertex(wedge)) = (side, kind) {
                        map.put(wedge, distance);
                    }
                }
                if let (0, SampleKind::Vertex(wedge)) = (side, kind)
                    && let Some(entry) = self.vertex_distances.get_mut(wedge as usize)
                {
                    *entry = distance as f32;
                }
            }
        }
        // Half of the triangles bring a new vertex, and some samples on their edges.
        let triangles = walk.sampler.triangle() - triangle_before;
        self.work_done += triangles as f64 + (sums.face_samples - before.face_samples) as f64;
        if ended {
            walk.part += 1;
            walk.hint = 0;
            walk.sampler.enter_part();
        }
        used
    }

    /// Climbs from one candidate; returns the queries that it took.
    fn climb(&mut self) -> usize {
        let Stage::Climb(climbs) = &mut self.stage else { return 0 };
        let side = climbs.side;
        let Some(candidate) = climbs.candidates.pop() else {
            self.stage = if side == 0 { self.walk_on(1) } else { Stage::Done };
            return 0;
        };
        let Candidate { part, triangle, .. } = candidate;
        let (mine, other) = (&self.sides[side][part], &self.sides[1 - side][part]);
        let (scale, sums) = (self.scales[part], &mut self.sums[side]);
        let corners = &mine.walkway(scale).corners[triangle as usize];
        let peak = climb(&candidate, corners, other.bvh(), climbs.step / scale, sums.max / scale);
        let distance = peak.nearest.distance_squared.sqrt() * scale;
        sums.samples += u64::from(peak.places);
        sums.max = sums.max.max(distance);
        if let Some(map) = &mut self.map {
            mark(map, side, peak.point, distance, (mine, triangle as usize), (other, peak.nearest.triangle as usize));
        }
        peak.places as usize + peak.nodes as usize / NODES_PER_QUERY
    }

    /// Gives the original's vertices of parts that are gone the distance that [`Sums::lose`] does.
    fn mark_lost(&mut self) {
        for (part, &scale) in self.scales.iter().enumerate() {
            let (mine, other) = (&self.sides[0][part], &self.sides[1][part]);
            if other.is_empty() {
                let distance = (mine.diagonal() * scale) as f32;
                for &wedge in mine.walkway(scale).wedges.iter().flatten() {
                    self.vertex_distances[wedge as usize] = distance;
                }
            }
        }
    }
}

/// Marks a distance measured from `side` on the map, at one of two triangles that are each other's nearest: either way it
/// is that of the simplified surface.
fn mark(
    map: &mut DistanceMap,
    side: usize,
    point: Point,
    distance: f64,
    from: (&Surface, usize),
    to: (&Surface, usize),
) {
    let (surface, triangle) = if side == 0 { to } else { from };
    let way = surface.walkway(1.0);
    map.mark(point, &way.corners[triangle], &way.wedges[triangle], distance);
}

impl Sums {
    fn add(&mut self, distance: f64, kind: SampleKind) {
        self.samples += 1;
        self.max = if distance > self.max { distance } else { self.max };
        if kind == SampleKind::Face {
            self.face_samples += 1;
            self.distance += distance;
            self.squared += distance * distance;
        }
    }

    /// A part of which nothing is left on the other side is as far from it as anything in the
    /// part's box could be: the box's diagonal.
    fn lose(&mut self, surface: &Surface, scale: f64) {
        let (area, distance) = (surface.add_area(0.0, scale), surface.diagonal() * scale);
        self.max = self.max.max(distance);
        self.lost_area += area;
        self.lost_distance += area * distance;
        self.lost_squared += area * distance * distance;
    }

    fn any(&self) -> bool {
        self.area + self.lost_area > 0.0
    }

    fn result(self) -> SideDeviation {
        let mut result = SideDeviation { max: self.max, mean: 0.0, rms: 0.0, samples: self.samples };
        if self.any() {
            let sample_area = self.area / self.face_samples.max(1) as f64;
            let area = self.area + self.lost_area;
            result.mean = (self.distance * sample_area + self.lost_distance) / area;
            result.rms = ((self.squared * sample_area + self.lost_squared) / area).sqrt();
        }
        result
    }
}
