//! Positions of vertices over time: of all, the versions of each vertex side by side, and of a segment, in one row.

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
    pub(super) fn part(&self, named: impl Iterator<Item = u32>, lasts: &[u32], first: usize, length: usize) -> Moves {
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
                if let Some(Move { vertex: same, until, .. }) = moves.last_mut()
                    && *same == vertex
                {
                    *until = from;
                }
                moves.push(Move { vertex, from, until: lasts, position: self.positions[i] });
            }
        }
        moves.shrink_to_fit();
        Moves(moves)
    }
}

/// The new positions of vertices in a segment, in the order of the vertices and their times.
#[derive(Debug, Default)]
pub(super) struct Moves(Vec<Move>);

/// Where a vertex is from one time to another, which is that of its next move or of its end.
#[derive(Debug, Clone, Copy)]
struct Move {
    vertex: u32,
    from: u32,
    until: u32,
    position: [f32; 3],
}

/// So many are looked at before those that count are handed out.
const BATCH: usize = 1024;

impl Moves {
    /// Hands out the vertices that are elsewhere at `time` than at first, with where they are.
    pub(super) fn at(&self, time: u32, mut place: impl FnMut(usize, [f32; 3])) {
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
                let Move { vertex, position, .. } = batch[usize::from(i)];
                place(vertex as usize, position);
            }
        }
    }

    /// Bytes on the heap.
    pub(super) fn byte_count(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}
