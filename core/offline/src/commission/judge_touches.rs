//! Judges a commissioned twin by how far new touches miss.

use std::sync::Arc;

use plumbline_correction::train::FEWEST_FOR_A_NETWORK;
use plumbline_correction::{CorrectionModel, Method};
use plumbline_engine::models::learn::{learn, options};
use plumbline_engine::models::losses::Losses;
use plumbline_engine::motion::{ScreenPlace, Wanted};
use plumbline_engine::touch::plan::{Aim, Corrector, PlanRequest, TIP, make};
use plumbline_engine::touch::store;
use plumbline_model::robot::Rig;
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::{Finger, Pattern, PlanOptions, Purpose, Sides, TouchArea};
use plumbline_model::{JobContext, Pixel};

use super::error::CommissionError;
use super::judged::TouchError;
use super::lab::Lab;
use super::plan::area;
use super::robot::Robot;
use super::touches::{Depths, rms, session};

/// New touches inside and outside.
const CHECKED: usize = 12;
/// So many are planned, so that there are enough of both kinds.
const DRAWN: usize = 96;

/// Touches new places, corrected by what was accepted, inside and outside of what was touched before; and the
/// same with M3 from the same touches.
pub(super) fn touches(
    lab: &Lab,
    robot: &mut Robot,
    context: &dyn JobContext,
) -> Result<TouchError, CommissionError> {
    let rig = lab.rig_with_screen()?;
    let corrector =
        if lab.model()?.is_nominal() { Corrector::None } else { Corrector::Effects(Arc::new(lab.known()?)) };
    let aims = new_aims(lab, &rig, corrector, context)?;
    let [inside, outside] = missed_mm(lab, robot, &rig, &aims, (0.6, context))?;
    let by_m3 = match m3(lab, &rig, context)? {
        Some(m3) => {
            let aims = new_aims(lab, &rig, Corrector::Model(m3), context)?;
            missed_mm(lab, robot, &rig, &aims, (0.8, context))?
        }
        None => [vec![], vec![]],
    };
    let uncorrected = uncorrected(lab, robot, &aims)?;
    Ok(TouchError {
        inside: rms(&inside),
        outside: rms(&outside),
        inside_mean: mean(&inside),
        outside_mean: mean(&outside),
        inside_touches: inside.len(),
        outside_touches: outside.len(),
        m3_inside: rms(&by_m3[0]),
        m3_outside: rms(&by_m3[1]),
        uncorrected,
    })
}

/// How far touches miss inside and outside of what was touched before, mm.
fn missed_mm(
    lab: &Lab,
    robot: &mut Robot,
    rig: &Arc<Rig>,
    aims: &[Aim],
    (begin, context): (f64, &dyn JobContext),
) -> Result<[Vec<f64>; 2], CommissionError> {
    let stored = store::read(&session(lab))?;
    let touched: Vec<Pixel<Screen>> = stored.progress.counted().map(|record| record.touched).collect();
    let mut depths = Depths::new(rig, ScreenPlace::Measured)?;
    let mut errors = [vec![], vec![]];
    for aim in aims {
        context.checkpoint()?;
        let side = usize::from(!is_among(aim.touch.target, &touched));
        if errors[side].len() == CHECKED {
            continue;
        }
        let done = (errors[0].len() + errors[1].len()) as f64 / (2 * CHECKED) as f64;
        context.report(begin + 0.2 * done, "judging where new touches land");
        if let Ok(measured) = depths.touch(robot, &aim.wanted()) {
            errors[side].push(miss_mm(rig, measured.pixel, aim.touch.target));
        }
    }
    Ok(errors)
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The best published model without feedback, learned from the touches of the commissioning; `None`: they are
/// too few for it.
fn m3(
    lab: &Lab,
    rig: &Arc<Rig>,
    context: &dyn JobContext,
) -> Result<Option<Arc<CorrectionModel>>, CommissionError> {
    let folder = session(lab);
    if store::read(&folder)?.progress.counted().count() < FEWEST_FOR_A_NETWORK {
        return Ok(None);
    }
    let how = options(&folder, rig, lab.seed, false);
    let trained = learn(&folder, rig, &[Method::M3], &how, &Losses::default(), context)?;
    Ok(trained.models.into_iter().next())
}

/// Random targets that can be reached, with the points that are sent for them.
fn new_aims(
    lab: &Lab,
    rig: &Arc<Rig>,
    corrector: Corrector,
    context: &dyn JobContext,
) -> Result<Vec<Aim>, CommissionError> {
    let whole = TouchArea::reached_by(rig, TIP)?.map_or_else(|| area(rig), Ok)?;
    let options = PlanOptions {
        area: whole,
        patterns: vec![Pattern::Random { count: DRAWN }],
        repeats: 1,
        sides: Sides::Above,
        screen_heights_m: vec![0.0],
        payloads_kg: vec![0.0],
        // Not the commissioning's own chance.
        seed: lab.seed.wrapping_add(1000),
        purpose: Purpose::Check,
        finger: Finger::Right,
        beside_described: false,
    };
    let request = PlanRequest { rig: rig.clone(), place: ScreenPlace::Measured, options, corrector };
    let plan = make(&request, context)?;
    Ok(plan.touches.into_iter().filter(|aim| aim.refusal.is_none()).collect())
}

/// The first of the new targets, sent as if nothing had been commissioned.
fn uncorrected(lab: &Lab, robot: &mut Robot, aims: &[Aim]) -> Result<Option<f64>, CommissionError> {
    let mut depths = Depths::new(&lab.rig, ScreenPlace::Nominal)?;
    let mut errors = vec![];
    for aim in aims.iter().take(CHECKED) {
        let sent = lab.rig.touchscreen.point_at(aim.touch.target);
        let met = depths.touch(robot, &Wanted::straight(aim.touch.target, sent, aim.touch.side));
        if let Ok(measured) = met {
            errors.push(miss_mm(&lab.rig, measured.pixel, aim.touch.target));
        }
    }
    Ok(rms(&errors))
}

fn miss_mm(rig: &Rig, touched: Pixel<Screen>, aimed: Pixel<Screen>) -> f64 {
    let [u_m, v_m] = rig.touchscreen.pitch_m();
    1e3 * ((touched.u_px - aimed.u_px) * u_m).hypot((touched.v_px - aimed.v_px) * v_m)
}

/// Whether a pixel lies inside the convex hull of others: every line through it has some on both sides.
fn is_among(pixel: Pixel<Screen>, others: &[Pixel<Screen>]) -> bool {
    let mut angles: Vec<f64> =
        others.iter().map(|other| (other.v_px - pixel.v_px).atan2(other.u_px - pixel.u_px)).collect();
    angles.sort_by(f64::total_cmp);
    let Some((first, last)) = angles.first().zip(angles.last()) else { return false };
    let around = first + std::f64::consts::TAU - last;
    angles.windows(2).map(|pair| pair[1] - pair[0]).fold(around, f64::max) < std::f64::consts::PI
}
