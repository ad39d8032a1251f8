//! What becomes of attributes when wedges merge: the values at a share between two wedges.

use super::segment::Source;
use crate::collapse_sequence::SolvedAttribute;
use crate::mesh::weld::NO_VERTEX;
use crate::mesh::{Attribute, Blend};

/// One merge that changes the values of `into`; see [`WedgeAttributes::blend`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Blending {
    pub(super) time: u32,
    pub(super) from: u32,
    pub(super) into: u32,
    pub(super) parameter: f32,
    /// Which of the sequence's solved values replace those that were blended.
    pub(super) solved: u32,
}

/// The merges of the segment that change values, and how far along the edge each is.
pub(super) fn blends(
    source: &Source<'_>,
    first: usize,
    length: usize,
    at_first: &[[f32; 3]],
    (vertex_names, wedge_names): (&[u32], &[u32]),
) -> Vec<Blending> {
    let number = |names: &[u32]| {
        let mut numbers = vec![NO_VERTEX; source.mesh.positions.len()];
        for (&name, number) in names.iter().zip(0..) {
            numbers[name as usize] = number;
        }
        move |name: u32| numbers.get(name as usize).filter(|&&n| n != NO_VERTEX).map(|&n| n as usize)
    };
    let (vertex, wedge) = (number(vertex_names), number(wedge_names));
    let sequence = source.sequence;
    let mut positions = at_first.to_vec();
    let mut blends = Vec::new();
    let collapses = sequence.collapses[first..first + length].iter();
    let mut solved = sequence.wedge_merges.count_before(first) as u32;
    for ((collapse, merges), time) in collapses.zip(sequence.merges_from(first)).zip(1..) {
        let mut parameter = 1.0;
        if let (Some(from), Some(into)) = (vertex(collapse.from), vertex(collapse.into)) {
            parameter = edge_parameter(positions[from], positions[into], collapse.position);
            positions[into] = collapse.position;
        }
        for (from, into) in merges {
            if (parameter < 1.0 || sequence.solved.components > 0)
                && let (Some(from), Some(into)) = (wedge(from), wedge(into))
            {
                blends.push(Blending { time, from: from as u32, into: into as u32, parameter, solved });
            }
            solved += 1;
        }
    }
    blends
}

/// Where `p` projects on the edge: 0 at `from`, 1 at `into`, clamped.
fn edge_parameter(from: [f32; 3], into: [f32; 3], p: [f32; 3]) -> f32 {
    let (mut dot, mut squared) = (0.0_f64, 0.0_f64);
    for k in 0..3 {
        let edge = f64::from(into[k]) - f64::from(from[k]);
        dot += (f64::from(p[k]) - f64::from(from[k])) * edge;
        squared += edge * edge;
    }
    if squared > 0.0 { (dot / squared).clamp(0.0, 1.0) as f32 } else { 1.0 }
}

/// The attributes of all sets while wedges merge.
pub(super) struct WedgeAttributes {
    /// First wedge of each set.
    starts: Vec<usize>,
    sets: Vec<Vec<Attribute>>,
}

