//! Positions of vertices over time, the versions of each vertex side by side.

/// Where each vertex is put, and when.
#[derive(Debug, Default)]
pub(super) struct Versions {
    /// For each vertex the end of its versions.
    ends: Vec<u32>,
    times: Vec<u32>,
    positions: Vec<[f32; 3]>,
}

impl Versions {
    /// From all `(vertex, position, time)` in the order of their times, which are asked for twice.
    pub(super) fn new<I: Iterator<Item = (usize, [f32; 3], u32)>>(vertices: usize, placed: impl Fn() -> I) -> Self {
        let mut ends = vec![0_u32; vertices];
        for (vertex, ..) in placed() {
            ends[vertex] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            // The start for now; putting the versions in moves it to the end.
            sum += std::mem::replace(end, sum);
        }
        let (mut times, mut positions) = (vec![0; sum as usize], vec![[0.0; 3]; sum as usize]);
        for (vertex, position, time) in placed() {
            let at = ends[vertex] as usize;
            ends[vertex] += 1;
            times[at] = time;
            positions[at] = position;
        }
        Self { ends, times, positions }
    }

    /// The versions of the vertices so `named` from `first` on and up to `length` after it, counted from there.
    pub(super) fn part(&self, named: impl Iterator<Item = u32>, first: usize, length: usize) -> Self {
        let mut part = Self::default();
        // What a vertex is given at the first level itself is in its position there already, but at
        // the very start there may be a fit and nothing else.
        let begins = if first == 0 { 0 } else { first as u32 + 1 };
        for name in named {
            let mut i = self.start(name as usize);
            let end = self.ends[name as usize] as usize;
            while i < end && self.times[i] < begins {
                i += 1;
            }
            while i < end && self.times[i] as usize <= first + length {
                part.times.push(self.times[i] - first as u32);
                part.positions.push(self.positions[i]);
                i += 1;
            }
            part.ends.push(part.times.len() as u32);
        }
        part.times.shrink_to_fit();
        part.positions.shrink_to_fit();
        part
    }

    fn start(&self, vertex: usize) -> usize {
        vertex.checked_sub(1).map_or(0, |before| self.ends[before] as usize)
    }

    /// The last position that the vertex was given until `time`, if it was given any.
    pub(super) fn at(&self, vertex: usize, time: u32) -> Option<[f32; 3]> {
        let start = self.start(vertex);
        let end = self.ends[vertex] as usize;
        let last = (start..end).rev().find(|&i| self.times[i] <= time)?;
        Some(self.positions[last])
    }

    /// Bytes on the heap.
    pub(super) fn byte_count(&self) -> usize {
        size_of_val(self.ends.as_slice()) + size_of_val(self.times.as_slice()) + size_of_val(self.positions.as_slice())
    }
}
