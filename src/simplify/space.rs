//! Engine space: each part about its own centre, the whole model's diagonal 1.
//!
//! Nothing in the engine then depends on the file's unit of length or on the distance from the
//! origin, and errors of different parts compare as they do in the world.

use super::quadric::Vec3;
use crate::mesh::Mesh;

/// The space in which one part is simplified: local = centre + engine · `local_per_engine`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Space {
    centre: [f64; 3],
    local_per_engine: f64,
    engine_per_local: f64,
    pub(super) world_per_engine: f64,
}

impl Space {
    /// The space of each part, about the middle of the wedges that `is_used` names: others may be anywhere.
    pub(super) fn of_parts(mesh: &Mesh, world_per_engine: f64, is_used: impl Fn(usize) -> bool) -> Vec<Self> {
        let mut bounds = vec![([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]); mesh.parts.len()];
        for set in &mesh.wedge_sets {
            let (low, high) = &mut bounds[set.part];
            for (_, p) in set.wedges.clone().zip(&mesh.positions[set.wedges.clone()]).filter(|(w, _)| is_used(*w)) {
                for k in 0..3 {
                    // Comparisons, because `min` and `max` are calls in WebAssembly.
                    let c = f64::from(p[k]);
                    low[k] = if c < low[k] { c } else { low[k] };
                    high[k] = if c > high[k] { c } else { high[k] };
                }
            }
        }
        bounds
            .iter()
            .zip(&mesh.parts)
            .map(|((low, high), part)| {
                let local_per_engine = world_per_engine / f64::from(part.scale);
                Self {
                    centre: std::array::from_fn(|k| if low[k] <= high[k] { 0.5 * (low[k] + high[k]) } else { 0.0 }),
                    local_per_engine,
                    engine_per_local: 1.0 / local_per_engine,
                    world_per_engine,
                }
            })
            .collect()
    }

    pub(super) fn engine_per_local(self) -> f64 {
        self.engine_per_local
    }

    pub(super) fn to_engine(self, p: [f32; 3]) -> Vec3 {
        let coordinate = |k: usize| ((f64::from(p[k]) - self.centre[k]) * self.engine_per_local) as f32;
        Vec3 { x: coordinate(0), y: coordinate(1), z: coordinate(2) }
    }

    pub(super) fn to_local(self, e: Vec3) -> [f32; 3] {
        let local = |c: f32, k: usize| (self.centre[k] + f64::from(c) * self.local_per_engine) as f32;
        [local(e.x, 0), local(e.y, 1), local(e.z, 2)]
    }
}
