//! Judges a commissioned twin: it alone reads what is hidden, after everything is done. Nothing that it
//! finds goes back into the commissioning.

use std::sync::Arc;

use plumbline_correction::train::FEWEST_FOR_A_NETWORK;
use plumbline_correction::{CorrectionModel, Method};
use plumbline_effects::PlaceInRobot;
use plumbline_effects::rig_model::Conditions;
use plumbline_engine::models::learn::{learn, options};
use plumbline_engine::models::losses::Losses;
use plumbline_engine::motion::{Planner, ScreenPlace, Wanted};
use plumbline_engine::touch::plan::{Aim, Corrector, PlanRequest, TIP, make};
use plumbline_engine::touch::store;
use plumbline_grasp::Hand;
use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::session::Screen;
use plumbline_model::touch_plan::{Finger, Pattern, PlanOptions, Purpose, Sides, TouchArea};
use plumbline_model::{JobContext, Pixel, Point};
use plumbline_twin::Toy;

use super::error::CommissionError;
use super::judged::{PalmError, PlaceError, PlaceRow, TouchError};
use super::lab::Lab;
use super::plan::area;
use super::robot::Robot;
use super::see::Seer;
use super::touches::{Depths, rms, session};

/// Places of the published grid: along x, then along y, robot frame, m.
const GRID_X_M: [f64; 4] = [0.2, 0.3, 0.4, 0.5];
const GRID_Y_M: [f64; 9] = [-0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4];
/// New touches inside and outside.
const CHECKED: usize = 12;
/// So many are planned, so that there are enough of both kinds.
const DRAWN: usize = 96;
/// The palm is sent so high over the table, m.
const PALM_HEIGHT_M: f64 = 0.1;
/// A toy that was put down comes to rest, s.
const REST_S: f64 = 0.8;

/// Where the object was found, less where it was, at one place; robot frame, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged {
    at_m: [f64; 2],
    error_m: nalgebra::Vector3<f64>,
    /// As stated with the place.
    covariance_m2: nalgebra::Matrix3<f64>,
    /// Where both eyes saw it, less where it was; robot frame, m.
    by_eyes_m: nalgebra::Vector3<f64>,
}

impl Judged {
    /// Errors along x, y and z in units of the stated standard deviations.
    fn in_sigmas(&self) -> impl Iterator<Item = f64> {
        (0..3).map(|k| self.error_m[k].abs() / self.covariance_m2[(k, k)].sqrt())
    }

    fn row(&self) -> PlaceRow {
        let sigma_m = self.covariance_m2.diagonal().map(f64::sqrt);
        let [error_mm, sigma_mm] = [self.error_m, sigma_m].map(|m| (m * 1e3).into());
        PlaceRow { at_m: self.at_m, error_mm, sigma_mm }
    }

    /// eᵀ C⁻¹ e: 3 on average where what is stated is honest.
    fn chi2(&self) -> Option<f64> {
        Some((self.error_m.transpose() * self.covariance_m2.try_inverse()? * self.error_m).x)
    }
}

/// Share of numbers up to a bound.
fn share_within(values: &[f64], bound: f64) -> Option<f64> {
    let within = values.iter().filter(|value| **value <= bound).count();
    (!values.is_empty()).then(|| within as f64 / values.len() as f64)
}

