//! Who carries out a grasp: a robot on its bus, or a twin.

use std::sync::Arc;

use image::RgbImage;
use plumbline_effects::robot_model::SeenUnder;
use plumbline_model::robot::{JointIndex, Posture, Rig};

/// Fingers press with this share of their stall torque: far less than what shuts a servo down for an
/// overload, and about 5 N at a fingertip. (Physics, `tests/tolerance.rs`: of tomatoes 8 % larger than usual, of 0.72
/// of the friction and 1.3 of the mass, 4 of 22 are still held after ten seconds with 0.4, 17 with 0.5, 19 with 0.6;
/// of the usual size all, and a hand that is 12 mm beside holds more of them with 0.5 than with 0.4.)
const FINGER_FORCE: f64 = 0.5;
/// The thumb with this one: the motors of two fingers press against it, and what it cannot hold against them is
/// pushed out across the hand. (A tomato of 0.7 of the usual friction and 1.3 of the mass, physics, eight places:
/// 3 are still held after ten seconds where all press with 0.2, 5 with 0.35, 7 where the thumb alone may use
/// 0.5, and 8 with 0.4 and 0.8.) More would shut its servo down after seconds.
const THUMB_FORCE: f64 = 0.8;
/// Fingers that close bend this fast, rad/s.
pub const GRIP_RAD_S: f64 = 1.2;

/// The share of its stall torque with which a joint of a hand presses on what it meets.
pub fn grip_force(rig: &Rig, joint: JointIndex) -> f64 {
    if is_thumb(rig, joint) { THUMB_FORCE } else { FINGER_FORCE }
}

/// Whether a joint of a hand is one of its thumb.
pub fn is_thumb(rig: &Rig, joint: JointIndex) -> bool {
    rig.description.joint(joint).name.contains("thumb")
}

/// Joints that are elsewhere than before by more than `same_rad` in one of these postures, in the order of their
/// servos.
pub fn turning(rig: &Rig, from: &Posture, way: &[Posture], same_rad: f64) -> Vec<JointIndex> {
    let turns = |joint: &JointIndex| way.iter().any(|to| (to[*joint] - from[*joint]).abs() > same_rad);
    rig.servos.iter().map(|servo| servo.joint).filter(turns).collect()
}

/// Whether these goals are of fingers alone, each farther bent than it is: they close, and what they meet is pressed.
pub fn closes(hands: &[JointIndex], from: &Posture, goals: &[(JointIndex, f64)]) -> bool {
    let bends =
        |(joint, to_rad): &(JointIndex, f64)| hands.contains(joint) && to_rad.abs() > from[*joint].abs();
    !goals.is_empty() && goals.iter().all(bends)
}

/// What carries out what a grasp asks for. Calls wait until it is done.
///
/// Whoever asks has checked the way; whoever carries out has limits of its own, and may refuse.
pub trait Body {
    /// The robot as described.
    fn rig(&self) -> &Arc<Rig>;

    /// Its clock, s.
    fn now_s(&self) -> f64;

    /// All joints as the servos have them now, in the order of the rig.
    ///
    /// # Errors
    /// When that is not known.
    fn servos(&mut self) -> Result<Vec<ServoState>, Halt>;

    /// What was commanded last; joints that were never commanded stand where their encoders say.
    ///
    /// # Errors
    /// When that is not known.
    fn commanded(&mut self) -> Result<Posture, Halt>;

    /// Through postures one after another, each in a straight line in joint space from what was
    /// commanded last with this peak speed (rad/s), until the joints have come to rest.
    ///
    /// # Errors
    /// When it was not carried out to its end. The arm holds where it is.
    fn follow(&mut self, way: &[Posture], speed_rad_s: f64) -> Result<(), Halt>;

    /// Fingers that were closed press anew: what they hold may have given way. A body whose fingers press
    /// all the time has nothing to do.
    ///
    /// # Errors
    /// When it was not carried out to its end.
    fn grip(&mut self) -> Result<(), Halt> {
        Ok(())
    }

    /// Holds for a time (s).
    ///
    /// # Errors
    /// When somebody wants it to end.
    fn wait(&mut self, duration_s: f64) -> Result<(), Halt>;

    /// A pair that was taken after this call.
    ///
    /// # Errors
    /// When there is none.
    fn look(&mut self) -> Result<Sight, Halt>;
}

/// A servo as it says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoState {
    /// The joint that it moves.
    pub joint: JointIndex,
    /// By the encoder, rad of the joint.
    pub angle_rad: f64,
    /// Share of the full torque in the joint's sense, −1 to 1; `None`: it does not say.
    pub load: Option<f64>,
    /// Current of its motor, A; `None`: it does not say.
    pub current_a: Option<f64>,
    /// °C; `None`: it does not say.
    pub temperature_c: Option<f64>,
}

/// A pair of images and the robot at that moment.
#[derive(Clone, Debug)]
pub struct Sight {
    /// Left eye, raw.
    pub left: Arc<RgbImage>,
    /// Right eye, raw.
    pub right: Arc<RgbImage>,
    /// All joints by their encoders.
    pub posture: Posture,
    /// Clock of the body, s.
    pub at_s: f64,
    /// For how long the eyes had been on, s; `None`: nobody knows.
    pub eyes_on_s: Option<f64>,
    /// Counts up with every pair.
    pub seq: u64,
}

impl Sight {
    /// What effects on the eyes depend on besides the posture.
    pub fn seen_under(&self) -> SeenUnder {
        SeenUnder { t_secs: self.eyes_on_s, ..SeenUnder::default() }
    }
}

/// Why something was not carried out to its end. The arm holds where it is. Reads as a sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Halt {
    /// The operator pressed STOP.
    #[error("STOP was pressed")]
    Stopped,
    /// The operator ended it.
    #[error("it was ended by the operator")]
    Cancelled,
    /// The robot does not answer, or not all of it.
    #[error("the robot is not known any more: {0}")]
    Lost(String),
    /// What protects the robot refused.
    #[error("{0}")]
    Refused(String),
    /// The eyes give no pairs.
    #[error("the eyes give no pairs: {0}")]
    Blind(String),
}
