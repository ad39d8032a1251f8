//! The fit of a finished level to the original surface: the vertices that are left move so that the
//! original's vertices are as near to the level as they can be.
//!
//! This is the inner loop of Hoppe, DeRose, Duchamp, McDonald & Stuetzle (1993) with the distances
//! measured along the normal, as in registration (Chen & Medioni 1992). Every original vertex finds
//! the nearest point of the level, in the triangles around the vertex it was merged into or a few
//! steps from there, with barycentric coordinates β and distance d along the direction n. Each
//! vertex then solves Σ β n nᵀ δ = Σ β d n. With weights β and not β² all vertices may move at once:
//! the sum majorises the true one (the square of a mean is at most the mean of the squares), so that
//! no step makes the sum of squares larger.

use super::lanes::{Lanes, Lanes3};
use super::legality;
use super::prepare::{Around, NEAR};
use super::quadric::{Quadric, Vec3, larger};
use super::topology::{Corner, Form, Topology};
use super::vertex_kind::VertexKind;
use super::{Simplifier, Tuning};
use crate::mesh::Mesh;
use crate::mesh::weld::NO_VERTEX;

/// How often an original vertex may change to a neighbour's triangles while it looks for the
/// nearest.
const HOPS: usize = 8;

/// A sample this many times as far, squared, as the mean counts half: it belongs to a part that is
/// gone, which no vertex nearby can bring back.
const OUTLIER: f32 = 9.0;

/// Every how many of the original's triangles is a sample at least: at a tenth of the triangles all of them double the
/// time of the fit for half a per cent of error.
const LEAST_STRIDE: usize = 2;

/// Every how many samples the mean distance is taken from.
const SCALE_STRIDE: usize = 16;

/// Least squared cosine between a triangle's normals before and after a move.
const TURN: f32 = 0.64;

/// Longest move of a round, squared, in the scale of the outliers.
const STEP: f32 = 0.11;

/// Longest ring that is searched: each of its many samples would search all of it.
const MAX_RING: usize = 64;

/// Stiffness of a vertex that is held, in engine units.
const HELD: f32 = 1e20;

/// Share of the trace that is added to the diagonal.
const REGULARISATION: f32 = 0.02;

/// A point of the original surface.
#[derive(Debug, Clone, Copy)]
struct Sample {
    position: Vec3,
    /// Area vector: twice the area that the sample stands for.
    normal: Vec3,
    /// The vertex that one of its triangle's corners was merged into.
    owner: u32,
}

/// The nearest point of a triangle: squared distance, barycentric coordinates, offset to it.
#[derive(Debug, Clone, Copy)]
struct Nearest {
    squared: f32,
    weights: [f32; 3],
    /// From the nearest point to the sample.
    offset: Vec3,
}

/// A fit under way, in bounded steps.
#[derive(Debug)]
pub(super) struct Fit {
    rounds: usize,
    /// Every how many of the original's triangles is a sample.
    stride: usize,
    phase: Phase,
    /// By sample its [`Sample::owner`], and [`NO_VERTEX`] for a triangle without an area. The rest is computed anew each
    /// time: it would take seven times the room.
    owners: Vec<u32>,
    /// Vertex of each wedge that names one.
    vertex_of_wedge: Vec<u32>,
    /// The living vertex where each was; while samples are taken.
    merged_into: Vec<u32>,
    /// Squared distance at which a sample pulls half as much.
    scale_squared: f32,
    /// Squared distance at which a sample holds the vertices of its triangle where they are.
    hold_squared: f32,
    /// The same in mean squared distances.
    hold: f32,
}

#[derive(Debug, Clone, Copy)]
enum Phase {
    Sample(usize),
    Scale,
    Clear(usize),
    Pull(usize),
    Move(usize),
}

impl Fit {
    /// How much of it is done, 0 to 1.
    pub(super) fn fraction(&self, rounds: usize) -> f32 {
        let left = match self.phase {
            Phase::Sample(_) => rounds + 1,
            _ => self.rounds,
        };
        1.0 - left as f32 / (rounds + 1) as f32
    }
}

