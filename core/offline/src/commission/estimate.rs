//! Effects that are taken for given, sized by the touches and by their usual sizes: least squares with
//! every parameter drawn to zero as far as robots usually have it (the posterior mode under normal
//! priors). The screen's place is fitted with them; where the eyes have seen it, it ties the arm to the
//! eyes, and the zero of the neck's turn is fitted, too.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix6, Vector6};
use plumbline_effects::measurements::Observation;
use plumbline_effects::{Assumed, Effect, Measurements, Present};
use plumbline_model::robot::Rig;

use super::glass::{SeenScreen, pose};
use super::plan::{NOISE_M, SCREEN_SD, moves_palm};

/// What the neck's zero is off by, usually, rad: as the library of effects has it.
const NECK_SD_RAD: f64 = 0.026;
/// Unknowns before the effects: six of the screen, one of the neck.
const FRAME: usize = 7;

/// What is known besides the touches.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    pub rig: &'a Rig,
    pub seen: Option<&'a SeenScreen>,
    /// This robot's arm is off by this share of what robots usually are. What is only between finger and
    /// screen counts in full.
    pub share: f64,
}

/// A fit.
pub(super) struct Fit {
    /// Effects with their values, and where the screen lies.
    pub assumed: Assumed,
    /// Covariance of the values, in units of the parameters, effects in turn.
    pub covariance: DMatrix<f64>,
    /// Zero of the neck's turn (true less encoder, rad) and its standard deviation; `None` when the eyes
    /// have not seen the screen.
    pub neck_rad: Option<(f64, f64)>,
}

/// Rounds of linearizing.
const ROUNDS: usize = 6;

/// Fits effects to rows of one session of touches. `None` when the rows cannot be predicted.
pub(super) fn fit(
    measurements: &Measurements,
    rows: &[&Observation],
    effects: &[Effect],
    known: &Known<'_>,
) -> Option<Fit> {
    let typical: Vec<f64> =
        effects.iter().flat_map(|effect| effect.parameters().iter().map(|p| p.typical)).collect();
    let count = FRAME + typical.len();
    let shares: Vec<f64> = effects
        .iter()
        .flat_map(|effect| {
            let share = if moves_palm(effect) { known.share } else { 1.0 };
            vec![share; effect.parameters().len()]
        })
        .collect();
    let sd = |k: usize| match k {
        0..6 => SCREEN_SD[k / 3],
        6 => NECK_SD_RAD,
        _ => shares[k - FRAME],
    };
    let mut assumed = Assumed {
        effects: effects
            .iter()
            .map(|effect| Present { effect: effect.clone(), values: vec![0.0; effect.parameters().len()] })
            .collect(),
        placements: vec![Isometry3::identity()],
        ..Assumed::default()
    };
    // Where the fit stands, in the units of the tangents.
    let mut at = DVector::<f64>::zeros(count);
    let mut inverse = DMatrix::identity(count, count);
    for _ in 0..ROUNDS {
        let mut normal = DMatrix::from_diagonal(&DVector::from_fn(count, |k, _| sd(k).powi(-2)));
        let mut right = DVector::from_fn(count, |k, _| -at[k] / sd(k).powi(2));
        for row in rows {
            let tangents = measurements.tangents(row, &assumed, effects)?;
            for (k, noise_m) in NOISE_M.into_iter().enumerate() {
                let slope = DVector::from_fn(count, |i, _| match i {
                    0..6 => tangents.gauge[(k, i)],
                    6 => 0.0,
                    _ => tangents.effects[(k, i - FRAME)],
                });
                let weight = noise_m.powi(-2);
                normal += &slope * slope.transpose() * weight;
                right += slope * ((row.measured[k] - tangents.predicted[k]) * weight);
            }
        }
        if let Some(seen) = known.seen {
            let (slopes, off, information) = tie(known.rig, seen, &assumed.placements[0], at[6])?;
            let mut frame = normal.view_mut((0, 0), (FRAME, FRAME));
            frame += slopes.transpose() * information * &slopes;
            let mut frame = right.rows_mut(0, FRAME);
            frame += slopes.transpose() * (information * off);
        }
        let factor = normal.cholesky()?;
        let change = factor.solve(&right);
        inverse = factor.inverse();
        let twist: [f64; 6] = std::array::from_fn(|k| change[k]);
        assumed.placements[0] = measurements.moved(0, &assumed.placements[0], &twist);
        at += &change;
        let mut k = FRAME;
        for present in &mut assumed.effects {
            for value in &mut present.values {
                *value = at[k] * typical[k - FRAME];
                k += 1;
            }
        }
        if change.amax() < 1e-7 {
            break;
        }
    }
    let n = typical.len();
    let covariance = DMatrix::from_fn(n, n, |r, c| inverse[(FRAME + r, FRAME + c)] * typical[r] * typical[c]);
    let neck_rad = known.seen.map(|_| (at[6], inverse[(6, 6)].max(0.0).sqrt()));
    Some(Fit { assumed, covariance, neck_rad })
}

/// How far the screen as seen, the neck's zero off by `neck_rad`, lies from where `placement` has it (shift,
/// turn), how that changes with the placement's twist and the zero, and its information.
fn tie(
    rig: &Rig,
    seen: &SeenScreen,
    placement: &Isometry3<f64>,
    neck_rad: f64,
) -> Option<(DMatrix<f64>, Vector6<f64>, Matrix6<f64>)> {
    let home = rig.home();
    let eye = |turn_rad: f64| {
        let pan = rig.eyes.pan;
        rig.robot_from_left(&home.with(&[pan], &[home[pan] + turn_rad])).isometry
    };
    let by_eyes = |neck_rad: f64| eye(neck_rad) * eye(0.0).inverse() * seen.robot_from_screen;
    let by_arm = placement.inverse() * pose(&rig.touchscreen);
    let off = |neck_rad: f64| {
        let by_eyes = by_eyes(neck_rad);
        let shift = by_eyes.translation.vector - by_arm.translation.vector;
        let turn = (by_eyes.rotation * by_arm.rotation.inverse()).scaled_axis();
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    };
    const STEP: f64 = 1e-4;
    let by_neck = (off(neck_rad + STEP) - off(neck_rad - STEP)) / (2.0 * STEP);
    // The placement moves the robot's points: the screen goes the other way.
    let slopes = DMatrix::from_fn(6, FRAME, |r, c| match c {
        6 => -by_neck[r],
        _ if r == c => -1.0,
        _ => 0.0,
    });
    Some((slopes, off(neck_rad), seen.covariance.try_inverse()?))
}

/// Error on rows that were not fitted, each group of repeats held out once: rms of the distance along
/// the glass and of the height together, m.
pub(super) fn held_out_m(measurements: &Measurements, effects: &[Effect], known: &Known<'_>) -> Option<f64> {
    let mut squares = 0.0;
    for cell in 0..measurements.cell_count() {
        let (back, used): (Vec<&Observation>, Vec<&Observation>) =
            measurements.rows.iter().partition(|row| row.cell == cell);
        let fitted = fit(measurements, &used, effects, known)?;
        for row in back {
            let predicted = measurements.predict(row, &fitted.assumed)?;
            squares += (0..3).map(|k| (row.measured[k] - predicted[k]).powi(2)).sum::<f64>();
        }
    }
    let rows = measurements.rows.len();
    (rows > 0).then(|| (squares / rows as f64).sqrt())
}
