//! Sorts short lists by a heap: one small function for all, where the standard library's sort is
//! ten kilobytes of code for each type.

/// The numbers 0 to `count - 1` in the order that `less` gives; equal ones keep theirs.
/// At most about 2 · count · log₂ count comparisons.
pub(super) fn order(count: usize, less: &dyn Fn(usize, usize) -> bool) -> Vec<usize> {
    let less = |a: usize, b: usize| less(a, b) || (!less(b, a) && a < b);
    let mut heap: Vec<usize> = (0..count).collect();
    for top in (0..count / 2).rev() {
        sink(&mut heap, top, &less);
    }
    for end in (1..count).rev() {
        heap.swap(0, end);
        sink(&mut heap[..end], 0, &less);
    }
    heap
}

/// Lets the element at `top` sink until none of its children is greater.
fn sink(heap: &mut [usize], mut top: usize, less: &dyn Fn(usize, usize) -> bool) {
    loop {
        let mut child = 2 * top + 1;
        if child >= heap.len() {
            return;
        }
        if child + 1 < heap.len() && less(heap[child], heap[child + 1]) {
            child += 1;
        }
        if !less(heap[top], heap[child]) {
            return;
        }
        heap.swap(top, child);
        top = child;
    }
}

#[cfg(test)]
mod tests {
    use super::order;

    #[test]
    fn equal_keys_keep_their_order() {
        for count in [0usize, 1, 2, 3, 10, 1000] {
            let keys: Vec<usize> = (0..count).map(|i| i * 7919 % 13).collect();
            let mut expected: Vec<usize> = (0..count).collect();
            expected.sort_by_key(|&i| (keys[i], i));
            assert_eq!(order(count, &|a, b| keys[a] < keys[b]), expected);
        }
    }
}
