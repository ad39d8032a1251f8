//! Legality: which collapses keep the surface a surface, and its triangles upright.

use super::lanes::{Lanes, Lanes3, WIDTH};
use super::topology::{FanTriangle, Topology};

/// Smallest cosine between a triangle's normal before and after: about 78°. Smaller values let
/// folds through on noisy scans, larger ones block collapses that flatten noise.
const MIN_NORMAL_COSINE: f32 = 0.2;

/// Smallest ratio of twice the area to the longest edge squared; below it a triangle counts as
/// degenerate and may not be made. Far above `f32`'s rounding, far below any visible sliver.
const MIN_SHAPE: f32 = 1e-4;

/// Fans longer than this together are not merged: keeps the worst case (the apex of a cone with a
/// million sides) away from quadratic time.
const MAX_FAN: usize = 2048;

/// Why a collapse was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It would change the topology: the link condition fails.
    Topology,
    /// A triangle would turn over or become degenerate.
    Flip,
}

/// The link condition (Dey, Edelsbrunner, Guha & Nekhayev 1999) for the edge between `u` and `v`
/// with the given fans: the vertices that both see are just the ones opposite the edge, and
/// no edge lies in both links. `epoch` is advanced.
pub(super) fn check_link(
    topology: &mut Topology,
    (u, fan_u): (u32, &[FanTriangle]),
    (v, fan_v): (u32, &[FanTriangle]),
    epoch: &mut u32,
) -> Result<(), Refusal> {
    if fan_u.len() + fan_v.len() > MAX_FAN {
        return Err(Refusal::Topology);
    }
    *epoch += 2;
    let (seen, counted) = (*epoch, *epoch + 1);
    let mut opposite = [u32::MAX; 2];
    let mut shared = 0;
    for t in fan_u {
        for (w, other) in [(t.next, t.previous), (t.previous, t.next)] {
            if w == v {
                if shared == 2 {
                    return Err(Refusal::Topology);
                }
                opposite[shared] = other;
                shared += 1;
            } else {
                topology.vertices[w as usize].mark = seen;
            }
        }
    }
    let mut common = 0;
    for t in fan_v {
        for w in [t.next, t.previous] {
            if w != u && topology.vertices[w as usize].mark == seen {
                topology.vertices[w as usize].mark = counted;
                common += 1;
            }
        }
    }
    // At least one triangle stays, so that no part of the model vanishes.
    if shared == 0 || common != shared || fan_u.len() + fan_v.len() == 2 * shared {
        return Err(Refusal::Topology);
    }
    let spans =
        |fan: &[FanTriangle]| fan.iter().any(|t| [t.next, t.previous] == opposite || [t.previous, t.next] == opposite);
    if shared == 2 && spans(fan_u) && spans(fan_v) {
        return Err(Refusal::Topology);
    }
    Ok(())
}

/// Whether triangles with area vectors `old` may all become ones with area vectors `new` and
/// longest edges squared `longest_squared`. A triangle without a direction has none to keep.
#[inline(always)]
pub(super) fn keep_upright(old: Lanes3, new: Lanes3, longest_squared: Lanes) -> bool {
    let zero = Lanes::splat(0.0);
    let (old_squared, new_squared) = (old.dot(old), new.dot(new));
    let cosine = old.dot(new);
    let least = Lanes::splat(MIN_NORMAL_COSINE * MIN_NORMAL_COSINE) * old_squared * new_squared;
    let (turned, aligned) = (cosine.at_most(zero), least.at_most(cosine * cosine));
    let shapeless = old_squared.at_most(zero);
    let solid = (longest_squared * longest_squared * Lanes::splat(MIN_SHAPE * MIN_SHAPE)).at_most(new_squared);
    let vanished = new_squared.at_most(zero);
    let grown = old_squared.at_most(new_squared);
    let mut all = u32::MAX;
    for k in 0..WIDTH {
        let upright = (!turned[k] & aligned[k]) | shapeless[k];
        let shaped = (solid[k] & !vanished[k]) | grown[k];
        all &= upright & shaped;
    }
    all != 0
}
