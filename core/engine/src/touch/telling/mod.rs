//! Touches that tell most of where the palm will be: the finger goes to the glass from several sides, the
//! hand held in several ways, where that shows best what the arm errs by.
//!
//! [`candidates`] are the touches that the arm can make, [`choose`] takes those that tell most, and
//! [`in_short_ways`] puts them into an order.

mod choice;
#[cfg(test)]
mod tests;

use plumbline_model::touch_plan::{PlannedTouch, Side, TouchArea};
use plumbline_model::{Cancelled, JobContext};

use crate::motion::{Hold, Planner, TouchPath, Wanted};

pub use choice::{Chosen, choose};

/// Candidates across and down.
const GRID: [usize; 2] = [7, 4];
/// The hand is turned or leaned by so much, rad.
const TURN_RAD: f64 = 0.4;
const LEAN_RAD: f64 = 0.4;
/// Repeats of a touch are made as if they were so far away from it, rad: not one after the other.
const REPEAT_AWAY_RAD: f64 = 10.0;

/// A touch that can be made.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The arm's way.
    pub path: TouchPath,
    /// From where the fingertip arrives.
    pub side: Side,
    /// How the hand is held.
    pub hold: Hold,
    /// Label that blocks cross-validation: a part of the screen.
    pub set: String,
}

impl Candidate {
    /// As a planned touch of the screen as it lies, with a bare hand.
    pub fn planned(&self, number: usize, group: usize) -> PlannedTouch {
        PlannedTouch {
            number,
            target: self.path.target,
            set: self.set.clone(),
            group: format!("g{:02}", group + 1),
            side: self.side,
            screen_height_m: 0.0,
            payload_kg: 0.0,
            as_described: false,
        }
    }
}

/// All touches that the arm can make on a grid, from each side.
///
/// # Errors
/// When it is cancelled.
pub fn candidates(
    planner: &Planner,
    area: &TouchArea,
    context: &dyn JobContext,
) -> Result<Vec<Candidate>, Cancelled> {
    let from = planner.ready(&planner.rig().home());
    let screen = &planner.rig().touchscreen;
    let mut found = vec![];
    let [columns, rows] = GRID;
    for column in 0..columns {
        context.checkpoint()?;
        context.report(column as f64 / columns as f64, "looking which touches can be made");
        for row in 0..rows {
            let part = |i: usize, n: usize| i as f64 / (n - 1) as f64;
            let target = area.at(part(column, columns), part(row, rows));
            // Rows go toward the robot.
            let (near, aside) =
                (["far", "near"][2 * row / rows], ["left", "middle", "right"][3 * column / columns]);
            let set = format!("{near} {aside}");
            for (side, hold) in ways() {
                let wanted = Wanted { hold, ..Wanted::straight(target, screen.point_at(target), side) };
                let path = planner.plan(&wanted, &from);
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

/// Always the nearest next; repeats of a touch are not made one after the other.
pub fn in_short_ways(chosen: &[Chosen], candidates: &[Candidate]) -> Vec<Chosen> {
    let mut left: Vec<Chosen> = chosen.to_vec();
    let mut ordered: Vec<Chosen> = vec![];
    let contact = |pick: &Chosen| &candidates[pick.candidate].path.contact;
    while !left.is_empty() {
        let cost = |pick: &Chosen| {
            let Some(last) = ordered.last() else { return 0.0 };
            let way_rad = contact(last).distance_rad(contact(pick));
            way_rad + if last.group == pick.group { REPEAT_AWAY_RAD } else { 0.0 }
        };
        let nearest = (0..left.len()).min_by(|a, b| cost(&left[*a]).total_cmp(&cost(&left[*b]))).unwrap_or(0);
        ordered.push(left.remove(nearest));
    }
    ordered
}
