//! Goes on looking whether a thing that was grasped is still in the hand, until the hand is told something
//! else.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use plumbline_grasp::body::grip_force;
use plumbline_grasp::{Grip, Hand, HoldWatch, ServoState};
use plumbline_model::robot::{JointIndex, Rig};

use super::view::{AttemptView, SinceHeld};
use crate::robot::view::{JointView, MotionState, RobotView};

/// A hand whose joints are sent so much farther open than they were, the mean, was told to open, rad. The goals
/// of a grip go on with its fingers, a little back and forth around what is held and far on around nothing.
const OPENED_RAD: f64 = 0.3;

/// Fingers that have bent on by this since it was grasped are about to lose it, rad. (On the twin they bend on by 5° in the
/// first two minutes around a tomato, and by 14° in six.)
const GIVES_WAY_RAD: f64 = 0.18;

/// No hand presses with less than this share of what it was told.
const LEAST_LEFT: f64 = 0.3;

/// A thing in a hand.
#[derive(Clone, Debug)]
pub struct HeldWatch {
    /// Name of the attempt that grasped it.
    pub attempt: String,
    /// Its folder.
    pub folder: PathBuf,
    /// What is held.
    pub object: String,
    /// In which hand.
    pub hand: Hand,
    hold: HoldWatch,
    /// Since when it is known to be held.
    since: Instant,
    /// How far its joints were sent toward the closed hand at most, the mean, rad.
    closed_rad: Option<f64>,
    /// The share of its torque with which each joint was told to press.
    told: Vec<(JointIndex, f64)>,
    /// How far its fingers were kept open when they were felt first, rad.
    open_rad: Option<Vec<f64>>,
    /// How much farther one of them is closed by now, rad.
    gave_rad: f64,
    /// It was asked to leave the hand.
    leaves: bool,
}

impl HeldWatch {
    /// Of an attempt that has just ended and holds something; `None`: the robot has no such hand.
    pub fn of(attempt: &AttemptView, rig: &Rig, robot: &RobotView, now: Instant) -> Option<Self> {
        let mut watch = Self {
            attempt: attempt.name.clone(),
            folder: attempt.folder.clone(),
            object: attempt.object.clone(),
            hand: attempt.hand,
            hold: HoldWatch::new(Grip::of_rig(rig, attempt.hand)?),
            since: now,
            closed_rad: None,
            told: rig
                .arm(attempt.hand.name())?
                .hand
                .iter()
                .map(|joint| (*joint, grip_force(rig, *joint)))
                .collect(),
            open_rad: None,
            gave_rad: 0.0,
            leaves: false,
        };
        watch.closed_rad = watch.sent_rad(robot);
        Some(watch)
    }

    /// The hand is to let go of it: when it is empty, it did.
    pub fn leaves(&mut self) {
        self.leaves = true;
    }

    /// It goes on to hold it after all.
    pub fn stays(&mut self) {
        self.leaves = false;
    }

    /// Looks at the hand; anything but [`SinceHeld::Held`] is the end of it.
    pub fn look(&mut self, robot: &RobotView, now: Instant) -> SinceHeld {
        if !robot.connection.is_connected() {
            return SinceHeld::Unknown;
        }
        // Fingers without force hold nothing, whatever they lie around.
        if self.is_limp(robot) {
            return SinceHeld::LetGo;
        }
        let Some(sent_rad) = self.sent_rad(robot) else { return SinceHeld::Held };
        let closed_rad = self.closed_rad.map_or(sent_rad, |closed_rad| closed_rad.max(sent_rad));
        self.closed_rad = Some(closed_rad);
        if closed_rad - sent_rad > OPENED_RAD {
            return SinceHeld::LetGo;
        }
        // While the arm moves, what it carries presses now more and now less.
        let servos = self.servos(robot).filter(|_| !matches!(robot.motion, MotionState::Moving { .. }));
        if let Some(servos) = &servos {
            self.note_open(servos);
        }
        let now_s = now.saturating_duration_since(self.since).as_secs_f64();
        match self.hold.feel(servos.as_deref(), now_s) {
            Some(_) if self.leaves => SinceHeld::LetGo,
            Some(empty_s) => SinceHeld::Slipped(Duration::from_secs_f64(empty_s)),
            None => SinceHeld::Held,
        }
    }

    /// How far fingers have bent on around what they hold, whole degrees as rad; `None`: no farther than they settle.
    pub fn gives_way_rad(&self) -> Option<f64> {
        (self.gave_rad >= GIVES_WAY_RAD).then(|| self.gave_rad.to_degrees().round().to_radians())
    }

