//! Charts: wedges of one vertex that continue the same parametrisation.

use super::weld::NO_VERTEX;
use super::{Blend, Mesh};

/// The chart of each wedge: wedges of one vertex that agree in everything but the shading frame
/// share one, named by one of them.
pub(crate) fn charts(mesh: &Mesh, vertex_of_wedge: &[u32]) -> Vec<u32> {
    let mut chart: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    // The wedges that share a vertex with an earlier one, beside each other.
    let mut sharing: Vec<(u32, u32)> = vertex_of_wedge
        .iter()
        .enumerate()
        .filter(|&(w, &v)| v != NO_VERTEX && v as usize != w)
        .map(|(w, &v)| (v, w as u32))
        .collect();
    sharing.sort_unstable();
    let set_of = |w: u32| mesh.wedge_sets.partition_point(|s| s.wedges.end <= w as usize);
    let same = |a: u32, b: u32| {
        let set = set_of(a);
        set == set_of(b) && {
            let set = &mesh.wedge_sets[set];
            set.attributes.iter().filter(|x| !matches!(x.blend, Blend::Direction | Blend::Tangent)).all(|x| {
                let value = |w: u32| {
                    let at = (w as usize - set.wedges.start) * x.components;
                    &x.values[at..at + x.components]
                };
                value(a) == value(b)
            })
        }
    };
    for others in sharing.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(vertex, w)) in others.iter().enumerate() {
            let mut earlier = std::iter::once(vertex).chain(others[..i].iter().map(|o| o.1));
            if let Some(e) = earlier.find(|&e| same(e, w)) {
                chart[w as usize] = chart[e as usize];
            }
        }
    }
    chart
}
