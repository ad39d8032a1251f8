//! A level by replaying the whole history over copies of the whole mesh: slow, simple, and what every
//! faster way must equal bit for bit.
#![allow(unreachable_pub, clippy::unwrap_used, reason = "a test may stop at the first surprise")]

use decimesh::collapse_sequence::CollapseSequence;
use decimesh::lod::{self, Level, LevelMesh};
use decimesh::mesh::weld::NO_VERTEX;
use decimesh::mesh::{Attribute, Blend, Group, Mesh, WedgeSet};

/// Extracts the level. `mesh` is the one the sequence was made from.
#[must_use]
pub fn extract(mesh: &Mesh, sequence: &CollapseSequence, level: Level) -> LevelMesh {
    let count = lod::collapse_count(sequence, level);
    let collapses = &sequence.collapses[..count];

    let mut positions = mesh.positions.clone();
    let mut attributes = WedgeAttributes::new(mesh);
    // Parents of vertices and of wedges, both named by wedges; the same when each has one.
    let mut vertex_parent: Vec<u32> = (0..positions.len() as u32).collect();
    let mut wedge_parent = vertex_parent.clone();
    if count > 0 {
        for &(wedge, same) in &sequence.duplicates {
            wedge_parent[wedge as usize] = same;
        }
    }
    let mut ordinal = 0;
    for (collapse, merges) in collapses.iter().zip(sequence.merges_from(0)) {
        let t = edge_parameter(positions[collapse.from as usize], positions[collapse.into as usize], collapse.position);
        for (from, into) in merges {
            attributes.blend(from, into, t);
            attributes.replace(into, sequence, ordinal);
            ordinal += 1;
            wedge_parent[from as usize] = into;
        }
        positions[collapse.into as usize] = collapse.position;
        vertex_parent[collapse.from as usize] = collapse.into;
    }
    if count == sequence.collapses.len() {
        for &(vertex, position) in &sequence.fitted {
            positions[vertex as usize] = position;
        }
    }
    resolve(&mut vertex_parent);
    resolve(&mut wedge_parent);

    let vertex_at_level = |w: u32| vertex_parent[sequence.vertex_of_wedge[w as usize] as usize];
    let wedge_at_level = |w: u32| wedge_parent[w as usize];
    let alive = |t: &[u32; 3]| {
        let [a, b, c] = t.map(vertex_at_level);
        a != b && b != c && c != a
    };

    let mut new_index = vec![NO_VERTEX; positions.len()];
    let mut out = Mesh { parts: mesh.parts.clone(), ..Mesh::default() };
    for group in &mesh.groups {
        let start = out.triangles.len();
        for t in mesh.triangles[group.triangles.clone()].iter().filter(|t| alive(t)) {
            let wedges = t.map(wedge_at_level);
            for w in wedges {
                new_index[w as usize] = 0;
            }
            out.triangles.push(wedges);
        }
        out.groups.push(Group { triangles: start..out.triangles.len(), wedge_set: group.wedge_set });
    }
    let mut wedge_map = Vec::new();
    for (s, set) in mesh.wedge_sets.iter().enumerate() {
        let start = wedge_map.len();
        for w in set.wedges.clone() {
            if new_index[w] != NO_VERTEX {
                new_index[w] = wedge_map.len() as u32;
                wedge_map.push(w as u32);
            }
        }
        out.wedge_sets.push(WedgeSet {
            wedges: start..wedge_map.len(),
            part: set.part,
            attributes: attributes.compact(s, set, &wedge_map[start..]),
        });
    }
    out.positions = wedge_map.iter().map(|&w| positions[vertex_at_level(w) as usize]).collect();
    // A wedge that was never merged may have moved with its vertex; one that did not move keeps
    // its own bits (the sign of a zero may differ between the wedges of a vertex).
    for (position, &w) in out.positions.iter_mut().zip(&wedge_map) {
        if *position == mesh.positions[w as usize] {
            *position = mesh.positions[w as usize];
        }
    }
    for index in out.triangles.iter_mut().flatten() {
        *index = new_index[*index as usize];
    }
    LevelMesh { mesh: out, wedge_map, error: collapses.last().map_or(0.0, |c| c.error) }
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

/// Points every entry at its root.
fn resolve(parent: &mut [u32]) {
    for i in 0..parent.len() {
        let mut root = parent[i];
        while parent[root as usize] != root {
            root = parent[root as usize];
        }
        let mut at = i;
        while parent[at] != root {
            at = std::mem::replace(&mut parent[at], root) as usize;
        }
    }
}

/// A copy of all attributes that the replay changes.
struct WedgeAttributes {
    /// Set of each wedge: `(first wedge, set)` by binary search over the starts.
    starts: Vec<usize>,
    sets: Vec<Vec<Attribute>>,
}

impl WedgeAttributes {
    fn new(mesh: &Mesh) -> Self {
        Self {
            starts: mesh.wedge_sets.iter().map(|s| s.wedges.start).collect(),
            sets: mesh.wedge_sets.iter().map(|s| s.attributes.clone()).collect(),
        }
    }

    /// Gives wedge `into` the values at `t` between `from` (0) and itself (1).
    fn blend(&mut self, from: u32, into: u32, t: f32) {
        if t >= 1.0 {
            return;
        }
        let set = if self.starts.len() == 1 { 0 } else { self.starts.partition_point(|&s| s <= into as usize) - 1 };
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

    /// Gives wedge `into` what was solved for at merge number `ordinal`.
    fn replace(&mut self, into: u32, sequence: &CollapseSequence, ordinal: usize) {
        let values = sequence.solved.of(ordinal);
        let set = if self.starts.len() == 1 { 0 } else { self.starts.partition_point(|&s| s <= into as usize) - 1 };
        let into = into as usize - self.starts[set];
        let attributes = &mut self.sets[set];
        let mut normal = None;
        for place in sequence.solved.layouts.get(set).into_iter().flatten().filter(|_| !values.is_empty()) {
            let attribute = &mut attributes[place.attribute];
            let new = &values[place.start..place.start + place.length];
            attribute.values[into * attribute.components..][..place.length].copy_from_slice(new);
            if attribute.blend == Blend::Direction {
                normal = Some([new[0], new[1], new[2]]);
            }
        }
        for tangents in attributes.iter_mut().filter(|a| a.blend == Blend::Tangent) {
            let Some(normal) = normal else { continue };
            let tangent = &mut tangents.values[into * tangents.components..][..3];
            let before = [tangent[0], tangent[1], tangent[2]];
            let along: f32 = tangent.iter().zip(normal).map(|(t, n)| t * n).sum();
            tangent.iter_mut().zip(normal).for_each(|(t, n)| *t -= along * n);
            normalise(tangent, &before);
        }
    }

    fn compact(&self, set: usize, original: &WedgeSet, wedges: &[u32]) -> Vec<Attribute> {
        self.sets[set]
            .iter()
            .map(|attribute| {
                let n = attribute.components;
                let mut values = Vec::with_capacity(wedges.len() * n);
                for &w in wedges {
                    let at = (w as usize - original.wedges.start) * n;
                    values.extend_from_slice(&attribute.values[at..at + n]);
                }
                Attribute { name: attribute.name.clone(), components: n, values, blend: attribute.blend }
            })
            .collect()
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
    merged.sort_by(|x, y| y.1.total_cmp(&x.1).then(x.0.total_cmp(&y.0)));
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
