//! The robot that is commissioned: what it does, how long that takes, and a person's part of it.

use std::sync::Arc;

use image::RgbImage;
use plumbline_grasp::{Body, Halt, ServoState, Sight as BodySight};
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::{Board, Pose, Robot as RobotFrame};
use plumbline_twin::eyes::EyeRenderer;
use plumbline_twin::{Lockstep, Toy};

use super::error::CommissionError;
use super::lab::Lab;

/// Peak speed of joints on the way, rad/s: that of touches in the window.
pub(super) const SPEED_RAD_S: f64 = 0.6;
/// A person brings the board to a new place and says so, s.
pub(super) const PERSON_S: f64 = 10.0;

/// The robot during one step. Every step begins with one that stands at home, so that work which was
/// interrupted between two steps goes on as if it had not been.
pub(super) struct Robot {
    lockstep: Lockstep,
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
        Toy::ALL.into_iter().for_each(|toy| lockstep.remove_toy(toy));
        lockstep.advance_warm_up(before_s);
        Ok(Self { lockstep, before_s, person_s: 0.0 })
    }

    /// The twin itself, for those who judge.
    pub fn lockstep(&mut self) -> &mut Lockstep {
        &mut self.lockstep
    }

    /// Time since it was switched on, s.
    pub fn on_s(&self) -> f64 {
        self.before_s + self.spent_s()
    }

    /// Time of this step, s.
    pub fn spent_s(&self) -> f64 {
        self.person_s + self.lockstep.now_s()
    }

    /// Everything stands still for a while: a person does something, or the eyes warm up.
    pub fn pass(&mut self, duration_s: f64) {
        self.lockstep.advance_warm_up(duration_s);
        self.person_s += duration_s;
    }

    /// A person puts the board somewhere, or takes it away.
    pub fn hold_board(&mut self, place: Option<Pose<RobotFrame, Board>>) {
        self.lockstep.hold_board(place);
        self.pass(PERSON_S);
    }

    /// To a posture, until it stands there.
    pub fn go(&mut self, posture: &Posture) {
        self.lockstep.follow(std::slice::from_ref(posture), SPEED_RAD_S);
    }

    /// What the eyes see.
    pub fn look(&mut self) -> Result<Sight, CommissionError> {
        let pair = self.lockstep.look()?;
        let posture = self.lockstep.encoders();
        Ok(Sight { left: Arc::new(pair.left), right: Arc::new(pair.right), posture })
    }

    /// The renderer, for the next step.
    pub fn into_eyes(mut self) -> Option<EyeRenderer> {
        self.lockstep.take_eyes()
    }
}

impl Body for Robot {
    fn rig(&self) -> &Arc<Rig> {
        self.lockstep.rig()
    }

    fn now_s(&self) -> f64 {
        self.lockstep.now_s()
    }

    fn servos(&mut self) -> Result<Vec<ServoState>, Halt> {
        let servos = self.lockstep.servos().into_iter().map(|servo| ServoState {
            joint: servo.joint,
            angle_rad: servo.angle_rad,
            load: Some(servo.load),
            current_a: None,
            temperature_c: Some(servo.temperature_c),
        });
        Ok(servos.collect())
    }

    fn commanded(&mut self) -> Result<Posture, Halt> {
        Ok(self.lockstep.commanded().clone())
    }

    fn follow(&mut self, way: &[Posture], speed_rad_s: f64) -> Result<(), Halt> {
        self.lockstep.follow(way, speed_rad_s);
        Ok(())
    }

    fn wait(&mut self, duration_s: f64) -> Result<(), Halt> {
        self.lockstep.wait(duration_s);
        Ok(())
    }

    fn look(&mut self) -> Result<BodySight, Halt> {
        let Sight { left, right, posture } =
            Self::look(self).map_err(|error| Halt::Blind(error.to_string()))?;
        let (at_s, eyes_on_s) = (self.on_s(), Some(self.on_s()));
        Ok(BodySight { left, right, posture, at_s, eyes_on_s, seq: 0 })
    }
}
