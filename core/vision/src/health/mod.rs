//! Whether a calibration of the eyes still holds, told from ordinary pairs without a board.
//!
//! A place that both eyes see lies in one plane with both of them (epipolar geometry; Hartley and
//! Zisserman, *Multiple View Geometry*, ch. 9). Matched places that leave that plane say how the right eye
//! has turned against the left one since the calibration: about the baseline directly, about its own axis
//! and to the side because lenses this wide see the planes fan out. What that costs is said where the robot
//! works: how far off the old calibration puts places on the table.
//!
//! Not seen this way: the distance of the eyes, and what both eyes do together.

mod align;
mod cost;
mod judged;
mod matches;
mod turn;

#[cfg(test)]
mod tests;

pub use cost::{Cost, cost};
pub use judged::{BEARABLE_M, Better, Judged, TableRows, better, judge};
pub use matches::{HealthError, Match, MatchCount, find_matches, find_matches_until};
pub use turn::{Turn, epipolar_px, fit_turn, fits_better_by, turned};
