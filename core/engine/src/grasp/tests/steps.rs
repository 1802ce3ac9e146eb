//! Steps of a hand by themselves, and Home in the middle of a grasp.

use std::sync::Arc;
use std::time::Duration;

use nalgebra::Vector3;
use plumbline_effects::RobotModel;
use plumbline_grasp::{Failure, Hand, HandChoice, PalmArm};
use plumbline_model::robot::Rig;
use plumbline_twin::Toy;

use super::bench::{Bench, is_truly_lifted, truly_at_m, words};
use crate::command::{GraspCommand, HandStep};
use crate::view::{GraspOutcome, GraspPhase, GraspStep, HandWaits, View};

const EASY_M: [f64; 2] = [0.32, -0.15];
/// Where the right hand hands over (`steps.rs`): in front of the robot, to its side, over the table, m.
const GIVE_M: [f64; 3] = [0.34, -0.16, 0.26];

fn rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("comes with the program"))
}

/// How far the joints of the right arm are from home at most, rad.
fn from_home_rad(rig: &Rig, view: &View) -> f64 {
    let arm = &rig.arm("right").expect("an arm").joints;
    let (here, home) = (view.robot.measured.as_ref().expect("read").of(arm), rig.home().of(arm));
    here.iter().zip(&home).map(|(here, home)| (here - home).abs()).fold(0.0, f64::max)
}

/// How far the right index finger is bent, rad.
fn bent_rad(rig: &Rig, view: &View) -> f64 {
    let finger = rig.description.find_joint("r_indexfinger_x").expect("a finger");
    -view.robot.measured.as_ref().expect("read")[finger]
}

fn palm_m(rig: &Arc<Rig>, view: &View) -> Vector3<f64> {
    let arm = PalmArm::new(&RobotModel::nominal(rig.clone()), Hand::Right.name()).expect("an arm");
    arm.palm(view.robot.measured.as_ref().expect("read")).coords.coords
}

/// The view once readings of now have come.
fn now(bench: &Bench) -> Arc<View> {
    bench.settle();
    bench.until("angles", |view| view.robot.measured.is_some())
}

#[test]
fn home_in_the_middle_of_a_grasp_ends_it_and_the_arm_goes_home() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    let rig = rig();
    bench.send(GraspCommand::Arm(HandChoice::Right));
    bench.begin();
    let view = bench.until_step(GraspStep::Lower);
    let begins_rad = from_home_rad(&rig, &view);
    assert!(begins_rad > 0.3, "over the thing it is only {begins_rad} rad from home");
    std::thread::sleep(Duration::from_millis(200));
    bench.send(GraspCommand::Hand(HandStep::Home));
    bench.until("the way home to begin", |view| {
        matches!(view.grasp.phase, GraspPhase::Hand { step: HandStep::Home, .. })
    });
    let view = bench.until_idle();
    let run = view.grasp.run.clone().expect("there was one");
    assert!(
        matches!(&run.outcome, Some(GraspOutcome::Failed { failure: Failure::Halted, why }) if why.contains("ended by the operator")),
        "{}",
        words(run.outcome.as_ref())
    );
    let record = bench.kept();
    assert_eq!((record.step, record.outcome), (Some(GraspStep::Lower), run.outcome.clone()));
    let left_rad = from_home_rad(&rig, &now(&bench));
    assert!(left_rad < 0.05, "it ends {left_rad} rad from home");
}

#[test]
fn the_hand_lifts_hands_over_and_closes_when_each_is_asked_for_by_itself() {
    let Some(bench) = Bench::start("perfect", Toy::Tomato, EASY_M) else { return };
    let rig = rig();
    bench.send(GraspCommand::Arm(HandChoice::Right));
    let run = bench.grasp();
    assert_eq!(run.outcome, Some(GraspOutcome::Success), "{run:?}");
    let low = now(&bench);

    bench.hand(HandStep::Lift);
    let high = now(&bench);
    let up_m = palm_m(&rig, &high) - palm_m(&rig, &low);
    assert!((up_m.z - 0.1).abs() < 0.02 && up_m.xy().norm() < 0.02, "straight up by {up_m:?}");
    let tomato_m = |view: &View| truly_at_m(view, Toy::Tomato).expect("out")[2];
    let carried_m = tomato_m(&high) - tomato_m(&low);
    assert!((carried_m - up_m.z).abs() < 0.03, "the tomato comes up by {carried_m} m");
    assert!(bent_rad(&rig, &high) > 0.4, "fingers stay as they are");

    bench.hand(HandStep::Give);
    let given = now(&bench);
    let [x_m, y_m, over_table_m] = GIVE_M;
    let off_m = palm_m(&rig, &given) - Vector3::new(x_m, y_m, rig.table.height_m + over_table_m);
    assert!(off_m.norm() < 0.02, "it hands over {off_m:?} beside");
    assert!(bent_rad(&rig, &given) > 0.4, "it holds on until somebody has it");
    assert!(is_truly_lifted(&given, Toy::Tomato) && given.grasp.held.is_some(), "it is held out");
    assert_eq!(given.grasp.hand_waits, Some(HandWaits::Offers));
    bench.hand(HandStep::Open);
    let opened = now(&bench);
    assert!(bent_rad(&rig, &opened) < 0.2, "the hand is open: {}", bent_rad(&rig, &opened));
    assert!(
        !is_truly_lifted(&opened, Toy::Tomato) && opened.grasp.held.is_none(),
        "nobody took it: it falls"
    );

    bench.hand(HandStep::Close);
    let closed = now(&bench);
    assert!(bent_rad(&rig, &closed) > 0.5, "it is bent by {} rad", bent_rad(&rig, &closed));
    assert!((palm_m(&rig, &closed) - palm_m(&rig, &given)).norm() < 0.01, "the arm stays");
}
