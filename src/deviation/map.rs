//! The measured distances as a map over the simplified surface: what a heat map is coloured by.

use super::triangle::{Point, wide};
use crate::mesh::Mesh;
use crate::mesh::weld::{NO_VERTEX, weld};

/// Distances by vertex of the simplified mesh, world units.
#[derive(Debug)]
pub(super) struct DistanceMap {
    vertex_of_wedge: Vec<u32>,
    at: Vec<f32>,
    around: Vec<f32>,
}

impl DistanceMap {
    /// Wedges at one place are one vertex: a seam does not show in the map.
    pub(super) fn new(simplified: &Mesh) -> Self {
        let weld = weld(simplified);
        let count = weld.wedge_of_vertex.len();
        Self { vertex_of_wedge: weld.vertex_of_wedge, at: vec![0.0; count], around: vec![0.0; count] }
    }

    /// The vertex of this wedge is so far from the original.
    pub(super) fn put(&mut self, wedge: u32, distance: f64) {
        if let Some(entry) = self.at.get_mut(self.vertex_of_wedge[wedge as usize] as usize) {
            *entry = distance as f32;
        }
    }

    /// At `point`, on or next to this triangle, the surfaces are so far apart: it counts for the nearest corner.
    pub(super) fn mark(&mut self, point: Point, corners: &[[f32; 3]; 3], wedges: &[u32; 3], distance: f64) {
        let squared = corners.map(|corner| {
            let corner = wide(corner);
            (0..3).map(|k| (corner[k] - point[k]).powi(2)).sum::<f64>()
        });
        let nearer = usize::from(squared[1] < squared[0]);
        let nearest = if squared[2] < squared[nearer] { 2 } else { nearer };
        if let Some(entry) = self.around.get_mut(self.vertex_of_wedge[wedges[nearest] as usize] as usize) {
            *entry = entry.max(distance as f32);
        }
    }

    /// For each wedge the distance at it and the largest around it, 0 for wedges without a triangle.
    pub(super) fn finish(self) -> (Vec<f32>, Vec<f32>) {
        let of = |values: &[f32]| -> Vec<f32> {
            let value = |&v: &u32| if v == NO_VERTEX { 0.0 } else { values[v as usize] };
            self.vertex_of_wedge.iter().map(value).collect()
        };
        (of(&self.at), of(&self.around))
    }
}
