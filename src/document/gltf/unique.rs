//! Rows of numbers that lie in columns, each bit pattern kept once: an open-addressing table of the rows' hashes.

use crate::document::row_table::{LONGEST_CHAIN, SEEDS};

/// Numbers of every row, and how many there are in each.
pub(super) type Rows<'a> = (&'a [f32], usize);

/// The number of each row among those kept: the first of equal rows (bit for bit in every column), in their order.
/// `None` if no two are equal.
pub(super) fn repeated(columns: &[Rows<'_>], count: usize) -> Option<Vec<u32>> {
    let chosen = (0..SEEDS).find_map(|seed| numbered(columns, count, seed, LONGEST_CHAIN));
    chosen.unwrap_or_else(|| numbered(columns, count, SEEDS, usize::MAX).flatten())
}

/// The same by hashes that start from `seed`; nothing if a chain of more than `longest` slots had to be looked through.
fn numbered(columns: &[Rows<'_>], count: usize, seed: u32, longest: usize) -> Option<Option<Vec<u32>>> {
    let hashes = hashes(columns, count, seed);
    // At most half full, so that probes stay short. A row's number plus one; 0 where free.
    let slots = (count.max(1) * 2).next_power_of_two();
    let mut table = vec![0u32; slots];
    // Empty as long as each row is its own.
    let mut numbers = Vec::new();
    let mut kept = 0;
    for (row, &hash) in hashes.iter().enumerate() {
        let mut slot = hash as usize & (slots - 1);
        let mut chain = 0;
        let known = loop {
            let Some(found) = (table[slot] as usize).checked_sub(1) else {
                table[slot] = row as u32 + 1;
                break None;
            };
            if hashes[found] == hash && columns.iter().all(|rows| equal(rows, found, row)) {
                break Some(found);
            }
            slot = (slot + 1) & (slots - 1);
            chain += 1;
            if chain > longest {
                return None;
            }
        };
        if known.is_some() && kept == row {
            numbers.reserve_exact(count);
            numbers.extend(0..row as u32);
        }
        kept += usize::from(known.is_none());
        if kept <= row {
            numbers.push(known.map_or(kept as u32 - 1, |known| numbers[known]));
        }
    }
    Some((kept < count).then_some(numbers))
}

/// Leaves the rows that are kept, by the numbers that [`repeated`] gave.
pub(super) fn keep(values: &mut Vec<f32>, width: usize, numbers: &[u32]) {
    let mut kept = 0;
    for (row, &number) in numbers.iter().enumerate() {
        if number as usize == kept {
            values.copy_within(row * width..(row + 1) * width, kept * width);
            kept += 1;
        }
    }
    values.truncate(kept * width);
}

fn equal(&(values, width): &Rows<'_>, a: usize, b: usize) -> bool {
    let row = |row: usize| &values[row * width..(row + 1) * width];
    row(a).iter().zip(row(b)).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// Multiply and fold; the fold carries high bits down to where the table looks.
fn hashes(columns: &[Rows<'_>], count: usize, seed: u32) -> Vec<u32> {
    const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15; // 2^64 / golden ratio: odd, without a pattern in its bits
    let mut hashes = vec![seed; count];
    for &(values, width) in columns {
        for (hash, row) in hashes.iter_mut().zip(values.chunks_exact(width)) {
            let h = row.iter().fold(u64::from(*hash) ^ FACTOR, |h, value| {
                let h = (h ^ u64::from(value.to_bits())).wrapping_mul(FACTOR);
                h ^ (h >> 32)
            });
            *hash = h as u32;
        }
    }
    hashes
}

#[cfg(test)]
mod tests {
    use super::{LONGEST_CHAIN, hashes, keep, numbered, repeated};

    #[test]
    fn the_first_of_equal_rows_is_kept() {
        let mut values = vec![1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 0.0, -0.0, 3.0, 4.0, 0.0, 0.0];
        let numbers = repeated(&[(&values, 2)], 6).unwrap();
        assert_eq!(numbers, [0, 1, 0, 2, 1, 3], "zeros of either sign differ");
        keep(&mut values, 2, &numbers);
        assert_eq!(values, [1.0, 2.0, 3.0, 4.0, 0.0, -0.0, 0.0, 0.0]);
        assert_eq!(repeated(&[(&values, 2)], 4), None, "now all differ");
    }

    #[test]
    fn rows_are_equal_only_in_every_column() {
        let (a, b) = ([1.0, 1.0, 1.0, 2.0], [5.0, 6.0, 5.0, 5.0]);
        assert_eq!(repeated(&[(&a, 1), (&b, 1)], 4).unwrap(), [0, 1, 0, 2]);
        assert_eq!(repeated(&[(&a, 2), (&b, 2)], 2), None);
        assert_eq!(repeated(&[], 0), None);
    }

    #[test]
    fn rows_chosen_to_collide_are_hashed_anew() {
        let slots = 4096;
        let place = |row: &[f32; 2]| hashes(&[(row, 2)], 1, 0)[0] & (slots - 1);
        let rows = (0..u32::MAX).map(|i| [f32::from_bits(i), 1.0]).filter(|row| place(row) == 5);
        let values: Vec<f32> = rows.take(slots as usize / 4).chain([[0.0, 7.0], [0.0, 7.0]]).flatten().collect();
        let columns: [(&[f32], usize); 1] = [(&values, 2)];
        assert_eq!(numbered(&columns, values.len() / 2, 0, LONGEST_CHAIN), None);
        let numbers = repeated(&columns, values.len() / 2).unwrap();
        assert_eq!(numbers[numbers.len() - 3..], [slots / 4 - 1, slots / 4, slots / 4]);
    }

    #[test]
    fn many_rows_of_every_width() {
        for width in 1..9 {
            let row = |i: usize| (0..width).map(move |c| ((i * 31 + c) % 97) as f32);
            let mut values: Vec<f32> = (0..1000).flat_map(row).collect();
            let original = values.clone();
            let numbers = repeated(&[(&values, width)], 1000).unwrap();
            keep(&mut values, width, &numbers);
            assert_eq!(values.len() / width, 97);
            for (i, &number) in numbers.iter().enumerate() {
                let number = number as usize;
                assert_eq!(values[number * width..(number + 1) * width], original[i * width..(i + 1) * width]);
            }
        }
    }
}
