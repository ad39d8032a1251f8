//! A hash table that numbers distinct rows of integers in the order they first appear.

/// Rows of `N` numbers; each distinct one gets the next number from 0.
#[derive(Debug)]
pub(super) struct RowTable<const N: usize> {
    rows: Vec<[u32; N]>,
    /// Row number + 1 at the row's hash or the next free place after it; 0 is free. The length is
    /// a power of two, at least twice the number of rows.
    slots: Vec<u32>,
    /// Where the hash starts; the next number whenever a chain has become too long.
    seed: u32,
}

/// Places looked at before the table is filled anew by other hashes. Half full, the longest chain of ten million rows
/// is near 80, unless somebody chose the rows such that their hashes are the same: time would go with their square.
pub(super) const LONGEST_CHAIN: usize = 512;

/// Hashes that are tried, one after the other; nobody finds rows that collide under as many.
pub(super) const SEEDS: u32 = 16;

impl<const N: usize> RowTable<N> {
    /// An empty table.
    pub(super) fn new() -> Self {
        Self { rows: Vec::new(), slots: vec![0; 16], seed: 0 }
    }

    /// The distinct rows by their number.
    pub(super) fn rows(&self) -> &[[u32; N]] {
        &self.rows
    }

    /// The number of `row`, a new one if it was not seen before.
    #[inline]
    pub(super) fn number(&mut self, row: [u32; N]) -> u32 {
        if (self.rows.len() + 1) * 2 > self.slots.len() {
            self.fill(self.slots.len() * 2);
        }
        let mask = self.slots.len() - 1;
        let first = hash(&row, self.seed) & mask;
        let mut slot = first;
        loop {
            match self.slots[slot] {
                0 => {
                    self.rows.push(row);
                    #[allow(clippy::cast_possible_truncation)] // fewer rows than bytes in the file / 2
                    let count = self.rows.len() as u32;
                    self.slots[slot] = count;
                    if slot.wrapping_sub(first) & mask > LONGEST_CHAIN && self.seed < SEEDS {
                        self.seed += 1;
                        self.fill(self.slots.len());
                    }
                    return count - 1;
                }
                found if self.rows[found as usize - 1] == row => return found - 1,
                _ => slot = (slot + 1) & mask,
            }
        }
    }

    /// Puts all rows into so many free slots.
    #[cold]
    fn fill(&mut self, slots: usize) {
        let mask = slots - 1;
        self.slots.clear();
        self.slots.resize(slots, 0);
        for (number, row) in (1..).zip(&self.rows) {
            let mut slot = hash(row, self.seed) & mask;
            while self.slots[slot] != 0 {
                slot = (slot + 1) & mask;
            }
            self.slots[slot] = number;
        }
    }
}

/// Mixes every bit of the row into the low bits, which are the ones used: float bits differ
/// mostly in their high ones, indices in their low ones. Another seed makes other rows collide.
#[inline]
#[allow(clippy::cast_possible_truncation)] // the low bits are the mixed ones
fn hash<const N: usize>(row: &[u32; N], seed: u32) -> usize {
    // 2^64 / golden ratio, odd: consecutive inputs spread evenly (Knuth's multiplicative hash).
    let mut state = u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    for &value in row {
        state = (state.rotate_left(29) ^ u64::from(value)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
    state ^= state >> 32;
    state = state.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (state >> 32) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_numbered_by_first_appearance() {
        let mut table = RowTable::new();
        for i in 0..5000_u32 {
            assert_eq!(table.number([i, i * i, 7]), i);
            assert_eq!(table.number([i / 2, (i / 2).pow(2), 7]), i / 2);
        }
        assert_eq!(table.rows().len(), 5000);
        assert_eq!(table.rows()[3], [3, 9, 7]);
    }

    #[test]
    fn rows_chosen_to_collide_are_spread_anew() {
        let alike = (0..u32::MAX).map(|i| [7, i, i / 3]).filter(|row| hash(row, 0) & 0xfff == 5);
        let rows: Vec<[u32; 3]> = alike.take(2000).collect();
        let mut table = RowTable::new();
        for (number, &row) in (0..).zip(&rows) {
            assert_eq!(table.number(row), number);
        }
        assert_eq!(table.seed, 1);
        assert!(rows.iter().zip(0..).all(|(&row, number)| table.number(row) == number));
    }

    #[test]
    fn regular_rows_do_not_collide_much() {
        // The integer grid as float bits and as indices: the longest probe stays short.
        for scale in [1.0, 1024.0, 1.0 / 1024.0] {
            let mut slots = vec![0_u32; 1 << 18];
            let mut longest = 0;
            for i in 0..40_u32.pow(3) {
                let at = [i % 40, i / 40 % 40, i / 1600].map(|c| (c as f32 * scale).to_bits());
                let mut slot = hash(&at, 0) & (slots.len() - 1);
                let mut probes = 0;
                while slots[slot] != 0 {
                    slot = (slot + 1) & (slots.len() - 1);
                    probes += 1;
                }
                slots[slot] = 1;
                longest = longest.max(probes);
            }
            assert!(longest < 20, "{scale}: {longest}");
        }
    }
}
