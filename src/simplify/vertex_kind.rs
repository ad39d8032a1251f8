//! Vertex kinds, and which kinds of vertices may merge.
//!
//! | kind        | what it is                                             | why it matters |
//! |-------------|--------------------------------------------------------|----------------|
//! | Manifold    | one closed fan, no seam                                | moves freely |
//! | Border      | one open fan: two border edges, no seam                | the outline must keep its shape |
//! | Seam        | one closed fan crossed by a seam: two seam edges       | both sides must move together along the seam |
//! | Corner      | one fan, where seams meet, end, or reach a border      | a place that seams hang on; atlases of small charts have few others |
//! | NonManifold | several fans, or an edge of three triangles and more   | there is no surface to preserve, but the lines where sheets meet |
//! | Locked      | on a border that is to stay                            | neither moves nor vanishes |
//!
//! Fans are those of the *set* of triangles: one that is there twice, or turned against its
//! neighbours, makes no other kind of vertex.
//!
//! A *seam edge* is one whose two triangles disagree in the chart (texture coordinates, colours,
//! skin, material) at either end. A crease in the normals alone is no seam: its shape is in the
//! quadrics already, and its wedges follow their triangles. Border edges, seam edges and edges of
//! three triangles and more are the *lines* of a vertex.
//!
//! What may merge with what, and where the merged vertex may be:
//!
//! | from ↓ into → | Manifold | Border     | Seam       | Corner       | NonManifold  | Locked      |
//! |---------------|----------|------------|------------|--------------|--------------|-------------|
//! | Manifold      | anywhere | at `into`  | at `into`  | at `into`    | at `into`    | at `into`   |
//! | Border        | –        | anywhere ¹ | –          | at `into` ¹  | at `into` ¹  | at `into` ¹ |
//! | Seam          | –        | –          | anywhere ¹ | at `into` ¹  | at `into` ¹  | at `into` ¹ |
//! | Corner        | –        | –          | –          | at `into` ¹² | at `into` ¹² | –           |
//! | NonManifold   | –        | –          | –          | –            | anywhere ¹³  | –           |
//! | Locked        | –        | –          | –          | –            | –            | –           |
//!
//! ¹ only along a line of both: a chord would pinch the surface or the chart. The quadrics of the
//! lines keep "anywhere" near them.
//! ² the seams of `from` that do not lead to `into` are dragged along, and what was drawn beside
//! them is stretched. The quadrics of all lines of `from` make that as dear as it is far.
//! ³ when nothing else is left to do, along any edge, and Border, Seam and Corner into NonManifold too.

use super::topology::{Corner, Form, NONE, RingBuilder};

/// See the module. In ascending order of what the merged vertex of two is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(super) enum VertexKind {
    Manifold,
    Border,
    Seam,
    Corner,
    NonManifold,
    Locked,
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
    /// At one of the ends, which stays.
    AtEither,
    /// The edge may not be collapsed.
    Forbidden,
}

/// The table of the module, for the edge between two vertices; `along` says whether the edge is
/// a line of both; `last_resort` that nothing else is left to do.
#[inline(always)]
pub(super) fn freedom(first: VertexKind, second: VertexKind, last_resort: bool, along: impl Fn() -> bool) -> Freedom {
    use VertexKind::{Border, Corner, Locked, Manifold, NonManifold, Seam};
    match (first, second) {
        (Manifold, Manifold) => Freedom::Anywhere,
        (Manifold, _) => Freedom::AtSecond,
        (_, Manifold) => Freedom::AtFirst,
        (Border | Seam | Corner, NonManifold) if last_resort => Freedom::AtSecond,
        (NonManifold, Border | Seam | Corner) if last_resort => Freedom::AtFirst,
        (NonManifold, NonManifold) if last_resort => Freedom::Anywhere,
        _ if !along() => Freedom::Forbidden,
        (Border, Border) | (Seam, Seam) | (NonManifold, NonManifold) => Freedom::Anywhere,
        (Border | Seam, Corner | NonManifold | Locked) | (Corner, NonManifold) => Freedom::AtSecond,
        (Corner | NonManifold | Locked, Border | Seam) | (NonManifold, Corner) => Freedom::AtFirst,
        (Corner, Corner) => Freedom::AtEither,
        (Border, Seam) | (Seam, Border) | (Locked, _) | (_, Locked) => Freedom::Forbidden,
    }
}

