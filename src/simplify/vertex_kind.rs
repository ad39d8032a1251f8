//! Vertex kinds, and which kinds of vertices may merge.
//!
//! | kind     | what it is                                        | why it matters |
//! |----------|---------------------------------------------------|----------------|
//! | Manifold | one closed fan, no seam                           | moves freely |
//! | Border   | one open fan: two border edges                    | the outline must keep its shape |
//! | Seam     | one closed fan crossed by a seam: two seam edges  | both sides must move together along the seam |
//! | Complex  | all else: corners of seams, non-manifold, locked  | stays where it is |
//!
//! A *seam edge* is one whose two triangles disagree in the chart (texture coordinates, colours,
//! skin, material) at either end. A crease in the normals alone is no seam: its shape is in the
//! quadrics already, and its wedges follow their triangles.
//!
//! What may merge with what, and where the merged vertex may be:
//!
//! | from ↓ into → | Manifold | Border     | Seam       | Complex    |
//! |---------------|----------|------------|------------|------------|
//! | Manifold      | anywhere | at `into`  | at `into`  | at `into`  |
//! | Border        | –        | anywhere ¹ | –          | at `into` ¹|
//! | Seam          | –        | –          | anywhere ¹ | at `into` ¹|
//! | Complex       | –        | –          | –          | –          |
//!
//! ¹ only along the border or seam itself: a chord would pinch the surface or the chart. The line
//! quadrics of the polyline keep "anywhere" near it.

use super::topology::{FanTriangle, Topology};

/// See the module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum VertexKind {
    Manifold,
    Border,
    Seam,
    Complex,
}

/// Where the vertex of a merged edge may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Freedom {
    /// Wherever the quadrics say; either end may vanish.
    Anywhere,
    /// At the first end, which stays.
    AtFirst,
    /// At the second end, which stays.
    AtSecond,
    /// The edge may not be collapsed.
    Forbidden,
}

/// The neighbours of a border or seam vertex along its polyline.
pub(super) type Polyline = [u32; 2];

/// No neighbour.
pub(super) const NONE: u32 = u32::MAX;

/// The table of the module, for the edge between two vertices; `along` says whether the edge is
/// part of the border or seam.
#[inline(always)]
pub(super) fn freedom(first: VertexKind, second: VertexKind, along: impl Fn() -> bool) -> Freedom {
    use VertexKind::{Border, Complex, Manifold, Seam};
    match (first, second) {
        (Manifold, Manifold) => Freedom::Anywhere,
        (Manifold, _) => Freedom::AtSecond,
        (_, Manifold) => Freedom::AtFirst,
        (Border, Border) | (Seam, Seam) if along() => Freedom::Anywhere,
        (Border | Seam, Complex) if along() => Freedom::AtSecond,
        (Complex, Border | Seam) if along() => Freedom::AtFirst,
        _ => Freedom::Forbidden,
    }
}

/// Finds the kind of every vertex. `is_seam(a, b, v, w)` says whether the edge from `v` to `w`
/// between the triangles `a` and `b` is a seam edge. Returns the polyline neighbours, empty when
/// every vertex is Manifold.
pub(super) fn classify(
    topology: &mut Topology,
    lock_border: bool,
    is_seam: impl Fn(u32, u32, u32, u32) -> bool,
) -> Vec<Polyline> {
    let count = topology.vertices.len();
    let mut polylines: Vec<Polyline> = Vec::new();
    let mut fan: Vec<FanTriangle> = Vec::new();
    // For the vertex whose turn it is: the fan triangle whose `next` / `previous` is a vertex.
    let mut leaving = vec![(NONE, 0_u32); count];
    let mut arriving = vec![NONE; count];
    for v in 0..count as u32 {
        topology.walk_fan(v, &mut fan);
        let mut manifold = true;
        for (i, t) in fan.iter().enumerate() {
            let out = &mut leaving[t.next as usize];
            manifold &= out.0 != v && arriving[t.previous as usize] != v;
            *out = (v, i as u32);
            arriving[t.previous as usize] = v;
        }
        let kind = if manifold {
            let opening = fan.iter().position(|t| arriving[t.next as usize] != v);
            let mut special = [NONE; 2];
            let mut seam_count = 0;
            let mut current = opening.unwrap_or(0);
            let mut steps = 0;
            let mut closing = NONE;
            while let Some(t) = fan.get(current) {
                steps += 1;
                let (stamp, following) = leaving[t.previous as usize];
                if stamp != v {
                    closing = t.previous;
                    break;
                }
                if is_seam(t.triangle, fan[following as usize].triangle, v, t.previous) {
                    if seam_count < 2 {
                        special[seam_count] = t.previous;
                    }
                    seam_count += 1;
                }
                current = following as usize;
                if steps == fan.len() {
                    break;
                }
            }
            let one_fan = steps == fan.len() && !fan.is_empty() && (opening.is_some() || current == 0);
            match (one_fan, opening, seam_count) {
                (true, None, 0) => VertexKind::Manifold,
                (true, None, 2) => {
                    set_polyline(&mut polylines, count, v, special);
                    VertexKind::Seam
                }
                (true, Some(first), 0) if !lock_border => {
                    set_polyline(&mut polylines, count, v, [fan[first].next, closing]);
                    VertexKind::Border
                }
                _ => VertexKind::Complex,
            }
        } else {
            VertexKind::Complex
        };
        topology.vertices[v as usize].kind = kind;
    }
    polylines
}

fn set_polyline(polylines: &mut Vec<Polyline>, count: usize, v: u32, ends: Polyline) {
    if polylines.is_empty() {
        polylines.resize(count, [NONE; 2]);
    }
    polylines[v as usize] = ends;
}
