//! Whether the way from one posture to another is free, and how long it takes.

use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use nalgebra::Vector3;
use plumbline_hardware::joints::{FloorShift, Guard, Refusal};
use plumbline_model::robot::collision::{Allowance, BesideModel, CollisionModel, PathCheck as Found};
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::unable::InTheWay;
use super::view::PathCheck;

/// Encoders read to a tick, and a loaded joint hangs: a start this far beyond a limit is no
/// reason to refuse what leads back.
const LIMIT_SLACK_RAD: f64 = 0.03;

/// Checks ways of one robot. Clones share what is around it and what may be touched: the guard in
/// the bus's thread is such a clone.
#[derive(Clone)]
pub struct Paths {
    around: Arc<RwLock<Around>>,
    floor: FloorShift,
    rig: Arc<Rig>,
}

/// Bodies, and what of them may meet at this moment.
struct Around {
    /// The robot and what stands around it.
    model: Arc<CollisionModel>,
    /// The robot that these are of.
    rig: Arc<Rig>,
    /// Joints of the arm that is sent beside where its hand ends, and how far, m.
    beside: Option<(Vec<JointIndex>, Vector3<f64>)>,
    /// The same with that hand where it ends.
    checked: Arc<BesideModel>,
    allowances: Arc<[Allowance]>,
}

impl Around {
    fn new(rig: &Arc<Rig>) -> Self {
        let model = Arc::new(CollisionModel::of_rig(rig));
        let checked = Arc::new(BesideModel::new(model.clone(), rig, &[], Vector3::zeros()));
        Self { model, rig: rig.clone(), beside: None, checked, allowances: Arc::from([]) }
    }

    fn look_anew(&mut self) {
        let (joints, by_m) = self.beside.clone().unwrap_or_default();
        self.checked = Arc::new(BesideModel::new(self.model.clone(), &self.rig, &joints, by_m));
    }
}

impl Paths {
    /// For a robot on its table.
    pub fn new(rig: &Arc<Rig>) -> Self {
        let around = Arc::new(RwLock::new(Around::new(rig)));
        Self { around, floor: FloorShift::default(), rig: rig.clone() }
    }

    /// The shift of the floor that goes with these ways.
    pub fn floor(&self) -> FloorShift {
        self.floor.clone()
    }

    /// The robot's bodies.
    pub fn model(&self) -> Arc<CollisionModel> {
        self.around.read().unwrap_or_else(PoisonError::into_inner).model.clone()
    }

    /// The same robot among things that lie elsewhere. What is known of a hand stays.
    pub fn place(&self, rig: &Arc<Rig>) {
        let mut around = self.around.write().unwrap_or_else(PoisonError::into_inner);
        (around.model, around.rig) = (Arc::new(CollisionModel::of_rig(rig)), rig.clone());
        around.look_anew();
    }

    /// From now on the arm of these joints is sent this much beside where its hand is known to end (robot axes, m):
    /// what the hand must not meet lies beside by as much, for the arm as it is described.
    pub fn sent_beside(&self, joints: &[JointIndex], by_m: Vector3<f64>) {
        let mut around = self.around.write().unwrap_or_else(PoisonError::into_inner);
        around.beside = Some((joints.to_vec(), by_m));
        around.look_anew();
        self.floor.set_m(by_m.z);
    }

    /// While the finger is lowered: what may meet, and how much deeper than usual it may go where it meets nothing, m.
    pub fn lower(&self, allowances: Vec<Allowance>, deeper_m: f64) {
        let mut around = self.around.write().unwrap_or_else(PoisonError::into_inner);
        around.allowances = allowances.into();
        let up_m = around.beside.as_ref().map_or(0.0, |(_, by_m)| by_m.z);
        self.floor.set_m(up_m - deeper_m);
    }

    /// From now on nothing may meet, and every arm stands where it is sent.
    pub fn as_described(&self) {
        let mut around = self.around.write().unwrap_or_else(PoisonError::into_inner);
        (around.beside, around.allowances) = (None, Arc::from([]));
        around.look_anew();
        self.floor.set_m(0.0);
    }

    /// What may meet from now on: a finger and the screen, while it is touched; usually nothing.
    pub fn allow(&self, allowances: Vec<Allowance>) {
        self.around.write().unwrap_or_else(PoisonError::into_inner).allowances = allowances.into();
    }

