//! The history by vertex instead of by time: when each goes, into what, and where it was put.
//!
//! One pass over the collapses in their order, which jumps about in space; everything after it
//! reads in the order of the mesh.

use super::segment::{NEVER, Source};
use super::versions::Versions;

/// Times are numbers of collapses from the start; vertices and wedges have their names.
#[derive(Debug, Default)]
pub(super) struct History {
    pub(super) vertices: Successors,
    /// The same as the vertices' if each vertex has one wedge, and empty.
    pub(super) wedges: Successors,
    pub(super) versions: Versions,
}

/// For each name when it merges into what; [`NEVER`] and itself.
#[derive(Debug, Default)]
pub(super) struct Successors {
    times: Vec<u32>,
    goes_into: Vec<u32>,
}

impl History {
    /// The first `count` collapses, and the fit if they are all.
    pub(super) fn new(source: &Source<'_>, count: usize) -> Self {
        let Source { mesh, sequence, plain } = *source;
        let names = mesh.positions.len();
        let collapses = &sequence.collapses[..count];
        let mut vertices = Successors::new(names);
        for (collapse, time) in collapses.iter().zip(1..) {
            vertices.merge(collapse.from, collapse.into, time);
        }
        let mut wedges = Successors::default();
        if !plain {
            wedges = Successors::new(names);
            if count > 0 {
                sequence.duplicates.iter().for_each(|&(from, into)| wedges.merge(from, into, 1));
            }
            for (merges, time) in sequence.merges_from(0).take(count).zip(1..) {
                merges.for_each(|(from, into)| wedges.merge(from, into, time));
            }
        }
        let fitted = if count == sequence.collapses.len() { sequence.fitted.as_slice() } else { &[] };
        let versions = Versions::new(names, || {
            let collapsed = collapses.iter().zip(1..).map(|(c, time)| (c.into, c.position, time));
            let placed = collapsed.chain(fitted.iter().map(|&(v, position)| (v, position, count as u32)));
            placed.map(|(name, position, time)| {
                // A vertex that did not move keeps its own bits: the sign of a zero.
                let before = mesh.positions[name as usize];
                (name as usize, if plain && before == position { before } else { position }, time)
            })
        });
        Self { vertices, wedges, versions }
    }
}

impl Successors {
    fn new(names: usize) -> Self {
        Self { times: vec![NEVER; names], goes_into: (0..names as u32).collect() }
    }

    fn merge(&mut self, from: u32, into: u32, time: u32) {
        self.times[from as usize] = time;
        self.goes_into[from as usize] = into;
    }

    /// The same with times since `first` and up to `length` after it, for the names that are there
    /// then, in rising order, each by its number in that order. `numbers` is room for a table.
    pub(super) fn part(
        &self,
        names: impl Iterator<Item = u32> + Clone,
        first: usize,
        length: usize,
        numbers: &mut Vec<u32>,
    ) -> (Vec<u32>, Vec<u32>) {
        numbers.resize(self.times.len(), 0);
        let mut count = 0;
        for name in names.clone() {
            numbers[name as usize] = count;
            count += 1;
        }
        let mut times = Vec::with_capacity(count as usize);
        let mut goes_into = Vec::with_capacity(count as usize);
        for (name, number) in names.zip(0..) {
            let time = self.times[name as usize];
            let merges = time != NEVER && time as usize <= first + length;
            times.push(if merges { time - first as u32 } else { NEVER });
            let into = numbers[self.goes_into[name as usize] as usize];
            goes_into.push(if merges && into < count { into } else { number });
        }
        (times, goes_into)
    }
}

/// The ancestor of `v` at `time`.
pub(super) fn climb(mut v: u32, time: u32, lasts: &[u32], goes_into: &[u32]) -> u32 {
    while lasts[v as usize] <= time && goes_into[v as usize] != v {
        v = goes_into[v as usize];
    }
    v
}

/// When two of the three vertices become one; 0 if they are.
pub(super) fn end_of_triangle(mut vertices: [u32; 3], lasts: &[u32], goes_into: &[u32]) -> u32 {
    let [a, b, c] = vertices;
    if a == b || b == c || c == a {
        return 0;
    }
    let mut times = vertices.map(|v| lasts[v as usize]);
    loop {
        let next = if times[0] < times[1] { 0 } else { 1 };
        let next = if times[2] < times[next] { 2 } else { next };
        let time = times[next];
        if time == NEVER {
            return NEVER;
        }
        let into = goes_into[vertices[next] as usize];
        if vertices.contains(&into) {
            return time;
        }
        vertices[next] = into;
        times[next] = lasts[into as usize];
    }
}
