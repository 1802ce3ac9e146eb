//! The wait for joints that were late, on states of joints that nobody read.

use std::time::{Duration, Instant};

use plumbline_hardware::joints::{
    Chains, HoldReason, JointReading, JointState, MoveOutcome, Refusal, Unheard,
};
use plumbline_model::Stamp;
use plumbline_model::robot::{JointIndex, Rig};

use super::GivenUp;
use super::late::{Late, MOST, Way, ended_late};

/// The robot, its elbow, and a reason to wait for that.
struct Arm {
    rig: Rig,
    together: Chains,
    elbow: JointIndex,
    began: Instant,
}

impl Arm {
    fn new() -> Self {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let elbow = rig.description.find_joint("r_elbow_y").expect("a joint");
        Self { together: Chains::of(&rig.description), elbow, rig, began: Instant::now() }
    }

    fn at(&self, milliseconds: u64) -> Instant {
        self.began + Duration::from_millis(milliseconds)
    }

    /// What is read of the elbow at a moment.
    fn read(&self, milliseconds: u64) -> JointReading {
        JointReading {
            angle_rad: Some(0.1),
            torque_on: Some(true),
            read_at: Some(self.at(milliseconds)),
            ..JointReading::new(self.elbow, 5)
        }
    }

    fn state(&self, reading: JointReading, unknown: &[JointIndex], late: &[JointIndex]) -> JointState {
        let stamp = Stamp { seq: 1, captured_at: self.began };
        let state = JointState::new(stamp, [reading]);
        JointState { unknown: unknown.into(), late: late.into(), ..state }
    }

    fn waits(&self, late: &mut Late, state: &JointState, milliseconds: u64) -> Result<bool, GivenUp> {
        let Self { rig, together, .. } = self;
        let way = Way { rig, together, state, joints: &[self.elbow], is_alone: false };
        late.waits(way, self.at(milliseconds))
    }

    fn waiting(&self) -> Late {
        let mut late = Late::default();
        late.begin(why(), true, self.began).expect("it is waited for");
        late
    }
}

fn why() -> GivenUp {
    GivenUp::Lost("the elbow was not heard".to_owned())
}

#[test]
fn it_goes_on_once_all_were_heard_for_a_while_and_is_told_once() {
    let (mut late, arm) = (Late::default(), Arm::new());
    let elbow = arm.elbow;
    assert_eq!(arm.waits(&mut late, &arm.state(arm.read(0), &[], &[]), 0), Ok(false), "nothing happened");
    late.begin(why(), true, arm.began).expect("it is waited for");
    let said = late.take_news().expect("it is told");
    assert!(said.contains("goes on by itself: the elbow was not heard."), "{said}");
    assert_eq!(late.take_news(), None);
    // When it is looked, when the elbow was read, and whether it is late then.
    for (milliseconds, read, is_late, waits) in [
        (1000, 100, false, true),
        (1500, 1490, false, true),
        // Not known once more: it begins anew.
        (2200, 2190, true, true),
        (2300, 2290, false, true),
        (3200, 3190, false, true),
        (3300, 3290, false, false),
        (3400, 2500, false, false),
    ] {
        let unknown: &[JointIndex] = if is_late { &[elbow] } else { &[] };
        let state = arm.state(arm.read(read), unknown, unknown);
        assert_eq!(arm.waits(&mut late, &state, milliseconds), Ok(waits), "{milliseconds} ms");
    }
    assert!(!late.is_waiting());
}

#[test]
fn what_was_read_once_is_not_heard_for_as_long_as_it_stands_there() {
    let arm = Arm::new();
    let (mut late, state) = (arm.waiting(), arm.state(arm.read(0), &[], &[]));
    for milliseconds in [0, 200, 600, 1000, 1400, 20_000] {
        assert_eq!(arm.waits(&mut late, &state, milliseconds), Ok(true), "{milliseconds} ms");
    }
    assert_eq!(arm.waits(&mut late, &state, 20_001), Err(why()));
}

#[test]
fn what_is_not_heard_again_or_too_often_ends_it_with_the_first_reason() {
    let arm = Arm::new();
    let (mut late, elbow) = (arm.waiting(), arm.elbow);
    let unheard = arm.state(arm.read(0), &[elbow], &[elbow]);
    assert_eq!(arm.waits(&mut late, &unheard, 20_000), Ok(true));
    // Held by the operator it waits as long as he does.
    late.paused(arm.at(20_000));
    assert_eq!(arm.waits(&mut late, &unheard, 39_000), Ok(true));
    assert_eq!(arm.waits(&mut late, &unheard, 40_001), Err(why()));
    for _ in 1..MOST {
        late.begin(why(), true, arm.began).expect("it is waited for");
    }
    assert_eq!(late.begin(why(), true, arm.began), Err(why()));
    assert_eq!(Late::default().begin(why(), false, arm.began), Err(why()), "it was something else");
}

