//! Legality: which collapses keep the surface a surface, and its triangles upright.

use super::lanes::{Lanes, Lanes3, Mask};
use super::topology::Corner;

/// Smallest cosine between a triangle's normal before and after: about 70°. Smaller values let
/// folds through on noisy scans (0.2: a third more flipped triangles), larger ones block collapses
/// that flatten noise.
const MIN_NORMAL_COSINE: f32 = 0.35;

/// Smallest ratio of twice the area to the longest edge squared; below it a triangle counts as
/// degenerate and may not be made. Far above `f32`'s rounding, far below any visible sliver.
const MIN_SHAPE: f32 = 1e-4;

/// Fans longer than this together are not merged: keeps the worst case (the apex of a cone with a
/// million sides) away from quadratic time.
pub(super) const MAX_FAN: usize = 2048;

/// Why a collapse was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It would change the topology: the link condition fails.
    Topology,
    /// A line of borders, seams or sheets would close onto itself or tear.
    Lines,
    /// A triangle would turn over or become degenerate.
    Flip,
    /// The estimated error would exceed the limit.
    Error,
}

/// The link condition (Dey, Edelsbrunner, Guha & Nekhayev 1999) for the edge between `u` and `v`
/// with the given triangles: the vertices that both see are just the ones opposite the edge, and
/// no edge lies in both links. `marks` has an entry for each vertex and `epoch` is advanced.
pub(super) fn check_link(
    marks: &mut [u32],
    epoch: &mut u32,
    (u, corners_u): (u32, &[Corner]),
    (v, corners_v): (u32, &[Corner]),
) -> Result<(), Refusal> {
    if corners_u.len() + corners_v.len() > MAX_FAN {
        return Err(Refusal::Topology);
    }
    *epoch += 2;
    let (seen, opposite) = (*epoch, *epoch + 1);
    let mut shared = 0;
    for c in corners_u {
        for w in [c.next, c.previous] {
            if w != v && marks[w as usize] != opposite {
                marks[w as usize] = seen;
            }
        }
        if c.next == v || c.previous == v {
            shared += 1;
            let third = if c.next == v { c.previous } else { c.next };
            marks[third as usize] = opposite;
        }
    }
    // At least one triangle stays, so that no part of the model vanishes.
    if shared == 0 || corners_u.len() + corners_v.len() == 2 * shared {
        return Err(Refusal::Topology);
    }
    for c in corners_v {
        for w in [c.next, c.previous] {
            if w != u && marks[w as usize] == seen {
                return Err(Refusal::Topology);
            }
        }
    }
    // Edges between two opposite vertices, which only short fans have.
    let spans =
        |c: &&Corner, marks: &[u32]| marks[c.next as usize] == opposite && marks[c.previous as usize] == opposite;
    for c in corners_u.iter().filter(|c| spans(c, marks)) {
        let same =
            |o: &Corner| (o.next, o.previous) == (c.previous, c.next) || (o.next, o.previous) == (c.next, c.previous);
        if corners_v.iter().any(same) {
            return Err(Refusal::Topology);
        }
    }
    Ok(())
}

/// What is left of [`check_link`] at a vertex that no surface goes through: the merge puts no triangle upon another, and
/// makes no edge of more than two triangles that was none before. With `spare` it may make more of them than it removes
/// by at most as many. Returns how many more there are.
pub(super) fn check_soup(
    (u, corners_u): (u32, &[Corner]),
    (v, corners_v): (u32, &[Corner]),
    spare: Option<i64>,
) -> Result<i64, Refusal> {
    if corners_u.len() + corners_v.len() > MAX_FAN {
        return Err(Refusal::Topology);
    }
    let stays = |c: &&Corner, end: u32| c.next != end && c.previous != end;
    let pair = |c: &Corner| (c.next.min(c.previous), c.next.max(c.previous));
    let mut pairs: Vec<(u32, u32)> = corners_u.iter().filter(|c| stays(c, v)).map(pair).collect();
    pairs.sort_unstable();
    let mut left = pairs.len();
    // Triangles at each neighbour: by whether they are of `v` (2) and whether they stay (1).
    let mut sides: Vec<(u32, u32)> = Vec::new();
    for (corners, other, second) in [(corners_u, v, false), (corners_v, u, true)] {
        for c in corners {
            sides.extend([c.next, c.previous].map(|w| (w, 2 * u32::from(second) + u32::from(stays(&c, other)))));
        }
    }
    for c in corners_v.iter().filter(|c| stays(c, u)) {
        left += 1;
        if pairs.binary_search(&pair(c)).is_ok() {
            return Err(Refusal::Topology);
        }
    }
    sides.sort_unstable();
    let shared = corners_u.iter().filter(|c| !stays(c, v)).count();
    let (mut more, mut any_worse) = (-i64::from(shared > 2), false);
    for edge in sides.chunk_by(|a, b| a.0 == b.0).filter(|edge| edge[0].0 != u && edge[0].0 != v) {
        let after = edge.iter().filter(|s| s.1 & 1 != 0).count();
        let second = edge.iter().filter(|s| s.1 & 2 != 0).count();
        let before = i64::from(second > 2) + i64::from(edge.len() - second > 2);
        more += i64::from(after > 2) - before;
        any_worse |= after > 2 && before == 0;
    }
    let allowed = spare.map_or(!any_worse, |spare| more <= spare);
    if left > 0 && allowed { Ok(more) } else { Err(Refusal::Topology) }
}

/// Where a triangle with area vector `old` may become one with area vector `new` and longest edge
/// squared `longest_squared`. A triangle without a direction has none to keep.
#[inline(always)]
pub(super) fn keep_upright(old: Lanes3, new: Lanes3, longest_squared: Lanes) -> Mask {
    let zero = Lanes::splat(0.0);
    let (old_squared, new_squared) = (old.dot(old), new.dot(new));
    let cosine = old.dot(new);
    let least = Lanes::splat(MIN_NORMAL_COSINE * MIN_NORMAL_COSINE) * old_squared * new_squared;
    let aligned = !cosine.at_most(zero) & least.at_most(cosine * cosine);
    let shapeless = old_squared.at_most(zero);
    let solid = (longest_squared * longest_squared * Lanes::splat(MIN_SHAPE * MIN_SHAPE)).at_most(new_squared);
    let grown = old_squared.at_most(new_squared);
    (aligned | shapeless) & ((solid & !new_squared.at_most(zero)) | grown)
}
