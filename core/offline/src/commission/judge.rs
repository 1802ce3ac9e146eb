//! Judges a commissioned twin: it alone reads what is hidden, after everything is done. Nothing that it
//! finds goes back into the commissioning.

use plumbline_effects::PlaceInRobot;
use plumbline_effects::rig_model::Conditions;
use plumbline_engine::motion::{Planner, ScreenPlace};
use plumbline_grasp::Hand;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::{JobContext, Point};
use plumbline_twin::Toy;

use super::error::CommissionError;
use super::judged::{PalmError, PlaceError, PlaceRow};
use super::lab::Lab;
use super::robot::Robot;
use super::see::Seer;
use super::touches::rms;

/// Places of the published grid: along x, then along y, robot frame, m.
const GRID_X_M: [f64; 4] = [0.2, 0.3, 0.4, 0.5];
const GRID_Y_M: [f64; 9] = [-0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4];
/// The palm is sent so high over the table, m.
const PALM_HEIGHT_M: f64 = 0.1;
/// Standard deviations on both sides that hold 95 %.
const HOLDS_95: f64 = 1.96;
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
    let known = lab.known()?.arm(hand.palm())?;
    let (mut stated, mut in_sigmas) = (vec![], vec![]);
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
        let posture = ready.with(solver.joints(), &reached.answer.best().joints);
        robot.go(&posture);
        let truth = robot.lockstep().truth_for_judging();
        let Some(palm) = truth.robot_from_link[link.0] else { continue };
        let error = palm.translation.vector - point.coords.coords;
        alone.push(1e3 * error.norm());
        let variances_m2 = known.covariance_m2(&posture, &Conditions::default()).diagonal();
        if !known.is_nominal() {
            stated.push(1e3 * variances_m2.sum().sqrt());
            in_sigmas.extend((0..3).map(|k| error[k].abs() / variances_m2[k].sqrt()));
        }
        to_object.push(1e3 * (error + judged.error_m).xy().norm());
    }
    robot.go(&ready);
    Ok(PalmError {
        median: quantile(&alone, 0.5),
        p95: quantile(&alone, 0.95),
        to_object_median: quantile(&to_object, 0.5),
        to_object_p95: quantile(&to_object, 0.95),
        stated: rms(&stated),
        within_95: share_within(&in_sigmas, HOLDS_95),
        places: alone.len(),
    })
}

fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(at.clamp(1, sorted.len().max(1)) - 1).copied()
}
