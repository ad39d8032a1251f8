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
    /// Collapses that were read for who merges, and for positions.
    read: (usize, usize),
    /// Collapses to read.
    count: usize,
}

/// For each name when it merges into what; [`NEVER`] and itself.
#[derive(Debug, Default)]
pub(super) struct Successors {
    times: Vec<u32>,
    goes_into: Vec<u32>,
}

impl History {
    /// Nothing yet of the first `count` collapses.
    pub(super) fn new(source: &Source<'_>, count: usize) -> Self {
        let names = source.mesh.positions.len();
        let wedges = if source.plain { Successors::default() } else { Successors::new(names) };
        Self { vertices: Successors::new(names), wedges, versions: Versions::new(names), read: (0, 0), count }
    }

    /// The first `count` collapses, and the fit if they are all.
    pub(super) fn whole(source: &Source<'_>, count: usize) -> Self {
        let mut history = Self::new(source, count);
        while history.step(source, count.max(1)) {}
        history
    }

    /// Reads about `work` more collapses. Returns false if there was nothing left to do.
    pub(super) fn step(&mut self, source: &Source<'_>, work: usize) -> bool {
        let Source { mesh, sequence, plain } = *source;
        let (start, end) = (self.read.0, self.count.min(self.read.0.saturating_add(work)));
        if start == 0 || start < end {
            for (collapse, time) in sequence.collapses[start..end].iter().zip(start as u32 + 1..) {
                self.vertices.merge(collapse.from, collapse.into, time);
                self.versions.count(collapse.into);
            }
            if !plain {
                if start == 0 && self.count > 0 {
                    sequence.duplicates.iter().for_each(|&(from, into)| self.wedges.merge(from, into, 1));
                }
                for (merges, time) in sequence.merges_from(start).take(end - start).zip(start as u32 + 1..) {
                    merges.for_each(|(from, into)| self.wedges.merge(from, into, time));
                }
            }
            self.read.0 = end;
            if end == self.count {
                // No collapse at all is done as well.
                self.read.0 = self.count.max(1);
                self.fitted(source).iter().for_each(|&(vertex, _)| self.versions.count(vertex));
                self.versions.make_room();
            }
            return true;
        }
        // A vertex that did not move keeps its own bits: the sign of a zero.
        let kept = |name: u32, position| {
            let before = mesh.positions[name as usize];
            if plain && before == position { before } else { position }
        };
        let (start, end) = (self.read.1, self.count.min(self.read.1.saturating_add(work)));
        if start > self.count {
            return false;
        }
        for (c, time) in sequence.collapses[start..end].iter().zip(start as u32 + 1..) {
            self.versions.put(c.into, kept(c.into, c.position), time);
        }
        self.read.1 = end;
        if end == self.count {
            self.read.1 = self.count + 1;
            for &(vertex, position) in self.fitted(source) {
                self.versions.put(vertex, kept(vertex, position), self.count as u32);
            }
        }
        true
    }

    /// The share that was read.
    pub(super) fn fraction(&self) -> f32 {
        (self.read.0 + self.read.1) as f32 / (2 * self.count + 1) as f32
    }

    fn fitted<'a>(&self, source: &Source<'a>) -> &'a [(u32, [f32; 3])] {
        if self.count == source.sequence.collapses.len() { &source.sequence.fitted } else { &[] }
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
