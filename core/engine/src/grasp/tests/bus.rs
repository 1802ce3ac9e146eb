//! The bus fails in the middle of a grasp: the record on disk says what happened, and when port and power are
//! there again the arm holds and the next grasp works.

use plumbline_grasp::{Failure, HandChoice, Record, Step};
use plumbline_twin::Toy;

use super::bench::{Bench, words};
use crate::command::{GraspCommand, HandStep, RobotCommand, TwinCommand};
use crate::robot::view::Connection;
use crate::view::{Gate, GateState, GraspOutcome, GraspStep, Need, View};

const EASY_M: [f64; 2] = [0.32, -0.15];
/// What holds moves by less, rad.
const HOLDS_RAD: f64 = 0.02;

fn fault(bench: &Bench, name: &str, on: bool) {
    bench.send(TwinCommand::Fault { name: name.to_owned(), on });
}

/// A grasp in the middle of which the bus fails, to its end: what was kept, and why it ended.
fn broken_in(bench: &Bench, step: GraspStep, name: &str) -> (Record, String) {
    bench.begin();
    let view = bench.until_step(step);
    let run = view.grasp.run.clone().expect("it is under way");
    assert!(run.outcome.is_none(), "it ended before: {}", words(run.outcome.as_ref()));
    fault(bench, name, true);
    bench.until_idle();
    let record = bench.kept();
    let Some(GraspOutcome::Failed { failure: Failure::Halted, why }) = &record.outcome else {
        panic!("{}", words(record.outcome.as_ref()))
    };
    println!("{name} in {step:?}: {why}");
    let why = why.clone();
    (record, why)
}

fn arm_gate(view: &View) -> Option<&Gate> {
    view.grasp.gates.iter().find(|gate| gate.of == Need::Arm)
}

fn grasps_again(bench: &Bench) {
    bench.settle();
    bench.until("nothing in the way of a grasp", |view| view.grasp.trouble().is_none());
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
}

#[test]
fn a_port_that_is_unplugged_in_the_approach_is_told_and_after_connecting_the_next_grasp_works() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    let (record, why) = broken_in(&bench, GraspStep::Approach, "port-closed");
    assert!(why.contains("the robot is not known any more"), "{why}");
    assert_eq!(record.step, Some(Step::Approach));
    let view = bench
        .until("the connection to be lost", |view| matches!(view.robot.connection, Connection::Lost { .. }));
    let trouble = view.grasp.trouble().expect("nothing can be grasped");
    let Connection::Lost { reason, .. } = &view.robot.connection else { unreachable!("just seen") };
    assert_eq!(trouble, reason, "the first gate says what the lamp says");

    fault(&bench, "port-closed", false);
    bench.send(RobotCommand::Scan);
    assert!(bench.make_ready(Toy::Tomato, EASY_M), "its eyes were rendered before");
    let moved_rad = bench.creeps_rad();
    assert!(moved_rad < HOLDS_RAD, "connected again it moves by {moved_rad} rad");
    // It is the same twin, whose hand was left in the air.
    bench.hand(HandStep::Home);
    grasps_again(&bench);
}

#[test]
fn an_elbow_without_power_in_the_lift_is_named_and_holds_when_it_is_told_to() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    // Left the choice, the other hand would grasp.
    bench.send(GraspCommand::Arm(HandChoice::Right));
    let (record, why) = broken_in(&bench, GraspStep::Lift, "elbow-power-cut");
    assert!(why.to_lowercase().contains("right elbow"), "{why}");
    let reached = record.step.expect("it was begun");
    assert!([Step::Lift, Step::Check].contains(&reached), "{reached:?}");
    bench.until("the elbow to be missed", |view| {
        arm_gate(view).is_some_and(|gate| gate.state == GateState::Shut && gate.text.contains("elbow"))
    });

    // With power it is limp, and nothing takes hold of it unasked.
    fault(&bench, "elbow-power-cut", false);
    bench.until("a limp elbow", |view| {
        arm_gate(view).is_some_and(|gate| gate.text.contains("Right elbow does not hold"))
    });
    bench.send(RobotCommand::Torque { joints: vec![], on: true });
    bench.until("an arm that holds", |view| {
        arm_gate(view).is_some_and(|gate| gate.state != GateState::Shut)
            && view.robot.joints.iter().all(|joint| joint.torque_on == Some(true) && !joint.let_go)
    });
    let moved_rad = bench.creeps_rad();
    assert!(moved_rad < HOLDS_RAD, "told to hold it moves by {moved_rad} rad");

    // Somebody puts arm and things back to where they were.
    bench.send(TwinCommand::Reset);
    bench.settle();
    assert!(bench.make_ready(Toy::Tomato, EASY_M), "its eyes were rendered before");
    bench.hand(HandStep::Open);
    grasps_again(&bench);
}
