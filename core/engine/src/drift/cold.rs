//! Whether a correction would count twice what the calibrations in use hold already.

use plumbline_effects::Kind;
use plumbline_effects::rig_model::ModelEffect;
use plumbline_model::robot::CalibratedAt;

use super::DriftAround;

/// Eyes that had been on for longer had turned by something that counts, s.
const WARM_S: f64 = 60.0;

/// A law begins at switching on, and a correction goes on from what the calibration holds of it. What is to be said
/// where nobody knows how much that is, and where an effect in force takes no account of it.
pub(super) fn counted_twice(around: &DriftAround) -> Vec<String> {
    [of_unknown_time(around), from_cold(around)].into_iter().flatten().collect()
}

fn of_unknown_time(around: &DriftAround) -> Option<String> {
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

/// An effect that an older version added counts from cold eyes, whenever they were calibrated.
fn from_cold(around: &DriftAround) -> Option<String> {
    let calibrated_at = &around.model.rig().eyes.calibrated_at;
    let counted_cold = |effect: &ModelEffect| {
        let kind = Kind::of_id(&effect.id).filter(|kind| kind.is_growth_of_eyes(effect.shape))?;
        let held_at_s = kind.held_at_s(calibrated_at).filter(|held_at_s| *held_at_s > WARM_S)?;
        (effect.reference_s == 0.0).then_some((kind, held_at_s))
    };
    let (kind, held_at_s) = around.model.added().effects().iter().find_map(counted_cold)?;
    Some(format!(
        "An effect in use ({}) counts from cold eyes, and the eyes were calibrated {:.0} min after they were switched \
         on: what they had turned until then is corrected twice. Undo it on the screen Gap, and explain again.",
        kind.about(),
        held_at_s / 60.0
    ))
}
