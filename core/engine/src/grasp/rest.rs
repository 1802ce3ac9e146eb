//! Whether an arm stands where it was sent before anything moves.

use plumbline_grasp::attempt::{FINGER_HANGS_RAD, HANGS_RAD};

use super::around::GraspAround;
use super::gates::{closed, doubtful, open};
use super::view::{Gate, Need};
use crate::robot::view::{JointView, MotionState};

/// Faster than this a joint turns, rad/s.
const TURNS_RAD_S: f64 = 0.1;

/// The arm and its fingers stand, where they were sent: some degrees of droop and play are as they should be.
pub(super) fn rest(around: &GraspAround, arm: &str) -> Gate {
    let robot = &around.robot;
    if robot.rests_on_the_way {
        return open(Need::Rest, "The arm holds on its way.");
    }
    if matches!(robot.motion, MotionState::Moving { .. }) {
        // A grasp that is under way, or a move: what turns now turns on purpose, and follows a little behind.
        return doubtful(Need::Rest, "The arm is on its way.");
    }
    let Some(arm) = around.described.arm(arm) else {
        return closed(Need::Rest, "The robot has no such arm.");
    };
    let is_of_arm = |joint: &JointView| arm.joints.contains(&joint.joint) || arm.hand.contains(&joint.joint);
    let of_arm = |joint: &&JointView| is_of_arm(joint) && joint.torque_on == Some(true);
    let may_hang_rad =
        |joint: &JointView| if arm.hand.contains(&joint.joint) { FINGER_HANGS_RAD } else { HANGS_RAD };
    let turns = |joint: &&JointView| joint.speed_rad_s.is_some_and(|speed| speed.abs() > TURNS_RAD_S);
    if let Some(joint) = robot.joints.iter().filter(of_arm).find(turns) {
        // A reading may be half a second old: the grasp itself waits, and refuses if it does not end.
        return doubtful(Need::Rest, format!("{} turns: the grasp waits until it stands.", joint.title));
    }
    let off_rad = |joint: &JointView| Some((joint.angle_rad? - robot.commanded.as_ref()?[joint.joint]).abs());
    let mut hanging = robot.joints.iter().filter(of_arm).filter_map(|joint| Some((joint, off_rad(joint)?)));
    match hanging.find(|(joint, off_rad)| *off_rad > may_hang_rad(joint)) {
        Some((joint, off_rad)) => closed(
            Need::Rest,
            format!(
                "{} is {:.0}° from where it was sent: free the arm by hand, or press Arm home.",
                joint.title,
                off_rad.to_degrees()
            ),
        ),
        None if robot.joints.iter().any(|joint| is_of_arm(joint) && joint.torque_on == Some(false)) => {
            doubtful(Need::Rest, "Joints of the arm are limp: where it stands holds it, nothing else.")
        }
        None => open(Need::Rest, "The arm stands, and holds what it was told last."),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_model::robot::{Limits, Rig, Servo};

    use super::*;
    use crate::grasp::view::GateState;
    use crate::robot::view::RobotView;

    /// A robot that stands at home, but for its right elbow.
    fn elbow(off_rad: f64, speed_rad_s: f64) -> GraspAround {
        but_for("r_elbow_y", off_rad, speed_rad_s)
    }

    /// A robot that stands at home, but for a joint: so far (rad) from where it was sent, and turning so fast
    /// (rad/s).
    fn but_for(name: &str, off_rad: f64, speed_rad_s: f64) -> GraspAround {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let one = rig.description.find_joint(name).expect("a joint");
        let home = rig.home();
        let joint = |servo: &Servo| JointView {
            angle_rad: Some(home[servo.joint] + if servo.joint == one { off_rad } else { 0.0 }),
            speed_rad_s: Some(if servo.joint == one { speed_rad_s } else { 0.0 }),
            torque_on: Some(true),
            ..JointView::unheard(servo, Limits { lower_rad: -3.0, upper_rad: 3.0 })
        };
        let joints = rig.servos.iter().map(joint).collect();
        let robot = RobotView { joints, commanded: Some(home.clone()), ..RobotView::default() };
        GraspAround { robot: Arc::new(robot), ..GraspAround::bare(&rig) }
    }

    #[test]
    fn an_arm_that_turns_is_waited_for_and_one_that_hangs_is_not_sent_anywhere() {
        let of = |off_rad, speed_rad_s| rest(&elbow(off_rad, speed_rad_s), "right");
        // Some degrees of droop are as they should be, and what flickers does not turn.
        assert_eq!(of(HANGS_RAD - 0.03, 0.03).state, GateState::Open);
        let turns = of(0.0, -0.4);
        assert_eq!(turns.state, GateState::Doubtful);
        assert!(turns.text.contains("Right elbow turns: the grasp waits"), "{}", turns.text);
        for off_rad in [0.18, -0.18] {
            let hangs = of(off_rad, 0.0);
            assert_eq!(hangs.state, GateState::Shut);
            assert!(hangs.text.contains("Right elbow is 10° from where it was sent"), "{}", hangs.text);
        }
        assert_eq!(rest(&elbow(0.18, 0.4), "left").state, GateState::Open, "the other arm is not used");
        let mut unsent = elbow(0.18, 0.0);
        Arc::make_mut(&mut unsent.robot).commanded = None;
        assert_eq!(rest(&unsent, "right").state, GateState::Open, "nothing was sent yet");
    }

    #[test]
    fn fingers_may_press_on_what_they_hold_and_turn_and_hang_no_more_than_the_arm() {
        let of = |off_rad, speed_rad_s| rest(&but_for("r_indexfinger_x", off_rad, speed_rad_s), "right");
        assert_eq!(of(-FINGER_HANGS_RAD + 0.05, 0.0).state, GateState::Open, "it presses");
        assert_eq!(of(-FINGER_HANGS_RAD - 0.05, 0.0).state, GateState::Shut);
        assert_eq!(of(0.0, 0.4).state, GateState::Doubtful);
    }

    #[test]
    fn while_the_arm_is_moved_nothing_is_waited_for() {
        for (off_rad, speed_rad_s) in [(0.0, -0.4), (0.2, -0.4)] {
            let mut around = elbow(off_rad, speed_rad_s);
            let what = "grasping".to_owned();
            Arc::make_mut(&mut around.robot).motion =
                MotionState::Moving { what, fraction: None, remaining: None };
            let gate = rest(&around, "right");
            // Neither green nor shut: it moves, and nothing is wrong with that.
            assert_eq!(gate.state, GateState::Doubtful, "{gate:?}");
            assert!(gate.text.contains("on its way") && !gate.text.contains("waits"), "{gate:?}");
        }
    }
}
