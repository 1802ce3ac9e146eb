//! Whether something is between fingers and thumb, by what their servos say.

use plumbline_model::robot::{JointIndex, Rig};

use crate::body::{ServoState, is_thumb};
use crate::hands::Hand;

/// What is held presses the thumb with at least this share of what presses the strongest finger: what fingers
/// press on alone is the hand itself, or slips out between them. Of 883 attempts of the twin the thumb had
/// more than 0.42 in all but one of 763 that held something, and less than 0.18 in the 120 that did not. (That was with
/// the full torque of the fingers; with the grip of today what an attempt says of itself ten seconds later is so in all
/// but one of 528.)
const THUMB_SHARE: f64 = 0.3;
/// A thumb or a finger that presses with less than this share of its torque presses on nothing.
const PRESSES: f64 = 0.1;
/// The same by the currents of their motors, A: those of a hand say no load. Fingers that press with a fifth
/// of their torque take several times as much.
const PRESSES_A: f64 = 0.015;
/// Where servos say neither: a finger that is kept open by more than this holds something, rad.
const HELD_RAD: f64 = 0.10;
/// Fingers and thumb bend this far around nothing, rad.
const CLOSED_RAD: f64 = 1.8;

/// Joints of a hand, and where they are when it is closed around nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// Joints of the fingers without the thumb, closed, rad.
    fingers: Vec<(JointIndex, f64)>,
    /// Joints of the thumb.
    thumb: Vec<JointIndex>,
}

impl Grip {
    /// Of a hand of the robot; `None`: it has none.
    pub fn of_rig(rig: &Rig, hand: Hand) -> Option<Self> {
        let joints = &rig.arm(hand.name())?.hand;
        (!joints.is_empty()).then(|| Self::of_joints(rig, joints))
    }

    pub(crate) fn of_joints(rig: &Rig, hand: &[JointIndex]) -> Self {
        let (thumb, fingers): (Vec<_>, Vec<_>) =
            hand.iter().copied().partition(|joint| is_thumb(rig, *joint));
        let fingers = fingers.into_iter().map(|joint| (joint, closed_rad(rig, joint))).collect();
        Self { fingers, thumb }
    }

    /// All joints of the hand.
    pub fn joints(&self) -> impl Iterator<Item = JointIndex> + '_ {
        self.fingers.iter().map(|(joint, _)| *joint).chain(self.thumb.iter().copied())
    }

    /// How far the fingers (the thumb is none) are kept from closing around nothing, each, rad.
    pub fn open_rad(&self, servos: &[ServoState]) -> Vec<f64> {
        let of = |(joint, closed_rad): &(JointIndex, f64)| {
            let servo = servos.iter().find(|servo| servo.joint == *joint)?;
            Some((servo.angle_rad - closed_rad).abs())
        };
        self.fingers.iter().filter_map(of).collect()
    }

    /// Whether something is between fingers and thumb: what presses fingers presses the thumb too. Where
    /// servos do not say how hard they press, fingers that are kept open count.
    pub fn holds(&self, servos: &[ServoState]) -> bool {
        let pinched = |says: fn(&ServoState) -> Option<f64>, presses: f64| {
            let all = |joints: Vec<JointIndex>| {
                let of = |joint| servos.iter().find(|servo| servo.joint == joint).and_then(says);
                joints.into_iter().map(of).collect::<Option<Vec<f64>>>()
            };
            let fingers = all(self.fingers.iter().map(|(joint, _)| *joint).collect())?;
            let thumb = all(self.thumb.clone())?;
            (!thumb.is_empty()).then(|| is_pinched(&fingers, &thumb, presses))
        };
        let pinched =
            pinched(|servo| servo.load, PRESSES).or_else(|| pinched(|servo| servo.current_a, PRESSES_A));
        pinched.unwrap_or_else(|| self.open_rad(servos).iter().any(|open_rad| *open_rad > HELD_RAD))
    }
}

/// A hand that presses on nothing for so long has lost what it held, s: a single reading says little.
const EMPTY_FOR_S: f64 = 1.0;

/// Feels whether a thing that was grasped is still in the hand.
#[derive(Clone, Debug)]
pub struct HoldWatch {
    grip: Grip,
    empty_since_s: Option<f64>,
}

impl HoldWatch {
    /// Of a hand that holds something.
    pub fn new(grip: Grip) -> Self {
        Self { grip, empty_since_s: None }
    }

    /// Joints of the hand.
    pub fn joints(&self) -> impl Iterator<Item = JointIndex> + '_ {
        self.grip.joints()
    }

    /// How far each finger is kept from closing around nothing, rad.
    pub fn open_rad(&self, servos: &[ServoState]) -> Vec<f64> {
        self.grip.open_rad(servos)
    }

    /// Whether the hand felt empty at last, not yet for so long that it is sure.
    pub fn doubts(&self) -> bool {
        self.empty_since_s.is_some()
    }

    /// What the servos of the hand say at a time (s, of any clock that only goes on). `None` of them: they are
    /// not all heard, or say nothing of what is held, as while the arm moves, when what it carries presses now
    /// more and now less. Since when the hand is empty, once that is sure.
    pub fn feel(&mut self, servos: Option<&[ServoState]>, now_s: f64) -> Option<f64> {
        if servos.is_none_or(|servos| self.grip.holds(servos)) {
            self.empty_since_s = None;
            return None;
        }
        let since_s = *self.empty_since_s.get_or_insert(now_s);
        (now_s - since_s >= EMPTY_FOR_S).then_some(since_s)
    }
}

