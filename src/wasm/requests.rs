//! What JavaScript asks for, as JSON text: read, checked, and made the engine's options.

use serde::Deserialize;

use crate::error::{Error, ErrorCode};
use crate::mesh::Mesh;
use crate::simplify::{AttributeWeights, PlacementRule, Preset, SimplifyOptions};

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(super) struct AttributeRequest {
    pub(super) name: String,
    pub(super) components: usize,
    pub(super) blend: String,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct WeightRequest {
    pub(super) normal: Option<f32>,
    pub(super) uv: Option<f32>,
    pub(super) color: Option<f32>,
    pub(super) morph: Option<f32>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
pub(super) struct SimplifyRequest {
    pub(super) triangles: Option<f64>,
    pub(super) ratio: Option<f64>,
    pub(super) error: Option<f64>,
    pub(super) error_relative: Option<f64>,
    pub(super) lock_border: bool,
    pub(super) prune: bool,
    pub(super) attribute_weights: WeightRequest,
    pub(super) placement: Option<String>,
    pub(super) preset: Option<String>,
    pub(super) every_level: bool,
    pub(super) keep_levels: bool,
    pub(super) index_levels: bool,
    /// Name of an attribute, as [`Mesh::channel`] takes it.
    pub(super) weight_attribute: Option<String>,
    pub(super) weight_scale: Option<f32>,
    /// World units.
    pub(super) merge_distance: f32,
    /// Bytes.
    pub(super) memory_limit: Option<f64>,
}

impl WeightRequest {
    fn weights(&self) -> AttributeWeights {
        let automatic = AttributeWeights::default();
        AttributeWeights {
            normal: self.normal.unwrap_or(automatic.normal),
            texture: self.uv.unwrap_or(automatic.texture),
            color: self.color.unwrap_or(automatic.color),
            morph: self.morph.unwrap_or(automatic.morph),
        }
    }
}

impl SimplifyRequest {
    pub(super) fn options(&self, mesh: &Mesh) -> Result<SimplifyOptions, Error> {
        let invalid = |place: &str, message: &str| Err(Error::new(ErrorCode::InvalidArgument, place, message));
        let mut targets: Vec<f64> = Vec::new();
        if let Some(triangles) = self.triangles {
            if !(triangles >= 0.0 && triangles.is_finite()) {
                return invalid("triangles", "must be a number of at least 0");
            }
            targets.push(triangles.floor());
        }
        if let Some(ratio) = self.ratio {
            if !(0.0..=1.0).contains(&ratio) {
                return invalid("ratio", "must be between 0 and 1");
            }
            targets.push((ratio * mesh.triangles.len() as f64).floor());
        }
        let mut max_error = f64::INFINITY;
        for (place, error) in [("error", self.error), ("errorRelative", self.error_relative)] {
            if let Some(error) = error {
                if error.is_nan() || error < 0.0 {
                    return invalid(place, "must be a number of at least 0");
                }
                // The diagonal takes a pass over all triangles.
                let unit = if place == "error" { 1.0 } else { mesh.diagonal() };
                max_error = max_error.min(error * unit);
            }
        }
        // Of several targets the first that is reached stops the run: the largest count.
        let target = targets.into_iter().fold(0.0, f64::max);
        let placement = match self.placement.as_deref() {
            None | Some("optimal") => PlacementRule::Optimal,
            Some("subset") => PlacementRule::Subset,
            Some(_) => return invalid("placement", "must be 'optimal' or 'subset'"),
        };
        let preset = match self.preset.as_deref() {
            Some("fast") => Preset::Fast,
            None | Some("balanced") => Preset::Balanced,
            Some("best") => Preset::Best,
            Some(_) => return invalid("preset", "must be 'fast', 'balanced' or 'best'"),
        };
        let mut weights = match &self.weight_attribute {
            Some(name) => mesh.channel(name)?,
            None => Vec::new(),
        };
        let scale = self.weight_scale.unwrap_or(1.0);
        if !(scale.is_finite() && scale >= 0.0) {
            return invalid("weightScale", "must be a finite number of at least 0");
        }
        weights.iter_mut().for_each(|weight| *weight *= scale);
        // What the model itself takes is there already. A sixteenth is left for results and what no count explains.
        let most = (u64::from(u32::MAX) / 16 * 15).saturating_sub(mesh.byte_count());
        Ok(SimplifyOptions {
            merge_distance: self.merge_distance,
            memory_limit: self.memory_limit.map_or(most, |limit| most.min(limit as u64)),
            weights,
            locked: Vec::new(),
            target_triangle_count: target as usize,
            max_error: max_error as f32,
            lock_border: self.lock_border,
            prune: self.prune,
            attribute_weights: self.attribute_weights.weights(),
            placement,
            preset,
            every_level: self.every_level,
        })
    }
}