#[test]
fn a_joint_that_lost_its_torque_or_was_let_go_ends_it_at_once_and_is_named() {
    let arm = Arm::new();
    let limp = JointReading { torque_on: Some(false), ..arm.read(90) };
    let let_go = JointReading { let_go: true, ..arm.read(90) };
    for (reading, what) in [(limp, "lost its torque"), (let_go, "take hold of it")] {
        let mut late = arm.waiting();
        let ended = arm.waits(&mut late, &arm.state(reading, &[], &[]), 100).expect_err("it must not go on");
        let GivenUp::Lost(said) = ended else { panic!("{ended:?}") };
        assert!(said.contains("Right elbow") && said.contains(what), "{said}");
    }
}

#[test]
fn a_servo_that_does_not_answer_ends_it_after_a_second_and_is_named() {
    let arm = Arm::new();
    let joint = |name| arm.rig.description.find_joint(name).expect("a joint");
    // Power is cut: it is let go, too, but that is not what is wrong.
    let cut = JointReading { torque_on: None, let_go: true, ..arm.read(0) };
    for (reading, silent, name) in
        [(cut, arm.elbow, "Right elbow"), (arm.read(0), joint("r_shoulder_y"), "Right shoulder swing")]
    {
        let (mut late, state) = (arm.waiting(), arm.state(reading, &[silent], &[]));
        assert_eq!(arm.waits(&mut late, &state, 100), Ok(true), "it may only seem so");
        assert_eq!(arm.waits(&mut late, &state, 1099), Ok(true));
        let said = arm.waits(&mut late, &state, 1100).expect_err("it is silent").to_string();
        assert!(said.contains(name) && said.contains("check its cable and power"), "{said}");
    }
    // What is not on this way keeps nothing from going on.
    let mut late = arm.waiting();
    for (milliseconds, waits) in [(100, true), (1200, false)] {
        let state = arm.state(arm.read(milliseconds), &[joint("l_elbow_y")], &[]);
        assert_eq!(arm.waits(&mut late, &state, milliseconds), Ok(waits), "{milliseconds} ms");
    }
}

#[test]
fn a_window_that_does_not_answer_ends_it() {
    let arm = Arm::new();
    let state = arm.state(arm.read(90), &[], &[]);
    let Arm { rig, together, .. } = &arm;
    let way = Way { rig, together, state: &state, joints: &[arm.elbow], is_alone: true };
    assert_eq!(Late::default().waits(way, arm.at(100)), Ok(false), "it does not wait");
    let said = arm.waiting().waits(way, arm.at(100)).expect_err("nobody watches").to_string();
    assert!(said.contains("the window does not answer"), "{said}");
}

#[test]
fn only_a_busy_computer_is_waited_out() {
    let arm = Arm::new();
    let (joint, known) = (arm.elbow, arm.state(arm.read(0), &[], &[]));
    let unknown = |why| Refusal::Unknown { joint, name: "Elbow".to_owned(), why };
    assert!(ended_late(&MoveOutcome::Held(HoldReason::Refused(unknown(Unheard::TooBusy))), &known));
    assert!(ended_late(&MoveOutcome::Refused(unknown(Unheard::TooBusy)), &known));
    let (age, since) = (Duration::from_millis(300), Duration::from_secs(1));
    let slow = MoveOutcome::Held(HoldReason::Slow { joint, name: "Elbow".to_owned(), age, since });
    assert!(ended_late(&slow, &known));
    assert!(ended_late(&slow, &arm.state(arm.read(0), &[joint], &[joint])));
    assert!(!ended_late(&slow, &arm.state(arm.read(0), &[joint], &[])), "it does not answer at all");
    let silent = HoldReason::NoAnswer { joint, name: "Elbow".to_owned(), servo: 5, cycles: 25 };
    for reason in [silent, HoldReason::Stop, HoldReason::Refused(unknown(Unheard::Silent))] {
        assert!(!ended_late(&MoveOutcome::Held(reason.clone()), &known), "{reason}");
    }
    assert!(!ended_late(&MoveOutcome::Replaced, &known));
}
