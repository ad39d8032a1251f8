//! What becomes of attributes when wedges merge: the values at a share between two wedges.

use super::segment::Source;
use super::versions::Moves;
use crate::collapse_sequence::{SolvedAttribute, SolvedValues};
use crate::mesh::weld::NO_VERTEX;
use crate::mesh::{Attribute, Blend, Mesh};

/// One merge that changes the values of `into`; see [`WedgeAttributes::blend`].
#[derive(Debug, Clone, Copy)]
struct Blending {
    time: u32,
    from: u32,
    into: u32,
    parameter: f32,
    /// Which of the sequence's solved values replace those that were blended.
    solved: u32,
}

/// The values of wedges that change in a segment.
#[derive(Debug, Default)]
pub(super) struct Blends {
    /// Each with where its values begin: those of all attributes of its set, one after the other.
    moves: Moves<u32>,
    values: Vec<f32>,
}

impl Blends {
    /// Hands out the wedges whose values at `time` are not those at first, with the values.
    pub(super) fn at(&self, time: u32, mut place: impl FnMut(usize, &[f32])) {
        self.moves.at(time, |wedge, start| place(wedge, &self.values[start as usize..]));
    }

    /// Bytes on the heap.
    pub(super) fn byte_count(&self) -> usize {
        self.moves.byte_count() + size_of_val(self.values.as_slice())
    }
}

/// The blends of a segment while they are done one after the other.
#[derive(Debug)]
pub(super) struct BlendRun {
    attributes: WedgeAttributes,
    todo: Vec<Blending>,
    /// What is done, in order: the wedge, the time, and where its values begin.
    done: Vec<(u32, u32, u32)>,
    values: Vec<f32>,
}

impl BlendRun {
    /// The merges of the segment that change values; nothing if there are none. `state` is the mesh at its first level.
    pub(super) fn new(
        source: &Source<'_>,
        state: &Mesh,
        (first, length): (usize, usize),
        at_first: &[[f32; 3]],
        names: (&[u32], &[u32]),
    ) -> Option<Self> {
        if state.wedge_sets.iter().all(|set| set.attributes.is_empty()) {
            return None;
        }
        let todo = blends(source, first, length, at_first, names);
        let sets = state.wedge_sets.iter().map(|set| (set.wedges.start, set.attributes.as_slice()));
        let (attributes, done) = (WedgeAttributes::new(sets), Vec::with_capacity(todo.len()));
        Some(Self { attributes, todo, done, values: Vec::new() })
    }

    /// Does about `work` more. Returns whether all are done.
    pub(super) fn step(&mut self, solved: &SolvedValues, work: usize) -> bool {
        let start = self.done.len();
        let end = self.todo.len().min(start.saturating_add(work));
        for b in &self.todo[start..end] {
            self.attributes.blend(b.from, b.into, b.parameter);
            self.attributes.replace(b.into, solved.of(b.solved as usize), &solved.layouts);
            self.done.push((b.into, b.time, self.values.len() as u32));
            self.attributes.copy_values(b.into, &mut self.values);
        }
        end == self.todo.len()
    }

    /// All of them, sorted by wedge.
    pub(super) fn finish(self, wedges: usize) -> Blends {
        let mut starts = vec![0_u32; wedges + 1];
        for &(wedge, ..) in &self.done {
            starts[wedge as usize + 1] += 1;
        }
        for w in 0..wedges {
            starts[w + 1] += starts[w];
        }
        let mut order = vec![0_u32; self.done.len()];
        for (&(wedge, ..), i) in self.done.iter().zip(0..) {
            let at = &mut starts[wedge as usize];
            order[*at as usize] = i;
            *at += 1;
        }
        let mut values = Vec::with_capacity(self.values.len());
        let moves = order.iter().map(|&i| {
            let (wedge, time, start) = self.done[i as usize];
            let end = self.done.get(i as usize + 1).map_or(self.values.len(), |next| next.2 as usize);
            let moved = values.len() as u32;
            values.extend(&self.values[start as usize..end]);
            (wedge, time, moved)
        });
        let moves = Moves::from_sorted(moves);
        Blends { moves, values }
    }
}

/// The merges of the segment that change values, and how far along the edge each is.
fn blends(
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
#[derive(Debug)]
struct WedgeAttributes {
    /// First wedge of each set.
    starts: Vec<usize>,
    sets: Vec<Vec<Attribute>>,
}

impl WedgeAttributes {
    /// A copy of the attributes of each set, with its first wedge.
    fn new<'a>(sets: impl Iterator<Item = (usize, &'a [Attribute])>) -> Self {
        let (starts, sets) = sets.map(|(start, attributes)| (start, attributes.to_vec())).unzip();
        Self { starts, sets }
    }

    fn set_of(&self, wedge: u32) -> usize {
        if self.starts.len() == 1 { 0 } else { self.starts.partition_point(|&s| s <= wedge as usize) - 1 }
    }

    /// Gives wedge `into` the solved values that are not blended, and its tangents a right angle to
    /// the normal.
    fn replace(&mut self, into: u32, values: &[f32], layouts: &[Vec<SolvedAttribute>]) {
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

    /// Appends the values of a wedge, those of each attribute after the other.
    fn copy_values(&self, wedge: u32, values: &mut Vec<f32>) {
        let set = self.set_of(wedge);
        let at = wedge as usize - self.starts[set];
        for Attribute { components: n, values: from, .. } in &self.sets[set] {
            match n {
                2 => values.extend(from.as_chunks::<2>().0[at]),
                3 => values.extend(from.as_chunks::<3>().0[at]),
                4 => values.extend(from.as_chunks::<4>().0[at]),
                _ => values.extend(&from[at * n..(at + 1) * n]),
            }
        }
    }

    /// Gives wedge `into` the values at `t` between `from` (0) and itself (1).
    fn blend(&mut self, from: u32, into: u32, t: f32) {
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
}

/// The values of `components` numbers each for just these, by their numbers less `first`.
pub(super) fn gather(values: &[f32], components: usize, numbers: &[u32], first: usize) -> Vec<f32> {
    // Copying a few numbers of a length that is not known is a call, which takes longer than the copying.
    fn chunks<const N: usize>(values: &[f32], numbers: &[u32], first: usize) -> Vec<f32> {
        let chunks = values.as_chunks::<N>().0;
        let gathered: Vec<[f32; N]> = numbers.iter().map(|&w| chunks[w as usize - first]).collect();
        gathered.into_flattened()
    }
    match components {
        1 => chunks::<1>(values, numbers, first),
        2 => chunks::<2>(values, numbers, first),
        3 => chunks::<3>(values, numbers, first),
        4 => chunks::<4>(values, numbers, first),
        n => {
            let of = |&w: &u32| values[(w as usize - first) * n..][..n].iter().copied();
            numbers.iter().flat_map(of).collect()
        }
    }
}

/// Puts the first numbers of `from`, one for each component, at place `at` of `to`.
pub(super) fn put(to: &mut [f32], components: usize, at: usize, from: &[f32]) {
    fn chunk<const N: usize>(to: &mut [f32], at: usize, from: &[f32]) {
        if let (Some(to), Some(from)) = (to.as_chunks_mut::<N>().0.get_mut(at), from.first_chunk::<N>()) {
            *to = *from;
        }
    }
    match components {
        1 => chunk::<1>(to, at, from),
        2 => chunk::<2>(to, at, from),
        3 => chunk::<3>(to, at, from),
        4 => chunk::<4>(to, at, from),
        n => to[at * n..(at + 1) * n].copy_from_slice(&from[..n]),
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
