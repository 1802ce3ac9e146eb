//! Which of the touches that can be made tell most: always the one that leaves the least expected error of
//! the palm over the table (V-optimal, one after the other), whatever of the library's effects is at work.

use nalgebra::{DMatrix, Isometry3};
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Observation, What};
use plumbline_effects::{Assumed, Effect, Surface};
use plumbline_fit::{NOISE_M, SCREEN_SD, measurements, moves_palm, row, usual};
use plumbline_model::Point;
use plumbline_model::robot::ik::{Options, Solver, SolverError, Target};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::touch_plan::Finger;

use super::Candidate;

/// Heights over the table at which the palm will work, m.
const WORK_HEIGHTS_M: [f64; 2] = [0.04, 0.10];

/// A chosen touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// Among the candidates.
    pub candidate: usize,
    /// Touches of one group repeat each other.
    pub group: usize,
}

/// Chooses `count` among the candidates; `again` of them are chosen twice, to tell the noise.
///
/// # Errors
/// When the robot has no such finger, or no palm of that hand.
pub fn choose(
    rig: &Rig,
    finger: Finger,
    candidates: &[Candidate],
    count: usize,
    again: usize,
) -> Result<Vec<Chosen>, SolverError> {
    let arm = Arm::of_rig(rig, finger.tip())?;
    let effects = usual(&arm);
    let tangents = touch_tangents(rig, &arm, &effects, candidates);
    let wanted = palm_tangents(rig, finger, &effects)?;
    let parameters = wanted.ncols();
    let mut covariance = DMatrix::<f64>::identity(parameters, parameters);
    for k in 0..6 {
        covariance[(k, k)] = SCREEN_SD[k / 3].powi(2);
    }
    let worth = wanted.transpose() * &wanted;
    let mut chosen: Vec<Chosen> = vec![];
    let gain = |covariance: &DMatrix<f64>, h: &DMatrix<f64>| -> f64 {
        let ph = covariance * h.transpose();
        let mut s = h * &ph;
        (0..3).for_each(|k| s[(k, k)] += 1.0);
        s.cholesky()
            .map_or(0.0, |factor| (ph.transpose() * &worth * &ph).component_mul(&factor.inverse()).sum())
    };
    let learn = |covariance: &mut DMatrix<f64>, h: &DMatrix<f64>| {
        let ph = &*covariance * h.transpose();
        let mut s = h * &ph;
        (0..3).for_each(|k| s[(k, k)] += 1.0);
        if let Some(factor) = s.cholesky() {
            *covariance -= &ph * factor.inverse() * ph.transpose();
        }
    };
    while chosen.len() < count {
        let free = (0..candidates.len()).filter(|i| chosen.iter().all(|known| known.candidate != *i));
        let best = free.map(|i| (i, gain(&covariance, &tangents[i]))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((candidate, _)) = best else { break };
        learn(&mut covariance, &tangents[candidate]);
        chosen.push(Chosen { candidate, group: chosen.len() });
    }
    let repeated: Vec<Chosen> =
        (0..again.min(chosen.len())).map(|k| chosen[k * chosen.len() / again]).collect();
    chosen.extend(repeated);
    Ok(chosen)
}

/// What a touch shows, in units of its noise: frame first, then each effect of usual size.
fn touch_tangents(rig: &Rig, arm: &Arm, effects: &[Effect], candidates: &[Candidate]) -> Vec<DMatrix<f64>> {
    let surface = Some(Surface::of(&rig.touchscreen));
    let rows = candidates.iter().map(|candidate| {
        let angles_rad =
            candidate.path.contact.of(&arm.parts.iter().filter_map(|part| part.index).collect::<Vec<_>>());
        let direction = candidate.path.direction.iter().map(|sign| f64::from(*sign)).collect();
        row(What::Touch, angles_rad, direction)
    });
    let measurements = measurements(rig, arm.clone(), surface, rows.collect());
    let assumed = Assumed { placements: vec![Isometry3::identity()], ..Assumed::default() };
    measurements
        .rows
        .iter()
        .map(|row| {
            let tangents =
                measurements.tangents(row, &assumed, effects).expect("an arm and a screen are there");
            let mut h = beside(&tangents.gauge, &tangents.effects);
            for (k, noise_m) in NOISE_M.into_iter().enumerate() {
                h.row_mut(k).scale_mut(1.0 / noise_m);
            }
            h
        })
        .collect()
}

/// How the palm moves with each effect of usual size, at places of its work; m. The screen's frame does
/// not move it.
fn palm_tangents(rig: &Rig, finger: Finger, effects: &[Effect]) -> Result<DMatrix<f64>, SolverError> {
    let arm = Arm::of_rig(rig, palm(finger))?;
    let rows: Vec<Observation> = palm_postures(rig, finger)?
        .into_iter()
        .map(|angles_rad| row(What::Pose, angles_rad, vec![0.0; 6]))
        .collect();
    let measurements = measurements(rig, arm, None, rows);
    let assumed = Assumed { placements: vec![Isometry3::identity()], ..Assumed::default() };
    let mut all: Vec<DMatrix<f64>> = vec![];
    for row in &measurements.rows {
        let tangents = measurements.tangents(row, &assumed, effects).expect("an arm is there");
        let mut of_effects = tangents.effects;
        let mut at = 0;
        for effect in effects {
            let width = effect.parameters().len();
            if !moves_palm(effect) {
                of_effects.columns_mut(at, width).fill(0.0);
            }
            at += width;
        }
        all.push(beside(&DMatrix::zeros(3, 6), &of_effects));
    }
    let columns = all.first().map_or(0, DMatrix::ncols);
    let mut stacked = DMatrix::zeros(3 * all.len(), columns);
    for (k, part) in all.iter().enumerate() {
        stacked.rows_mut(3 * k, 3).copy_from(part);
    }
    Ok(stacked)
}

/// The middle of the palm of the hand that the finger belongs to.
fn palm(finger: Finger) -> &'static str {
    match finger {
        Finger::Right => "right_palm_center",
        Finger::Left => "left_palm_center",
    }
}

/// The arm with its palm over places of the table, angles of its chain, rad.
fn palm_postures(rig: &Rig, finger: Finger) -> Result<Vec<Vec<f64>>, SolverError> {
    let solver = Solver::of_rig(rig, palm(finger))?;
    let to_its_side = match finger {
        Finger::Right => 1.0,
        Finger::Left => -1.0,
    };
    let mut from: Posture = rig.home();
    let mut found = vec![];
    for height_m in WORK_HEIGHTS_M {
        for i in 0..5 {
            for j in 0..3 {
                let (x_m, y_m) = (0.22 + 0.1 * f64::from(j), to_its_side * (-0.35 + 0.1 * f64::from(i)));
                let target = Target::Position(Point::new(x_m, y_m, rig.table.height_m + height_m));
                let Ok(answer) = solver.solve_from(&target, &from, &Options::upright()) else { continue };
                if answer.is_reached() {
                    from = from.with(solver.joints(), &answer.best().joints);
                    found.push(answer.best().joints.to_vec());
                }
            }
        }
    }
    Ok(found)
}

/// One matrix to the right of another one.
fn beside(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let mut both = DMatrix::zeros(left.nrows(), left.ncols() + right.ncols());
    both.columns_mut(0, left.ncols()).copy_from(left);
    both.columns_mut(left.ncols(), right.ncols()).copy_from(right);
    both
}
