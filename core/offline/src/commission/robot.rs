//! The robot that is commissioned: what it does, how long that takes, and a person's part of it.

use std::sync::Arc;

use image::RgbImage;
use plumbline_grasp::Body as _;
use plumbline_model::robot::Posture;
use plumbline_model::{Board, Pose, Robot as RobotFrame};
use plumbline_twin::Lockstep;
use plumbline_twin::eyes::EyeRenderer;

use super::error::CommissionError;
use super::lab::Lab;
use crate::twin_body::TwinBody;

/// Peak speed of joints on the way, rad/s: that of touches in the window.
pub(super) const SPEED_RAD_S: f64 = 0.6;
/// A person brings the board to a new place and says so, s.
pub(super) const PERSON_S: f64 = 10.0;

/// The robot during one step. Every step begins with one that stands at home, so that work which was
/// interrupted between two steps goes on as if it had not been.
pub(super) struct Robot {
    twin: TwinBody,
    /// Since it was switched on, when the step began, s.
    before_s: f64,
    /// A person's time in this step, s.
    person_s: f64,
}

/// A pair of images and the encoders at that moment.
pub(super) struct Sight {
    pub left: Arc<RgbImage>,
    pub right: Arc<RgbImage>,
    pub posture: Posture,
}

impl Robot {
    /// On since `before_s`, its table cleared.
    pub fn new(lab: &Lab, before_s: f64, eyes: Option<EyeRenderer>) -> Result<Self, CommissionError> {
        let mut lockstep = Lockstep::new(lab.rig.clone(), &lab.scenario, lab.seed)?.with_eyes(eyes);
        lockstep.advance_warm_up(before_s);
        Ok(Self { twin: TwinBody::cleared(lockstep), before_s, person_s: 0.0 })
    }

    /// The twin itself, for those who judge.
    pub fn lockstep(&mut self) -> &mut Lockstep {
        self.twin.twin()
    }

    /// What looks, and moves as it is told.
    pub fn body(&mut self) -> &mut TwinBody {
        &mut self.twin
    }

    /// Time since it was switched on, s.
    pub fn on_s(&self) -> f64 {
        self.before_s + self.spent_s()
    }

    /// Time of this step, s.
    pub fn spent_s(&self) -> f64 {
        self.person_s + self.twin.now_s()
    }

    /// Everything stands still for a while: a person does something, or the eyes warm up.
    pub fn pass(&mut self, duration_s: f64) {
        self.lockstep().advance_warm_up(duration_s);
        self.person_s += duration_s;
    }

    /// A person puts the board somewhere, or takes it away.
    pub fn hold_board(&mut self, place: Option<Pose<RobotFrame, Board>>) {
        self.lockstep().hold_board(place);
        self.pass(PERSON_S);
    }

    /// To a posture, until it stands there.
    pub fn go(&mut self, posture: &Posture) {
        self.lockstep().follow(std::slice::from_ref(posture), SPEED_RAD_S);
    }

    /// What the eyes see.
    pub fn look(&mut self) -> Result<Sight, CommissionError> {
        let pair = self.lockstep().look()?;
        let posture = self.lockstep().encoders();
        Ok(Sight { left: Arc::new(pair.left), right: Arc::new(pair.right), posture })
    }

    /// The renderer, for the next step.
    pub fn into_eyes(self) -> Option<EyeRenderer> {
        self.twin.into_twin().take_eyes()
    }
}
