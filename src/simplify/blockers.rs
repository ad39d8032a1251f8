//! What blocks the edges that are left when a run ends above its target: looked at once, when it is over.
//!
//! The sweep itself counts nothing. When no collapse is left, every remaining edge is evaluated as in the
//! sweep and inspected without being done; the first thing that stands against it is counted.

use std::ops::Range;

use super::Simplifier;
use super::legality::Refusal;
use super::topology::NONE;
use super::vertex_kind::{Freedom, VertexKind};
use crate::collapse_sequence::Blockers;

impl Simplifier {
    /// Counts the edges from the vertices in the range to those after them. Returns the work done.
    pub(super) fn count_blockers(&mut self, range: Range<usize>) -> usize {
        let mut work = 0;
        let mut neighbours: Vec<u32> = Vec::new();
        for v in range {
            let v = v as u32;
            self.topology.refresh(v, &mut self.patch.builder);
            neighbours.clear();
            neighbours.extend(self.topology.ring(v).iter().filter(|&&w| w != NONE && w > v));
            neighbours.sort_unstable();
            neighbours.dedup();
            if neighbours.is_empty() {
                continue;
            }
            work += 2 + neighbours.len();
            self.edges.list(
                &self.topology,
                &self.polylines,
                self.attributes.as_ref(),
                self.options.placement,
                self.last_resort,
                v,
            );
            let edges: Vec<_> = self.edges.iter().collect();
            for &w in &neighbours {
                // An edge may be there once for each of its ends; it is free if one of them is.
                let mut refusal = None;
                for edge in edges.iter().filter(|edge| edge.neighbour == w) {
                    let (into, from) = if edge.freedom == Freedom::AtSecond { (w, v) } else { (v, w) };
                    let found = if edge.placement.cost < f32::INFINITY {
                        self.inspect(from, into, edge.placement).err()
                    } else {
                        Some(Refusal::Flip)
                    };
                    refusal = Some(found);
                    if found.is_none() {
                        break;
                    }
                }
                let kind = |v: u32| self.topology.vertices[v as usize].kind;
                let kind = kind(v).max(kind(w));
                let count = counter(&mut self.blockers, refusal, kind);
                *count += 1;
            }
        }
        work
    }
}

/// The count that an edge belongs to: by its refusal, or by its more bound end if the kinds of its ends or their lines
/// forbid it. `None`: the kinds allow nothing; `Some(None)`: nothing was found against it.
fn counter(blockers: &mut Blockers, refusal: Option<Option<Refusal>>, kind: VertexKind) -> &mut usize {
    match refusal {
        Some(Some(Refusal::Topology)) => &mut blockers.topology,
        Some(Some(Refusal::Flip)) => &mut blockers.flip,
        Some(Some(Refusal::Error)) => &mut blockers.error,
        Some(None) => &mut blockers.other,
        None | Some(Some(Refusal::Lines)) => match kind {
            VertexKind::Manifold => &mut blockers.topology,
            VertexKind::Border => &mut blockers.border,
            VertexKind::Seam => &mut blockers.seam,
            VertexKind::Corner => &mut blockers.corner,
            VertexKind::NonManifold => &mut blockers.non_manifold,
            VertexKind::Locked => &mut blockers.locked,
        },
    }
}
