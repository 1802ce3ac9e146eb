//! A device whose frame is left-handed: what it measured is the mirror image of what the arm did, and no frame, however it
//! lies, brings both together.

use plumbline_effects::measurements::{Measurements, What};
use plumbline_model::JobContext;

use super::turns::left_m;
use crate::error::GapError;

/// To which share of it what is left has to shrink when the measured places are mirrored back. An arm whose joints are off
/// looks no more like its mirror image than it does before.
const CLEARLY: f64 = 0.35;
/// A first joint that turns the other way mirrors most of what the arm does: a mirror is believed where it leaves less than
/// this share of what the best of such joints leaves.
const THAN_A_JOINT: f64 = 0.7;

/// Stops where an external device's places are mirrored; `measurements` are rows of that session, `by_joint_m` what a joint
/// that turns otherwise leaves at best.
///
/// # Errors
/// [`GapError::Mirrored`], or cancelled.
pub(super) fn check(
    measurements: &Measurements,
    session: usize,
    by_joint_m: Option<f64>,
    context: &dyn JobContext,
) -> Result<(), GapError> {
    if !measurements.rows.iter().all(|row| row.what.is_pose()) {
        return Ok(());
    }
    // What is mirrored of an orientation is another matter: places alone tell.
    let mut places = measurements.clone();
    for row in &mut places.rows {
        row.what = What::Pose;
        row.orientation = None;
        row.measured.truncate(3);
    }
    let off_m = left_m(&places, session, context)?;
    for row in &mut places.rows {
        // Which axis does not matter: the frame turns.
        row.measured[2] = -row.measured[2];
    }
    let with_m = left_m(&places, session, context)?;
    if with_m >= CLEARLY * off_m || by_joint_m.is_some_and(|by_joint_m| with_m >= THAN_A_JOINT * by_joint_m) {
        return Ok(());
    }
    Err(GapError::Mirrored { session: measurements.apparatuses[session].title.clone(), off_m, with_m })
}
