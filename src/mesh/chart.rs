//! Which wedges of one vertex belong together: those that look the same in everything, and charts,
//! those that continue the same parametrisation.

use super::weld::NO_VERTEX;
use super::{Attribute, Blend, Mesh};

/// How far two directions may be apart that are told apart by nobody: a step of an 8-bit normal.
const SAME_DIRECTION: f32 = 1.0 / 256.0;

/// Wedges that equal an earlier one of their vertex in every attribute, each with the earliest such.
/// Directions may differ by the rounding of whoever wrote the file: wedges that part for so little
/// would go different ways. Wedges that no triangle with an area in the topology uses are left out.
pub(crate) fn duplicates(mesh: &Mesh, vertex_of_wedge: &[u32]) -> Vec<(u32, u32)> {
    let mut in_use = vec![false; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|w| vertex_of_wedge[w as usize]);
        if a != b && b != c && c != a {
            t.iter().for_each(|&w| in_use[w as usize] = true);
        }
    }
    let mut found = Vec::new();
    let all = |_: &&Attribute| true;
    for others in sharing(vertex_of_wedge).chunk_by(|a, b| a.0 == b.0) {
        let mut distinct: Vec<u32> = vec![others[0].0];
        distinct.retain(|&w| in_use[w as usize]);
        for &(_, w) in others.iter().filter(|o| in_use[o.1 as usize]) {
            match distinct.iter().find(|&&e| agree(mesh, e, w, all)) {
                Some(&e) => found.push((w, e)),
                None => distinct.push(w),
            }
        }
    }
    found
}

/// The wedges that share a vertex with an earlier one, as (vertex, wedge), beside each other.
fn sharing(vertex_of_wedge: &[u32]) -> Vec<(u32, u32)> {
    let mut sharing: Vec<(u32, u32)> =
        vertex_of_wedge.iter().zip(0..).filter(|&(&v, w)| v != NO_VERTEX && v != w).map(|(&v, w)| (v, w)).collect();
    sharing.sort_unstable();
    sharing
}

/// Whether two wedges are of one set and have the same values of those attributes that `counts` picks.
fn agree(mesh: &Mesh, a: u32, b: u32, counts: impl Fn(&&Attribute) -> bool) -> bool {
    let set_of = |w: u32| mesh.wedge_sets.partition_point(|s| s.wedges.end <= w as usize);
    let set = set_of(a);
    set == set_of(b) && {
        let set = &mesh.wedge_sets[set];
        set.attributes.iter().filter(counts).all(|x| {
            let value = |w: u32| {
                let at = (w as usize - set.wedges.start) * x.components;
                &x.values[at..at + x.components]
            };
            match x.blend {
                Blend::Direction | Blend::Tangent => {
                    value(a).iter().zip(value(b)).all(|(p, q)| (p - q).abs() <= SAME_DIRECTION)
                }
                _ => value(a) == value(b),
            }
        })
    }
}

/// The chart of each wedge: wedges of one vertex that agree in everything but the shading frame
/// share one, named by one of them.
pub(crate) fn charts(mesh: &Mesh, vertex_of_wedge: &[u32]) -> Vec<u32> {
    let mut chart: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let frame = |x: &&Attribute| !matches!(x.blend, Blend::Direction | Blend::Tangent);
    let same = |a: u32, b: u32| agree(mesh, a, b, frame);
    for others in sharing(vertex_of_wedge).chunk_by(|a, b| a.0 == b.0) {
        for (i, &(vertex, w)) in others.iter().enumerate() {
            let mut earlier = std::iter::once(vertex).chain(others[..i].iter().map(|o| o.1));
            if let Some(e) = earlier.find(|&e| same(e, w)) {
                chart[w as usize] = chart[e as usize];
            }
        }
    }
    chart
}
