//! The measured deviation of the selected level, in steps.

use wasm_bindgen::prelude::*;

use super::summaries::DeviationSummary;
use super::{Model, thrown, to_json};
use crate::deviation::{DeviationMeter, DeviationOptions};
use crate::error::{Error, ErrorCode};

/// More would take hours and change nothing.
const MOST_SAMPLES: f64 = 1e9;

/// A measurement under way.
pub(super) struct Measuring {
    meter: DeviationMeter,
    /// As in [`DeviationSummary`].
    map_lengths: Vec<usize>,
}

#[wasm_bindgen]
impl Model {
    /// Prepares a measurement of the selected level against the original, with so many samples on
    /// each side's faces and, if wanted, a map, in place of one that is running. Later changes of the level do not
    /// touch it.
    #[wasm_bindgen(js_name = beginMeasure)]
    pub fn begin_measure(&mut self, samples: Option<f64>, map: bool) -> Result<(), JsValue> {
        let mut options = DeviationOptions { simplified_map: map, ..DeviationOptions::default() };
        if let Some(samples) = samples {
            if !(1.0..=MOST_SAMPLES).contains(&samples) {
                return Err(thrown(Error::new(ErrorCode::InvalidArgument, "samples", "must be from 1 to 1e9")));
            }
            options.sample_count = samples as usize;
        }
        let level = self.level_mesh();
        let meter = DeviationMeter::new(self.mesh(), level, &options).map_err(thrown)?;
        let sets = level.wedge_sets.iter().filter(|_| map);
        self.measuring = Some(Measuring { meter, map_lengths: sets.map(|set| set.wedges.len()).collect() });
        Ok(())
    }

    /// Advances the measurement by about `work` samples. Returns the fraction done, 0 to 1; at 1
    /// [`Model::take_deviation`] has the result.
    #[wasm_bindgen(js_name = stepMeasure)]
    pub fn step_measure(&mut self, work: f64) -> Result<f32, JsValue> {
        let measuring = self.measuring.as_mut().ok_or_else(not_measuring)?;
        Ok(measuring.meter.step(work.clamp(1.0, 1e9) as usize).fraction)
    }

    /// The measurement's result as JSON, and the end of it.
    #[wasm_bindgen(js_name = takeDeviation)]
    pub fn take_deviation(&mut self) -> Result<String, JsValue> {
        let Measuring { meter, map_lengths } = self.measuring.take().ok_or_else(not_measuring)?;
        let mut deviation = meter.finish();
        let summary = DeviationSummary { map_lengths, ..DeviationSummary::from(&deviation) };
        self.map = std::mem::take(&mut deviation.simplified_distances);
        self.map.append(&mut deviation.simplified_surroundings);
        to_json(&summary)
    }

    /// The map of the measurement taken last, once: for all vertices of the measured level the distance at each, then
    /// for all of them the largest around each.
    #[wasm_bindgen(js_name = takeMap)]
    pub fn take_map(&mut self) -> js_sys::Float32Array {
        std::mem::take(&mut self.map).as_slice().into()
    }

    /// Drops a running measurement.
    #[wasm_bindgen(js_name = cancelMeasure)]
    pub fn cancel_measure(&mut self) {
        self.measuring = None;
    }
}

fn not_measuring() -> JsValue {
    thrown(Error::new(ErrorCode::WrongState, "measure", "begin first"))
}
