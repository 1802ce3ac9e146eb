//! A run that holds because joints were not heard goes on by itself, or does not.

use std::time::Duration;

use plumbline_model::robot::Limits;

use super::command::TouchCommand;
use super::testing::{Desk, grid};
use super::view::TouchPhase;
use crate::robot::patience::MOST;
use crate::robot::view::{JointView, MotionState};
use crate::robot::{TouchOrder, TouchRun};

/// What happens while the run waits.
type Happens = fn(&mut Desk);

const MOMENT: Duration = Duration::from_millis(300);

/// An arm that holds, all of its joints heard.
fn desk() -> (Desk, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::new(folder.path());
    desk.robot.motion = MotionState::Holding { why: None };
    let rig = desk.rig.clone();
    let limits = Limits { lower_rad: -3.0, upper_rad: 3.0 };
    let joint = |servo| JointView {
        angle_rad: Some(0.0),
        goal_rad: Some(0.0),
        load: Some(0.0),
        temperature_c: Some(30.0),
        torque_on: Some(true),
        age: Some(Duration::from_millis(10)),
        ..JointView::unheard(servo, limits)
    };
    desk.robot.joints = rig.servos.iter().map(joint).collect();
    (desk, folder)
}

fn paused(desk: &Desk) -> String {
    match desk.view().phase {
        TouchPhase::Paused { why } => why.unwrap_or_default(),
        phase => panic!("{phase:?}"),
    }
}

fn unheard(desk: &mut Desk, order: &TouchOrder) {
    desk.say(order, TouchRun::Unheard("The servo of Right elbow was not heard in time.".to_owned()));
}

/// A run whose first touch was interrupted because joints were not heard.
fn interrupted() -> (Desk, TouchOrder, tempfile::TempDir) {
    let (mut desk, folder) = desk();
    desk.start(grid(2, 2));
    let order = desk.order().expect("first");
    unheard(&mut desk, &order);
    assert!(paused(&desk).contains("goes on by itself"), "{}", paused(&desk));
    (desk, order, folder)
}

/// Time in which a run that goes on by itself would have.
fn wait(desk: &mut Desk) {
    (0..10).for_each(|_| desk.wait(MOMENT));
}

#[test]
fn it_goes_on_once_all_joints_were_heard_for_a_while_and_says_so() {
    let (mut desk, order, _folder) = interrupted();
    let joints = desk.robot.joints.clone();
    let mut silent = joints.to_vec();
    silent.iter_mut().for_each(|joint| joint.age = Some(Duration::from_secs(2)));
    desk.robot.joints = silent.into();
    wait(&mut desk);
    assert!(desk.order().is_none(), "nothing moves while joints are not heard");
    desk.robot.joints = joints;
    desk.wait(MOMENT);
    assert!(desk.order().is_none(), "one reading is not enough");
    wait(&mut desk);
    let again = desk.order().expect("it goes on");
    assert_eq!(again.number, order.number);
    assert!(desk.said().contains("goes on by itself"), "{}", desk.said());
    assert_eq!(desk.view().held, 1, "it stays said");
    desk.touch(&again);
    assert!(desk.order().is_some_and(|next| next.number != order.number));
}

#[test]
fn it_stays_after_stop_and_after_whatever_needs_a_person() {
    let cases: [(&str, Happens); 5] = [
        ("STOP", |desk| desk.robot.stopped = true),
        ("goes limp", |desk| change_elbow(desk, |joint| joint.torque_on = Some(false))),
        ("let go", |desk| change_elbow(desk, |joint| joint.let_go = true)),
        ("no force", |desk| change_elbow(desk, |joint| joint.no_force = true)),
        ("moved", |desk| {
            desk.robot.motion =
                MotionState::Moving { what: "to Home".to_owned(), fraction: None, remaining: None };
        }),
    ];
    for (what, happens) in cases {
        let (mut desk, _, _folder) = interrupted();
        let before = desk.robot.clone();
        happens(&mut desk);
        desk.wait(MOMENT);
        desk.robot = before;
        wait(&mut desk);
        assert!(desk.order().is_none(), "{what}");
        assert!(paused(&desk).contains("It did not"), "{what}: {}", paused(&desk));
        desk.apply(TouchCommand::Resume);
        assert!(desk.order().is_some(), "the operator says so: {what}");
    }
}

fn change_elbow(desk: &mut Desk, change: fn(&mut JointView)) {
    let mut joints = desk.robot.joints.to_vec();
    change(joints.iter_mut().find(|joint| joint.name == "r_elbow_y").expect("NICO has it"));
    desk.robot.joints = joints.into();
}

#[test]
fn what_is_wrong_with_a_joint_keeps_it_waiting_and_then_it_is_the_operators() {
    let (mut desk, _, _folder) = interrupted();
    change_elbow(&mut desk, |joint| joint.problem = Some("servo 5 is 71 °C hot".to_owned()));
    (0..80).for_each(|_| desk.wait(MOMENT));
    assert!(paused(&desk).contains("It did not: For 20 s"), "{}", paused(&desk));
    change_elbow(&mut desk, |joint| joint.problem = None);
    wait(&mut desk);
    assert!(desk.order().is_none());
}

#[test]
fn the_operators_pause_and_a_refusal_are_no_reason_to_go_on() {
    let (mut desk, _, _folder) = interrupted();
    desk.apply(TouchCommand::Pause);
    wait(&mut desk);
    assert_eq!((paused(&desk), desk.order().is_none()), (String::new(), true));
    desk.apply(TouchCommand::Resume);
    let order = desk.order().expect("as asked");
    desk.say(&order, TouchRun::Interrupted("The elbow would meet the table.".to_owned()));
    wait(&mut desk);
    assert!(desk.order().is_none() && paused(&desk).contains("meet the table"));
}

#[test]
fn it_goes_on_a_few_times_in_a_row_only_and_a_touch_begins_the_row_anew() {
    let (mut desk, _, _folder) = interrupted();
    for _ in 0..MOST {
        wait(&mut desk);
        let order = desk.order().expect("it goes on");
        unheard(&mut desk, &order);
    }
    assert!(!paused(&desk).contains("by itself"), "{}", paused(&desk));
    wait(&mut desk);
    assert!(desk.order().is_none());
    desk.apply(TouchCommand::Resume);
    let order = desk.order().expect("as asked");
    desk.touch(&order);
    let order = desk.order().expect("the next one");
    unheard(&mut desk, &order);
    wait(&mut desk);
    assert!(desk.order().is_some());
}
