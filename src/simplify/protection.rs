//! Protection: weights that make the collapses at a vertex dear, and vertices that are locked.
//!
//! A weight does not bend the quadrics: positions and the estimated error are those of an unweighted run, only the
//! order is another. Garland (1999, section 3.4) and the painted weights of later tools scale the quadric instead,
//! which a memoryless one would have forgotten after the next collapse.

use super::vertex_kind::VertexKind;
use super::{Simplifier, SimplifyOptions};
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;
use crate::mesh::weld::NO_VERTEX;

/// Above this a weight makes no difference any more; far beyond, costs would leave what thresholds can reach.
const MOST: f32 = 1e6;

/// What the cost of a collapse at each vertex is multiplied by; empty without weights.
#[derive(Debug, Default)]
pub(super) struct Protection {
    factors: Vec<f32>,
}

impl Protection {
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.factors.is_empty()
    }

    /// Of the edge between two vertices: that of the dearer end.
    pub(super) fn factor(&self, v: u32, w: u32) -> f32 {
        let at = |v: u32| self.factors.get(v as usize).copied().unwrap_or(1.0);
        at(v).max(at(w))
    }

    /// `from` went into `into`, which stands for both.
    pub(super) fn merge(&mut self, from: u32, into: u32) {
        let factor = self.factor(from, into);
        if let Some(own) = self.factors.get_mut(into as usize) {
            *own = factor;
        }
    }
}

/// Checks the weights and locks of `options` against the mesh they are for.
pub(super) fn check(mesh: &Mesh, options: &SimplifyOptions) -> Result<(), Error> {
    let count = mesh.positions.len();
    for (place, length) in [("weights", options.weights.len()), ("locked", options.locked.len())] {
        if length != 0 && length != count {
            let message = format!("must have one value for each of the {count} vertices, not {length}");
            return Err(Error::new(ErrorCode::InvalidArgument, place, message));
        }
    }
    if let Some(at) = options.weights.iter().position(|w| !(w.is_finite() && *w >= 0.0)) {
        let code = if options.weights[at] < 0.0 { ErrorCode::InvalidArgument } else { ErrorCode::NotFinite };
        return Err(Error::new(code, format!("weights[{at}]"), "must be a finite number of at least 0"));
    }
    Ok(())
}

impl Simplifier {
    /// Gives the vertices their weights and locks, once their kinds and first keys are known. What several wedges of a
    /// vertex have is the most of it.
    #[inline(never)]
    pub(super) fn protect(&mut self) {
        let (weights, locked) = (std::mem::take(&mut self.options.weights), std::mem::take(&mut self.options.locked));
        if weights.is_empty() && locked.is_empty() {
            return;
        }
        let mut vertex_of_name = vec![NO_VERTEX; self.vertex_of_wedge.len()];
        for (&wedge, v) in self.wedge_of_vertex.iter().zip(0..) {
            vertex_of_name[wedge as usize] = v;
        }
        let vertex = |wedge: usize| {
            let name = self.vertex_of_wedge[wedge];
            vertex_of_name.get(name as usize).map(|&v| v as usize)
        };
        let mut factors = vec![1.0_f32; if weights.iter().any(|&w| w > 0.0) { self.wedge_of_vertex.len() } else { 0 }];
        if !factors.is_empty() {
            for (wedge, weight) in weights.iter().enumerate() {
                if let Some(v) = vertex(wedge) {
                    factors[v] = factors[v].max((1.0 + weight).min(MOST));
                }
            }
            for (key, factor) in self.keys.iter_mut().zip(&factors) {
                *key *= factor;
            }
        }
        self.protection = Protection { factors };
        for (wedge, _) in locked.iter().enumerate().filter(|(_, locked)| **locked) {
            if let Some(v) = vertex(wedge) {
                self.topology.vertices[v].kind = VertexKind::Locked;
            }
        }
    }
}
