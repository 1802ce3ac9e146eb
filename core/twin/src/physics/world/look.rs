//! Where everything is: for drawing, and for judging.

use mujoco_rs::prelude::*;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use plumbline_model::frame::Head;
use plumbline_model::robot::{LinkIndex, Rig};
use plumbline_model::{Pose, Robot};

use super::{EyePlaces, World};
use crate::physics::place::Places;
use crate::scenario::Scenario;
use crate::scene::{Snapshot, TrueEyes};

impl World {
    /// True places of table and touchscreen. For judging only.
    pub(crate) fn places(&self) -> &Places {
        &self.places
    }

    /// True place of a link, or of a mark on one. For judging only.
    pub(crate) fn true_link(&self, link: LinkIndex) -> Option<Isometry3<f64>> {
        let name = &self.rig.description.links()[link.0].name;
        let (position, turn) = if let Some(body) = self.data.body(name) {
            let view = body.view(&self.data);
            let q = view.xquat;
            return Some(isometry([view.xpos[0], view.xpos[1], view.xpos[2]], [q[0], q[1], q[2], q[3]]));
        } else {
            let site = self.data.site(name)?;
            let view = site.view(&self.data);
            let mut turn = [0.0; 9];
            turn.copy_from_slice(&view.xmat[..]);
            ([view.xpos[0], view.xpos[1], view.xpos[2]], turn)
        };
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_row_slice(&turn));
        let turn = UnitQuaternion::from_rotation_matrix(&rotation);
        Some(Isometry3::from_parts(Translation3::from(position), turn))
    }

    /// Brings all places up to date with the joint angles; a step leaves them one step behind.
    pub(crate) fn refresh(&mut self) {
        self.data.forward();
    }

    /// Where everything is now, for drawing.
    pub fn snapshot(&self) -> Snapshot {
        let bodies = self.data.xpos().iter().zip(self.data.xquat());
        Snapshot {
            time_s: self.data.time(),
            robot_from_body: bodies.map(|(p, q)| isometry(*p, *q)).collect(),
            eyes: self.true_eyes(),
        }
    }

    /// The eyes as they are now.
    pub(crate) fn true_eyes(&self) -> TrueEyes {
        let body = self.eyes_body;
        let head = Pose::<Robot, Head>::new(isometry(self.data.xpos()[body], self.data.xquat()[body]));
        let (left_turn, right_turn) = self.warm_up.turns();
        let robot_from_cold_left = head * self.eyes.head_from_left;
        let robot_from_cold_right = robot_from_cold_left * self.eyes.left_from_right;
        let cameras = &self.rig.eyes.cameras;
        TrueEyes {
            robot_from_left: Pose::new(robot_from_cold_left.isometry * left_turn),
            robot_from_right: Pose::new(robot_from_cold_right.isometry * right_turn),
            left: cameras.left,
            right: cameras.right,
        }
    }

    /// Number of the body of a link in a [`Snapshot`]; `None` for mere marks.
    pub(crate) fn body_of_link(&self, link: LinkIndex) -> Option<usize> {
        self.body_named(&self.rig.description.links()[link.0].name)
    }

    /// Number of a body in a [`Snapshot`].
    pub(crate) fn body_named(&self, name: &str) -> Option<usize> {
        self.data.model().name_to_id(MjtObjBase::mjOBJ_BODY, name)
    }

    /// Number of the chessboard's body.
    pub(crate) fn board_body(&self) -> usize {
        self.board_body
    }

    /// Lets the eyes' clock run ahead.
    pub fn advance_warm_up(&mut self, duration_s: f64) {
        self.warm_up.pass(duration_s);
    }

    /// Lets the eyes' clock run so many times faster than everything else; their warming up goes with it.
    pub fn set_warm_up_pace(&mut self, times: f64) {
        self.warm_up_pace = times;
    }

    /// How many times faster than everything else the eyes' clock runs.
    pub fn warm_up_pace(&self) -> f64 {
        self.warm_up_pace
    }

    /// The eyes are cold again.
    pub fn cool_eyes(&mut self) {
        self.warm_up.reset();
    }

    /// Since when the eyes are on, s.
    pub fn eyes_on_s(&self) -> f64 {
        self.warm_up.on_s()
    }
}

impl EyePlaces {
    pub(super) fn of(rig: &Rig, scenario: &Scenario) -> Self {
        let reality = &scenario.eyes;
        let nominal = rig.eyes.head_from_left.isometry;
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(reality.rotation_rad));
        let place = nominal.translation.vector + Vector3::from(reality.translation_m);
        let left = Isometry3::from_parts(Translation3::from(place), turn * nominal.rotation);
        let right_turn = UnitQuaternion::from_scaled_axis(Vector3::from(reality.right_rotation_rad));
        let right = rig.eyes.cameras.right_from_left.inverse().isometry * right_turn;
        Self { head_from_left: Pose::new(left), left_from_right: Pose::new(right) }
    }
}

pub(super) fn isometry(position: [f64; 3], [w, i, j, k]: [f64; 4]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
    Isometry3::from_parts(Translation3::from(position), turn)
}
