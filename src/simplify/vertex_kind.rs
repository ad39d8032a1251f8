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

use super::topology::{Form, NONE, RingBuilder};

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

/// The kind of a vertex with the given ring, and its neighbours along its polyline.
/// `is_seam(i, j, w)` says whether the edge to `w` between the corners `i` and `j` is a seam edge.
pub(super) fn classify(
    form: Form,
    built: &RingBuilder,
    lock_border: bool,
    is_seam: impl Fn(u32, u32, u32) -> bool,
) -> (VertexKind, Polyline) {
    let (ring, order) = (&built.ring, &built.order);
    if form == Form::Parts || ring.is_empty() {
        return (VertexKind::Complex, [NONE; 2]);
    }
    let mut seam = [NONE; 2];
    let mut seam_count = 0;
    let mut before = if form == Form::Closed { order[order.len() - 1] } else { NONE };
    for (&neighbour, &after) in ring.iter().zip(order) {
        if before != NONE && after != NONE && is_seam(before, after, neighbour) {
            if seam_count < 2 {
                seam[seam_count] = neighbour;
            }
            seam_count += 1;
        }
        before = after;
    }
    match (form, seam_count) {
        (Form::Closed, 0) => (VertexKind::Manifold, [NONE; 2]),
        (Form::Closed, 2) => (VertexKind::Seam, seam),
        (Form::Open, 0) if !lock_border => (VertexKind::Border, [ring[0], ring[ring.len() - 1]]),
        _ => (VertexKind::Complex, [NONE; 2]),
    }
}
