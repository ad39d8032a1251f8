//! Rows of numbers, each bit pattern kept once: an open-addressing table over one flat array.

/// Distinct rows in the order in which they first came.
pub(super) struct Unique {
    width: usize,
    values: Vec<f32>,
    /// Row number plus one at the row's hash; 0 where free. The length is a power of two.
    table: Vec<u32>,
}

impl Unique {
    /// Room for `rows` rows of `width` numbers.
    pub(super) fn new(width: usize, rows: usize) -> Self {
        // At most half full, so that probes stay short.
        let slots = (rows.max(1) * 2).next_power_of_two();
        Self { width, values: Vec::with_capacity(rows * width), table: vec![0; slots] }
    }

    /// The number of the row with these bits, which is added if new. No more than `rows` times.
    pub(super) fn insert(&mut self, row: &[f32]) -> u32 {
        let mask = self.table.len() - 1;
        let mut slot = hash(row) as usize & mask;
        while let Some(found) = (self.table[slot] as usize).checked_sub(1) {
            let known = &self.values[found * self.width..(found + 1) * self.width];
            if known.iter().zip(row).all(|(a, b)| a.to_bits() == b.to_bits()) {
                return found as u32;
            }
            slot = (slot + 1) & mask;
        }
        self.values.extend_from_slice(row);
        let count = (self.values.len() / self.width) as u32;
        self.table[slot] = count;
        count - 1
    }

    /// The rows so far.
    pub(super) fn rows(&self) -> std::slice::ChunksExact<'_, f32> {
        self.values.chunks_exact(self.width)
    }
}

/// Multiply and fold, a word at a time; the fold carries high bits down to where the table looks.
fn hash(row: &[f32]) -> u64 {
    const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15; // 2^64 / golden ratio: odd, without a pattern in its bits
    row.iter().fold(FACTOR, |h, value| {
        let h = (h ^ u64::from(value.to_bits())).wrapping_mul(FACTOR);
        h ^ (h >> 29)
    })
}
