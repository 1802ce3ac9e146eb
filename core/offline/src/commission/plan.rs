//! Which touches tell most about where the palm will be: of all touches that the arm can make, always
//! the one that leaves the least expected error of the palm over the table (V-optimal, one after the
//! other), whatever of the library's effects is at work.

use nalgebra::{DMatrix, Isometry3};
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Observation, What};
use plumbline_effects::{Assumed, Effect, Surface};
use plumbline_engine::motion::{Hold, Planner, TouchPath};
use plumbline_engine::touch::plan::TIP;
use plumbline_fit::{NOISE_M, SCREEN_SD, measurements, moves_palm, row, usual};
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::touch_plan::{Side, TouchArea};
use plumbline_model::{JobContext, Point};

use super::error::CommissionError;

/// Touches in all.
pub(super) const TOUCHES: usize = 25;
/// So many of them repeat others, which tells the noise.
const REPEATS: usize = 3;
/// Candidates across and down.
const GRID: [usize; 2] = [7, 4];
/// The middle of the palm.
const PALM: &str = "right_palm_center";
/// The hand is turned or leaned by so much, rad.
const TURN_RAD: f64 = 0.4;
const LEAN_RAD: f64 = 0.4;
/// Share of the reachable area that stays untouched at each side, so that the judge has places outside.
const MARGIN: f64 = 0.1;
/// Heights over the table at which the palm will work, m.
const WORK_HEIGHTS_M: [f64; 2] = [0.04, 0.10];

/// A touch that can be made.
#[derive(Clone)]
pub(super) struct Candidate {
    pub path: TouchPath,
    pub side: Side,
    pub hold: Hold,
    /// Label that blocks cross-validation: a part of the screen.
    pub set: String,
}

/// A chosen touch.
pub(super) struct Chosen {
    /// Among the candidates.
    pub candidate: usize,
    /// Touches of one group repeat each other.
    pub group: usize,
}

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

/// All touches that the arm can make on a grid, from each side.
pub(super) fn candidates(
    planner: &Planner,
    area: &TouchArea,
    context: &dyn JobContext,
) -> Result<Vec<Candidate>, CommissionError> {
    let from = planner.ready(&planner.rig().home());
    let screen = &planner.rig().touchscreen;
    let mut found = vec![];
    let [columns, rows] = GRID;
    for column in 0..columns {
        context.checkpoint()?;
        context.report(0.2 * column as f64 / columns as f64, "looking which touches can be made");
        for row in 0..rows {
            let part = |i: usize, n: usize| i as f64 / (n - 1) as f64;
            let target = area.at(part(column, columns), part(row, rows));
            let set = format!("part {}-{}", 3 * column / columns + 1, 2 * row / rows + 1);
            for (side, hold) in ways() {
                let path = planner.plan_held(target, screen.point_at(target), side, hold, &from);
                found.extend(path.ok().map(|path| Candidate { path, side, hold, set: set.clone() }));
            }
        }
    }
    Ok(found)
}

/// From which side and how held a place may be touched: as the window does it, and from above with the
/// hand turned or leaned, which shows what joints err by apart from each other.
fn ways() -> Vec<(Side, Hold)> {
    let usual = [Side::Above, Side::Left, Side::Right].map(|side| (side, Hold::default()));
    let turned = [TURN_RAD, -TURN_RAD].map(|turn_rad| Hold { turn_rad, ..Hold::default() });
    let leaned = [[LEAN_RAD, 0.0], [-LEAN_RAD, 0.0], [0.0, LEAN_RAD], [0.0, -LEAN_RAD]]
        .map(|lean_rad| Hold { lean_rad, ..Hold::default() });
    let held = turned.into_iter().chain(leaned).map(|hold| (Side::Above, hold));
    usual.into_iter().chain(held).collect()
}

/// Chooses among the candidates; some are chosen twice, to tell the noise.
pub(super) fn choose(rig: &Rig, candidates: &[Candidate]) -> Result<Vec<Chosen>, CommissionError> {
    let arm = Arm::of_rig(rig, TIP)?;
    let effects = usual(&arm);
    let tangents = touch_tangents(rig, &arm, &effects, candidates);
    let wanted = palm_tangents(rig, &effects)?;
    let count = wanted.ncols();
    let mut covariance = DMatrix::<f64>::identity(count, count);
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
    while chosen.len() < TOUCHES - REPEATS {
        let free = (0..candidates.len()).filter(|i| chosen.iter().all(|known| known.candidate != *i));
        let best = free.map(|i| (i, gain(&covariance, &tangents[i]))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((candidate, _)) = best else { break };
        learn(&mut covariance, &tangents[candidate]);
        chosen.push(Chosen { candidate, group: chosen.len() });
    }
    let again: Vec<Chosen> = (0..REPEATS.min(chosen.len()))
        .map(|k| k * chosen.len() / REPEATS)
        .map(|k| Chosen { candidate: chosen[k].candidate, group: chosen[k].group })
        .collect();
    chosen.extend(again);
    Ok(chosen)
}

/// What a touch shows, in units of its noise: frame first, then each effect of usual size.
fn touch_tangents(rig: &Rig, arm: &Arm, effects: &[Effect], candidates: &[Candidate]) -> Vec<DMatrix<f64>> {
    let surface = Some(Surface::of(&rig.touchscreen));
    let rows = candidates.iter().map(|candidate| {
        let angles_rad =
            candidate.path.contact.of(&arm.parts.iter().map(|part| part.index).collect::<Vec<_>>());
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
fn palm_tangents(rig: &Rig, effects: &[Effect]) -> Result<DMatrix<f64>, CommissionError> {
    let arm = Arm::of_rig(rig, PALM)?;
    let rows: Vec<Observation> =
        palm_postures(rig)?.into_iter().map(|angles_rad| row(What::Pose, angles_rad, vec![0.0; 6])).collect();
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

/// The arm with its palm over places of the table, angles of its chain, rad.
fn palm_postures(rig: &Rig) -> Result<Vec<Vec<f64>>, CommissionError> {
    let solver = Solver::of_rig(rig, PALM)?;
    let mut from: Posture = rig.home();
    let mut found = vec![];
    for height_m in WORK_HEIGHTS_M {
        for i in 0..5 {
            for j in 0..3 {
                let (x_m, y_m) = (0.22 + 0.1 * f64::from(j), -0.35 + 0.1 * f64::from(i));
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