/// Whether what presses the fingers presses the thumb, by what their servos say of their torque; less than
/// `presses` is nothing.
fn is_pinched(fingers: &[f64], thumb: &[f64], presses: f64) -> bool {
    let strongest = fingers.iter().fold(0.0f64, |strongest, load| strongest.max(load.abs()));
    let thumb: f64 = thumb.iter().map(|load| load.abs()).sum();
    strongest > presses && thumb > presses.max(THUMB_SHARE * strongest)
}

/// Bent inward, as far as the fingers of the pose "close-hand" are.
pub(crate) fn closed_rad(rig: &Rig, joint: JointIndex) -> f64 {
    if rig.description.joint(joint).name.contains("thumb_z") {
        return 0.0;
    }
    let limits = rig.limits(joint);
    let inward = if limits.upper_rad > -limits.lower_rad { 1.0 } else { -1.0 };
    inward * CLOSED_RAD
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_presses_the_thumb_however_far_the_fingers_are_closed() {
        // Fingers and thumb of attempts: a tomato pressed with all and with a fifth of the torque, a mushroom.
        for (fingers, thumb) in [
            ([-0.0, -1.0], [-0.4, 0.35]),
            ([-0.01, -0.2], [-0.15, 0.01]),
            ([-0.0, -1.0], [-0.3, 0.12]),
            ([-0.0, -1.0], [-0.4, 0.07]),
        ] {
            assert!(is_pinched(&fingers, &thumb, PRESSES), "{fingers:?} {thumb:?}");
        }
        // A tomato that slipped out, fingers that press on the hand itself, fingers that closed around nothing.
        for (fingers, thumb) in [
            ([-0.0, -1.0], [-0.09, 0.07]),
            ([-0.2, -0.2], [-0.0, -0.0]),
            ([-0.0, -0.03], [-0.02, 0.02]),
            ([0.0, 0.0], [0.0, 0.0]),
        ] {
            assert!(!is_pinched(&fingers, &thumb, PRESSES), "{fingers:?} {thumb:?}");
        }
    }

    fn servos(
        grip: &Grip,
        rig: &Rig,
        load: Option<f64>,
        current_a: Option<f64>,
        open_rad: f64,
    ) -> Vec<ServoState> {
        grip.joints()
            .map(|joint| {
                let angle_rad = closed_rad(rig, joint) * (1.0 - open_rad / CLOSED_RAD);
                ServoState { joint, angle_rad, load, current_a, temperature_c: None }
            })
            .collect()
    }

    #[test]
    fn what_slips_out_is_told_once_the_hand_was_empty_for_a_while() {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let grip = Grip::of_rig(&rig, Hand::Right).expect("it has a right hand");
        let [holds, empty] = [0.2, 0.0].map(|load| servos(&grip, &rig, Some(load), None, 0.0));
        let mut watch = HoldWatch::new(grip);
        assert_eq!(watch.feel(Some(&holds), 0.0), None);
        // A moment of it, and a hand that is not heard or moves, say nothing.
        assert_eq!(watch.feel(Some(&empty), 1.0), None);
        assert_eq!(watch.feel(Some(&empty), 1.9), None);
        assert_eq!(watch.feel(None, 2.1), None);
        assert_eq!(watch.feel(Some(&empty), 2.2), None);
        assert_eq!(watch.feel(Some(&holds), 3.3), None);
        assert_eq!(watch.feel(Some(&empty), 4.0), None);
        assert_eq!(watch.feel(Some(&empty), 5.0), Some(4.0));
        assert_eq!(watch.feel(Some(&empty), 9.0), Some(4.0));
    }

    /// Servos that say neither load nor current: fingers that creep on to the closed hand have lost it.
    #[test]
    fn a_hand_that_says_no_force_is_felt_by_how_far_it_closes() {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let grip = Grip::of_rig(&rig, Hand::Right).expect("it has a right hand");
        let [open, closed] = [0.4, 0.02].map(|open_rad| servos(&grip, &rig, None, None, open_rad));
        let mut watch = HoldWatch::new(grip);
        assert_eq!(watch.feel(Some(&open), 0.0), None);
        assert_eq!(watch.feel(Some(&closed), 1.0), None);
        assert_eq!(watch.feel(Some(&closed), 2.5), Some(1.0));
    }

    #[test]
    fn by_load_by_current_else_by_how_far_the_fingers_are_open() {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let grip = Grip::of_rig(&rig, Hand::Right).expect("it has a right hand");
        assert!(!grip.fingers.is_empty() && !grip.thumb.is_empty());
        let servos = |load, current_a, open_rad| servos(&grip, &rig, load, current_a, open_rad);
        assert!(grip.holds(&servos(Some(0.2), None, 0.0)) && !grip.holds(&servos(Some(0.02), None, 0.5)));
        assert!(grip.holds(&servos(None, Some(0.1), 0.0)) && !grip.holds(&servos(None, Some(0.001), 0.5)));
        assert!(grip.holds(&servos(None, None, 0.3)) && !grip.holds(&servos(None, None, 0.05)));
    }
}
