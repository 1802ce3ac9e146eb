//! Which part of the screen an arm reaches.

use super::TouchArea;
use crate::pixel::Pixel;
use crate::robot::ik::{Answer, Options, Solver, SolverError, Target};
use crate::robot::{Posture, Rig};
use crate::session::{Screen, Touchscreen};

/// Fingers slip off and panels err nearer to the border than this, m.
const MARGIN_M: f64 = 0.01;
/// Places that are tried across and down: one every 2 to 3 cm of a usual screen.
const TRIED: [usize; 2] = [20, 11];
/// The fingertip must also get here above the glass, to come down from, m.
const ABOVE_M: f64 = 0.04;

impl TouchArea {
    /// The largest rectangle of the screen that a tip of the arm reaches, by inverse kinematics
    /// within the limits of the joints, at the glass and a little above it. What stands in the way
    /// is not looked at. `None` when it reaches no part of it.
    ///
    /// # Errors
    /// When the rig has no such tip.
    pub fn reached_by(rig: &Rig, tip: &str) -> Result<Option<Self>, SolverError> {
        let solver = Solver::of_rig(rig, tip)?;
        let screen = &rig.touchscreen;
        let mut from = rig.home();
        let area = Self::largest_where(screen, |pixel| {
            let heights = [ABOVE_M, 0.0].map(|height_m| screen.raised(height_m).point_at(pixel));
            heights.into_iter().all(|point| reaches(&solver, &Target::Position(point), &mut from))
        });
        Ok(area)
    }

    /// The largest rectangle in which every tried place (about 2 cm apart, 1 cm and more from the
    /// border) passes. `None` when no four neighbors do.
    pub fn largest_where(
        screen: &Touchscreen,
        mut passes: impl FnMut(Pixel<Screen>) -> bool,
    ) -> Option<Self> {
        let whole = Self::within(screen, MARGIN_M);
        let [columns, rows] = TRIED;
        let at = |column: usize, row: usize| {
            whole.at(column as f64 / (columns - 1) as f64, row as f64 / (rows - 1) as f64)
        };
        let passed: Vec<Vec<bool>> =
            (0..rows).map(|row| (0..columns).map(|column| passes(at(column, row))).collect()).collect();
        let (mut best, mut size) = (None, 0);
        for top in 0..rows {
            // Columns in which every row from `top` on passed.
            let mut free = vec![true; columns];
            for bottom in top..rows {
                free.iter_mut().zip(&passed[bottom]).for_each(|(free, passed)| *free &= passed);
                for run in runs(&free) {
                    let cells = (run.end - run.start - 1) * (bottom - top);
                    if cells > size {
                        size = cells;
                        best = Some((at(run.start, top), at(run.end - 1, bottom)));
                    }
                }
            }
        }
        best.map(|(first, last)| Self { u_px: [first.u_px, last.u_px], v_px: [first.v_px, last.v_px] })
    }
}

/// Longest stretches of `true`.
fn runs(free: &[bool]) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = vec![];
    for (i, _) in free.iter().enumerate().filter(|(_, free)| **free) {
        match runs.last_mut() {
            Some(run) if run.end == i => run.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs
}

fn reaches(solver: &Solver, target: &Target, from: &mut Posture) -> bool {
    match solver.solve_from(target, from, &Options::default()) {
        Ok(Answer::Reached(solution)) => {
            // The next place is near this one.
            *from = from.with(solver.joints(), &solution.joints);
            true
        }
        _ => false,
    }
}
