//! With which model the robot's thread knows the robot.

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_effects::rig_model::Conditions;
use plumbline_model::frame::{Pose, Robot, Tip};
use plumbline_model::robot::{Posture, Reach};

use super::Worker;

impl Worker {
    /// From now on the robot is known so. A move that is shown was found with another arm where the
    /// effects are others: it is shown no more.
    pub fn use_model(&mut self, model: Arc<RobotModel>) {
        let screen_moved = self.rig.touchscreen != model.rig().touchscreen;
        let other_effects = !Arc::ptr_eq(self.model.added(), model.added())
            && self.model.added().contents != model.added().contents;
        (self.rig, self.title) = (model.rig().clone(), model.title().into());
        self.arm_model = model.arm(&self.tip).ok();
        self.model = model;
        self.forget_level();
        if screen_moved {
            self.paths.place(&self.rig);
            self.reach = Reach::with_model(&self.rig, &self.tip, self.paths.model()).ok();
        }
        if other_effects {
            self.preview = None;
            self.trail.clear();
        }
    }

    /// Where the tip is when encoders read a posture.
    pub(in crate::robot) fn tip_by_encoders(&self, encoders: &Posture) -> Pose<Robot, Tip> {
        match &self.arm_model {
            Some(arm) => arm.robot_from_tip_by_encoders(encoders, &Conditions::default()),
            None => self.chain.robot_from_tip_in(encoders),
        }
    }
}