    fn look(&self) -> (Arc<BesideModel>, Arc<[Allowance]>) {
        let around = self.around.read().unwrap_or_else(PoisonError::into_inner);
        (around.checked.clone(), around.allowances.clone())
    }

    /// The smallest distance on the straight way in joint space, or a sentence that says what
    /// is in the way.
    pub fn check(&self, from: &Posture, to: &Posture) -> Result<PathCheck, InTheWay> {
        let from = self.without_slack(from);
        let to = self.without_slack(to);
        let (model, allowances) = self.look();
        match model.check_path(&from, &to, &allowances)? {
            Found::Clear { smallest_m, between, .. } => Ok(PathCheck {
                smallest_m,
                between: between
                    .map(|pair| format!("{} and {}", pair.a_name, pair.b_name))
                    .unwrap_or_default(),
            }),
            Found::Collides { at_fraction, contact, .. } => {
                let a = sentence_start(&contact.a_name);
                Err(InTheWay::Collides { a, b: contact.b_name, at_fraction })
            }
            Found::BeyondLimit { name, by_rad, why, at_fraction, .. } => {
                Err(InTheWay::BeyondLimit { joint: self.title(name), by_rad, why, at_fraction })
            }
        }
    }

    /// What a joint of this name is called for people.
    fn title(&self, name: String) -> String {
        let joint = self.rig.description.find_joint(&name).ok();
        let servo = joint.and_then(|joint| self.rig.servo_of(joint));
        servo.map_or(name, |servo| servo.title.clone())
    }

    /// The posture with joints that read a little beyond their limits put back to them.
    fn without_slack(&self, posture: &Posture) -> Posture {
        let mut posture = posture.clone();
        for servo in &self.rig.servos {
            let excess_rad = self.rig.limits_in(servo.joint, &posture).excess_rad(posture[servo.joint]);
            if excess_rad.abs() < LIMIT_SLACK_RAD {
                posture[servo.joint] -= excess_rad;
            }
        }
        posture
    }
}

/// In the thread of the bus each small step is looked at once more: nothing passes that nobody
/// has checked.
impl Guard for Paths {
    fn check(&self, present: &Posture, goal: &Posture) -> Result<(), Refusal> {
        Self::check(self, present, goal).map(drop).map_err(|way| Refusal::Guarded(way.to_string()))
    }
}

fn sentence_start(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Time of a move with minimal jerk whose fastest joint turns by `turn_rad` at no more than
/// `peak_rad_s`: the peak speed of such a move is 15/8 of its mean speed.
pub fn duration(turn_rad: f64, peak_rad_s: f64) -> Duration {
    Duration::try_from_secs_f64(1.875 * turn_rad / peak_rad_s).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nico() -> Arc<Rig> {
        Arc::new(Rig::built_in("nico").expect("the rig that comes with the program"))
    }

    #[test]
    fn from_home_to_home_is_free_and_an_arm_through_the_table_is_not() {
        let rig = nico();
        let paths = Paths::new(&rig);
        let home = rig.home();
        assert!(paths.check(&home, &home).is_ok());
        let joint = |name| rig.description.find_joint(name).expect("a joint of NICO");
        let down =
            home.with(&[joint("r_shoulder_y"), joint("r_elbow_y"), joint("r_arm_x")], &[0.3, 3.1, 0.1]);
        let message = paths.check(&home, &down).expect_err("the table is in the way").to_string();
        assert!(message.contains("would run into"), "{message}");
    }

    #[test]
    fn every_pose_of_the_rig_can_be_reached_from_home() {
        let rig = nico();
        let paths = Paths::new(&rig);
        for pose in &rig.poses {
            if let Err(reason) = paths.check(&rig.home(), &pose.applied_to(&rig.home())) {
                panic!("{}: {reason}", pose.name);
            }
        }
    }

    #[test]
    fn a_joint_that_reads_half_a_tick_beyond_its_limit_may_come_back() {
        let rig = nico();
        let elbow = rig.description.find_joint("r_elbow_y").expect("a joint of NICO");
        let beyond = rig.home().with(&[elbow], &[rig.limits(elbow).lower_rad - 0.001]);
        assert!(Paths::new(&rig).check(&beyond, &rig.home()).is_ok());
    }
}
