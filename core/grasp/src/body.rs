//! Who carries out a grasp: a robot on its bus, or a twin.

use std::sync::Arc;

use image::RgbImage;
use plumbline_effects::robot_model::SeenUnder;
use plumbline_model::robot::{JointIndex, Posture, Rig};

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