    fn note_open(&mut self, servos: &[ServoState]) {
        let open_rad = self.hold.open_rad(servos);
        let first_rad = self.open_rad.get_or_insert_with(|| open_rad.clone());
        self.gave_rad = open_rad.iter().zip(first_rad).map(|(now, first)| *first - now).fold(0.0, f64::max);
    }

    /// The share of what a joint was told to press with that it still presses with: a hand that got warm presses less.
    fn left(&self, view: &JointView) -> f64 {
        let told = self.told.iter().find(|(joint, _)| *joint == view.joint);
        let left = told.zip(view.force).map_or(1.0, |((_, told), force)| force / told);
        left.clamp(LEAST_LEFT, 1.0)
    }

    /// Whether a joint of the hand was let go limp.
    fn is_limp(&self, robot: &RobotView) -> bool {
        let limp = |joint| {
            let view = robot.joints.iter().find(|view| view.joint == joint);
            view.is_some_and(|view| view.torque_on == Some(false))
        };
        self.hold.joints().any(limp)
    }

    /// How far the joints of the hand are sent from where they are open, the mean, rad; `None` while that is
    /// not known.
    fn sent_rad(&self, robot: &RobotView) -> Option<f64> {
        let goal = |joint| robot.joints.iter().find(|view| view.joint == joint)?.goal_rad;
        let goals_rad: Vec<f64> = self.hold.joints().map(goal).collect::<Option<_>>()?;
        Some(goals_rad.iter().map(|goal_rad| goal_rad.abs()).sum::<f64>() / goals_rad.len().max(1) as f64)
    }

    /// What the servos of the hand say; `None`: not all of them are heard.
    fn servos(&self, robot: &RobotView) -> Option<Vec<ServoState>> {
        let of = |joint| {
            let view = robot.joints.iter().find(|view| view.joint == joint)?;
            // What a hand that presses less holds presses less on it.
            let left = self.left(view);
            Some(ServoState {
                joint,
                angle_rad: view.angle_rad?,
                load: view.load.map(|load| load / left),
                current_a: view.current_a.map(|current_a| current_a / left),
                temperature_c: view.temperature_c,
            })
        };
        self.hold.joints().map(of).collect()
    }
}

#[cfg(test)]
pub(super) mod tests {
    use jiff::Timestamp;
    use plumbline_grasp::{Method, Outcome};
    use plumbline_model::robot::Limits;

    use super::*;
    use crate::robot::view::Connection;

    const HOLDS: MotionState = MotionState::Holding { why: None };

    fn rig() -> Rig {
        Rig::built_in("nico").expect("comes with the program")
    }

    pub fn attempt() -> AttemptView {
        AttemptView {
            name: "one".to_owned(),
            folder: PathBuf::from("one"),
            began: Timestamp::UNIX_EPOCH,
            method: Method::M5,
            hand: Hand::Right,
            model: "as described".to_owned(),
            object: "Tomato".to_owned(),
            outcome: Some(Outcome::Success),
            reached: None,
            told: None,
            slipped_after: None,
            alignment_m: None,
            closed_at_m: None,
            seconds: None,
        }
    }

    /// A robot whose joints press with this share of their torque and were sent there.
    fn robot(load: f64, goal_rad: f64, motion: MotionState) -> RobotView {
        let rig = rig();
        let limits = Limits { lower_rad: -3.0, upper_rad: 3.0 };
        let joint = |servo| JointView {
            angle_rad: Some(1.0),
            goal_rad: Some(goal_rad),
            load: Some(load),
            torque_on: Some(true),
            ..JointView::unheard(servo, limits)
        };
        RobotView {
            joints: rig.servos.iter().map(joint).collect(),
            connection: Connection::Connected { to: "twin".to_owned(), twin: true },
            motion,
            ..RobotView::default()
        }
    }

    fn watch(began: Instant) -> HeldWatch {
        HeldWatch::of(&attempt(), &rig(), &robot(0.2, 1.8, HOLDS), began).expect("it has a right hand")
    }

    #[test]
    fn what_slips_out_is_told_once_the_hand_was_empty_for_a_while() {
        let began = Instant::now();
        let at = |tenths: u64| began + Duration::from_millis(100 * tenths);
        let mut held = watch(began);
        assert_eq!(held.look(&robot(0.2, 1.8, HOLDS), at(1)), SinceHeld::Held);
        // One bad reading, and one as the arm moves, say nothing.
        assert_eq!(held.look(&robot(0.0, 1.8, HOLDS), at(40)), SinceHeld::Held);
        assert_eq!(held.look(&robot(0.2, 1.8, HOLDS), at(41)), SinceHeld::Held);
        let moving = MotionState::Moving { what: "to Home".to_owned(), fraction: None, remaining: None };
        for tenths in 42..70 {
            assert_eq!(held.look(&robot(0.0, 1.8, moving.clone()), at(tenths)), SinceHeld::Held);
        }
        for tenths in 70..80 {
            assert_eq!(held.look(&robot(0.0, 1.8, HOLDS), at(tenths)), SinceHeld::Held);
        }
        // Around nothing the goals of a grip go on to the closed hand.
        let slipped = held.look(&robot(0.0, 2.4, HOLDS), at(80));
        assert_eq!(slipped, SinceHeld::Slipped(Duration::from_secs(7)));
    }

