//! What JavaScript is told, as JSON text.

use serde::Serialize;

use crate::collapse_sequence::Blockers;
use crate::deviation::{AttributeDeviation, Deviation, SideDeviation};
use crate::error::Warning;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Summary<'a> {
    pub(super) format: &'a str,
    pub(super) bytes: usize,
    pub(super) triangles: usize,
    pub(super) vertices: usize,
    pub(super) meshes: usize,
    pub(super) diagonal: f64,
    pub(super) groups: Vec<GroupSummary<'a>>,
    pub(super) wedge_sets: Vec<WedgeSetSummary<'a>>,
    pub(super) warnings: Vec<WarningSummary<'a>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct GroupSummary<'a> {
    pub(super) mesh: usize,
    pub(super) primitive: usize,
    pub(super) object: Option<&'a str>,
    pub(super) material: Option<&'a str>,
    pub(super) wedge_set: usize,
}

#[derive(Serialize)]
pub(super) struct WedgeSetSummary<'a> {
    pub(super) vertices: usize,
    pub(super) attributes: Vec<AttributeSummary<'a>>,
}

#[derive(Serialize)]
pub(super) struct AttributeSummary<'a> {
    pub(super) name: &'a str,
    pub(super) components: usize,
}

#[derive(Serialize)]
pub(super) struct WarningSummary<'a> {
    pub(super) code: &'a str,
    pub(super) message: &'a str,
    #[serde(rename = "where")]
    pub(super) place: &'a str,
}

impl<'a> From<&'a Warning> for WarningSummary<'a> {
    fn from(warning: &'a Warning) -> Self {
        Self { code: warning.code, message: &warning.message, place: &warning.place }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct LevelSummary<'a> {
    pub(super) triangles: usize,
    pub(super) vertices: usize,
    pub(super) estimated_error: f32,
    pub(super) stop_reason: &'a str,
    /// What blocks the edges that are left; only at the end of a run that did not reach its target.
    pub(super) blockers: Option<BlockersSummary>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BlockersSummary {
    pub(super) seam: usize,
    pub(super) corner: usize,
    pub(super) border: usize,
    pub(super) non_manifold: usize,
    pub(super) locked: usize,
    pub(super) topology: usize,
    pub(super) flip: usize,
    pub(super) error: usize,
    pub(super) other: usize,
}

impl From<Blockers> for BlockersSummary {
    fn from(blockers: Blockers) -> Self {
        let Blockers { seam, corner, border, non_manifold, locked, topology, flip, error, other } = blockers;
        Self { seam, corner, border, non_manifold, locked, topology, flip, error, other }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct DeviationSummary {
    pub(super) max: f64,
    pub(super) mean: f64,
    pub(super) rms: f64,
    pub(super) relative_to: f64,
    pub(super) original_to_simplified: SideSummary,
    pub(super) simplified_to_original: SideSummary,
    #[serde(skip_serializing_if = "AttributesSummary::is_empty")]
    pub(super) attributes: AttributesSummary,
    /// With a map: how many values each wedge set of the level has in it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) map_lengths: Vec<usize>,
}

/// Of the attributes that there are.
#[derive(Serialize)]
pub(super) struct AttributesSummary {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) normal: Option<SpreadSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) uv: Option<SpreadSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) color: Option<SpreadSummary>,
}

impl AttributesSummary {
    fn is_empty(&self) -> bool {
        self.normal.is_none() && self.uv.is_none() && self.color.is_none()
    }
}

#[derive(Serialize)]
pub(super) struct SpreadSummary {
    pub(super) max: f64,
    pub(super) mean: f64,
    pub(super) rms: f64,
}

#[derive(Serialize)]
pub(super) struct SideSummary {
    pub(super) max: f64,
    pub(super) mean: f64,
    pub(super) rms: f64,
    pub(super) samples: u64,
}

impl From<&Deviation> for DeviationSummary {
    fn from(deviation: &Deviation) -> Self {
        let side = |SideDeviation { max, mean, rms, samples }| SideSummary { max, mean, rms, samples };
        let spread = |AttributeDeviation { max, mean, rms }| SpreadSummary { max, mean, rms };
        Self {
            max: deviation.max,
            mean: deviation.mean,
            rms: deviation.rms,
            relative_to: deviation.diagonal,
            original_to_simplified: side(deviation.original_to_simplified),
            simplified_to_original: side(deviation.simplified_to_original),
            attributes: AttributesSummary {
                normal: deviation.attributes.normal.map(spread),
                uv: deviation.attributes.texture.map(spread),
                color: deviation.attributes.color.map(spread),
            },
            map_lengths: Vec::new(),
        }
    }
}
