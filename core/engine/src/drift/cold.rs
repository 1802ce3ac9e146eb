//! Whether a correction would count twice what the calibrations in use hold already.

use plumbline_model::robot::CalibratedAt;

use super::DriftAround;

/// A law begins at switching on, and a correction goes on from what the calibration holds of it. What is to be said
/// where nobody knows how much that is; `None`: it is known.
pub(super) fn counted_twice(around: &DriftAround) -> Option<String> {
    let CalibratedAt { cameras_s, mount_s } = around.model.rig().eyes.calibrated_at;
    let cameras = around.is_calibrated && cameras_s.is_none();
    let mount = around.is_mounted && mount_s.is_none();
    let (what, again) = match (cameras, mount) {
        (false, false) => return None,
        (true, false) => ("calibration", "the eyes"),
        (false, true) => ("mount", "the mount"),
        (true, true) => ("calibration and the mount", "the eyes and the mount"),
    };
    let were = if cameras && mount { "were" } else { "was" };
    Some(format!(
        "It is not known how long the cameras had been on when the {what} in use {were} made: if they were warm, what \
         the eyes had turned until then is in it already, and correcting by what is found would count it twice. Take \
         it for how long to wait; to correct by it, calibrate {again} again first, with the time at the clock in the \
         top line."
    ))
}