    #[test]
    fn a_hand_that_was_told_something_else_has_not_lost_it() {
        let began = Instant::now();
        let mut held = watch(began);
        assert_eq!(held.look(&robot(0.2, 1.8, HOLDS), began), SinceHeld::Held);
        assert_eq!(held.look(&robot(0.0, 0.0, HOLDS), began), SinceHeld::LetGo);
        let mut limp = robot(0.2, 1.8, MotionState::Limp);
        let joints: Vec<JointView> =
            limp.joints.iter().map(|joint| JointView { torque_on: Some(false), ..joint.clone() }).collect();
        limp.joints = joints.into();
        assert_eq!(watch(began).look(&limp, began), SinceHeld::LetGo, "fingers without force hold nothing");
        let away = RobotView { connection: Connection::None, ..robot(0.2, 1.8, HOLDS) };
        assert_eq!(watch(began).look(&away, began), SinceHeld::Unknown);
    }

    #[test]
    fn what_is_taken_out_on_purpose_has_not_slipped() {
        let began = Instant::now();
        let mut held = watch(began);
        assert_eq!(held.look(&robot(0.2, 1.8, HOLDS), began), SinceHeld::Held);
        held.leaves();
        let at = |seconds| began + Duration::from_secs(seconds);
        assert_eq!(held.look(&robot(0.0, 1.8, HOLDS), at(1)), SinceHeld::Held);
        assert_eq!(held.look(&robot(0.0, 1.8, HOLDS), at(3)), SinceHeld::LetGo);
        // Opened before anybody had looked.
        assert_eq!(watch(began).look(&robot(0.0, 0.0, HOLDS), began), SinceHeld::LetGo);
    }

    #[test]
    fn fingers_that_bend_on_around_what_they_hold_are_told() {
        let began = Instant::now();
        let mut held = watch(began);
        let bent = |by_rad: f64| {
            let robot = robot(0.2, 1.8, HOLDS);
            let bends_up = |joint| {
                let limits = rig().limits(joint);
                limits.upper_rad > -limits.lower_rad
            };
            let farther = |joint: &JointView| match bends_up(joint.joint) {
                true => 1.0 + by_rad,
                false => -1.0 - by_rad,
            };
            let bend = |joint: &JointView| JointView { angle_rad: Some(farther(joint)), ..joint.clone() };
            RobotView { joints: robot.joints.iter().map(bend).collect(), ..robot }
        };
        for (by_rad, told_deg) in [(0.0, None), (0.1, None), (0.2, Some(11.0)), (0.05, None)] {
            assert_eq!(held.look(&bent(by_rad), began), SinceHeld::Held);
            let told = held.gives_way_rad().map(|rad| rad.to_degrees().round());
            assert_eq!(told, told_deg, "bent on by {by_rad}");
        }
    }

    /// Its servos then say less of the same thing.
    #[test]
    fn a_hand_that_got_warm_and_presses_less_has_not_lost_what_it_holds() {
        let began = Instant::now();
        let of = |load: f64, left: f64| {
            let robot = robot(load, 1.8, HOLDS);
            let ease = |joint: &JointView| {
                let told = grip_force(&rig(), joint.joint);
                JointView { force: Some(left * told), ..joint.clone() }
            };
            RobotView { joints: robot.joints.iter().map(ease).collect(), ..robot }
        };
        for (load, left, loses) in [(0.08, 0.5, false), (0.08, 1.0, true), (0.03, 0.5, true)] {
            let mut held = watch(began);
            for seconds in 0..4 {
                let after = held.look(&of(load, left), began + Duration::from_secs(seconds));
                assert_eq!(
                    after != SinceHeld::Held,
                    loses && seconds > 0,
                    "{load} of {left} after {seconds} s"
                );
            }
        }
    }

    #[test]
    fn nothing_is_said_of_a_hand_that_is_not_heard() {
        let began = Instant::now();
        let mut held = watch(began);
        let mut silent = robot(0.0, 1.8, HOLDS);
        silent.joints = silent.joints.iter().map(JointView::without_readings).collect();
        for seconds in 0..20 {
            let now = began + Duration::from_secs(seconds);
            assert_eq!(held.look(&silent, now), SinceHeld::Held);
        }
    }
}
