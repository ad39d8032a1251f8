//! The weld: which wedges share a vertex, and the vertices' order along a Morton curve.
//!
//! Both come from one sort. Equal positions have equal Morton codes, so after sorting the wedges
//! by code the duplicates stand side by side; and vertices numbered in that order are near in
//! memory when they are near in space, which is what the simplifier's speed depends on (Morton,
//! 1966, for the curve; three counting passes of 10 bits for the sort).

use super::Mesh;

/// Marks a wedge that no triangle refers to.
pub const NO_VERTEX: u32 = u32::MAX;

/// Vertices of a mesh: the classes of wedges with exactly equal positions within one part.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Weld {
    /// Vertex of each wedge, or [`NO_VERTEX`].
    pub vertex_of_wedge: Vec<u32>,
    /// The lowest-numbered wedge of each vertex; its length is the vertex count.
    pub wedge_of_vertex: Vec<u32>,
}

/// Finds the vertices of `mesh`, numbered along the Morton curve of each part's bounding cube.
/// Negative zero equals zero; otherwise equality is of bits. `O(n)` for any real model.
#[must_use]
pub fn weld(mesh: &Mesh) -> Weld {
    let mut referenced = vec![false; mesh.positions.len()];
    for &w in mesh.triangles.iter().flatten() {
        referenced[w as usize] = true;
    }
    let mut vertex_of_wedge = vec![NO_VERTEX; mesh.positions.len()];
    let mut wedge_of_vertex = Vec::with_capacity(mesh.positions.len());
    for part in 0..mesh.parts.len() {
        let wedges: Vec<u32> = mesh
            .wedge_sets
            .iter()
            .filter(|set| set.part == part)
            .flat_map(|set| set.wedges.clone())
            .filter(|&w| referenced[w])
            .map(|w| w as u32)
            .collect();
        weld_part(mesh, wedges, &mut vertex_of_wedge, &mut wedge_of_vertex);
    }
    Weld { vertex_of_wedge, wedge_of_vertex }
}

fn weld_part(mesh: &Mesh, wedges: Vec<u32>, vertex_of_wedge: &mut [u32], wedge_of_vertex: &mut Vec<u32>) {
    let key = |w: u32| mesh.positions[w as usize].map(|c| if c == 0.0 { 0 } else { c.to_bits() });
    let mut order = morton_sorted(&mesh.positions, wedges);
    let mut start = 0;
    while start < order.len() {
        let code = order[start].0;
        let mut end = start + 1;
        while end < order.len() && order[end].0 == code {
            end += 1;
        }
        let run = &mut order[start..end];
        if run.len() > 1 {
            // The code has 10 bits an axis, so near but different positions may share it.
            run.sort_unstable_by_key(|&(_, w)| (key(w), w));
        }
        let mut previous = None;
        for &(_, w) in run.iter() {
            let position = key(w);
            if previous != Some(position) {
                wedge_of_vertex.push(w);
                previous = Some(position);
            }
            vertex_of_wedge[w as usize] = wedge_of_vertex.len() as u32 - 1;
        }
        start = end;
    }
}

/// Pairs of Morton code and wedge, sorted by code and, within a code, by wedge.
fn morton_sorted(positions: &[[f32; 3]], wedges: Vec<u32>) -> Vec<(u32, u32)> {
    let (mut low, mut extent) = ([f64::INFINITY; 3], 0.0_f64);
    let mut high = [f64::NEG_INFINITY; 3];
    for &w in &wedges {
        for (axis, &c) in positions[w as usize].iter().enumerate() {
            // Comparisons, because `min` and `max` are calls in WebAssembly.
            let c = f64::from(c);
            low[axis] = if c < low[axis] { c } else { low[axis] };
            high[axis] = if c > high[axis] { c } else { high[axis] };
        }
    }
    for axis in 0..3 {
        extent = extent.max(high[axis] - low[axis]);
    }
    let cells = if extent > 0.0 { 1023.0 / extent } else { 0.0 };
    let mut pairs: Vec<(u32, u32)> = wedges
        .into_iter()
        .map(|w| {
            let p = positions[w as usize];
            let cell = |axis: usize| ((f64::from(p[axis]) - low[axis]) * cells) as u32;
            (spread(cell(0)) | spread(cell(1)) << 1 | spread(cell(2)) << 2, w)
        })
        .collect();
    let mut other = vec![(0, 0); pairs.len()];
    for pass in 0..3 {
        let digit = |code: u32| (code >> (10 * pass)) as usize & 1023;
        let mut starts = [0_usize; 1024];
        for &(code, _) in &pairs {
            starts[digit(code)] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += std::mem::replace(start, sum);
        }
        for &pair in &pairs {
            let slot = &mut starts[digit(pair.0)];
            other[*slot] = pair;
            *slot += 1;
        }
        std::mem::swap(&mut pairs, &mut other);
    }
    pairs
}

/// Spreads the low 10 bits to every third bit.
fn spread(v: u32) -> u32 {
    let v = v & 0x3ff;
    let v = (v | v << 16) & 0x0300_00ff;
    let v = (v | v << 8) & 0x0300_f00f;
    let v = (v | v << 4) & 0x030c_30c3;
    (v | v << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_positions_share_a_vertex_and_minus_zero_is_zero() {
        let positions =
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [9.0; 3]];
        let mesh = Mesh::from_arrays(positions, vec![[0, 1, 2], [3, 4, 1]], vec![]);
        let weld = weld(&mesh);
        assert_eq!(weld.wedge_of_vertex.len(), 4);
        assert_eq!(weld.vertex_of_wedge[0], weld.vertex_of_wedge[3]);
        assert_eq!(weld.wedge_of_vertex[weld.vertex_of_wedge[3] as usize], 0, "named by the lowest wedge");
        assert_eq!(weld.vertex_of_wedge[5], NO_VERTEX, "unreferenced");
    }

    #[test]
    fn near_positions_in_one_cell_stay_apart() {
        let near = 1.0 + f32::EPSILON;
        let positions = vec![[1.0, 0.0, 0.0], [near, 0.0, 0.0], [1000.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        let mesh = Mesh::from_arrays(positions, vec![[0, 1, 2], [3, 2, 1]], vec![]);
        let weld = weld(&mesh);
        assert_eq!(weld.wedge_of_vertex.len(), 3);
        assert_eq!(weld.vertex_of_wedge[0], weld.vertex_of_wedge[3]);
        assert_ne!(weld.vertex_of_wedge[0], weld.vertex_of_wedge[1]);
    }
}