/// Puts a toy on the 36 places and compares where it is found with where it is.
pub(super) fn places(
    toy: Toy,
    lab: &Lab,
    robot: &mut Robot,
    context: &dyn JobContext,
) -> Result<(PlaceError, Vec<Judged>), CommissionError> {
    let mut seer = Seer::new(&lab.calibration()?, lab.known()?)?;
    robot.go(&lab.rig.home());
    let mut judged: Vec<Judged> = vec![];
    let all: Vec<(f64, f64)> = GRID_X_M.iter().flat_map(|x| GRID_Y_M.iter().map(move |y| (*x, *y))).collect();
    for (k, (x_m, y_m)) in all.iter().enumerate() {
        context.checkpoint()?;
        context.report(0.5 * k as f64 / all.len() as f64, "judging where a toy is found");
        robot.lockstep().place_toy(toy, *x_m, *y_m)?;
        robot.lockstep().wait(REST_S);
        let found = seer.look_for(robot, toy.name())?;
        let truth = robot.lockstep().truth_for_judging();
        let stands = truth.toys.iter().find_map(|(which, place)| place.filter(|_| *which == toy));
        if let (Some(found), Some(stands)) = (found, stands) {
            let off_m = |place: &PlaceInRobot| place.point.coords.coords - stands.translation.vector;
            judged.push(Judged {
                at_m: [*x_m, *y_m],
                error_m: off_m(&found.place),
                covariance_m2: found.place.covariance_m2,
                by_eyes_m: off_m(&found.by_eyes),
            });
        }
    }
    robot.lockstep().remove_toy(toy);
    let errors: Vec<nalgebra::Vector3<f64>> = judged.iter().map(|judged| judged.error_m).collect();
    let mm =
        |of: fn(&nalgebra::Vector3<f64>) -> f64| -> Vec<f64> { errors.iter().map(|e| 1e3 * of(e)).collect() };
    let (space, plane) = (mm(|e| e.norm()), mm(|e| e.xy().norm()));
    let by_eyes: Vec<f64> = judged.iter().map(|judged| judged.by_eyes_m.norm() * 1e3).collect();
    let mean = errors.iter().sum::<nalgebra::Vector3<f64>>() / errors.len().max(1) as f64 * 1e3;
    let in_sigmas: Vec<f64> = judged.iter().flat_map(Judged::in_sigmas).collect();
    let sigma = |k: usize| judged.iter().map(|j| 1e3 * j.covariance_m2[(k, k)].sqrt()).sum::<f64>();
    let chi2: Vec<f64> = judged.iter().filter_map(Judged::chi2).collect();
    let error = PlaceError {
        median: quantile(&space, 0.5),
        p95: quantile(&space, 0.95),
        by_eyes: [quantile(&by_eyes, 0.5), quantile(&by_eyes, 0.95)],
        plane_median: quantile(&plane, 0.5),
        plane_p95: quantile(&plane, 0.95),
        mean: (!errors.is_empty()).then(|| mean.into()),
        sigma: (!errors.is_empty()).then(|| [0, 1, 2].map(|k| sigma(k) / judged.len() as f64)),
        within_sigma: share_within(&in_sigmas, 1.0),
        within_two_sigma: share_within(&in_sigmas, 2.0),
        chi2: (!chi2.is_empty()).then(|| chi2.iter().sum::<f64>() / chi2.len() as f64),
        found: errors.len(),
        places: all.len(),
        rows: judged.iter().map(Judged::row).collect(),
    };
    Ok((error, judged))
}

/// Sends a palm over places of the table in its reach, with the effects in use, and compares.
pub(super) fn palm(
    hand: Hand,
    lab: &Lab,
    robot: &mut Robot,
    found: &[Judged],
    context: &dyn JobContext,
) -> Result<PalmError, CommissionError> {
    let (rig, model) = (&lab.rig, lab.model()?);
    let (arm, solver) = (model.arm(rig, hand.palm())?, Solver::of_rig(rig, hand.palm())?);
    let link = rig.description.find_link(hand.palm())?;
    let ready = Planner::new(rig, hand.index_tip(), ScreenPlace::Nominal)?.ready(&rig.home());
    let side = if hand == Hand::Left { -1.0 } else { 1.0 };
    let (mut alone, mut to_object) = (vec![], vec![]);
    for judged in found.iter().filter(|judged| side * judged.at_m[1] <= 0.1) {
        context.checkpoint()?;
        context.report(0.55, "judging where the palm gets to");
        let [x_m, y_m] = judged.at_m;
        let point = Point::new(x_m, y_m, rig.table.height_m + PALM_HEIGHT_M);
        let start = ready.of(solver.joints());
        let reached =
            arm.reach(&solver, &Target::Position(point), &start, &Options::upright(), &Conditions::default());
        let Some(reached) = reached.ok().filter(plumbline_effects::rig_model::Reached::is_reached) else {
            continue;
        };
        robot.go(&ready);
        robot.go(&ready.with(solver.joints(), &reached.answer.best().joints));
        let truth = robot.lockstep().truth_for_judging();
        let Some(palm) = truth.robot_from_link[link.0] else { continue };
        let error = palm.translation.vector - point.coords.coords;
        alone.push(1e3 * error.norm());
        to_object.push(1e3 * (error + judged.error_m).xy().norm());
    }
    robot.go(&ready);
    Ok(PalmError {
        median: quantile(&alone, 0.5),
        p95: quantile(&alone, 0.95),
        to_object_median: quantile(&to_object, 0.5),
        to_object_p95: quantile(&to_object, 0.95),
        places: alone.len(),
    })
}

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
        let met = depths.touch(robot, &aim.wanted());
        if let Ok(measured) = met {
            errors[side].push(miss_mm(rig, measured.pixel, aim.touch.target));
        }
    }
    Ok(errors)
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

fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(at.clamp(1, sorted.len().max(1)) - 1).copied()
}