impl Simplifier {
    /// A fit of the tuning's rounds to at most its number of samples for each triangle that is left.
    pub(super) fn begin_fit(&mut self, mesh: &Mesh, tuning: Tuning) -> Fit {
        let merged_into = self.topology.settle(&mut self.patch.builder);
        let mut vertex_of_wedge = vec![NO_VERTEX; mesh.positions.len()];
        for (&wedge, v) in self.wedge_of_vertex.iter().zip(0..) {
            vertex_of_wedge[wedge as usize] = v;
        }
        let wanted = self.topology.live_triangle_count.saturating_mul(tuning.fit_samples).max(1);
        let stride = mesh.triangles.len().div_ceil(wanted).max(LEAST_STRIDE);
        let owners = Vec::with_capacity(mesh.triangles.len().div_ceil(stride));
        Fit {
            rounds: tuning.fit_rounds,
            stride,
            phase: Phase::Sample(0),
            owners,
            vertex_of_wedge,
            merged_into,
            scale_squared: f32::MAX,
            hold_squared: f32::MAX,
            hold: tuning.fit_hold,
        }
    }

    /// Does about `work` units of the fit; true when it is done.
    pub(super) fn step_fit(&mut self, mesh: &Mesh, fit: &mut Fit, work: usize) -> bool {
        let part = |first: usize, count: usize| first..count.min(first.saturating_add(work.max(1)));
        let vertices = self.topology.vertices.len();
        match fit.phase {
            Phase::Sample(first) => {
                let count = mesh.triangles.len().div_ceil(fit.stride);
                let range = part(first, count);
                fit.phase = if range.end == count { Phase::Scale } else { Phase::Sample(range.end) };
                for i in range {
                    let sample = self.sample(mesh, fit, i, 0);
                    let vertex = sample.and_then(|(vertex, _)| fit.merged_into.get(vertex as usize));
                    fit.owners.push(vertex.copied().unwrap_or(NO_VERTEX));
                }
            }
            Phase::Scale => {
                fit.merged_into = Vec::new();
                fit.scale_squared = self.scale_squared(mesh, fit);
                fit.hold_squared = fit.scale_squared / OUTLIER * fit.hold;
                fit.phase = Phase::Clear(0);
            }
            Phase::Clear(first) => {
                let range = part(first, vertices);
                fit.phase = if range.end == vertices { Phase::Pull(0) } else { Phase::Clear(range.end) };
                for v in range {
                    self.topology.vertices[v].packed.set_quadric(&Quadric::default());
                }
            }
            Phase::Pull(first) => {
                let range = part(first, fit.owners.len());
                fit.phase = if range.end == fit.owners.len() { Phase::Move(0) } else { Phase::Pull(range.end) };
                for i in range {
                    let owner = fit.owners[i];
                    if owner != NO_VERTEX
                        && let Some((_, sample)) = self.sample(mesh, fit, i, owner)
                    {
                        fit.owners[i] = pull(&mut self.topology, &sample, fit.scale_squared, fit.hold_squared);
                    }
                }
            }
            Phase::Move(first) => {
                let range = part(first, vertices);
                if range.end == vertices {
                    fit.rounds -= 1;
                    fit.phase = Phase::Clear(0);
                } else {
                    fit.phase = Phase::Move(range.end);
                }
                for v in range {
                    let vertex = &self.topology.vertices[v];
                    let lives = vertex.form() == Form::Closed && vertex.ring_length() > 0;
                    if lives && vertex.kind == VertexKind::Manifold {
                        move_to_fit(&mut self.topology, v as u32, fit.scale_squared);
                    }
                }
                return fit.rounds == 0;
            }
        }
        false
    }

    /// Several times the mean squared distance, from some of the samples.
    fn scale_squared(&self, mesh: &Mesh, fit: &Fit) -> f32 {
        let (mut sum, mut areas) = (0.0_f64, 0.0_f64);
        for (i, &owner) in fit.owners.iter().enumerate().step_by(SCALE_STRIDE).filter(|(_, owner)| **owner != NO_VERTEX)
        {
            let Some((_, sample)) = self.sample(mesh, fit, i, owner) else { continue };
            if let Some((_, nearest)) = nearest_to(&self.topology, &sample) {
                let area = f64::from(sample.normal.length_squared().sqrt());
                sum += area * f64::from(nearest.squared);
                areas += area;
            }
        }
        let mean = if areas > 0.0 { sum / areas } else { 0.0 };
        (mean as f32 * OUTLIER).max(f32::MIN_POSITIVE)
    }

