//! The next experiment as a plan that the touch wizard can run.

use plumbline_model::touch_plan::{Finger, Pattern, PlanOptions, Purpose, Sides, TouchArea};

use super::menu::{BLOCKS_M, WEIGHT_KG};
use crate::finding::{Experiment, NextExperiment};

/// What to touch for an experiment; `None` for those that are no matter of which touches are made
/// (speed, posture, eyes), which the operator arranges.
///
/// The plan holds the condition that is known and the new one, so that both are measured with the
/// screen in one place. Make it with [`plumbline_model::touch_plan::TouchPlan::make`].
pub fn plan_for(next: &NextExperiment, finger: Finger, area: TouchArea) -> Option<PlanOptions> {
    let plain = PlanOptions {
        area,
        patterns: vec![],
        repeats: 1,
        sides: Sides::Above,
        screen_heights_m: vec![0.0],
        payloads_kg: vec![0.0],
        seed: 1,
        purpose: Purpose::Train,
        finger,
        beside_described: false,
    };
    let grid = |times: usize| {
        let places = next.count.div_ceil(times).max(2);
        vec![Pattern::Grid { columns: places.div_ceil(2), rows: 2 }]
    };
    let heights: Vec<f64> = std::iter::once(0.0).chain(BLOCKS_M).collect();
    Some(match next.kind {
        Experiment::OtherSide => PlanOptions { patterns: grid(2), sides: Sides::LeftAndRight, ..plain },
        Experiment::Weight => PlanOptions { patterns: grid(2), payloads_kg: vec![0.0, WEIGHT_KG], ..plain },
        Experiment::RaisedScreen => {
            PlanOptions { patterns: grid(heights.len()), screen_heights_m: heights, ..plain }
        }
        Experiment::Repeats => PlanOptions { patterns: grid(3), repeats: 3, ..plain },
        Experiment::MorePlaces => {
            PlanOptions { patterns: vec![Pattern::Random { count: next.count.max(1) }], ..plain }
        }
        _ => return None,
    })
}