/// Finds the kind of a vertex with the given triangles and their ring; `lines` receives the
/// neighbours along its lines. `is_seam(i, j, w)` says whether the edge to `w` between the corners
/// `i` and `j` is a seam edge.
pub(super) fn classify(
    form: Form,
    built: &RingBuilder,
    corners: &[Corner],
    lock_border: bool,
    is_seam: impl Fn(u32, u32, u32) -> bool,
    lines: &mut Vec<u32>,
) -> VertexKind {
    let (ring, order) = (&built.ring, &built.order);
    lines.clear();
    if ring.is_empty() {
        return VertexKind::Locked;
    }
    if form == Form::Parts {
        return classify_parts(corners, lock_border, is_seam, lines);
    }
    if form == Form::Open {
        lines.extend([ring[0], ring[ring.len() - 1]]);
    }
    let ends = lines.len();
    let mut before = if form == Form::Closed { order[order.len() - 1] } else { NONE };
    for (&neighbour, &after) in ring.iter().zip(order) {
        if before != NONE && after != NONE && is_seam(before, after, neighbour) {
            lines.push(neighbour);
        }
        before = after;
    }
    match (form, lines.len() - ends) {
        (Form::Open, _) if lock_border => VertexKind::Locked,
        (Form::Open, 0) => VertexKind::Border,
        (Form::Closed, 0) => VertexKind::Manifold,
        (Form::Closed, 2) => VertexKind::Seam,
        _ => VertexKind::Corner,
    }
}

/// As [`classify`], from the set of triangles: how often one is there, and which way it is turned,
/// does not matter.
fn classify_parts(
    corners: &[Corner],
    lock_border: bool,
    is_seam: impl Fn(u32, u32, u32) -> bool,
    lines: &mut Vec<u32>,
) -> VertexKind {
    // (neighbour, the triangle's other vertex, corner)
    let mut sides: Vec<(u32, u32, u32)> =
        corners.iter().zip(0..).flat_map(|(c, i)| [(c.next, c.previous, i), (c.previous, c.next, i)]).collect();
    sides.sort_unstable();
    let (mut border_edges, mut is_manifold, mut seams) = (0, true, 0);
    for edge in sides.chunk_by(|a, b| a.0 == b.0) {
        let neighbour = edge[0].0;
        let triangles = 1 + edge.windows(2).filter(|pair| pair[0].1 != pair[1].1).count();
        let seam = triangles == 2 && edge.windows(2).any(|pair| is_seam(pair[0].2, pair[1].2, neighbour));
        border_edges += usize::from(triangles == 1);
        is_manifold &= triangles <= 2;
        seams += usize::from(seam);
        if triangles != 2 || seam {
            lines.push(neighbour);
        }
    }
    if border_edges > 0 && lock_border {
        return VertexKind::Locked;
    }
    if !is_manifold || !is_one_fan(&sides) {
        return VertexKind::NonManifold;
    }
    match (border_edges, seams) {
        (0, 0) => VertexKind::Manifold,
        (0, 2) => VertexKind::Seam,
        (2, 0) => VertexKind::Border,
        _ => VertexKind::Corner,
    }
}

/// Whether a walk from triangle to triangle comes to every neighbour, if each has at most two.
fn is_one_fan(sides: &[(u32, u32, u32)]) -> bool {
    let other_sides = |w: u32| {
        let first = sides.partition_point(|s| s.0 < w);
        let run = &sides[first..];
        (run[0].1, run.iter().take_while(|s| s.0 == w).map(|s| s.1).max().unwrap_or(NONE))
    };
    let neighbours = sides.chunk_by(|a, b| a.0 == b.0).count();
    let start = sides.chunk_by(|a, b| a.0 == b.0).map(|e| e[0].0).find(|&w| {
        let (least, most) = other_sides(w);
        least == most
    });
    let start = start.unwrap_or(sides[0].0);
    let (mut before, mut at, mut seen) = (NONE, start, 0);
    loop {
        seen += 1;
        let (a, b) = other_sides(at);
        let next = if a == before { b } else { a };
        // A border, or around: a triangle that is there alone leads back where the walk came from.
        if next == before || next == start {
            return seen == neighbours;
        }
        (before, at) = (at, next);
    }
}
