//! Pruning: parts that the run has brought down to one triangle or one tetrahedron vanish.
//!
//! Every part shrinks by collapses like all else, until no legal one is left; what is left of a
//! small part is then about as large as the part was, and leaving it out is a deviation of that
//! size. So parts vanish in the order of their cost among all other collapses, and no component has
//! to be looked for.

use super::Simplifier;
use super::quadric::larger;
use super::topology::{Form, Topology};
use crate::mesh::Mesh;

impl Simplifier {
    /// Whether `v` belongs to a part of one triangle or one tetrahedron.
    pub(super) fn is_last_of_part(&self, v: u32) -> bool {
        let shape = |v: u32| {
            let vertex = &self.topology.vertices[v as usize];
            (vertex.form(), vertex.ring_length())
        };
        let own = shape(v);
        matches!(own, (Form::Open, 2) | (Form::Closed, 3)) && self.topology.ring(v).iter().all(|&w| shape(w) == own)
    }

    /// Visits a vertex of such a part: drops the part if that is cheap enough, but never the last
    /// one. Returns the work done.
    pub(super) fn visit_last_of_part(&mut self, mesh: &Mesh, v: u32) -> usize {
        let ring = self.topology.ring(v).to_vec();
        let tetrahedron = ring.len() == 3;
        let (area_squared, extent_squared) = measures(&self.topology, v, &ring);
        let dearest = ring.iter().map(|&w| self.protection.factor(v, w)).fold(1.0, larger);
        let area_squared = area_squared * dearest;
        if area_squared > self.threshold {
            self.keys[v as usize] = area_squared;
            return 2;
        }
        self.keys[v as usize] = f32::INFINITY;
        let all = [v].into_iter().chain(ring.iter().copied());
        let worst = all.clone().map(|w| self.topology.vertices[w as usize].error_squared).fold(0.0, larger);
        if worst + extent_squared > self.max_error_squared {
            self.blocked_by_error = true;
            return 2;
        }
        let triangles = if tetrahedron { 4 } else { 1 };
        if all.clone().any(|w| self.is_locked(w)) || self.topology.live_triangle_count <= triangles {
            return 2;
        }
        for &w in &ring {
            self.topology.replace_ring(w, Form::Closed, &[], &[]);
            self.keys[w as usize] = f32::INFINITY;
        }
        self.topology.set_ring(v, ring[0], Form::Closed, &[], &[]);
        self.topology.vertices[v as usize].error_squared = worst + extent_squared;
        self.patch.merges.clear();
        // The first collapse of a tetrahedron leaves two triangles on the same three vertices.
        for &from in &ring[..if tetrahedron { 2 } else { 1 }] {
            self.topology.live_triangle_count -= if tetrahedron { 2 } else { 1 };
            self.record.rank(from, v, &ring, area_squared);
            self.record_collapse(mesh, from, v);
        }
        self.pruned_count += 1;
        4
    }

    fn is_locked(&self, v: u32) -> bool {
        self.topology.vertices[v as usize].kind == super::vertex_kind::VertexKind::Locked
    }
}

/// The squared lengths of the area vectors, summed, and of the longest edge.
fn measures(topology: &Topology, v: u32, ring: &[u32]) -> (f32, f32) {
    let at = |w: u32| topology.vertices[w as usize].position();
    let mut points = vec![at(v)];
    points.extend(ring.iter().map(|&w| at(w)));
    let (mut area_squared, mut extent_squared) = (0.0, 0.0);
    for (i, &a) in points.iter().enumerate() {
        for (j, &b) in points[..i].iter().enumerate() {
            extent_squared = larger(extent_squared, (a - b).length_squared());
            for &c in &points[..j] {
                area_squared += (b - a).cross(c - a).length_squared();
            }
        }
    }
    (area_squared, extent_squared)
}
