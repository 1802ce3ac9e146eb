//! How much of the screen is touched, and how often; which touches tell most is chosen as in the window.

use plumbline_engine::touch::plan::TIP;
use plumbline_model::robot::Rig;
use plumbline_model::touch_plan::TouchArea;

use super::error::CommissionError;

/// Places that are touched.
pub(super) const PLACES: usize = 22;
/// So many of them are touched twice, which tells the noise.
pub(super) const AGAIN: usize = 3;
/// Share of the reachable area that stays untouched at each side, so that the judge has places outside.
const MARGIN: f64 = 0.1;

/// The part of the screen that is touched.
pub(super) fn area(rig: &Rig) -> Result<TouchArea, CommissionError> {
    let reached = TouchArea::reached_by(rig, TIP)?.ok_or(CommissionError::TooFewTouches {
        touched: 0,
        planned: 0,
        example: "It reaches no part of it.".to_owned(),
    })?;
    let inner = |[low, high]: [f64; 2]| [low + MARGIN * (high - low), high - MARGIN * (high - low)];
    Ok(TouchArea { u_px: inner(reached.u_px), v_px: inner(reached.v_px) })
}
