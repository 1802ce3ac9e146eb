//! Judges a commissioned twin: it alone reads what is hidden, after everything is done. Nothing that it
//! finds goes back into the commissioning.

use std::sync::Arc;

use plumbline_engine::motion::{Planner, ScreenPlace};
use plumbline_engine::touch::plan::{Aim, Corrector, PlanRequest, TIP, make};
use plumbline_engine::touch::store;
use plumbline_model::robot::Rig;
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::{Pattern, PlanOptions, Purpose, Sides, TouchArea};
use plumbline_model::{JobContext, Pixel};
use plumbline_twin::Toy;
use serde::{Deserialize, Serialize};

use super::error::CommissionError;
use super::lab::Lab;
use super::plan::area;
use super::robot::Robot;
use super::see::Seer;
use super::touches::{rms, session, touch};

/// Places of the published grid: along x, then along y, robot frame, m.
const GRID_X_M: [f64; 4] = [0.2, 0.3, 0.4, 0.5];
const GRID_Y_M: [f64; 9] = [-0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4];
/// New touches inside and outside.
const CHECKED: usize = 6;
/// So many are planned, so that there are enough of both kinds.
const DRAWN: usize = 48;
/// A toy that was put down comes to rest, s.
const REST_S: f64 = 0.8;

/// Median and 95 % of errors, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlaceError {
    /// Median of the distance in space.
    pub median: Option<f64>,
    /// 95 % of them lie below.
    pub p95: Option<f64>,
    /// Median of the distance along the table.
    pub plane_median: Option<f64>,
    /// 95 % of those lie below.
    pub plane_p95: Option<f64>,
    /// Mean error (found − true) along x, y, z.
    pub mean: Option<[f64; 3]>,
    /// Places where the object was found.
    pub found: usize,
    /// Places where it stood.
    pub places: usize,
}

/// Errors of new touches, touched − aimed along the glass, rms, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TouchError {
    /// Inside of the touched area.
    pub inside: Option<f64>,
    /// Outside of it.
    pub outside: Option<f64>,
    /// Touches inside.
    pub inside_touches: usize,
    /// Touches outside.
    pub outside_touches: usize,
    /// The same touches without any effect and with the nominal screen would have missed by, rms.
    pub uncorrected: Option<f64>,
}

/// Puts the tomato on the 36 places and compares where it is found with where it is.
pub(super) fn places(
    lab: &Lab,
    robot: &mut Robot,
    context: &dyn JobContext,
) -> Result<PlaceError, CommissionError> {
    let mut seer = Seer::new(&lab.calibration()?, lab.rig_with_eyes()?, &lab.model()?)?;
    robot.go(&lab.rig.home());
    let mut errors: Vec<nalgebra::Vector3<f64>> = vec![];
    let all: Vec<(f64, f64)> = GRID_X_M.iter().flat_map(|x| GRID_Y_M.iter().map(move |y| (*x, *y))).collect();
    for (k, (x_m, y_m)) in all.iter().enumerate() {
        context.checkpoint()?;
        context.report(0.5 * k as f64 / all.len() as f64, "judging where the tomato is found");
        robot.lockstep().place_toy(Toy::Tomato, *x_m, *y_m)?;
        robot.lockstep().wait(REST_S);
        let found = seer.look_for(robot, "Tomato")?;
        let truth = robot.lockstep().truth_for_judging();
        let stands = truth.toys.iter().find_map(|(toy, place)| place.filter(|_| *toy == Toy::Tomato));
        if let (Some(found), Some(stands)) = (found, stands) {
            let error = found.coords.coords - stands.translation.vector;
            eprintln!(
                "tomato at ({x_m:.1}, {y_m:.1}) m: found {:.1} {:.1} {:.1} mm beside",
                1e3 * error.x,
                1e3 * error.y,
                1e3 * error.z
            );
            errors.push(error);
        }
    }
    robot.lockstep().remove_toy(Toy::Tomato);
    let mm =
        |of: fn(&nalgebra::Vector3<f64>) -> f64| -> Vec<f64> { errors.iter().map(|e| 1e3 * of(e)).collect() };
    let (space, plane) = (mm(|e| e.norm()), mm(|e| e.xy().norm()));
    let mean = errors.iter().sum::<nalgebra::Vector3<f64>>() / errors.len().max(1) as f64 * 1e3;
    Ok(PlaceError {
        median: quantile(&space, 0.5),
        p95: quantile(&space, 0.95),
        plane_median: quantile(&plane, 0.5),
        plane_p95: quantile(&plane, 0.95),
        mean: (!errors.is_empty()).then(|| mean.into()),
        found: errors.len(),
        places: all.len(),
    })
}

/// Touches new places, corrected by what was accepted, inside and outside of what was touched before.
pub(super) fn touches(
    lab: &Lab,
    robot: &mut Robot,
    context: &dyn JobContext,
) -> Result<TouchError, CommissionError> {
    let stored = store::read(&session(lab))?;
    let touched: Vec<Pixel<Screen>> = stored.progress.counted().map(|record| record.touched).collect();
    let rig = lab.rig_with_screen()?;
    let corrector =
        if lab.model()?.is_nominal() { Corrector::None } else { Corrector::Effects(Arc::new(lab.known()?)) };
    let aims = new_aims(lab, &rig, corrector, context)?;
    let planner = Planner::new(&rig, TIP, ScreenPlace::Measured)?;
    let mut errors = [vec![], vec![]];
    for aim in &aims {
        context.checkpoint()?;
        let side = usize::from(!is_among(aim.touch.target, &touched));
        if errors[side].len() == CHECKED {
            continue;
        }
        context.report(
            0.6 + 0.4 * (errors[0].len() + errors[1].len()) as f64 / (2 * CHECKED) as f64,
            "judging where new touches land",
        );
        let stands = robot.lockstep().commanded().clone();
        let Ok(path) = planner.plan(aim.touch.target, aim.sent(), aim.touch.side, &stands) else { continue };
        if let Some(measured) = touch(robot, &path, planner.chain()) {
            errors[side].push(miss_mm(&rig, measured.pixel, aim.touch.target));
        }
    }
    let uncorrected = uncorrected(lab, robot, &aims)?;
    let [inside, outside] = &errors;
    Ok(TouchError {
        inside: rms(inside),
        outside: rms(outside),
        inside_touches: inside.len(),
        outside_touches: outside.len(),
        uncorrected,
    })
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
    };
    let request = PlanRequest { rig: rig.clone(), place: ScreenPlace::Measured, options, corrector };
    let plan = make(&request, context)?;
    Ok(plan.touches.into_iter().filter(|aim| aim.refusal.is_none()).collect())
}

/// The first of the new targets, sent as if nothing had been commissioned.
fn uncorrected(lab: &Lab, robot: &mut Robot, aims: &[Aim]) -> Result<Option<f64>, CommissionError> {
    let planner = Planner::new(&lab.rig, TIP, ScreenPlace::Nominal)?;
    let mut errors = vec![];
    for aim in aims.iter().take(CHECKED) {
        let stands = robot.lockstep().commanded().clone();
        let sent = lab.rig.touchscreen.point_at(aim.touch.target);
        let Ok(path) = planner.plan(aim.touch.target, sent, aim.touch.side, &stands) else { continue };
        if let Some(measured) = touch(robot, &path, planner.chain()) {
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

fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(at.clamp(1, sorted.len().max(1)) - 1).copied()
}
