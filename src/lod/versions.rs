//! What changes over time: the positions of all vertices, each one's side by side, and what a segment needs in one row.

use super::segment::NEVER;

/// Where each vertex is put, and when.
#[derive(Debug, Default)]
pub(super) struct Versions {
    /// For each vertex the end of its versions.
    ends: Vec<u32>,
    times: Vec<u32>,
    positions: Vec<[f32; 3]>,
}

impl Versions {
    /// No versions yet of so many vertices: they are first counted, then filled in.
    pub(super) fn new(vertices: usize) -> Self {
        Self { ends: vec![0; vertices], ..Self::default() }
    }

    /// There will be one more of this vertex.
    pub(super) fn count(&mut self, vertex: u32) {
        self.ends[vertex as usize] += 1;
    }

    /// Makes room when all are counted.
    pub(super) fn make_room(&mut self) {
        let mut sum = 0;
        for end in &mut self.ends {
            // The start for now; putting the versions in moves it to the end.
            sum += std::mem::replace(end, sum);
        }
        (self.times, self.positions) = (vec![0; sum as usize], vec![[0.0; 3]; sum as usize]);
    }

    /// Puts the next one in; those of a vertex come in the order of their times.
    pub(super) fn put(&mut self, vertex: u32, position: [f32; 3], time: u32) {
        let at = self.ends[vertex as usize] as usize;
        self.ends[vertex as usize] += 1;
        self.times[at] = time;
        self.positions[at] = position;
    }

    /// The versions of the vertices so `named` from `first` on and up to `length` after it, counted
    /// from there; `lasts` says until when each vertex is there.
    pub(super) fn part(
        &self,
        named: impl Iterator<Item = u32>,
        lasts: &[u32],
        first: usize,
        length: usize,
    ) -> Moves<[f32; 3]> {
        let mut moves = Vec::with_capacity(length);
        // What a vertex is given at the first level itself is in its position there already, but at
        // the very start there may be a fit and nothing else.
        let begins = if first == 0 { 0 } else { first as u32 + 1 };
        for ((name, vertex), &lasts) in named.zip(0..).zip(lasts) {
            let start = (name as usize).checked_sub(1).map_or(0, |before| self.ends[before] as usize);
            let end = self.ends[name as usize] as usize;
            for i in start..end {
                let time = self.times[i];
                if time < begins || time as usize > first + length {
                    continue;
                }
                let from = time - first as u32;
                if let Some(Move { of: same, until, .. }) = moves.last_mut()
                    && *same == vertex
                {
                    *until = from;
                }
                moves.push(Move { of: vertex, from, until: lasts, value: self.positions[i] });
            }
        }
        moves.shrink_to_fit();
        Moves(moves)
    }
}

/// The new values of vertices or wedges in a segment, in their order and that of the times.
#[derive(Debug)]
pub(super) struct Moves<T>(Vec<Move<T>>);

/// What a vertex or wedge has from one time to another, which is that of its next move or of its end.
#[derive(Debug, Clone, Copy)]
struct Move<T> {
    of: u32,
    from: u32,
    until: u32,
    value: T,
}

impl<T> Default for Moves<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

/// So many are looked at before those that count are handed out.
const BATCH: usize = 1024;

impl<T: Copy> Moves<T> {
    /// From `(of, time, value)` in the order of `of` and then of the times; a value counts until the next.
    pub(super) fn from_sorted(values: impl Iterator<Item = (u32, u32, T)>) -> Self {
        let mut moves: Vec<Move<T>> = Vec::with_capacity(values.size_hint().0);
        for (of, from, value) in values {
            if let Some(last) = moves.last_mut().filter(|last| last.of == of) {
                last.until = from;
            }
            moves.push(Move { of, from, until: NEVER, value });
        }
        Self(moves)
    }

    /// Hands out the vertices or wedges that are not at `time` as they were at first, with what they have.
    pub(super) fn at(&self, time: u32, mut place: impl FnMut(usize, T)) {
        let mut found = [0_u16; BATCH];
        for batch in self.0.chunks(BATCH) {
            // Which count is a matter of chance: each is written, and the place taken only if it does. No branch.
            let mut count = 0;
            for (i, m) in (0..).zip(batch) {
                if let Some(slot) = found.get_mut(count) {
                    *slot = i;
                }
                count += usize::from((m.from <= time) & (time < m.until));
            }
            for &i in &found[..count] {
                let Move { of, value, .. } = batch[usize::from(i)];
                place(of as usize, value);
            }
        }
    }

    /// Bytes on the heap.
    pub(super) fn byte_count(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}
