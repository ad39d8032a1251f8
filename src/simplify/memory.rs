//! Memory: what a run will take at most, said before it starts from the counts alone.
//!
//! A trap for want of memory would cost its owner everything else in the instance. The counts decide nearly all: a
//! vertex takes 64 bytes and its ring 32, a triangle 24 while the rings are made, an entry of the record 24.

use super::SimplifyOptions;
use super::attribute_layout::Layout;
use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;

/// What no count explains: buffers of the loop, and what an allocator leaves between its blocks.
const OTHER_BYTES: f64 = 256.0 * 1024.0;

/// An estimate of the bytes that a run over `mesh` takes at its peak, beside the mesh itself: not less than that for any
/// surface, and at most one and a half times that for one whose vertices are shared. Triangles that share no vertices
/// are taken for a surface that was cut up; if they are none at all, the weld finds twice as many vertices and more.
#[must_use]
pub fn estimate_bytes(mesh: &Mesh, options: &SimplifyOptions) -> u64 {
    let (wedges, triangles) = (mesh.positions.len() as f64, mesh.triangles.len() as f64);
    // Of triangles that share no vertices a closed surface would have half as many, an open one a few more.
    let vertices = if wedges > 1.5 * triangles { wedges.min(0.55 * triangles + 64.0) } else { wedges };
    let has_wedges = wedges > vertices || mesh.wedge_sets.iter().any(|set| !set.attributes.is_empty());
    let several = |bytes: f64| if has_wedges { bytes } else { 0.0 };
    let valence = 3.0 * triangles / vertices.max(1.0);
    // Slots of rings: blocks of eight, and longer ones, the more the more triangles there are at a vertex.
    let slots = vertices * (10.0 + if valence > 7.0 { 2.5 * valence } else { 0.0 });
    let pool = slots * (4.0 + several(4.0));
    let names = 4.0 * wedges + 6.0 * vertices;
    let weld = 30.0 * wedges + 8.0 * vertices;
    let groups = if mesh.groups.len() > 1 { 4.0 * triangles } else { 0.0 };
    let prepared = names + 4.0 * vertices + triangles * (24.0 + several(12.0)) + groups + several(12.0 * wedges);
    let wanted = (mesh.triangles.len().saturating_sub(options.target_triangle_count) / 2 + 1) as f64;
    let record = 24.0 * vertices.min(wanted) + if options.every_level { 8.0 * vertices } else { 0.0 };
    let protection = if options.weights.is_empty() && options.locked.is_empty() { 0.0 } else { 9.0 * wedges };
    // Vertices, keys, what is left, what is to be visited, lines, and marks.
    let kept = (68.0 + 4.0 + 16.0 + 12.0 + several(16.0)) * vertices;
    // A pool that grows by an eighth is there twice in between; it seldom does so more than twice.
    let sweep = names + kept + pool + 1.4 * slots * 4.0 + record;
    let order = names + 2.2 * record;
    let left = options.target_triangle_count.max(1) as f64;
    let samples = triangles.min(left * options.preset.tuning().fit_samples as f64);
    let fit = names + 84.0 * vertices + 4.0 * wedges + 1.3 * pool + record + 4.0 * samples;
    let attributes = attribute_bytes(mesh, options, vertices, wanted);
    let pairs = if options.merge_distance > 0.0 { 96.0 * vertices } else { 0.0 };
    let most = weld.max(prepared + 72.0 * vertices + pool).max(sweep).max(order).max(fit);
    (1.05 * most + attributes + pairs + protection + OTHER_BYTES) as u64
}

/// Bytes of the attributes that count: by wedge a matrix and by number a value with its gradient, and in the record the
/// solved values, in a list that doubles.
fn attribute_bytes(mesh: &Mesh, options: &SimplifyOptions, vertices: f64, wanted: f64) -> f64 {
    let Some(layout) = Layout::new(mesh, &options.attribute_weights, |_| 1.0) else { return 0.0 };
    let (wedges, numbers) = (mesh.positions.len() as f64, layout.solved().components as f64);
    wedges * (16.0 * (numbers + 2.0) + 8.0) + 4.0 * vertices + 12.0 * numbers * wedges.min(1.4 * wanted)
}

/// `too-large` if the estimate is above the limit.
pub(super) fn check(mesh: &Mesh, options: &SimplifyOptions) -> Result<(), Error> {
    let needed = estimate_bytes(mesh, options);
    if needed <= options.memory_limit {
        return Ok(());
    }
    let megabytes = |bytes: u64| bytes.div_ceil(1_000_000);
    let message = format!(
        "simplifying {} vertices and {} triangles takes about {} MB of memory; {} MB are allowed",
        mesh.positions.len(),
        mesh.triangles.len(),
        megabytes(needed),
        options.memory_limit / 1_000_000
    );
    Err(Error::new(ErrorCode::TooLarge, "mesh", message))
}