impl WedgeAttributes {
    /// A copy of the attributes of each set, with its first wedge.
    pub(super) fn new<'a>(sets: impl Iterator<Item = (usize, &'a [Attribute])>) -> Self {
        let (starts, sets) = sets.map(|(start, attributes)| (start, attributes.to_vec())).unzip();
        Self { starts, sets }
    }

    /// Gives wedge `into` the values at `t` between `from` (0) and itself (1).
    pub(super) fn blend(&mut self, from: u32, into: u32, t: f32) {
        if t >= 1.0 {
            return;
        }
        let set = self.set_of(into);
        let (from, into) = (from as usize - self.starts[set], into as usize - self.starts[set]);
        let attributes = &mut self.sets[set];
        for i in 0..attributes.len() {
            let n = attributes[i].components;
            let (a, b) = (from * n, into * n);
            match attributes[i].blend {
                Blend::Linear => lerp(&mut attributes[i].values, a, b, n, t),
                Blend::Direction | Blend::Tangent => {
                    let directions = n.min(3);
                    let before: [f32; 3] =
                        std::array::from_fn(|k| if k < directions { attributes[i].values[b + k] } else { 0.0 });
                    lerp(&mut attributes[i].values, a, b, directions, t);
                    normalise(&mut attributes[i].values[b..b + directions], &before);
                    if n > 3 && t < 0.5 {
                        attributes[i].values[b + 3] = attributes[i].values[a + 3];
                    }
                }
                Blend::Nearest => {
                    if t < 0.5 {
                        attributes[i].values.copy_within(a..a + n, b);
                    }
                }
                Blend::Joints => {
                    let (head, tail) = attributes.split_at_mut(i + 1);
                    if let (Some(joints), Some(weights)) = (head.last_mut(), tail.first_mut())
                        && (weights.blend, weights.components) == (Blend::Weights, n)
                    {
                        blend_influences(&mut joints.values, &mut weights.values, (a, b, n), t);
                    }
                }
                Blend::Weights => {}
            }
        }
    }

    /// Gives wedge `into` the solved values that are not blended, and its tangents a right angle to
    /// the normal.
    pub(super) fn replace(&mut self, into: u32, values: &[f32], layouts: &[Vec<SolvedAttribute>]) {
        if values.is_empty() {
            return;
        }
        let set = self.set_of(into);
        let (into, attributes) = (into as usize - self.starts[set], &mut self.sets[set]);
        let mut normal = None;
        for &SolvedAttribute { attribute, start, length } in layouts.get(set).into_iter().flatten() {
            let attribute = &mut attributes[attribute];
            let at = into * attribute.components;
            attribute.values[at..at + length].copy_from_slice(&values[start..start + length]);
            if let (Blend::Direction, &[x, y, z]) = (attribute.blend, &values[start..start + length]) {
                normal = Some([x, y, z]);
            }
        }
        let Some(normal) = normal else { return };
        for tangents in attributes.iter_mut().filter(|a| a.blend == Blend::Tangent && a.components >= 3) {
            let at = into * tangents.components;
            let tangent = &mut tangents.values[at..at + 3];
            let before = [tangent[0], tangent[1], tangent[2]];
            let along: f32 = tangent.iter().zip(normal).map(|(t, n)| t * n).sum();
            tangent.iter_mut().zip(normal).for_each(|(t, n)| *t -= along * n);
            normalise(tangent, &before);
        }
    }

    fn set_of(&self, wedge: u32) -> usize {
        if self.starts.len() == 1 { 0 } else { self.starts.partition_point(|&s| s <= wedge as usize) - 1 }
    }

    /// The attributes of one set for just these wedges.
    pub(super) fn compact(&self, set: usize, wedges: &[u32]) -> Vec<Attribute> {
        let compact = |attribute: &Attribute| {
            let n = attribute.components;
            let mut values = Vec::with_capacity(wedges.len() * n);
            for &w in wedges {
                let at = (w as usize - self.starts[set]) * n;
                values.extend_from_slice(&attribute.values[at..at + n]);
            }
            Attribute { name: attribute.name.clone(), components: n, values, blend: attribute.blend }
        };
        self.sets[set].iter().map(compact).collect()
    }
}

fn lerp(values: &mut [f32], a: usize, b: usize, n: usize, t: f32) {
    for k in 0..n {
        values[b + k] = values[a + k] * (1.0 - t) + values[b + k] * t;
    }
}

/// Scales to unit length; opposite directions that cancel keep what was `before`.
fn normalise(direction: &mut [f32], before: &[f32; 3]) {
    let squared: f32 = direction.iter().map(|c| c * c).sum();
    if squared > 1e-12 {
        let s = 1.0 / squared.sqrt();
        direction.iter_mut().for_each(|c| *c *= s);
    } else {
        direction.copy_from_slice(&before[..direction.len()]);
    }
}

/// Blends two sets of `n` joints and weights at `a` and `b` into `b`: the strongest `n` of both,
/// the sum kept.
fn blend_influences(joints: &mut [f32], weights: &mut [f32], (a, b, n): (usize, usize, usize), t: f32) {
    let mut merged: Vec<(f32, f32)> = Vec::with_capacity(2 * n);
    let mut total = 0.0;
    for (start, share) in [(b, t), (a, 1.0 - t)] {
        for k in 0..n {
            let (joint, weight) = (joints[start + k], weights[start + k] * share);
            total += weight;
            if weight > 0.0 {
                match merged.iter_mut().find(|m| m.0 == joint) {
                    Some(m) => m.1 += weight,
                    None => merged.push((joint, weight)),
                }
            }
        }
    }
    if merged.is_empty() {
        return;
    }
    // The strongest first, of equals the lower joint; there are at most a few.
    for k in 0..merged.len().min(n) {
        let stronger = |x: (f32, f32), y: (f32, f32)| x.1 > y.1 || (x.1 == y.1 && x.0 < y.0);
        let strongest = (k..merged.len()).fold(k, |best, i| if stronger(merged[i], merged[best]) { i } else { best });
        merged.swap(k, strongest);
    }
    merged.truncate(n);
    let kept: f32 = merged.iter().map(|m| m.1).sum();
    for k in 0..n {
        let (joint, weight) = merged.get(k).copied().unwrap_or((0.0, 0.0));
        joints[b + k] = joint;
        weights[b + k] = weight * total / kept;
    }
    // Weights that summed to 1 still do, to the last bit that the sum can show: the strongest
    // takes up the rounding.
    if (total - 1.0).abs() < 1e-3 {
        let others: f64 = weights[b + 1..b + n].iter().map(|&w| f64::from(w)).sum();
        weights[b] = (1.0 - others) as f32;
    }
}
