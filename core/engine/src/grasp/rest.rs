//! Whether an arm stands where it was sent before anything moves.

use plumbline_grasp::attempt::HANGS_RAD;

use super::around::GraspAround;
use super::gates::{closed, doubtful, open};
use super::view::Gate;
use crate::robot::view::JointView;

/// Faster than this a joint turns, rad/s.
const TURNS_RAD_S: f64 = 0.1;

/// The arm stands, where it was sent: some degrees of droop and play are as they should be. Fingers press on
/// what they hold, and stay behind.
pub(super) fn rest(around: &GraspAround, arm: &str) -> Gate {
    let robot = &around.robot;
    let of_arm = |joint: &&JointView| {
        around.described.arm(arm).is_some_and(|arm| arm.joints.contains(&joint.joint))
            && joint.torque_on == Some(true)
    };
    let turns = |joint: &&JointView| joint.speed_rad_s.is_some_and(|speed| speed.abs() > TURNS_RAD_S);
    if let Some(joint) = robot.joints.iter().filter(of_arm).find(turns) {
        // A reading may be half a second old: the grasp itself waits, and refuses if it does not end.
        return doubtful("Rest", format!("{} turns: the grasp waits until it stands.", joint.title));
    }
    let off_rad = |joint: &JointView| Some((joint.angle_rad? - robot.commanded.as_ref()?[joint.joint]).abs());
    let mut hanging = robot.joints.iter().filter(of_arm).filter_map(|joint| Some((joint, off_rad(joint)?)));
    match hanging.find(|(_, off_rad)| *off_rad > HANGS_RAD) {
        Some((joint, off_rad)) => closed(
            "Rest",
            format!(
                "{} is {:.0}° from where it was sent: look what holds it there, then choose Home.",
                joint.title,
                off_rad.to_degrees()
            ),
        ),
        None => open("Rest", "The arm stands where it was sent."),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_model::robot::{Limits, Rig, Servo};

    use super::*;
    use crate::grasp::view::GateState;
    use crate::robot::view::RobotView;

    /// A robot that stands at home, but for its right elbow: so far (rad) from where it was sent, and turning so
    /// fast (rad/s).
    fn elbow(off_rad: f64, speed_rad_s: f64) -> GraspAround {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let elbow = rig.description.find_joint("r_elbow_y").expect("an elbow");
        let home = rig.home();
        let joint = |servo: &Servo| JointView {
            angle_rad: Some(home[servo.joint] + if servo.joint == elbow { off_rad } else { 0.0 }),
            speed_rad_s: Some(if servo.joint == elbow { speed_rad_s } else { 0.0 }),
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
        assert_eq!(of(0.12, 0.03).state, GateState::Open);
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
}
