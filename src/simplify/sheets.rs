//! Sheets: how many edges have more than two triangles, in the mesh as it was and as it is.
//!
//! Asked only when nothing else is left to do: a tangle may get new such edges, but not more than it had.

use super::topology::{NONE, Topology};
use crate::mesh::Mesh;
use crate::mesh::weld::NO_VERTEX;

/// How many edges of the mesh have more than two proper triangles. `O(n log n)`.
pub(super) fn edges_of_mesh(mesh: &Mesh, vertex_of_wedge: &[u32]) -> usize {
    let vertex = |w: u32| vertex_of_wedge.get(w as usize).copied().unwrap_or(NO_VERTEX);
    let mut sides = Vec::with_capacity(3 * mesh.triangles.len());
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(vertex);
        if a != b && b != c && c != a {
            sides.extend([(a, b), (b, c), (c, a)].map(|(a, b)| if a < b { (a, b) } else { (b, a) }));
        }
    }
    sides.sort_unstable();
    sides.chunk_by(|a, b| a == b).filter(|edge| edge.len() > 2).count()
}

/// The same of the rings as they are.
pub(super) fn edges_of_rings(topology: &Topology) -> usize {
    let (mut corners, mut others) = (Vec::new(), Vec::new());
    let mut count = 0;
    for v in (0..topology.vertices.len() as u32).filter(|&v| topology.vertices[v as usize].ring_length() > 0) {
        corners.clear();
        others.clear();
        topology.corners(v, &mut corners);
        others.extend(corners.iter().flat_map(|c| [c.next, c.previous]).filter(|&w| w > v && w != NONE));
        others.sort_unstable();
        count += others.chunk_by(|a, b| a == b).filter(|edge| edge.len() > 2).count();
    }
    count
}