    /// The centroid of the original triangle of sample `i`, with the vertex of its first corner; none if it was degenerate.
    #[inline(always)]
    fn sample(&self, mesh: &Mesh, fit: &Fit, i: usize, owner: u32) -> Option<(u32, Sample)> {
        let triangle = mesh.triangles[i * fit.stride];
        let named = self.vertex_of_wedge[triangle[0] as usize];
        let vertex = *fit.vertex_of_wedge.get(named as usize)?;
        let space = self.spaces[usize::from(*self.part_of_vertex.get(vertex as usize)?)];
        let [a, b, c] = triangle.map(|w| space.to_engine(mesh.positions[w as usize]));
        let normal = (b - a).cross(c - a);
        let position = (a + b + c) * (1.0 / 3.0);
        (normal.length_squared() > 0.0).then_some((vertex, Sample { position, normal, owner }))
    }
}

fn move_to_fit(topology: &mut Topology, v: u32, scale_squared: f32) {
    let vertex = &topology.vertices[v as usize];
    let mut step = solve(&vertex.quadric());
    let reach = scale_squared * STEP;
    let length_squared = step.length_squared();
    if length_squared > reach {
        step = step * (reach / length_squared).sqrt();
    }
    let old = vertex.position();
    for share in [1.0, 0.5, 0.25] {
        let new = old + step * share;
        if stays_upright(topology, v, old, new) {
            let vertex = &mut topology.vertices[v as usize];
            vertex.packed.set_position(new);
            vertex.moved = true;
            return;
        }
    }
}

/// (M + λ tr(M) I)⁻¹ r, with M and r in the places of a quadric and its g.
fn solve(q: &Quadric) -> Vec3 {
    let r = q.trace() * REGULARISATION;
    if r.is_nan() || r <= 0.0 {
        return Vec3::ZERO;
    }
    let d1 = q.xx + r;
    let (l21, l31) = (q.xy / d1, q.xz / d1);
    let d2 = q.yy + r - l21 * q.xy;
    let m32 = q.yz - l31 * q.xy;
    let l32 = m32 / d2;
    let d3 = q.zz + r - l31 * q.xz - l32 * m32;
    let y = q.g.y - l21 * q.g.x;
    let z = (q.g.z - l31 * q.g.x - l32 * y) / d3;
    let y = y / d2 - l32 * z;
    Vec3 { x: q.g.x / d1 - l21 * y - l31 * z, y, z }
}

fn stays_upright(topology: &Topology, v: u32, old: Vec3, new: Vec3) -> bool {
    let ring = topology.ring(v);
    (0..ring.len()).all(|i| {
        let (a, b) = (ring[i], ring[if i + 1 == ring.len() { 0 } else { i + 1 }]);
        let (a, b) = (topology.vertices[a as usize].position(), topology.vertices[b as usize].position());
        let (before, after) = ((a - old).cross(b - old), (a - new).cross(b - new));
        let longest = larger(larger((a - new).length_squared(), (b - new).length_squared()), (b - a).length_squared());
        let cosine = before.dot(after);
        let turned = cosine <= 0.0 || cosine * cosine < TURN * before.length_squared() * after.length_squared();
        !turned && legality::keep_upright(Lanes3::splat(before), Lanes3::splat(after), Lanes::splat(longest)).all()
    })
}

