//! One level of a mesh without seams and attributes: each vertex asks the history once.
//!
//! Going through the collapses from the last to the first, the ancestor of every vertex that vanishes
//! is known when it is met, and the first position met of a vertex that stays is its last.

use super::LevelMesh;
use super::segment::Source;
use crate::mesh::{Group, Mesh, WedgeSet};

/// Marks a vertex that stays, has moved and is done.
const PLACED: u8 = 1;
const IN_USE: u8 = 2;

/// The level after `count` collapses; `None` if the mesh has more to it than this can do.
pub(super) fn extract(source: &Source<'_>, count: usize) -> Option<LevelMesh> {
    let Source { mesh, sequence, plain } = *source;
    if !plain || mesh.wedge_sets.iter().any(|set| !set.attributes.is_empty()) {
        return None;
    }
    let mut ancestor: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let mut state = vec![0_u8; mesh.positions.len()];
    let mut moved = Vec::new();
    let mut place = |state: &mut [u8], v: u32, position: [f32; 3]| {
        if state[v as usize] & PLACED == 0 {
            state[v as usize] |= PLACED;
            moved.push((v, position));
        }
    };
    if count == sequence.collapses.len() {
        for &(v, position) in &sequence.fitted {
            place(&mut state, v, position);
        }
    }
    for collapse in sequence.collapses[..count].iter().rev() {
        let into = ancestor[collapse.into as usize];
        ancestor[collapse.from as usize] = into;
        if into == collapse.into {
            place(&mut state, into, collapse.position);
        }
    }

    let mut out = Mesh { parts: mesh.parts.clone(), ..Mesh::default() };
    out.triangles.reserve_exact(sequence.triangle_counts.after(count));
    for group in &mesh.groups {
        let start = out.triangles.len();
        for t in &mesh.triangles[group.triangles.clone()] {
            let [a, b, c] = t.map(|w| ancestor[w as usize]);
            if (a != b) & (b != c) & (c != a) {
                out.triangles.push([a, b, c]);
                for w in [a, b, c] {
                    state[w as usize] |= IN_USE;
                }
            }
        }
        out.groups.push(Group { triangles: start..out.triangles.len(), wedge_set: group.wedge_set });
    }
    let mut wedge_map = Vec::new();
    // What was the ancestor becomes the place in the level.
    let mut new_index = ancestor;
    for set in &mesh.wedge_sets {
        let start = wedge_map.len();
        for w in set.wedges.clone().filter(|&w| state[w] & IN_USE != 0) {
            new_index[w] = wedge_map.len() as u32;
            wedge_map.push(w as u32);
        }
        out.wedge_sets.push(WedgeSet { wedges: start..wedge_map.len(), part: set.part, attributes: Vec::new() });
    }
    out.positions = wedge_map.iter().map(|&w| mesh.positions[w as usize]).collect();
    for (v, position) in moved {
        // One that did not move keeps its own bits: the sign of a zero.
        if state[v as usize] & IN_USE != 0 && mesh.positions[v as usize] != position {
            out.positions[new_index[v as usize] as usize] = position;
        }
    }
    for index in out.triangles.as_flattened_mut() {
        *index = new_index[*index as usize];
    }
    let error = count.checked_sub(1).map_or(0.0, |last| sequence.collapses[last].error);
    Some(LevelMesh { mesh: out, wedge_map, error })
}
