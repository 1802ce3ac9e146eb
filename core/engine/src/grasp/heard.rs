//! Whether joints are heard: who waits for whom, and who is to blame.

use std::time::Instant;

use plumbline_grasp::{Halt, ServoState};
use plumbline_hardware::joints::{JointReading, JointState, Unheard};
use plumbline_model::robot::Rig;

/// A servo as it was read last; `None` where it is not known where its joint is.
pub(super) fn known(state: &JointState, reading: &JointReading) -> Option<ServoState> {
    Some(ServoState {
        joint: reading.joint,
        angle_rad: reading.angle_rad.filter(|_| state.knows(reading.joint))?,
        load: reading.load,
        current_a: reading.current_a,
        temperature_c: reading.temperature_c,
    })
}

/// Whether each was read after it was read before; nothing was read before the first time.
pub(super) fn are_newer(read: &[Option<Instant>], before: &[Option<Instant>]) -> bool {
    read.iter().zip(before).all(|(read, before)| read > before)
}

/// Whether joints are not known, all of them because this computer was too busy.
pub(super) fn are_merely_late(state: &JointState) -> bool {
    !state.unknown.is_empty() && state.unknown.iter().all(|joint| state.late.contains(joint))
}

/// Who does not answer at all is named before who answers too late.
pub(super) fn unknown(rig: &Rig, state: &JointState) -> Halt {
    let silent = state.unknown.iter().find(|joint| !state.late.contains(joint));
    let unheard = silent.or(state.unknown.first());
    let servo = unheard.and_then(|joint| rig.servo_of(*joint));
    let which = servo.map_or_else(|| "a joint".to_owned(), |servo| servo.title.to_lowercase());
    let is_late = unheard.is_some_and(|joint| state.late.contains(joint));
    let why = if is_late { Unheard::TooBusy } else { Unheard::Silent };
    Halt::Lost(format!("it is not known where {which} is: {}", why.advice()))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use plumbline_model::Stamp;
    use plumbline_model::robot::JointIndex;

    use super::*;

    #[test]
    fn readings_are_new_where_every_joint_was_read_since() {
        let then = Instant::now();
        let at = |milliseconds| Some(then + Duration::from_millis(milliseconds));
        assert!(are_newer(&[at(0), at(3)], &[]), "the first ones are");
        assert!(are_newer(&[at(20), at(23)], &[at(0), at(3)]));
        assert!(!are_newer(&[at(0), at(3)], &[at(0), at(3)]), "the same ones");
        assert!(!are_newer(&[at(20), at(3)], &[at(0), at(3)]), "one of them was not heard in this cycle");
    }

    /// A robot whose joints of these names are not known, of some because they were late.
    fn state(rig: &Rig, unknown: &[&str], late: &[&str]) -> JointState {
        let joints = |names: &[&str]| -> Vec<JointIndex> {
            names.iter().map(|name| rig.description.find_joint(name).expect("a joint")).collect()
        };
        let bare = JointState::new(Stamp { seq: 1, captured_at: Instant::now() }, []);
        JointState { unknown: joints(unknown).into(), late: joints(late).into(), ..bare }
    }

    #[test]
    fn what_is_merely_late_is_waited_for_and_named_load_and_what_is_silent_is_named_first() {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let why = |state: &JointState| unknown(&rig, state).to_string();
        assert!(!are_merely_late(&state(&rig, &[], &[])), "all are known");
        let late = state(&rig, &["head_z"], &["head_z"]);
        assert!(are_merely_late(&late));
        assert!(why(&late).contains("too busy") && !why(&late).contains("cable"), "{}", why(&late));
        let silent = state(&rig, &["head_z"], &[]);
        assert!(!are_merely_late(&silent) && why(&silent).contains("cable and power"), "{}", why(&silent));
        let both = state(&rig, &["head_z", "r_elbow_y"], &["head_z"]);
        assert!(!are_merely_late(&both), "nobody waits for who does not answer");
        assert!(why(&both).contains("right elbow is: check its cable"), "{}", why(&both));
    }
}
