//! One part of a mesh as a surface: its triangles that have an area, ordered and in a tree.

use super::bvh::{Bvh, Ordering, diagonal};
use super::sampling::Walkway;
use super::triangle::area;
use crate::mesh::Mesh;

/// The triangles of one part, first as they came, then in the order of the tree over them.
#[derive(Debug, Default)]
pub(super) struct Surface {
    corners: Vec<[[f32; 3]; 3]>,
    wedges: Vec<[u32; 3]>,
    areas: Vec<f64>,
    reach: f32,
    stage: Stage,
    bvh: Bvh,
}

#[derive(Debug, Default)]
enum Stage {
    #[default]
    Gathered,
    Ordering(Ordering),
    Ordered,
    Built,
}

impl Surface {
    /// One surface for each part of `mesh`. Triangles without an area are no surface: nothing of
    /// them can be seen, and the simplifier drops them.
    pub(super) fn of_parts(mesh: &Mesh) -> Vec<Self> {
        let mut surfaces: Vec<Self> = Vec::new();
        surfaces.resize_with(mesh.parts.len(), Self::default);
        // Room for all at once: growing would copy everything several times over.
        let mut counts = vec![0; mesh.parts.len()];
        for group in &mesh.groups {
            counts[mesh.wedge_sets[group.wedge_set].part] += group.triangles.len();
        }
        for (surface, count) in surfaces.iter_mut().zip(counts) {
            surface.corners.reserve_exact(count);
            surface.wedges.reserve_exact(count);
        }
        for group in &mesh.groups {
            let surface = &mut surfaces[mesh.wedge_sets[group.wedge_set].part];
            for &wedges in &mesh.triangles[group.triangles.clone()] {
                let corners = wedges.map(|w| mesh.positions[w as usize]);
                if area(&corners) > 0.0 {
                    surface.reach = corners.iter().flatten().fold(surface.reach, |reach, c| reach.max(c.abs()));
                    surface.corners.push(corners);
                    surface.wedges.push(wedges);
                }
            }
        }
        surfaces
    }

    pub(super) fn is_empty(&self) -> bool {
        self.wedges.is_empty()
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.wedges.len()
    }

    /// The largest magnitude of a coordinate.
    pub(super) fn reach(&self) -> f32 {
        self.reach
    }

    /// Goes on building; returns how many triangles were handled, 0 when all is done. `reach` is
    /// that of the points that will be asked.
    pub(super) fn build_step(&mut self, reach: f32) -> usize {
        match &mut self.stage {
            _ if self.wedges.is_empty() => 0,
            Stage::Gathered => {
                self.stage = Stage::Ordering(Ordering::new(&self.corners));
                self.triangle_count()
            }
            Stage::Ordering(ordering) => {
                let handled = ordering.step();
                if handled > 0 {
                    return handled;
                }
                (self.corners, self.wedges) = ordering.order().map(|t| (self.corners[t], self.wedges[t])).unzip();
                self.stage = Stage::Ordered;
                self.triangle_count()
            }
            Stage::Ordered => {
                self.areas = self.corners.iter().map(area).collect();
                let reach = self.reach.max(reach);
                self.bvh = Bvh::new(std::mem::take(&mut self.corners), reach);
                self.stage = Stage::Built;
                self.triangle_count()
            }
            Stage::Built => 0,
        }
    }

    /// The tree; only once [`Surface::build_step`] has returned 0.
    pub(super) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The triangles for a walk; the same condition.
    pub(super) fn walkway(&self, scale: f64) -> Walkway<'_> {
        Walkway { corners: self.bvh.corners(), wedges: &self.wedges, areas: &self.areas, scale }
    }

    /// `sum` and then the area of each triangle in squared world units, added in their order.
    pub(super) fn add_area(&self, sum: f64, scale: f64) -> f64 {
        self.areas.iter().fold(sum, |sum, area| sum + area * scale * scale)
    }

    /// Of the bounding box, local units.
    pub(super) fn diagonal(&self) -> f64 {
        diagonal(self.bvh.corners())
    }
}