/// Finds the nearest triangle to `sample` from `owner` on, and adds the pull of the sample to its
/// vertices. Returns the vertex whose triangle it is.
fn pull(topology: &mut Topology, sample: &Sample, scale_squared: f32, hold_squared: f32) -> u32 {
    let Some((corner, nearest)) = nearest_to(topology, sample) else { return sample.owner };
    let distance = nearest.squared.sqrt();
    let outlier = nearest.squared / scale_squared;
    let weight = sample.normal.length_squared().sqrt() / (1.0 + outlier * outlier);
    let own = topology.vertices[corner.wedge as usize].position();
    let direction = if distance > 1e-9 {
        nearest.offset * (1.0 / distance)
    } else {
        let n = topology.area_vector(own, corner.next, corner.previous);
        let length = n.length_squared().sqrt();
        if length > 0.0 { n * (1.0 / length) } else { Vec3::ZERO }
    };
    let mut plane = Quadric::of_triangle(direction);
    if nearest.squared > hold_squared {
        for diagonal in [&mut plane.xx, &mut plane.yy, &mut plane.zz] {
            *diagonal += HELD;
        }
    }
    for (v, share) in [corner.wedge, corner.next, corner.previous].into_iter().zip(nearest.weights) {
        let share = share * weight;
        let scaled = Quadric {
            xx: plane.xx * share,
            xy: plane.xy * share,
            xz: plane.xz * share,
            yy: plane.yy * share,
            yz: plane.yz * share,
            zz: plane.zz * share,
            g: direction * (distance * share),
        };
        topology.add(v, &scaled.packed());
    }
    corner.wedge
}

/// The nearest triangle to the sample, from its owner on; the corner's `wedge` is the triangle's first vertex.
fn nearest_to(topology: &Topology, sample: &Sample) -> Option<(Corner, Nearest)> {
    let mut owner = sample.owner;
    let mut best: Option<(Corner, Nearest)> = None;
    for _ in 0..HOPS {
        let (corner, nearest) = nearest_around(topology, owner, sample);
        if best.is_some_and(|(_, b)| b.squared <= nearest.squared) {
            break;
        }
        let [own, next, previous] = nearest.weights;
        best = Some((Corner { wedge: owner, ..corner }, nearest));
        if own > 0.0 {
            break;
        }
        owner = if next >= previous { corner.next } else { corner.previous };
        if topology.vertices[owner as usize].form() != Form::Closed {
            break;
        }
    }
    best.filter(|b| b.1.squared < f32::INFINITY)
}

/// The nearest of the triangles at `v` that face the way of the sample: those of the far side of a
/// thin part are not what it belongs to.
#[inline(always)]
fn nearest_around(topology: &Topology, v: u32, sample: &Sample) -> (Corner, Nearest) {
    let none = Nearest { squared: f32::INFINITY, weights: [1.0, 0.0, 0.0], offset: Vec3::ZERO };
    let mut best = (Corner { next: v, previous: v, wedge: v }, none);
    let ring = topology.ring(v);
    if topology.vertices[v as usize].form() != Form::Closed || ring.is_empty() || ring.len() > MAX_RING {
        return best;
    }
    let own = topology.vertices[v as usize].position();
    let triangle = |i: usize| {
        let (next, previous) = (ring[i], ring[if i + 1 == ring.len() { 0 } else { i + 1 }]);
        let (b, c) = (topology.vertices[next as usize].position(), topology.vertices[previous as usize].position());
        (Corner { next, previous, wedge: v }, b, c)
    };
    if ring.len() <= NEAR {
        let (index, squared) = Around::of(topology, own, ring).nearest_facing(sample.position - own, sample.normal);
        if squared < f32::INFINITY {
            let (corner, b, c) = triangle(index);
            best = (corner, nearest_on_triangle(sample.position, own, b, c));
        }
        return best;
    }
    for i in 0..ring.len() {
        let (corner, b, c) = triangle(i);
        if (b - own).cross(c - own).dot(sample.normal) > 0.0 {
            let nearest = nearest_on_triangle(sample.position, own, b, c);
            if nearest.squared < best.1.squared {
                best = (corner, nearest);
            }
        }
    }
    best
}

/// The nearest point of the triangle (a, b, c), by the regions of its vertices, edges and inside
/// (Ericson 2005, section 5.1.5).
fn nearest_on_triangle(p: Vec3, a: Vec3, b: Vec3, c: Vec3) -> Nearest {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let at = |v: f32, w: f32| {
        let offset = ap - ab * v - ac * w;
        Nearest { squared: offset.length_squared(), weights: [1.0 - v - w, v, w], offset }
    };
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return at(0.0, 0.0);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return at(1.0, 0.0);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return at(d1 / (d1 - d3), 0.0);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return at(0.0, 1.0);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return at(0.0, d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return Nearest { weights: [0.0, 1.0 - w, w], ..at(1.0 - w, w) };
    }
    let scale = 1.0 / (va + vb + vc);
    at(vb * scale, vc * scale)
}
