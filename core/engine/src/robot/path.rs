//! Whether the way from one posture to another is free, and how long it takes.

use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use nalgebra::Vector3;
use plumbline_hardware::joints::{FloorShift, Guard, Refusal};
use plumbline_model::robot::collision::{Allowance, CollisionModel, PathCheck as Found};
use plumbline_model::robot::{Posture, Rig};

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
    /// Where they lie.
    model: Arc<CollisionModel>,
    rig: Arc<Rig>,
    /// Where they lie for the arm as it is described, while it is known to stand beside that.
    beside: Option<Arc<CollisionModel>>,
    allowances: Arc<[Allowance]>,
}

impl Paths {
    /// For a robot on its table.
    pub fn new(rig: &Arc<Rig>) -> Self {
        let model = Arc::new(CollisionModel::of_rig(rig));
        let around = Around { model, rig: rig.clone(), beside: None, allowances: Arc::from([]) };
        Self { around: Arc::new(RwLock::new(around)), floor: FloorShift::default(), rig: rig.clone() }
    }

    /// The shift of the floor that goes with these ways.
    pub fn floor(&self) -> FloorShift {
        self.floor.clone()
    }

    /// The robot's bodies.
    pub fn model(&self) -> Arc<CollisionModel> {
        self.around.read().unwrap_or_else(PoisonError::into_inner).model.clone()
    }

    /// The same robot among things that lie elsewhere.
    pub fn place(&self, rig: &Arc<Rig>) {
        let mut around = self.around.write().unwrap_or_else(PoisonError::into_inner);
        (around.model, around.rig) = (Arc::new(CollisionModel::of_rig(rig)), rig.clone());
        around.beside = None;
        self.floor.set_m(0.0);
    }

    /// From now on the arm is sent this much beside where it is known to end (robot axes, m): what it must not
    /// meet lies beside by as much, for the arm as it is described. Zero: it stands where it is sent.
    pub fn sent_beside(&self, by_m: Vector3<f64>) {
        let mut around = self.around.write().unwrap_or_else(PoisonError::into_inner);
        let moved = (by_m.norm() > 0.0).then(|| around.rig.with_surroundings_moved(by_m));
        around.beside = moved.map(|rig| Arc::new(around.model.among(&rig)));
        self.floor.set_m(by_m.z);
    }

    /// What may meet from now on: a finger and the screen, while it is touched; usually nothing.
    pub fn allow(&self, allowances: Vec<Allowance>) {
        self.around.write().unwrap_or_else(PoisonError::into_inner).allowances = allowances.into();
    }

    fn look(&self) -> (Arc<CollisionModel>, Arc<[Allowance]>) {
        let around = self.around.read().unwrap_or_else(PoisonError::into_inner);
        (around.beside.as_ref().unwrap_or(&around.model).clone(), around.allowances.clone())
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
                Err(InTheWay::BeyondLimit { joint: name, by_rad, why, at_fraction })
            }
        }
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
