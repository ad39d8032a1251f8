//! Rows of numbers, each bit pattern kept once: an open-addressing table beside one flat array.

/// Keeps the first of equal rows (bit for bit) of `width` numbers, in their order, and gives the number of each row
/// among those kept.
pub(super) fn keep_unique(values: &mut Vec<f32>, width: usize) -> Vec<u32> {
    let rows = values.len() / width;
    // At most half full, so that probes stay short. A row's number plus one; 0 where free.
    let slots = (rows.max(1) * 2).next_power_of_two();
    let mut table = vec![0u32; slots];
    let mut numbers = Vec::with_capacity(rows);
    let mut kept = 0;
    for row in 0..rows {
        let start = row * width;
        let mut slot = hash(&values[start..start + width]) as usize & (slots - 1);
        let number = loop {
            let Some(found) = (table[slot] as usize).checked_sub(1) else {
                values.copy_within(start..start + width, kept * width);
                kept += 1;
                table[slot] = kept as u32;
                break kept - 1;
            };
            let (known, row) = (&values[found * width..(found + 1) * width], &values[start..start + width]);
            if known.iter().zip(row).all(|(a, b)| a.to_bits() == b.to_bits()) {
                break found;
            }
            slot = (slot + 1) & (slots - 1);
        };
        numbers.push(number as u32);
    }
    values.truncate(kept * width);
    numbers
}

/// Multiply and fold, two numbers at a time; the fold carries high bits down to where the table looks.
fn hash(row: &[f32]) -> u64 {
    const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15; // 2^64 / golden ratio: odd, without a pattern in its bits
    let (pairs, last) = row.as_chunks::<2>();
    let mix = |h: u64, bits: u64| {
        let h = (h ^ bits).wrapping_mul(FACTOR);
        h ^ (h >> 29)
    };
    let h = pairs.iter().fold(FACTOR, |h, [a, b]| mix(h, u64::from(a.to_bits()) << 32 | u64::from(b.to_bits())));
    // Once more, for the low bits of the high half have only now come down.
    last.first().map_or(mix(h, 0), |last| mix(h, u64::from(last.to_bits())))
}

#[cfg(test)]
mod tests {
    use super::keep_unique;

    #[test]
    fn the_first_of_equal_rows_is_kept() {
        let mut values = vec![1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 0.0, -0.0, 3.0, 4.0, 0.0, 0.0];
        assert_eq!(keep_unique(&mut values, 2), [0, 1, 0, 2, 1, 3], "zeros of either sign differ");
        assert_eq!(values, [1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn many_rows_of_every_width() {
        for width in 1..9 {
            let row = |i: usize| (0..width).map(move |c| ((i * 31 + c) % 97) as f32);
            let mut values: Vec<f32> = (0..1000).flat_map(row).collect();
            let original = values.clone();
            let numbers = keep_unique(&mut values, width);
            assert_eq!(values.len() / width, 97);
            for (i, &number) in numbers.iter().enumerate() {
                let number = number as usize;
                assert_eq!(values[number * width..(number + 1) * width], original[i * width..(i + 1) * width]);
            }
        }
    }
}
